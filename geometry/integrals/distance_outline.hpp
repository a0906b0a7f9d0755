// The outline of a polygon with a distance field, for any number type, and the curves of points
// that are equally far from two of its features, which are edges and reflex vertices. They bound
// the cells of distance_volume.hpp.
//
// Everything follows from the vertices where they are now, also the directions of the edges. A
// position that is rounded after a rotation or a shift turns an edge whose length is near the
// spacing of the coordinates. With the direction from before, the perpendiculars at its two ends
// would no longer separate the cells of its neighbours.
//
// Which side of a line a vertex is on is decided exactly. All lengths that may be tiny are
// differences of positions that are near each other.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/potential/distance_field.hpp"
#include "geometry/spatial/ring_tree.hpp"
#include "geometry/spatial/strip.hpp"

namespace apothem {

/// A point or a vector of the plane.
template <class Real>
struct PlanePoint {
  Real x, y;
  PlanePoint operator-(const PlanePoint& p) const { return {x - p.x, y - p.y}; }
  PlanePoint operator+(const PlanePoint& p) const { return {x + p.x, y + p.y}; }
  PlanePoint operator*(const Real& f) const { return {x * f, y * f}; }
};
template <class Real>
Real dot(const PlanePoint<Real>& a, const PlanePoint<Real>& b) {
  return a.x * b.x + a.y * b.y;
}
template <class Real>
Real cross(const PlanePoint<Real>& a, const PlanePoint<Real>& b) {
  return a.x * b.y - a.y * b.x;
}

template <class Real>
class DistanceOutline {
 public:
  using Point = PlanePoint<Real>;

  /// With so few edges, to look at all of them costs less than to look for those that count.
  static constexpr int kFew = 32;
  explicit DistanceOutline(int few) : few_(few) {}

  /// The points that are equally far from edge i and from another edge: their height over edge i is
  /// start + rise (tau - origin) for tau between `from` and `to`, where tau is the coordinate along
  /// edge i. There the foot on the other edge lies within it, and the height is positive.
  struct Bisector {
    Real origin, start, rise, from, to;
  };

  /// Takes the vertices of a field, whose coordinates are finite. Vertices that are nearer to each
  /// other than a few units in the last place of the polygon's size become one: the edge between
  /// them has no direction.
  void load(const PlacedDistance<Real>& field) {
    using std::abs;
    const auto [x0, x1] = std::minmax_element(field.x, field.x + field.size);
    const auto [y0, y1] = std::minmax_element(field.y, field.y + field.size);
    const Real size = std::max(Real(*x1 - *x0), Real(*y1 - *y0));
    same_ = 8 * std::numeric_limits<Real>::epsilon() * size;
    const auto near = [&](const Point& p, const Point& q) {
      return abs(p.x - q.x) <= same_ && abs(p.y - q.y) <= same_;
    };
    vertex_.clear(), last_.clear();
    links_ = {};
    for_each_ring(field.links, field.size, [&](int begin, int end) {
      const size_t first = vertex_.size();
      for (int i = begin; i < end; ++i) {
        const Point p{field.x[i], field.y[i]};
        if (vertex_.size() == first || !near(p, vertex_.back())) {
          vertex_.push_back(p), last_.push_back(p);
        } else {
          last_.back() = p;
        }
      }
      while (vertex_.size() > first + 1 && near(vertex_.back(), vertex_[first])) {
        vertex_[first] = vertex_.back();
        vertex_.pop_back(), last_.pop_back();
      }
      if (!field.links) return;
      // A hole whose vertices have become one or two has no inside.
      if (vertex_.size() < first + 3) vertex_.resize(first), last_.resize(first);
      if (vertex_.size() > first) links_.add(static_cast<int>(vertex_.size() - first));
    });
    several_ = field.links != nullptr;
    n_ = static_cast<int>(vertex_.size());
    normal_.resize(n_);
    length_.resize(n_);
    turn_.resize(n_);
    reflex_.clear();
    for (int i = 0; i < n_; ++i) {
      using std::sqrt;
      const Point d = vertex_[after(i)] - vertex_[i];
      length_[i] = sqrt(dot(d, d));
      normal_[i] = {-d.y / length_[i], d.x / length_[i]};
    }
    for (int i = 0; i < n_; ++i) {
      turn_[i] = turn_at(i);
      if (turn_[i] < 0) reflex_.push_back(i);
    }
    trees_.clear();
    if (n_ > few_) plant_trees();
  }

