// The distance field: the distance potential of a polygon that is not convex, with the Euclidean
// distance to the boundary as depth. phi(x) = min(1, dist(x, boundary) / r) inside the polygon and
// 0 outside, where r is the reference length.
//
// Along a line the distance is the minimum of one function per edge and one per vertex. That of an
// edge is the absolute value of a linear function and is valid where the foot of the perpendicular
// lies within the edge. That of a vertex is the square root of a quadratic and is valid everywhere.
// Each function is an upper bound of the distance wherever it is used, so round-off in the
// intervals cannot make phi jump. Convex vertices are never the nearest point and are left out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/line_crossings.hpp"
#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/segment_moments.hpp"
#include "geometry/potential/piecewise_minimum.hpp"
#include "geometry/spatial/edge_trees.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

/// What a distance field needs beside the polygon itself.
struct DistanceField {
  double slope;              ///< inverse of the reference length r, 1/m
  std::vector<int> corners;  ///< vertices that may be nearest: all but the clearly convex ones
};

/// The distance field of a polygon with the reference length r = `reference`, m.
DistanceField make_distance_field(const Polygon& polygon, double reference);

/// A distance field at the present position of its polygon, in some frame. The arrays have at least
/// `size` entries.
template <class Real>
struct PlacedDistance {
  int size;                         ///< number of vertices
  const Real* x;                    ///< x coordinates of the vertices, m
  const Real* y;                    ///< y coordinates of the vertices, m
  const Real* gx;                   ///< x components of the edges' inward unit normals over r, 1/m
  const Real* gy;                   ///< y components of the edges' inward unit normals over r, 1/m
  Real slope;                       ///< inverse of the reference length r, 1/m
  const std::vector<int>* corners;  ///< vertices that may be nearest, see DistanceField
  bool capped;                      ///< whether phi is limited to 1
  const RingLinks* links =
      nullptr;  ///< neighbours of the vertices of a polygon with holes, or null
  const EdgeTrees* trees = nullptr;  ///< of the edges where they are now, or null; for double
};

/// Returns the integral of f(w) = sqrt(d2 + w^2) from w1 to w1 + h, and the integral of
/// (w - m) f(w), where m is the middle of the interval. No large numbers are subtracted: all terms
/// of the first integral are positive.
template <class Real>
std::array<Real, 2> root_moments(const Real& d2, const Real& w1, const Real& h) {
  using std::sqrt;
  const Real w2 = w1 + h;
  const Real m = w1 + h / 2;
  const Real r1 = sqrt(d2 + w1 * w1);
  const Real r2 = sqrt(d2 + w2 * w2);
  const Real r = (r1 + r2) / 2;
  if (!(r > 0)) return {Real(0 * h), Real(0 * h)};
  Real sum = h * (r + m * m / r);
  if (d2 > 0) {
    // asinh(w2/d) - asinh(w1/d) = asinh((w2 r1 - w1 r2)/d2)
    const Real product = w1 * w2;
    const Real ratio = product > 0 ? Real((1 + (w1 * w1 + w2 * w2 + d2) / (r1 * r2 + product)) / 2)
                                   : Real((1 + (r1 * r2 - product) / d2) / 2);
    sum += d2 * inverse_hyperbolic_sine(Real(h * ratio / r));
  }
  sum /= 2;
  const Real rise = h * m / r;  // r2 - r1
  return {sum, Real(m * (h * (r + rise * rise / (12 * r)) - sum))};
}

/// Adds the integrals of phi = sqrt(square + (rate (s - foot))^2) from s = u1 to u2, where it is v1
/// and v2.
template <class Real>
void add_root(const Real& square, const Real& rate, const Real& foot, const Real& u1,
              const Real& v1, const Real& u2, const Real& v2, SegmentMoments<Real>& moments) {
  const auto [sum, first] = root_moments<Real>(square, rate * (u1 - foot), rate * (u2 - u1));
  moments.sum += sum / rate;
  moments.first += sum / rate * ((u1 + u2) / 2) + first / (rate * rate);
  moments.largest = std::max(moments.largest, std::max(v1, v2));
}

