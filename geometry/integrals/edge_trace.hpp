// The potential phi of one polygon along the edges of another one, and the sums that give the
// integrals of a pair. This header is private to geometry/integrals; contact_patches.hpp includes
// it for the types of its workspace.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/integrals/edge_integral.hpp"
#include "geometry/integrals/edge_sums.hpp"
#include "geometry/integrals/placed_edge.hpp"
#include "geometry/polygon/segment_moments.hpp"
#include "lib/execution/pack.hpp"

namespace apothem::edge_detail {

// phi along an edge as the minimum of the linear functions a_i + s (b_i - a_i), s in [0, 1]. a_i
// and b_i are the heights of the two ends of the edge over edge i of the other polygon, divided by
// the reference length. The limit phi <= 1 is one more function, with a_i = b_i = 1. A row of packs
// belongs to several edges.
template <class Real>
struct Row {
  const Real* a;
  const Real* b;
  int size;   // number of functions that bound the polygon
  int lines;  // number of all functions: size, or size + 1 if phi is limited to 1
};

// Finds the interval of s in which the edge is inside the polygon; returns false if there is none.
// One sign per node decides, by a half-open rule and without a tolerance. An edge with a NaN is
// kept and never counts as outside. Nothing here branches on what is unpredictable.
template <class Real>
APOTHEM_INLINE Truth<Real> clip(const Row<Real>& row, Real& s0, Real& s1) {
  s0 = Real(0);
  s1 = Real(1);
  Truth<Real> outside = s0 > s1;
  for (int i = 0; i < row.size; ++i) {
    const Real& a = row.a[i];
    const Real& b = row.b[i];
    outside = outside | ((a < Real(0)) & (b < Real(0)));
    const Truth<Real> starts_inside = a >= Real(0);
    const Real s = a / (a - b);
    s1 = select(starts_inside & (!(b >= Real(0))) & (!(s >= s1)), s, s1);
    s0 = select((!starts_inside) & (!(s <= s0)), s, s0);
  }
  return (!outside) & (!(s0 >= s1));
}

// Calls piece(there, s, value, s_next, value_next) for every linear piece of phi, which is a
// concave lower envelope, from s0 to s1, where `inside` is true; `there` says in which lanes of a
// pack there is such a piece.
template <class Real, class Piece>
APOTHEM_INLINE void walk_envelope(const Row<Real>& row, const Real& s0, const Real& s1,
                                  Truth<Real> inside, const Piece& piece) {
  const auto slope_of = [&](int i) __attribute__((always_inline))->Real {
    return row.b[i] - row.a[i];
  };
  Real base = row.a[0];
  Real slope = slope_of(0);
  Real height = base + s0 * slope;
  for (int i = 1; i < row.lines; ++i) {
    const Real m = slope_of(i);
    const Real h = row.a[i] + s0 * m;
    const Truth<Real> lower = (!(h >= height)) | ((h == height) & (m < slope));
    base = select(lower, row.a[i], base);
    slope = select(lower, m, slope);
    height = select(lower, h, height);
  }
  for (Real s = s0; any(inside);) {
    // The next function of the envelope is the one that falls faster than the present one and meets
    // it first. The fractions gap/fall are compared by cross-multiplication, which needs one
    // division per piece instead of one per function. No function is below the present one, so that
    // one that does not fall faster is never nearer. Of functions that meet it at the same point,
    // the others follow after pieces of no length.
    Truth<Real> found = s < s;
    Real gap = s1 - s;
    Real fall(1);
    Real next_base = base;
    Real next_slope = slope;
    for (int i = 0; i < row.lines; ++i) {
      const Real m = slope_of(i);
      const Real f = slope - m;
      const Real above = row.a[i] + s * m - height;
      const Real g = select(above < Real(0), Real(0), above);
      const Truth<Real> nearer = g * fall < gap * f;
      gap = select(nearer, g, gap);
      fall = select(nearer, f, fall);
      next_base = select(nearer, row.a[i], next_base);
      next_slope = select(nearer, m, next_slope);
      found = found | nearer;
    }
    const Real meeting = s + gap / fall;
    const Real end = select((!found) | (s1 < meeting), s1, meeting);
    // The value is that of the flatter of the two functions, because along a needle the other one
    // may be a million times steeper.
    const Truth<Real> flatter = found & (magnitude(next_slope) < magnitude(slope));
    const Real end_height =
        select(flatter, next_base, base) + end * select(flatter, next_slope, slope);
    piece(inside & ((!found) | (end > s)), s, height, end, end_height);
    inside = inside & found & (!(end >= s1));
    s = end;
    height = end_height;
    base = next_base;
    slope = next_slope;
  }
}

// phi integrated along edges from s0 to s1.
template <class Real>
APOTHEM_INLINE SegmentMoments<Real> envelope_moments(const Row<Real>& row, const Real& s0,
                                                     const Real& s1, const Truth<Real>& inside) {
  SegmentMoments<Real> moments;
  walk_envelope(row, s0, s1, inside,
                [&](const Truth<Real>& there, const Real& u1, const Real& v1, const Real& u2,
                    const Real& v2) APOTHEM_LAMBDA { moments.add(there, u1, v1, u2, v2); });
  return moments;
}

// Growth of a box, relative to its extent, so that rounding lets no point outside reach into it.
inline constexpr double kFarAway = 1e-9;
// Generous bound of the error of a distance between two polygons, relative to their sizes.
inline constexpr double kRoundOff = 1e-12;

// Heights of a point over the edges of y divided by the reference length, and 1 if phi is limited.
inline void height_row(const PlacedPotential& y, double px, double py, double* row) {
  for (int i = 0; i < y.size; ++i) {
    row[i] = y.gx[i] * (px - y.x[i]) + y.gy[i] * (py - y.y[i]);
  }
  if (y.capped) row[y.size] = 1;
}

// Writes the heights of the vertices of x over the edges of y: one row per vertex, with y.size
// entries (and one more if phi is limited to 1), and the first row again at the end. Returns how
// far outside one edge of y all of x lies, in the unit of the heights, so that the polygons are
// apart; or 0 if there is no such edge.
inline double heights(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                      double* rows) {
  const int n = y.size;
  const int width = n + (y.capped ? 1 : 0);
  for (int v = 0; v < x.size; ++v) {
    height_row(y, x.x[v] + dx, x.y[v] + dy, rows + v * width);
  }
  for (int i = 0; i < width; ++i) rows[x.size * width + i] = rows[i];
  double gap = 0;
  for (int i = 0; i < n; ++i) {
    int outside = 0;
    double highest = -HUGE_VAL;
    for (int v = 0; v < x.size; ++v) {
      const double h = rows[v * width + i];
      outside += h < 0;
      highest = h > highest ? h : highest;
    }
    if (outside == x.size) gap = std::max(gap, -highest);
  }
  return gap;
}

// Adds a linear piece of phi, limited to 1.
template <class Real>
void add_capped(const Real& u1, const Real& v1, const Real& u2, const Real& v2,
                SegmentMoments<Real>& moments) {
  const Real one(1.);
  if ((v1 > one) == (v2 > one)) {
    moments.add(u1, std::min(v1, one), u2, std::min(v2, one));
    return;
  }
  const Real u = u1 + (one - v1) / (v2 - v1) * (u2 - u1);
  moments.add(u1, std::min(v1, one), u, one);
  moments.add(u, one, u2, std::min(v2, one));
}

/// The heights of the ends of edge e of x, which ends at vertex `end`, over the edges of y. They
/// are taken from the `rows` that `heights` has written, or, if the edge has been shortened,
/// computed in `scratch`, which has room for two rows.
inline Row<double> row_of(const PlacedEdge& edge, int e, int end, const PlacedPotential& y,
                          const double* rows, double* scratch) {
  const int width = y.size + (y.capped ? 1 : 0);
  if (!edge.shortened) return {rows + e * width, rows + end * width, y.size, width};
  height_row(y, edge.px, edge.py, scratch);
  height_row(y, edge.px + edge.ex, edge.py + edge.ey, scratch + width);
  return {scratch, scratch + width, y.size, width};
}

/// Memory for heights of the vertices of both polygons over the edges of the other one.
struct HeightRows {
  double* of_a;     ///< rows for the vertices of a
  double* of_b;     ///< rows for the vertices of b
  double* scratch;  ///< two rows for a shortened edge
};

/// Takes the memory from `buffer`, which grows if necessary. Only a convex polygon needs rows for
/// the vertices of the other one.
inline HeightRows height_rows(const PlacedPotential& a, const PlacedPotential& b,
                              std::vector<double>& buffer) {
  const size_t rows_a = b.convex() ? static_cast<size_t>(a.size + 1) * (b.size + 1) : 0;
  const size_t rows_b = a.convex() ? static_cast<size_t>(b.size + 1) * (a.size + 1) : 0;
  const size_t scratch = 2 * (static_cast<size_t>(std::max(a.size, b.size)) + 1);
  if (buffer.size() < rows_a + rows_b + scratch) buffer.resize(rows_a + rows_b + scratch);
  return {buffer.data(), buffer.data() + rows_a, buffer.data() + rows_a + rows_b};
}

/// The roof of a placed potential that has one.
inline PlacedRoof<double> placed_roof(const PlacedPotential& y, const RoofNodes& nodes) {
  return {&y.roof->arcs,  y.size,         static_cast<int>(y.roof->values.size()),
          nodes.x.data(), nodes.y.data(), y.roof->values.data()};
}

/// The distance field of a placed potential that has one.
inline PlacedDistance<double> placed_distance(const PlacedPotential& y) {
  return {y.size,   y.x,     y.y,    y.gx, y.gy, y.distance->slope, &y.distance->corners,
          y.capped, y.links, y.trees};
}

/// Adds a linear piece of phi of y, limited to 1 if y's potential is capped.
template <class Real>
void add_piece(const PlacedPotential& y, const Real& u1, const Real& v1, const Real& u2,
               const Real& v2, SegmentMoments<Real>& moments) {
  if (y.capped) {
    add_capped(u1, v1, u2, v2, moments);
  } else {
    moments.add(u1, v1, u2, v2);
  }
}

/// The reference point of a relative to that of b, m.
APOTHEM_INLINE Vec2 arm(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset) {
  return {(a.reference.x() - b.reference.x()) + offset.x(),
          (a.reference.y() - b.reference.y()) + offset.y()};
}

/// combine_sums as a PairIntegral, except for depth and breadth. `arm` is a's reference point
/// relative to b's.
APOTHEM_INLINE PairIntegral combine(const Half& of_a, const Half& of_b, const Vec2& arm) {
  const PairSums<double> sums = combine_sums<double>(of_a, of_b, arm.x(), arm.y());
  PairIntegral pair;
  pair.force = {sums.fx, sums.fy};
  pair.moment_a = sums.moment_a;
  pair.moment_b = sums.moment_b;
  pair.weight = sums.weight;
  pair.centre = {sums.centre_x, sums.centre_y};
  pair.inside_a = of_a.inside;
  pair.inside_b = of_b.inside;
  pair.own_length_a = of_a.length;
  pair.own_length_b = of_b.length;
  pair.largest_phi = std::max(of_a.largest, of_b.largest);
  return pair;
}

/// PairIntegral::depth.
APOTHEM_INLINE double depth(const PlacedPotential& a, const PlacedPotential& b, const Half& of_a,
                            const Half& of_b) {
  if (!(a.steepest > 0 && b.steepest > 0)) return 0;
  return std::max(of_a.largest / b.steepest, of_b.largest / a.steepest);
}

/// The edge of the other polygon that clips an edge at s, or -1 if the edge itself ends there.
inline int clipped_by(const Row<double>& row, double s, bool entering) {
  for (int i = 0; i < row.size; ++i) {
    const double a = row.a[i];
    const double b = row.b[i];
    if ((a < 0) == entering && (b < 0) != entering && a / (a - b) == s) return i;
  }
  return -1;
}

/// Calls segment(s0, edge0, s1, edge1, moments) for the segments of an edge in y, which is not
/// convex, by its whole roof or distance field. The nodes of a roof must have been placed in the
/// workspace.
template <class Segment>
void walk_whole_potential(const PlacedPotential& y, const PlacedEdge& edge,
                          EdgeWorkspace& workspace, const Segment& segment) {
  SegmentMoments<double> moments;
  const auto end = [&](double s0, int edge0, double s1, int edge1) {
    segment(s0, edge0, s1, edge1, moments);
    moments = {};
  };
  if (y.distance) {
    workspace.distance.segments(placed_distance(y), edge.px, edge.py, edge.ex, edge.ey, moments,
                                end);
    return;
  }
  workspace.roof.cross(placed_roof(y, workspace.nodes), edge.px, edge.py, edge.ex, edge.ey);
  workspace.roof.segments(
      [&](double u1, double v1, double u2, double v2) { add_piece(y, u1, v1, u2, v2, moments); },
      end);
}

/// Finds the segments of x: the maximal parts of its edges that lie inside y. Calls segment(e,
/// edge, s0, edge0, s1, edge1, moments) for the part from s0 to s1 of edge e, with the integrals of
/// phi of y along it, in ascending order of e. With `crossings`, edge0 and edge1 are the edges of y
/// that x crosses there, or -1 at an end of the edge. `near` are the edges that may enter y, and
/// `near_y` those of y that may enter x. With `use_layer`, edges that stay in the boundary layer of
/// y are evaluated by it alone. Returns 0, or NaN without any call if y is not convex and a
/// coordinate is not finite.
template <bool crossings, class Segment>
double walk_segments(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                     std::uint64_t near, std::uint64_t near_y, const double* rows, double* scratch,
                     EdgeWorkspace& workspace, bool use_layer, const Segment& segment) {
  if (!y.convex()) {
    // If edges are known to be near each other, all coordinates are finite.
    if (near == NearEdges::kAll || near_y == NearEdges::kAll) {
      if (const double finite = all_finite(x, y, dx, dy); !(finite == 0)) return finite;
    }
    LayerTrace& trace = workspace.layer_trace;
    trace.find(x, y, dx, dy, near, near_y, use_layer);
    size_t r = 0;
    bool nodes = false;  // whether the nodes of the roof are placed
    for (const LayerEdge& edge : trace.edges()) {
      for (; r < edge.segments_end; ++r) {
        if (edge.beyond_layer) continue;
        const LayerSegment& part = trace.segments()[r];
        segment(edge.index, edge.placed, part.s0, part.edge0, part.s1, part.edge1, part.moments);
      }
      if (!edge.beyond_layer) continue;
      if (y.roof && !nodes) workspace.nodes.place(y), nodes = true;
      walk_whole_potential(
          y, edge.placed, workspace,
          [&](double s0, int edge0, double s1, int edge1, const SegmentMoments<double>& sum) {
            segment(edge.index, edge.placed, s0, edge0, s1, edge1, sum);
          });
    }
    return 0;
  }
  for_each_edge(near, x.size, [&](int e) {
    const PlacedEdge edge(x, y, e, dx, dy);
    const Row<double> row = row_of(edge, e, x.end(e), y, rows, scratch);
    double s0, s1;
    if (!clip(row, s0, s1)) return;
    const SegmentMoments<double> moments = envelope_moments(row, s0, s1, true);
    if constexpr (crossings) {
      segment(e, edge, s0, clipped_by(row, s0, true), s1, clipped_by(row, s1, false), moments);
    } else {
      segment(e, edge, s0, -1, s1, -1, moments);
    }
  });
  return 0;
}

/// The extent of a set of points across a force, m.
struct Extent {
  double low = HUGE_VAL, high = -HUGE_VAL;
  void include(double t) { low = std::min(low, t), high = std::max(high, t); }
};

/// The ends of segments, in a buffer that never shrinks.
class SegmentEnds {
 public:
  explicit SegmentEnds(std::vector<double>& buffer) : buffer_(buffer) {}
  template <class Edge>
  void add(const Edge& e, double s0, double s1) {
    if (buffer_.size() < used_ + 4) buffer_.resize(2 * (used_ + 4));
    double* const end = buffer_.data() + used_;
    end[0] = e.qx + s0 * e.ex, end[1] = e.qy + s0 * e.ey;
    end[2] = e.qx + s1 * e.ex, end[3] = e.qy + s1 * e.ey;
    used_ += 4;
  }
  /// Number of coordinates.
  [[nodiscard]] size_t used() const { return used_; }
  void clear() { used_ = 0; }
  /// True if the segments are the sides of closed polygons, as the boundary of an overlap is, so
  /// that none is missing. Segments that lie on each other may count twice; then the result is
  /// false.
  [[nodiscard]] bool closed() const {
    constexpr double kOpen = 1e-9;  // tolerance relative to the length of all segments
    double x = 0, y = 0, length = 0;
    for (size_t i = 0; i < used_; i += 4) {
      const double ex = buffer_[i + 2] - buffer_[i], ey = buffer_[i + 3] - buffer_[i + 1];
      x += ex, y += ey;
      length += std::abs(ex) + std::abs(ey);
    }
    return std::abs(x) + std::abs(y) <= kOpen * length;
  }
  [[nodiscard]] const double* data() const { return buffer_.data(); }