  [[nodiscard]] int size() const { return n_; }
  [[nodiscard]] int after(int i) const { return next(links(), i, n_); }
  [[nodiscard]] int before(int i) const { return previous(links(), i, n_); }
  [[nodiscard]] const Point& vertex(int i) const { return vertex_[i]; }
  /// The inward unit normal of edge i.
  [[nodiscard]] const Point& normal(int i) const { return normal_[i]; }
  /// The direction of edge i.
  [[nodiscard]] Point tangent(int i) const { return {normal_[i].y, -normal_[i].x}; }
  [[nodiscard]] const Real& length(int i) const { return length_[i]; }
  /// The vertices at which the outline turns right.
  [[nodiscard]] const std::vector<int>& reflex() const { return reflex_; }

  [[nodiscard]] bool is_reflex(int v) const { return turn_[v] < 0; }

  /// Whether there are more than a few edges.
  [[nodiscard]] bool has_many() const { return !trees_.empty(); }

  /// Calls f(edge, box, slab) for edges and what is around them, roughly in ascending order of
  /// measure(box) of each ring, if there are many edges. It leaves out only those in boxes and
  /// slabs for which meets(box, slab, measure) is false when their turn comes.
  template <class Measure, class Meets, class F>
  void each_in_order(const Measure& measure, const Meets& meets, const F& f) {
    int first = 0;
    for (const RingTree& tree : trees_) {
      tree.each_in_order(
          measure, meets,
          [&](int e) {
            const int i = first + e;
            const Vec2 a = rounded(vertex_[i]), b = rounded(vertex_[after(i)]);
            const Vec2 n = rounded(normal_[i]);
            const double of_a = n.dot(a), of_b = n.dot(b);
            f(i, box_of(a, b), Slab{n, std::min(of_a, of_b), std::max(of_a, of_b)});
          },
          runs_);
      first += tree.size();
    }
  }

  /// The distance of a point from the outline, if there are many edges.
  [[nodiscard]] double distance(const Vec2& point) {
    const SegmentDistance to_point(point, point);
    double nearest = HUGE_VAL;
    each_in_order([&](const Box& box) { return to_point.least(box); },
                  [&](const Box&, const Slab&, double least) { return least < nearest; },
                  [&](int i, const Box&, const Slab&) {
                    const Vec2 from = rounded(vertex_[i]), to = rounded(vertex_[after(i)]);
                    const double d2 = nearest_on_segment(point - from, to - from).distance2;
                    nearest = std::min(nearest, std::sqrt(d2));
                  });
    return nearest;
  }

  /// The height of vertex v over the line of edge i, or 0 if the vertex is not in front of it.
  /// Both cells that the parabola between the two separates use this number.
  [[nodiscard]] Real height(int i, int v) const {
    const Point& p = vertex_[v];
    const Point from_start = p - vertex_[i];
    const Point from_end = p - vertex_[after(i)];
    const bool start_nearer = dot(from_start, from_start) <= dot(from_end, from_end);
    const Point& arm = start_nearer ? from_start : from_end;
    using std::abs;
    const Real reach = abs(arm.x) + abs(arm.y);
    const Real h = dot(normal_[i], arm);
    // Where vertices became one, the vertex may have come behind the line or onto it.
    if (h > kSure * reach) return h;
    if (h < -kSure * reach - 2 * same_) return 0;
    const Real least = std::numeric_limits<Real>::epsilon() * std::numeric_limits<Real>::epsilon();
    return side(i, v) > 0 ? std::max(h, Real(least * reach)) : Real(0);
  }

  /// Finds the bisector of the edges i and j, seen from edge i. Returns false if it is empty. Both
  /// edges compute the same one: a common error only moves points between two cells in which they
  /// have the same depth, but a difference would count an area twice.
  bool bisector(int i, int j, Bisector& result) const {
    const int a = std::min(i, j), b = std::max(i, j);
    const bool next = after(a) == b;
    const bool previous = after(b) == a;
    if (next || previous) {
      if (turn_[next ? b : a] <= 0) return false;
    } else if (!in_front(a, b) || !in_front(b, a)) {
      return false;
    }
    // The ends of the two edges that are nearer to each other.
    const Point at_end = vertex_[after(a)] - vertex_[b];
    const Point at_start = vertex_[a] - vertex_[after(b)];
    const bool end_of_a = next || (!previous && dot(at_end, at_end) <= dot(at_start, at_start));
    const Point& gap = end_of_a ? at_end : at_start;
    // At a tip of hardly any width, round-off must not turn its sides away from each other.
    constexpr double kLeast = 0x1p-200;
    Real sine = cross(normal_[a], normal_[b]);
    if (next) sine = std::max(sine, Real(kLeast));
    if (previous) sine = std::min(sine, Real(-kLeast));
    const Real cosine = dot(normal_[a], normal_[b]);
    if (cosine > 0 && sine == 0) return false;
    // With the coordinate u along edge a, from that end, the height is
    // (n_b . gap - u sin) / (1 - cos), and the coordinate along edge b is sum - u.
    const Real ratio = cosine > 0 ? Real((1 + cosine) / sine) : Real(sine / (1 - cosine));
    const Real over = dot(normal_[b], gap);
    const Real start = cosine > 0 ? Real(over / sine * ratio) : Real(over / (1 - cosine));
    const Real sum = dot(tangent(b), gap) + start * sine;
    const Real of_a = end_of_a ? length_[a] : Real(0);
    const Real of_b = end_of_a ? Real(0) : length_[b];
    if (i == a) {
      result = {of_a, start, Real(-ratio), of_a + sum + of_b - length_[b], of_a + sum + of_b};
    } else {
      result = {of_b, Real(start - ratio * sum), ratio, of_b + sum + of_a - length_[a],
                of_b + sum + of_a};
    }
    return clip(result, length_[i]);
  }