/// Evaluates phi along a segment. Nothing is allocated after the first calls with polygons of a
/// given size.
template <class Real>
class DistanceTrace {
 public:
  /// Returns the integrals of phi along the segment p + s e, s in [0, 1]. Calls inside(s0, s1) for
  /// every part of the segment that lies inside the polygon.
  template <class Inside>
  SegmentMoments<Real> integrate(const PlacedDistance<Real>& field, const Real& px, const Real& py,
                                 const Real& ex, const Real& ey, const Inside& inside) {
    SegmentMoments<Real> moments;
    segments(field, px, py, ex, ey, moments,
             [&](const Real& s0, int, const Real& s1, int) { inside(s0, s1); });
    return moments;
  }

  /// For every part of the segment p + s e, s in [0, 1], that lies inside the polygon, adds the
  /// integrals of phi to `moments` and then calls segment(s0, edge0, s1, edge1). `edge0` and
  /// `edge1` are the polygon's edges that the segment crosses at the ends of the part, or -1 at an
  /// end of the segment itself.
  template <class Segment>
  void segments(const PlacedDistance<Real>& field, const Real& px, const Real& py, const Real& ex,
                const Real& ey, SegmentMoments<Real>& moments, const Segment& segment) {
    using std::sqrt;
    px_ = px, py_ = py, ex_ = ex, ey_ = ey;
    k_ = sqrt(ex * ex + ey * ey) * field.slope;
    find_crossings(field);
    std::ranges::sort(crossings_, [](const Crossing& a, const Crossing& b) { return a.s < b.s; });
    for (size_t i = 0; i + 1 < crossings_.size(); i += 2) {
      const Crossing& a = crossings_[i];
      const Crossing& b = crossings_[i + 1];
      if (b.s <= 0 || a.s >= 1 || !(b.s > a.s)) continue;
      const Real s0 = std::max(a.s, Real(0));
      const Real s1 = std::min(b.s, Real(1));
      integrate_part(field, s0, s1, a.edge, b.edge, moments);
      segment(s0, a.s < 0 ? -1 : a.edge, s1, b.s > 1 ? -1 : b.edge);
    }
  }

 private:
  // The distance over r from one edge or one vertex, as a function of s. For an edge it is
  // |a + b s|. For a vertex, a is the parameter s of the foot of the perpendicular, b the squared
  // distance at the foot over r^2, and k the length of the segment over r.
  struct Function {
    Real a, b, k;
    int id;  // index of the edge, or the number of edges plus that of the vertex; -1 for the cap
    bool vertex;

    [[nodiscard]] Real square(const Real& s) const {
      const Real v = vertex ? Real(k * (s - a)) : Real(a + b * s);
      return vertex ? Real(b + v * v) : Real(v * v);
    }
    [[nodiscard]] Real operator()(const Real& s) const {
      using std::abs;
      using std::sqrt;
      return vertex ? Real(sqrt(square(s))) : Real(abs(a + b * s));
    }
    [[nodiscard]] bool operator==(const Function& g) const { return id == g.id; }
    // The mean of the square from s0 to s1.
    [[nodiscard]] Real mean_square(const Real& s0, const Real& s1) const {
      const Real half = (s1 - s0) / 2 * (vertex ? k : b);
      return square((s0 + s1) / 2) + half * half / 3;
    }
    [[nodiscard]] bool below(const Function& g, const Real& s0, const Real& s1) const {
      return mean_square(s0, s1) < g.mean_square(s0, s1);
    }
    int crossings(const Function& g, const Real& from, std::array<Real, 2>& roots) const {
      using std::sqrt;
      if (vertex && g.vertex) {  // the difference of the squares is linear in s
        const Real slope = 2 * k * k * (g.a - a);
        roots[0] = from + (g.square(from) - square(from)) / slope;
        return 1;
      }
      if (!vertex && !g.vertex) {  // one root for equal signs, one for opposite signs
        roots[0] = (g.a - a) / (b - g.b);
        roots[1] = -(g.a + a) / (b + g.b);
        return 2;
      }
      // The difference of the squares is A z^2 + 2 B z + C with z = s - from.
      const Function& line = vertex ? g : *this;
      const Function& root = vertex ? *this : g;
      const Real value = line.a + line.b * from;
      const Real foot = root.a - from;
      const Real A = (line.b - k) * (line.b + k);
      const Real B = value * line.b + k * k * foot;
      const Real C = value * value - root.b - k * k * foot * foot;
      const Real discriminant = B * B - A * C;
      if (!(discriminant >= 0)) return 0;
      const Real q = -(B + (B < 0 ? Real(-sqrt(discriminant)) : Real(sqrt(discriminant))));
      roots[0] = from + q / A;
      roots[1] = from + C / q;
      return 2;
    }
  };

