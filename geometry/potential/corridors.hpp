// Corridors with parallel walls, in which an inscribed circle may move. This header is private to
// the search for inscribed circles.
#pragma once

#include <vector>

#include "geometry/potential/edge_distance.hpp"
#include "geometry/spatial/ring_tree.hpp"

namespace apothem {

/// The two ends of a segment of centres; they are equal for an isolated centre.
struct Centre {
  Vec2 first, last;
};

class Corridors {
 public:
  /// The edges of a polygon whose size is 1 at most, and the trees of each ring's edges. Both must
  /// outlive it. Distances that differ by less than `slack` count as equal.
  Corridors(const std::vector<PolygonEdge>& edges, const std::vector<RingTree>& trees, double slack)
      : edges_(edges), trees_(trees), slack_(slack) {}

  /// The longest segment through a point that runs along two parallel edges which the circle with a
  /// radius touches there, and that keeps the distance `radius` or more from all edges. `most` is
  /// how large the circle may become on its way.
  [[nodiscard]] Centre longest(const Vec2& point, double radius, double most) const;

 private:
  template <class F>
  void each_touched(const Vec2& point, double radius, const F& f) const;
  [[nodiscard]] Centre free_way(const Vec2& point, const Vec2& u, double radius) const;
  [[nodiscard]] Vec2 along_wall(const Centre& way, const Vec2& u, double most) const;

  const std::vector<PolygonEdge>& edges_;
  const std::vector<RingTree>& trees_;
  double slack_;
};

}  // namespace apothem