 private:
  static Vec2 rounded(const Point& p) {
    return {static_cast<double>(p.x), static_cast<double>(p.y)};
  }
  void plant_trees() {
    for_each_ring(links(), n_, [&](int begin, int end) {
      std::vector<Vec2> ring;
      for (int i = begin; i < end; ++i) ring.push_back(rounded(vertex_[i]));
      trees_.emplace_back(std::move(ring));
      trees_.back().add_slabs();
    });
  }

  // A sine above this value has the right sign whatever the round-off.
  static constexpr double kSure = 0x1p-40;

  // The side of the line of edge i that vertex v is on: 1 in front, 0 on the line, -1 behind. Where
  // vertices became one, the edge begins in the last one of them: otherwise a vertex beside it
  // could come to lie on it, or behind it.
  [[nodiscard]] int side(int i, int v) const {
    return v == i ? 0 : side(last_[i], vertex_[after(i)], vertex_[v]);
  }
  // The side of the line from p to q that r is on.
  static int side(const Point& p, const Point& q, const Point& r) {
    if constexpr (std::is_same_v<Real, double>) {
      return orientation({p.x, p.y}, {q.x, q.y}, {r.x, r.y});
    } else {
      const Real area = cross(q - p, r - p);
      return (area > 0) - (area < 0);
    }
  }
  // The turn at vertex i. Where the outline turns back, vertices that became one may have bent one
  // edge across the other. Then the far end of the shorter edge tells a tip from the end of a slit:
  // it lies in front of the longer edge, or behind it.
  [[nodiscard]] int turn_at(int i) const {
    const int b = before(i), a = after(i);
    if (dot(normal_[b], normal_[i]) >= 0) return side(vertex_[b], vertex_[i], vertex_[a]);
    return length_[b] < length_[i] ? side(last_[i], vertex_[a], last_[b])
                                   : side(last_[b], vertex_[i], vertex_[a]);
  }
  // Whether a part of edge j is in front of the line of edge i.
  [[nodiscard]] bool in_front(int i, int j) const {
    return height(i, j) > 0 || height(i, after(j)) > 0;
  }
  // Reduces a bisector to the edge, of the given length, and to positive heights.
  static bool clip(Bisector& bisector, const Real& length) {
    bisector.from = std::max(bisector.from, Real(0));
    bisector.to = std::min(bisector.to, length);
    const Real zero = bisector.origin - bisector.start / bisector.rise;
    if (bisector.rise > 0) {
      bisector.from = std::max(bisector.from, zero);
    } else if (bisector.rise < 0) {
      bisector.to = std::min(bisector.to, zero);
    } else if (!(bisector.start >= 0)) {
      return false;
    }
    return bisector.from < bisector.to;
  }

  [[nodiscard]] const RingLinks* links() const { return several_ ? &links_ : nullptr; }

  int few_;
  int n_ = 0;
  bool several_ = false;  // whether there are several rings
  RingLinks links_;       // neighbours, if there are
  std::vector<Point> vertex_, normal_;
  Real same_{};              // distance within which vertices are one
  std::vector<Point> last_;  // of the vertices that have become this one
  std::vector<Real> length_;
  std::vector<int> turn_;    // per vertex: 1 where the outline turns left, -1 right, 0 straight on
  std::vector<int> reflex_;  // vertices with a right turn
  std::vector<RingTree> trees_;      // of the edges of each ring, unless they are few
  std::vector<RingTree::Run> runs_;  // memory of each_in_order()
};

}  // namespace apothem
