// The contact potential, its gradient and the distance from the boundary at single points.
#pragma once

#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"

namespace apothem {

/// Where a point lies with respect to a polygon.
enum class Side { outside, boundary, inside };
/// "outside", "boundary" or "inside".
const char* side_name(Side side);

/// What holds at a point.
struct PointValues {
  Side side;  ///< decided exactly
  /// The potential: 0 outside and on the boundary, 1 at most.
  double phi;
  /// Gradient of phi, 1/m: zero outside and where phi is limited to 1. On the boundary it is that
  /// of the inside, and where the gradient jumps, that of one side.
  Vec2 gradient;
  int nearest_edge;        ///< index in the rings as they were given; of several, the first one
  double signed_distance;  ///< distance from the boundary, m: negative inside
};

/// Evaluates a polygon and one of its potentials at points. Both must outlive it.
class PointEvaluator {
 public:
  /// `potential`: of make_potential(), relative to polygon.origin().
  PointEvaluator(const Polygon& polygon, const Potential& potential);

  /// The point is in the coordinates of the polygon's vertices, m.
  [[nodiscard]] PointValues operator()(const Vec2& point) const;

 private:
  struct Nearest {
    int edge;
    double share, distance;
  };
  [[nodiscard]] Nearest nearest(const Vec2& point) const;
  [[nodiscard]] int edge_below(const Vec2& point, const Nearest& nearest) const;
  void set_linear(const Vec2& point, int edge, PointValues& values) const;
  void set_distance(const Vec2& point, const Nearest& nearest, PointValues& values) const;

  const Polygon& polygon_;
  const Potential& potential_;
  std::vector<std::vector<Vec2>> faces_;  // of the roof, relative to the polygon's origin
};

}  // namespace apothem