  static constexpr int kNoEdge = -1;
  struct Crossing {
    Real s;
    int edge;  // kNoEdge far from the segment
  };

  // Finds the crossings of the line p + s e with the edges.
  void find_crossings(const PlacedDistance<Real>& field) {
    lines_.set(field.size, field.x, field.y, px_, py_, ex_, ey_);
    crossings_.clear();
    const auto cross = [&](int a, int b) {
      lines_.cross(a, b, [&](const Real& s, const Real&) { crossings_.push_back({s, a}); });
    };
    if constexpr (std::is_same_v<Real, double>) {
      if (field.trees) return find_crossings_near(field);
    }
    lines_.place(0, field.size);
    for (int a = 0; a < field.size; ++a) cross(a, next(field.links, a, field.size));
  }

  // Finds the crossings of the segment, and those before it where they are an odd number: of a run
  // of edges there one line from its start to its end is crossed an odd number of times with it.
  void find_crossings_near(const PlacedDistance<double>& field) {
    const double e2 = ex_ * ex_ + ey_ * ey_;
    const auto judge = [&](const Box& box) {
      if (lines_.passes(box.x0, box.y0, box.x1, box.y1)) return RunUse::none;
      constexpr double kRoundOff = 1e-12;
      const double x0 = box.x0 - px_, x1 = box.x1 - px_, y0 = box.y0 - py_, y1 = box.y1 - py_;
      const double slack = kRoundOff * (std::abs(ex_) * std::max(std::abs(x0), std::abs(x1)) +
                                        std::abs(ey_) * std::max(std::abs(y0), std::abs(y1)) + e2);
      const double least = ex_ * (ex_ > 0 ? x0 : x1) + ey_ * (ey_ > 0 ? y0 : y1);
      if (least > e2 + slack) return RunUse::none;
      const double most = ex_ * (ex_ > 0 ? x1 : x0) + ey_ * (ey_ > 0 ? y1 : y0);
      return most < -slack ? RunUse::whole : RunUse::edges;
    };
    field.trees->each_line(judge, [&](int a, int b) {
      lines_.place(a, a + 1);
      lines_.place(b, b + 1);
      const int edge = next(field.links, a, field.size) == b ? a : kNoEdge;
      lines_.cross(a, b, [&](double s, double) { crossings_.push_back({s, edge}); });
    });
    // One of those behind the segment, which are left out, ends the last part.
    if (crossings_.size() % 2 != 0) {
      crossings_.push_back({std::numeric_limits<double>::infinity(), kNoEdge});
    }
  }

  // Adds the integrals between s0 and s1. A part with many pieces is halved, so that each function
  // is compared with few of them.
  void integrate_part(const PlacedDistance<Real>& field, const Real& s0, const Real& s1, int first,
                      int second, SegmentMoments<Real>& moments) {
    trace(field, s0, s1, first, second);
    if (!too_many(field)) return add_pieces(moments);
    const Real middle = envelope_[envelope_.size() / 2].from;
    integrate_part(field, s0, middle, first, second, moments);
    integrate_part(field, middle, s1, first, second, moments);
  }

  // Whether the minimum has so many pieces that it is not worth while to go on. Without trees all
  // functions are tried anyway.
  [[nodiscard]] bool too_many(const PlacedDistance<Real>& field) const {
    constexpr size_t kMost = 32;
    return field.trees && envelope_.size() > kMost;
  }

  // Finds the minimum over all edges and vertices between s0 and s1. The two edges that the segment
  // crosses come first, because they are probably near; what is farther away than the minimum so
  // far is skipped.
  void trace(const PlacedDistance<Real>& field, const Real& s0, const Real& s1, int first,
             int second) {
    envelope_.reset(s0, s1);
    bound_ = std::numeric_limits<Real>::infinity();
    if (field.capped) insert({1, 0, k_, -1, false}, s0, s1);
    if (first != kNoEdge) insert_edge(field, first, s0, s1);
    if (second != kNoEdge) insert_edge(field, second, s0, s1);
    if constexpr (std::is_same_v<Real, double>) {
      if (field.trees) return insert_near(field, s0, s1);
    }
    for (int i = 0; i < field.size; ++i) {
      if (i != first && i != second) insert_edge(field, i, s0, s1);
    }
    for (const int i : *field.corners) insert_corner(field, i, s0, s1);
  }

