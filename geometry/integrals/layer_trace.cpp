#include "geometry/integrals/layer_trace.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "geometry/integrals/edge_trace.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "lib/execution/dispatch.hpp"

namespace apothem {

using namespace edge_detail;

namespace {

// The box of a polygon, enlarged so that no point outside reaches into it by rounding.
Box reach_of(const PlacedPotential& p, double dx, double dy) {
  const Box box = box_of(p, {dx, dy});
  return box.grown(kFarAway * box.extent());
}

// The sides of a box beyond which a point lies, with one bit for each of the four.
unsigned beyond(const Box& box, double x, double y) {
  return unsigned{x < box.x0} | unsigned{x > box.x1} << 1 | unsigned{y < box.y0} << 2 |
         unsigned{y > box.y1} << 3;
}

// Calls f(edge) for the edges whose boxes are not apart from the box `reach`.
template <class F>
void for_each_edge(const PlacedPotential& p, double dx, double dy, const Box& reach, const F& f) {
  for_each_ring(p.links, p.size, [&](int first, int last) {
    const auto sides = [&](int v) { return beyond(reach, p.x[v] + dx, p.y[v] + dy); };
    unsigned start = sides(first);
    for (int e = first; e < last; ++e) {
      const unsigned end = sides(p.end(e));
      if ((start & end) == 0) f(e);
      start = end;
    }
  });
}

}  // namespace

void LayerTrace::find(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                      std::uint64_t near_x, std::uint64_t near_y, bool use) {
  distance_ = y.distance != nullptr;
  list_edges(x, y, dx, dy, near_x);
  // The layers of polygons with holes are not made.
  if (!use || !y.layer || x.links) {
    segments_.clear();
    for (LayerEdge& edge : edges_) edge.beyond_layer = true, edge.segments_end = 0;
    return;
  }
  list_windows(x, y, dx, dy, near_y);
  while (!trace(x, y, dx, dy)) {
  }
  find_beyond(x, y, dx, dy);
}

// Lists the edges that may enter y. If nothing is known, edges whose boxes are apart from that of y
// are left out.
void LayerTrace::list_edges(const PlacedPotential& x, const PlacedPotential& y, double dx,
                            double dy, std::uint64_t near) {
  edges_.clear();
  const auto add = [&](int e) { edges_.push_back({e, PlacedEdge(x, y, e, dx, dy), false, 0}); };
  if (near != NearEdges::kAll) {
    for_each_edge(near, x.size, add);
  } else {
    for_each_edge(x, dx, dy, reach_of(y, 0, 0), add);
  }
}

// Finds the remaining edges that are not entirely in the layer. The boundary of x is one line: an
// edge that is deeper than the layer everywhere follows an edge that leaves the layer, or another
// such edge. Cells that only such edges reach may be unknown. So an edge that follows one beyond
// the layer is beyond the layer as well if it begins inside y.
void LayerTrace::find_beyond(const PlacedPotential& x, const PlacedPotential& y, double dx,
                             double dy) {
  if (edges_.empty()) return;
  const auto begins_inside = [&](const LayerEdge& edge) {
    return encloses(y, Vec2::Zero(), {x.x[edge.index] + dx, x.y[edge.index] + dy});
  };
  // If all edges are beyond the layer, no edge that leaves the layer precedes them, and the first
  // one has to be tested.
  const bool round = static_cast<int>(edges_.size()) == x.size;
  if (round && segments_.empty() && !edges_[0].beyond_layer)
    edges_[0].beyond_layer = begins_inside(edges_[0]);
  const LayerEdge* before = nullptr;
  for (LayerEdge& edge : edges_) {
    const bool follows = before && before->beyond_layer && before->index + 1 == edge.index;
    if (follows && !edge.beyond_layer) edge.beyond_layer = begins_inside(edge);
    before = &edge;
  }
  if (!before->beyond_layer || before->index != x.size - 1 || edges_[0].index != 0) return;
  for (size_t i = 0; i < edges_.size() && edges_[i].index == static_cast<int>(i); ++i) {
    if (edges_[i].beyond_layer) break;
    edges_[i].beyond_layer = begins_inside(edges_[i]);
    if (!edges_[i].beyond_layer) break;
  }
}

void LayerTrace::list_windows(const PlacedPotential& x, const PlacedPotential& y, double dx,
                              double dy, std::uint64_t near) {
  windows_.clear();
  const auto add = [&](int c) {
    if (windows_.empty() || c >= windows_.back().first + kPack) windows_.push_back({c, 0});
    windows_.back().cells |= 1u << (c - windows_.back().first);
  };
  if (near != NearEdges::kAll) {
    for_each_edge(near, y.size, add);
    return;
  }
  for_each_edge(y, 0, 0, reach_of(x, dx, dy), add);
}

// The last window that begins at the cell or before it, or null.
LayerTrace::Window* LayerTrace::window_of(int cell) {
  const auto behind = std::upper_bound(windows_.begin(), windows_.end(), cell,
                                       [](int c, const Window& w) { return c < w.first; });
  return behind == windows_.begin() ? nullptr : &*(behind - 1);
}

// Lists a cell. Returns false if it was listed before.
bool LayerTrace::add_cell(int cell) {
  Window* const window = window_of(cell);
  if (window && cell < window->first + kPack) {
    const unsigned bit = 1u << (cell - window->first);
    const bool added = (window->cells & bit) == 0;
    window->cells |= bit;
    return added;
  }
  const auto position =
      window ? windows_.begin() + (window - windows_.data()) + 1 : windows_.begin();
  windows_.insert(position, {cell, 1});
  return true;
}

// Lists the cells on both sides of a cell in which an edge has ended. Returns false if both were
// listed before.
bool LayerTrace::add_neighbours(const PlacedPotential& y, int cell) {
  const bool before = add_cell(previous(cell, y.size));
  const bool after = add_cell(next(cell, y.size));
  return before || after;
}

// True if the present edge touches edge c of y up to round-off, whose cell must not be used.
bool LayerTrace::touches(const PlacedPotential& y, int c) const {
  constexpr double kNear = 1e-9;  // round-off of phi
  const auto height = [&](double px, double py) {
    return y.gx[c] * (px - y.x[c]) + y.gy[c] * (py - y.y[c]);
  };
  const auto foot = [&](double px, double py) {
    return y.gy[c] * (px - y.x[c]) - y.gx[c] * (py - y.y[c]);
  };
  const double a = height(edge_->px, edge_->py), b = height(end_x_, end_y_);
  if (std::min(a, b) > kNear || std::max(a, b) < -kNear) return false;
  // The part of the present edge that is near the line of edge c.
  const double s = (kNear - a) / (b - a), t = (-kNear - a) / (b - a);
  const bool level = !(std::abs(b - a) > kNear);
  const double s0 = level ? 0 : std::clamp(std::min(s, t), 0., 1.);
  const double s1 = level ? 1 : std::clamp(std::max(s, t), 0., 1.);
  const double from = foot(edge_->px, edge_->py), to = foot(end_x_, end_y_);
  const double u = from + s0 * (to - from), v = from + s1 * (to - from);
  return std::max(u, v) >= -kNear && std::min(u, v) <= foot(y.x[c + 1], y.y[c + 1]) + kNear;
}

// Finds the pieces of the present edge in the cells of a window.
APOTHEM_INLINE LayerTrace::Found LayerTrace::trace_cells(const PlacedPotential& y,
                                                         const Window& window) {
  const auto line = [&](int i) APOTHEM_LAMBDA {
    const int k = window.first + i;
    return CellLine{Pack::load(y.x + k), Pack::load(y.y + k), Pack::load(y.gx + k),
                    Pack::load(y.gy + k)};
  };
  const Pack zero(0.);
  const CellShapes cells{Pack::load(y.layer->depth.data() + window.first),
                         Pack::load(y.layer->side.data() + window.first),
                         Pack::load(y.layer->side.data() + window.first + 1)};
  const Pack::Mask listed = listed_lanes(window.cells);
  for (unsigned rest = bits(listed & (cells.depth == zero)); rest != 0; rest &= rest - 1) {
    if (touches(y, window.first + std::countr_zero(rest))) return Found::beyond;
  }
  CellParts parts;
  if (!find_parts(cell_heights(line, edge_->px, edge_->py, distance_),
                  cell_heights(line, end_x_, end_y_, distance_), cells,
                  listed & (cells.depth > zero), distance_, parts)) {
    return Found::all;
  }
  enum { s0_, s1_, v0_, v1_, end0_, end1_, kNumbers };
  double numbers[kNumbers][kPack];
  parts.s0.store(numbers[s0_]), parts.s1.store(numbers[s1_]);
  parts.v0.store(numbers[v0_]), parts.v1.store(numbers[v1_]);
  parts.end0.store(numbers[end0_]), parts.end1.store(numbers[end1_]);
  for (unsigned rest = bits(parts.there); rest != 0; rest &= rest - 1) {
    const int k = std::countr_zero(rest);
    const int c = window.first + k;
    Piece& piece = pieces_[count_++];
    piece.s0 = numbers[s0_][k], piece.s1 = numbers[s1_][k];
    piece.v0 = numbers[v0_][k], piece.v1 = numbers[v1_][k];
    piece.end0 = static_cast<End>(numbers[end0_][k]);
    piece.end1 = static_cast<End>(numbers[end1_][k]);
    piece.cell = c;
    piece.arc = false;
    if (piece.end0 <= kEdge && piece.end1 <= kEdge) continue;
    const Found found = check_borders(y, piece, previous(c, y.size), next(c, y.size));
    if (found != Found::all) return found;
  }
  return Found::all;
}

APOTHEM_INLINE bool LayerTrace::trace_edges(const PlacedPotential& x, const PlacedPotential& y,
                                            double dx, double dy) {
  // `ended` is the cell in which the edge before has ended, or -1. An edge that does not begin
  // there begins on a border, in a cell that may be unlisted or too shallow.
  int ended = -1, last = -1;
  bool first_begins = false;
  for (LayerEdge& listed : edges_) {
    const int e = listed.index;
    const PlacedEdge& edge = listed.placed;
    edge_ = &edge;
    end_x_ = edge.shortened ? edge.px + edge.ex : x.x[e + 1] + dx;
    end_y_ = edge.shortened ? edge.py + edge.ey : x.y[e + 1] + dy;
    count_ = 0;
    Found found = Found::all;
    for (size_t i = 0; i < windows_.size() && found == Found::all; ++i) {
      found = trace_cells(y, windows_[i]);
    }
    if (distance_ && found == Found::all) found = trace_sectors(y);
    if (found == Found::neighbour) return false;
    listed.beyond_layer = found == Found::beyond;
    if (!listed.beyond_layer && count_ > 0) close_pieces(y);
    listed.segments_end = segments_.size();
    bool begins = listed.beyond_layer;
    int ends = -1;
    for (size_t i = 0; i < count_ && !listed.beyond_layer; ++i) {
      begins = begins || (pieces_[i].s0 == 0 && pieces_[i].end0 == kEdge);
      if (pieces_[i].end1 == kEdge) ends = pieces_[i].cell;
    }
    if (e == 0) first_begins = begins;
    if (last + 1 == e && ended >= 0 && !begins) {
      if (add_neighbours(y, ended)) return false;
      listed.beyond_layer = encloses(y, Vec2::Zero(), {edge.px, edge.py});
    }
    last = e, ended = ends;
  }
  const bool round = last == x.size - 1 && edges_[0].index == 0;
  if (round && ended >= 0 && !first_begins) {
    if (add_neighbours(y, ended)) return false;
    edges_[0].beyond_layer = encloses(y, Vec2::Zero(), {edges_[0].placed.px, edges_[0].placed.py});
  }
  return true;
}

// Traces all edges. Returns false if more cells were found, so that the trace must be repeated.
bool LayerTrace::trace(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy) {
  segments_.clear();
  // Each cell has at most one piece, and so has the sector of each of its two vertices.
  if (const size_t most = size_t{3} * kPack * windows_.size(); pieces_.size() < most)
    pieces_.resize(most);
  bool done = true;
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    done = trace_edges(x, y, dx, dy);
    return 0.;
  });
  return done;
}