 private:
  std::vector<double>& buffer_;
  size_t used_ = 0;
};

/// Combines the integrals along the edges of a and of b to those of the pair. The first `middle`
/// coordinates of `ends` belong to edges of a. `offset` is that of pair_integral.
inline PairIntegral join(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                         const Half& of_a, const Half& of_b, const SegmentEnds& ends,
                         size_t middle) {
  const Vec2 r = arm(a, b, offset);
  PairIntegral pair = combine(of_a, of_b, r);
  pair.depth = depth(a, b, of_a, of_b);
  const double size = std::sqrt(pair.force.x() * pair.force.x() + pair.force.y() * pair.force.y());
  if (size > 0) {
    const double nx = pair.force.x() / size;
    const double ny = pair.force.y() / size;
    Extent extent;
    const auto project = [&](size_t from, size_t to, double shift) {
      for (const double* p = ends.data() + from; p != ends.data() + to; p += 2) {
        extent.include(nx * p[1] - ny * p[0] + shift);
      }
    };
    project(0, middle, 0);
    const double shift = nx * r.y() - ny * r.x();
    project(middle, ends.used(), shift);
    pair.breadth = extent.high - extent.low;
    pair.middle = (extent.high + extent.low) / 2 - shift;
  }
  return pair;
}

/// True if the polygons are apart. If both are convex, `near` gets their distance as its skin,
/// unless it has one.
APOTHEM_INLINE bool separated(double gap, const PlacedPotential& a, const PlacedPotential& b,
                              double steepest, NearEdges& near) {
  if (!(gap > 0)) return false;
  if (near.skin == 0 && a.convex() && b.convex() && steepest > 0 && a.radius > 0 && b.radius > 0) {
    const double skin = gap / steepest - kRoundOff * (a.radius + b.radius);
    if (skin > kRoundOff * (a.radius + b.radius)) near = {0, 0, skin};
  }
  return true;
}

/// The ends of a segment along its edge, and the edges of the other polygon that it crosses there,
/// as in walk_segments.
struct SegmentSpan {
  double s0;
  int edge0;
  double s1;
  int edge1;
};

/// Computes the integrals of a pair. Arguments and result are those of pair_integral. Calls
/// segment(of_a, e, edge, span, sums) for every segment of edge e of a, and then of b; before the
/// first one it calls begin().
///
/// The segments are found by several methods, the fastest first: LayerPair for a few near edges,
/// then the boundary layers, then the whole potentials. If the segments are not closed, features of
/// the polygons coincide up to round-off, and the next method is used.
template <bool crossings, class Begin, class Segment>
PairIntegral integrate_pair(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                            NearEdges& near, EdgeWorkspace& workspace, const Begin& begin,
                            const Segment& segment) {
  const double dx = offset.x(), dy = offset.y();
  const HeightRows height = height_rows(a, b, workspace.values);
  if (b.convex() && separated(heights(a, b, dx, dy, height.of_a), a, b, b.steepest, near)) {
    return {};
  }
  if (a.convex() && separated(heights(b, a, -dx, -dy, height.of_b), a, b, a.steepest, near)) {
    return {};
  }
  SegmentEnds ends(workspace.ends);
  Half half_a, half_b;
  size_t middle = 0;
  const auto start = [&] {
    ends.clear();
    half_a = half_b = {};
    middle = 0;
    begin();
  };
  const auto take = [&](bool of_a, int e, const auto& edge, const SegmentSpan& span,
                        const EdgeSums<double>& sums) {
    Half& half = of_a ? half_a : half_b;
    half.add(sums);
    if (edge.fraction(span.s0) == 0) half.enter(e);
    ends.add(edge, span.s0, span.s1);
    if (of_a) middle = ends.used();
    segment(of_a, e, edge, span, sums);
  };
  const auto pair = [&] { return join(a, b, offset, half_a, half_b, ends, middle); };
  if (workspace.layer_pair.find(a, b, offset, near)) {
    start();
    for (const LayerPair::PairSegment& r : workspace.layer_pair.segments()) {
      take(r.of_a, r.edge, *r.placed, {r.s0, r.edge0, r.s1, r.edge1}, *r.integrals);
    }
    if (ends.closed()) return pair();
  }
  for (const bool use_layer : {true, false}) {
    start();
    const auto walk = [&](bool of_a) {
      return [&, of_a](int e, const PlacedEdge& edge, double s0, int edge0, double s1, int edge1,
                       const SegmentMoments<double>& moments) {
        take(of_a, e, edge, {s0, edge0, s1, edge1}, along_edge(edge, moments, s1 - s0));
      };
    };
    // A NaN is added to the weight, so that it is never taken for "no contact".
    half_a.weight += walk_segments<crossings>(a, b, dx, dy, near.of_a, near.of_b, height.of_a,
                                              height.scratch, workspace, use_layer, walk(true));
    half_b.weight += walk_segments<crossings>(b, a, -dx, -dy, near.of_b, near.of_a, height.of_b,
                                              height.scratch, workspace, use_layer, walk(false));
    if (ends.closed() || std::isnan(half_a.weight + half_b.weight) || (a.convex() && b.convex())) {
      break;
    }
  }
  return pair();
}

}  // namespace apothem::edge_detail