  // Inserts the edges and vertices that are not farther away than the minimum so far.
  void insert_near(const PlacedDistance<double>& field, double s0, double s1) {
    constexpr double kSure = 1 + 1e-9;  // more than one by far more than round-off
    const auto at = [&](double s) { return Vec2(px_ + s * ex_, py_ + s * ey_); };
    field.trees->each_near_first(
        at(s0), at(s1), [&] { return too_many(field) ? -HUGE_VAL : kSure * bound_ / field.slope; },
        [&](int i) {
          insert_edge(field, i, s0, s1);
          if (std::binary_search(field.corners->begin(), field.corners->end(), i)) {
            insert_corner(field, i, s0, s1);
          }
        });
  }

  void insert_edge(const PlacedDistance<Real>& field, int i, const Real& s0, const Real& s1) {
    const Real rx = px_ - field.x[i];
    const Real ry = py_ - field.y[i];
    const Real a = field.gx[i] * rx + field.gy[i] * ry;
    const Real b = field.gx[i] * ex_ + field.gy[i] * ey_;
    const Real h0 = a + b * s0;
    const Real h1 = a + b * s1;
    if ((h0 >= bound_ && h1 >= bound_) || (h0 <= -bound_ && h1 <= -bound_)) return;
    const int j = next(field.links, i, field.size);
    // Along the edge, at right angles to the gradient to the last bit. The difference of the ends
    // would not do: if they are a few units in the last place apart, its direction is round-off.
    const Real& tx = field.gy[i];
    const Real ty = -field.gx[i];
    const Real rate = tx * ex_ + ty * ey_;
    const Real start = tx * rx + ty * ry;  // foot at s = 0, from start and end
    const Real end = tx * (px_ - field.x[j]) + ty * (py_ - field.y[j]);
    Real from = s0, to = s1;
    if (rate > 0) {
      from = std::max(from, Real(-start / rate));
      to = std::min(to, Real(-end / rate));
    } else if (rate < 0) {
      from = std::max(from, Real(-end / rate));
      to = std::min(to, Real(-start / rate));
    } else if (!(start >= 0 && end <= 0)) {
      return;
    }
    if (from < to) insert({a, b, k_, i, false}, from, to);
  }

  void insert_corner(const PlacedDistance<Real>& field, int i, const Real& s0, const Real& s1) {
    const Real rx = field.x[i] - px_;
    const Real ry = field.y[i] - py_;
    const Real e2 = ex_ * ex_ + ey_ * ey_;
    const Real side = (ex_ * ry - ey_ * rx) * field.slope;
    const Real d2 = side * side / e2;
    const Real foot = (rx * ex_ + ry * ey_) / e2;
    const Real away = k_ * std::max(Real(0), std::max(Real(s0 - foot), Real(foot - s1)));
    if (d2 + away * away < bound_ * bound_) insert({foot, d2, k_, field.size + i, true}, s0, s1);
  }

  void insert(const Function& f, const Real& from, const Real& to) {
    if (envelope_.insert(f, from, to)) lower_bound();
  }

  // Lowers bound_ to the largest value of the minimum. All functions are convex, so that value is
  // at an end of a piece.
  void lower_bound() {
    Real largest = 0;
    for (size_t i = 0; i < envelope_.size(); ++i) {
      if (!envelope_[i].known) return;
      const Function& f = envelope_[i].function;
      largest = std::max(largest, std::max(f(envelope_[i].from), f(envelope_.end(i))));
    }
    bound_ = largest;
  }

  void add_pieces(SegmentMoments<Real>& moments) const {
    for (size_t i = 0; i < envelope_.size(); ++i) {
      const auto& piece = envelope_[i];
      if (!piece.known) continue;  // a gap between functions, no wider than round-off
      const Real& u1 = piece.from;
      const Real& u2 = envelope_.end(i);
      const Function& f = piece.function;
      const Real v1 = f(u1), v2 = f(u2);
      if (!f.vertex) {
        moments.add(u1, v1, u2, v2);
        continue;
      }
      add_root<Real>(f.b, k_, f.a, u1, v1, u2, v2, moments);
    }
  }

  Real px_, py_, ex_, ey_;
  Real k_;      // length of the segment over r
  Real bound_;  // largest value of the minimum so far; infinite until it is known everywhere
  LineCrossings<Real> lines_;
  std::vector<Crossing> crossings_;
  PiecewiseMinimum<Real, Function> envelope_;
};

}  // namespace apothem