// Checks whether a piece stays in the layer and whether the adjacent cells are listed; cells that
// are not are added.
LayerTrace::Found LayerTrace::check_borders(const PlacedPotential& y, const Piece& piece,
                                            int before, int after) {
  if (piece.end0 == kDepthLimit || piece.end1 == kDepthLimit) return Found::beyond;
  Found found = Found::all;
  const auto enter = [&](double v, int cell, bool by_sector) {
    if (!(v < y.layer->depth[cell])) {
      if (found == Found::all) found = Found::beyond;
    } else if (!by_sector) {
      if (add_cell(cell)) found = Found::neighbour;
    }
  };
  for (const auto& [end, v] : {std::pair(piece.end0, piece.v0), std::pair(piece.end1, piece.v1)}) {
    if (end == kBorderBefore) enter(v, before, !piece.arc && sector_at(y, piece.cell));
    if (end == kBorderAfter) enter(v, after, !piece.arc && sector_at(y, after));
  }
  return found;
}

// Finds the pieces of the present edge in the sectors of the vertices of all cells.
LayerTrace::Found LayerTrace::trace_sectors(const PlacedPotential& y) {
  int last = -1;  // last vertex that was treated
  const bool begins_at_zero = !windows_.empty() && windows_[0].first == 0;
  for (const Window& window : windows_) {
    for (int k = 0; k < kPack; ++k) {
      if ((window.cells >> k & 1) == 0) continue;
      const int c = window.first + k, d = next(c, y.size);
      if (c != last && sector_at(y, c)) {
        if (const Found found = trace_sector(y, c); found != Found::all) return found;
      }
      if (!(d == 0 && begins_at_zero) && sector_at(y, d)) {
        if (const Found found = trace_sector(y, d); found != Found::all) return found;
      }
      last = d;
    }
  }
  return Found::all;
}

