#include "geometry/potential/distance_field.hpp"

namespace apothem {

DistanceField make_distance_field(const Polygon& polygon, double reference) {
  // If the sine of the angle by which the boundary turns at a vertex exceeds this value, the vertex
  // is convex whatever the round-off.
  constexpr double kClearlyConvex = 0.125;
  DistanceField field{1 / reference, {}};
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 in = polygon[i] - polygon.before(i);
    const Vec2 out = polygon.after(i) - polygon[i];
    const double turn = cross(Vec2(in.normalized()), Vec2(out.normalized()));
    const bool convex = turn > 0 && (turn > kClearlyConvex || in.dot(out) < 0);
    if (!convex) field.corners.push_back(i);
  }
  return field;
}

}  // namespace apothem
