#include "apothem/geometry/integrals/collar_trace.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/geometry/integrals/edge_trace.hpp"

namespace apothem {

using namespace edge_detail;

namespace {

// The edges of p that a set stands for; if nothing is known, those whose boxes touch the other
// polygon's, which is given by its box.
void list_edges(const PlacedPotential& p, double dx, double dy, std::uint64_t near,
                const Box& other, std::vector<int>& list) {
  list.clear();
  if (near != NearEdges::kAll) {
    for_each_edge(near, p.size, [&](int e) { list.push_back(e); });
    return;
  }
  const Box reach = other.grown(kFarAway * other.extent());
  for (int e = 0; e < p.size; ++e) {
    Box box;
    box.include(p.x[e] + dx, p.y[e] + dy);
    box.include(p.x[e + 1] + dx, p.y[e + 1] + dy);
    if (!apart(box, reach)) list.push_back(e);
  }
}

Box box_of(const PlacedPotential& p, double dx, double dy) {
  Box box;
  for (int i = 0; i < p.size; ++i) box.include(p.x[i] + dx, p.y[i] + dy);
  return box;
}

// Even-odd rule.
bool encloses(const PlacedPotential& y, double px, double py) {
  bool inside = false;
  for (int k = 0; k < y.size; ++k) {
    const double y0 = y.y[k] - py, y1 = y.y[k + 1] - py;
    if ((y0 > 0) == (y1 > 0)) continue;
    const double x0 = y.x[k] - px, x1 = y.x[k + 1] - px;
    if ((x0 * y1 - x1 * y0 > 0) == (y1 > y0)) inside = !inside;
  }
  return inside;
}

}  // namespace

// Whether a sector of points that are nearest to the vertex is between the cells of its edges.
inline bool CollarTrace::sector_before(const PlacedPotential& y, int vertex) const {
  return distance_ && y.cells[vertex].reflex;
}

inline bool CollarTrace::Part::cut(double a, double b, bool a_inside, bool b_inside, int by) {
  if (a_inside && b_inside) return true;
  if (!a_inside && !b_inside) return false;
  const double s = a / (a - b);
  if (a_inside) {
    if (s < s1) s1 = s, end1 = by;
  } else {
    if (s > s0) s0 = s, end0 = by;
  }
  return s0 < s1;
}

bool CollarTrace::find(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                       std::uint64_t near_x, std::uint64_t near_y) {
  distance_ = y.distance != nullptr;
  Box box_x, box_y;
  if (near_x == NearEdges::kAll) box_y = box_of(y, 0, 0);
  if (near_y == NearEdges::kAll) box_x = box_of(x, dx, dy);
  list_edges(x, dx, dy, near_x, box_y, edges_);
  list_edges(y, 0, 0, near_y, box_x, cells_);
  Found found = Found::neighbour;
  while (found == Found::neighbour) found = trace(x, y, dx, dy);
  if (found == Found::deep) return false;
  // The boundary of x is one line. Where no part of it is in the collar, it is either all outside
  // or all inside, deeper.
  return !runs_.empty() || static_cast<int>(edges_.size()) < x.size ||
         !encloses(y, x.x[0] + dx, x.y[0] + dy);
}

// The line of a cell stands between those of its neighbours.
void CollarTrace::place_lines(const PlacedPotential& y) {
  const int n = y.size;
  stride_ = (3 * cells_.size() + kPack - 1) / kPack * kPack;
  if (lines_.size() < kLineNumbers * stride_) lines_.resize(kLineNumbers * stride_);
  slots_.resize(cells_.size());
  double* const to = lines_.data();
  size_t count = 0;
  int last = -2;
  const auto add = [&](int line) {
    const int i = line < 0 ? n - 1 : line < n ? line : 0;
    to[count] = y.gx[i], to[count + stride_] = y.gy[i];
    to[count + 2 * stride_] = y.x[i], to[count + 3 * stride_] = y.y[i];
    if (distance_) {
      to[count + 4 * stride_] = y.x[i + 1], to[count + 5 * stride_] = y.y[i + 1];
    }
    ++count;
    last = line;
  };
  for (size_t k = 0; k < cells_.size(); ++k) {
    const int c = cells_[k];
    if (last < c - 1) add(c - 1);
    if (last < c) add(c);
    slots_[k] = count - 1;
    add(c + 1);
  }
  packs_ = (count + kPack - 1) / kPack;
  const size_t all = packs_ * kPack;
  for (; count < all; ++count) {
    for (size_t k = 0; k < kLineNumbers; ++k) to[count + k * stride_] = 0;
  }
}

// Writes the heights of a point over the lines and, of a distance field, where its foot on a line
// is: behind the first vertex, and behind the second one.
inline void CollarTrace::place_point(double px, double py, double* row) const {
  using Pack = PackOf<kPack>;
  for (size_t i = 0; i < packs_ * kPack; i += kPack) {
    const double* const line = lines_.data() + i;
    const Pack gx = Pack::load(line), gy = Pack::load(line + stride_);
    const Pack rx = Pack(px) - Pack::load(line + 2 * stride_);
    const Pack ry = Pack(py) - Pack::load(line + 3 * stride_);
    (gx * rx + gy * ry).store(row + i);
    if (!distance_) continue;
    const Pack tx = Pack(px) - Pack::load(line + 4 * stride_);
    const Pack ty = Pack(py) - Pack::load(line + 5 * stride_);
    (gy * rx - gx * ry).store(row + stride_ + i);
    (gy * tx - gx * ty).store(row + 2 * stride_ + i);
  }
}

CollarTrace::Found CollarTrace::trace(const PlacedPotential& x, const PlacedPotential& y, double dx,
                                      double dy) {
  place_lines(y);
  runs_.clear();
  const size_t row = (distance_ ? 3 : 1) * stride_;
  if (rows_.size() < 2 * row) rows_.resize(2 * row);
  double* from = rows_.data();
  double* to = from + row;
  int placed = -1;  // the vertex of x in `to`
  for (const int e : edges_) {
    const PlacedEdge edge(x, y, e, dx, dy);
    px_ = edge.px, py_ = edge.py, ex_ = edge.ex, ey_ = edge.ey;
    std::swap(from, to);
    if (placed != e || edge.shortened) place_point(px_, py_, from);
    if (edge.shortened) {
      place_point(px_ + ex_, py_ + ey_, to);
      placed = -1;
    } else {
      place_point(x.x[e + 1] + dx, x.y[e + 1] + dy, to);
      placed = e + 1;
    }
    pieces_.clear();
    for (size_t k = 0; k < cells_.size(); ++k) {
      Found found = trace_cell(y, from, to, k);
      const int c = cells_[k], next = c + 1 == y.size ? 0 : c + 1;
      if (found == Found::all && sector_before(y, c)) {
        found = trace_sector(y, from, to, c, slots_[k]);
      }
      const bool next_follows = k + 1 < cells_.size() ? cells_[k + 1] == next : cells_[0] == next;
      if (found == Found::all && !next_follows && sector_before(y, next)) {
        found = trace_sector(y, from, to, next, slots_[k] + 1);
      }
      if (found != Found::all) return found;
    }
    if (!pieces_.empty()) close_pieces(e, distance_ ? y.distance->slope : 0);
  }
  return Found::all;
}

// The piece is part of the result unless it leaves the collar; the cells next to it, or -1, have to
// be looked at as well.
inline CollarTrace::Found CollarTrace::add_piece(const PlacedPotential& y, const Piece& piece,
                                                 int before, int after) {
  const Part& part = piece.part;
  if (part.end0 == kTop || part.end1 == kTop) return Found::deep;
  pieces_.push_back(piece);
  Found found = Found::all;
  const auto enter = [&](double v, int cell, bool looked_at) {
    if (!(v < y.cells[cell].depth)) {
      found = Found::deep;
    } else if (!looked_at && !std::binary_search(cells_.begin(), cells_.end(), cell)) {
      cells_.insert(std::lower_bound(cells_.begin(), cells_.end(), cell), cell);
      if (found == Found::all) found = Found::neighbour;
    }
  };
  for (const auto& [end, v] : {std::pair(part.end0, piece.v0), std::pair(part.end1, piece.v1)}) {
    if (end == kBefore) enter(v, before, !piece.arc && sector_before(y, piece.cell));
    if (end == kAfter) enter(v, after, !piece.arc && sector_before(y, after));
  }
  return found;
}

// The piece of an edge in a cell; its ends have the rows `from` and `to`.
inline CollarTrace::Found CollarTrace::trace_cell(const PlacedPotential& y, const double* from,
                                                  const double* to, size_t k) {
  const int c = cells_[k];
  const size_t own = slots_[k];
  const double a = from[own], b = to[own];
  if (a < 0 && b < 0) return Found::all;
  const int next = c + 1 == y.size ? 0 : c + 1;
  const double depth = y.cells[c].depth;
  Part part;
  if (!part.cut(a, b, a >= 0, b >= 0, c)) return Found::all;
  if (sector_before(y, c)) {
    const double fa = from[own + stride_], fb = to[own + stride_];
    if (!part.cut(fa, fb, fa >= 0, fb >= 0, kBefore)) return Found::all;
  } else {
    const double sign = y.cells[c].reflex ? -1 : 1;
    const double fa = sign * (from[own - 1] - a), fb = sign * (to[own - 1] - b);
    if (!part.cut(fa, fb, fa >= 0, fb >= 0, kBefore)) return Found::all;
  }
  if (sector_before(y, next)) {
    const double fa = -from[own + 2 * stride_], fb = -to[own + 2 * stride_];
    if (!part.cut(fa, fb, fa > 0, fb > 0, kAfter)) return Found::all;
  } else {
    const double sign = y.cells[next].reflex ? -1 : 1;
    const double fa = sign * (from[own + 1] - a), fb = sign * (to[own + 1] - b);
    if (!part.cut(fa, fb, fa > 0, fb > 0, kAfter)) return Found::all;
  }
  if (depth == 0) return part.end0 == c || part.end1 == c ? Found::deep : Found::all;
  if (!part.cut(depth - a, depth - b, a < depth, b < depth, kTop)) return Found::all;
  const double v0 = part.end0 == c ? 0 : a + part.s0 * (b - a);
  const double v1 = part.end1 == c ? 0 : part.s1 == 1 ? b : a + part.s1 * (b - a);
  return add_piece(y, {part, c, false, v0, v1, 0, 0}, c == 0 ? y.size - 1 : c - 1, next);
}

// The piece in the sector of a vertex; `own` is the place of the line of the edge behind it.
inline CollarTrace::Found CollarTrace::trace_sector(const PlacedPotential& y, const double* from,
                                                    const double* to, int vertex, size_t own) {
  const double* const e0 = from + 2 * stride_ + own - 1;  // behind the end of the edge before it
  const double* const e1 = to + 2 * stride_ + own - 1;
  const double ta = -from[own + stride_], tb = -to[own + stride_];  // before the other one
  Part part;
  if (!part.cut(*e0, *e1, *e0 >= 0, *e1 >= 0, kBefore)) return Found::all;
  if (!part.cut(ta, tb, ta > 0, tb > 0, kAfter)) return Found::all;
  const int before = vertex == 0 ? y.size - 1 : vertex - 1;
  const double depth = std::min(y.cells[before].depth, y.cells[vertex].depth);
  const double rx = y.x[vertex] - px_, ry = y.y[vertex] - py_;
  const double e2 = ex_ * ex_ + ey_ * ey_;
  const double side = (ex_ * ry - ey_ * rx) * y.distance->slope;
  const double foot = (rx * ex_ + ry * ey_) / e2;
  const double square = side * side / e2, rate2 = e2 * y.distance->slope * y.distance->slope;
  const auto at = [&](double s) { return square + rate2 * ((s - foot) * (s - foot)); };
  if (!(at(std::clamp(foot, part.s0, part.s1)) < depth * depth)) return Found::all;
  const double v0 = std::sqrt(at(part.s0)), v1 = std::sqrt(at(part.s1));
  if (!(v0 < depth && v1 < depth)) return Found::deep;
  return add_piece(y, {part, vertex, true, v0, v1, foot, square}, before, vertex);
}

// Puts the pieces of an edge in order, and together to runs.
void CollarTrace::close_pieces(int edge, double slope) {
  for (size_t i = 1; i < pieces_.size(); ++i) {
    for (size_t j = i; j > 0 && pieces_[j].part.s0 < pieces_[j - 1].part.s0; --j) {
      std::swap(pieces_[j], pieces_[j - 1]);
    }
  }
  const auto crossed = [](const Piece& piece, int end) { return end < kEnd ? piece.cell : end; };
  const Piece* last = nullptr;
  for (const Piece& piece : pieces_) {
    const Part& part = piece.part;
    const bool follows =
        last && last->part.end1 < kEnd && part.end0 < kEnd && last->part.s1 == part.s0;
    if (!follows) {
      runs_.push_back({edge, part.s0, part.s1, crossed(piece, part.end0), 0, {}});
    }
    Run& run = runs_.back();
    run.s1 = part.s1;
    run.edge1 = crossed(piece, part.end1);
    last = &piece;
    if (!piece.arc) {
      run.moments.add(part.s0, piece.v0, part.s1, piece.v1);
      continue;
    }
    const double rate = std::sqrt(ex_ * ex_ + ey_ * ey_) * slope;
    add_root(piece.square, rate, piece.foot, part.s0, piece.v0, part.s1, piece.v1, run.moments);
  }
}

}  // namespace apothem