LayerTrace::Found LayerTrace::trace_sector(const PlacedPotential& y, int vertex) {
  const PlacedEdge& edge = *edge_;
  Piece& piece = pieces_[count_];
  piece = {.s0 = 0,
           .s1 = 1,
           .v0 = 0,
           .v1 = 0,
           .end0 = kEdge,
           .end1 = kEdge,
           .cell = vertex,
           .arc = true,
           .foot = 0,
           .square = 0};
  // The sector lies beyond the end of the edge before the vertex and beyond the start of the edge
  // after it.
  const auto cut = [&](int e, double sign, bool closed, End cause) {
    const auto foot = [&](double px, double py) {
      return sign * (y.gy[e] * (px - y.x[vertex]) - y.gx[e] * (py - y.y[vertex]));
    };
    const double a = foot(edge.px, edge.py), b = foot(end_x_, end_y_);
    const bool a_inside = closed ? a >= 0 : a > 0, b_inside = closed ? b >= 0 : b > 0;
    if (a_inside && b_inside) return true;
    if (!a_inside && !b_inside) return false;
    const double s = a / (a - b);
    if (a_inside && s < piece.s1) piece.s1 = s, piece.end1 = cause;
    if (b_inside && s > piece.s0) piece.s0 = s, piece.end0 = cause;
    return piece.s0 < piece.s1;
  };
  if (!cut(vertex - 1, 1, true, kBorderBefore)) return Found::all;
  if (!cut(vertex, -1, false, kBorderAfter)) return Found::all;
  const int before = previous(vertex, y.size);
  const double depth = std::min(y.layer->depth[before], y.layer->depth[vertex]);
  const double slope = y.distance->slope;
  const double rx = y.x[vertex] - edge.px, ry = y.y[vertex] - edge.py;
  const double e2 = edge.ex * edge.ex + edge.ey * edge.ey;
  const double side = (edge.ex * ry - edge.ey * rx) * slope;
  piece.foot = (rx * edge.ex + ry * edge.ey) / e2;
  piece.square = side * side / e2;
  const auto square_at = [&](double s) {
    return piece.square + e2 * slope * slope * ((s - piece.foot) * (s - piece.foot));
  };
  if (!(square_at(std::clamp(piece.foot, piece.s0, piece.s1)) < depth * depth)) return Found::all;
  piece.v0 = std::sqrt(square_at(piece.s0)), piece.v1 = std::sqrt(square_at(piece.s1));
  if (!(piece.v0 < depth && piece.v1 < depth)) return Found::beyond;
  ++count_;
  return check_borders(y, piece, before, vertex);
}

// Sorts the pieces of an edge and joins them to segments.
void LayerTrace::close_pieces(const PlacedPotential& y) {
  const auto behind = [](const Piece& p, const Piece& q) {
    return p.s0 > q.s0 || (p.s0 == q.s0 && p.cell > q.cell);
  };
  for (size_t i = 1; i < count_; ++i) {
    for (size_t j = i; j > 0 && behind(pieces_[j - 1], pieces_[j]); --j) {
      std::swap(pieces_[j], pieces_[j - 1]);
    }
  }
  // If the next cell has no piece, the edge passes a vertex up to round-off.
  const auto crossed = [](const Piece& piece, End end) { return end == kEdge ? -1 : piece.cell; };
  const auto border = [](End end) { return end == kBorderBefore || end == kBorderAfter; };
  LayerSegment* segment = nullptr;
  for (size_t i = 0; i < count_; ++i) {
    const Piece& piece = pieces_[i];
    if (!(segment && segment->s1 == piece.s0 && border(pieces_[i - 1].end1) &&
          border(piece.end0))) {
      segment = &segments_.emplace_back();
      segment->s0 = piece.s0;
      segment->edge0 = crossed(piece, piece.end0);
    }
    segment->s1 = piece.s1;
    segment->edge1 = crossed(piece, piece.end1);
    if (piece.arc) {
      const double length = std::sqrt(edge_->ex * edge_->ex + edge_->ey * edge_->ey);
      add_root(piece.square, length * y.distance->slope, piece.foot, piece.s0, piece.v0, piece.s1,
               piece.v1, segment->moments);
    } else {
      segment->moments.add(piece.s0, piece.v0, piece.s1, piece.v1);
    }
  }
}

}  // namespace apothem
