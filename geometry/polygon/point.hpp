// Points, the cross product in two dimensions, and axis-parallel boxes. Every other header of the
// geometry uses them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {

/// A point or a vector of the plane. Coordinates are in m unless something else is said.
using Vec2 = Eigen::Vector2d;

/// The z component of the cross product a x b.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The cross product of the vector (0, 0, spin) with `arm`. If spin is an angular velocity, this is
/// the velocity that the rotation about the origin gives to the point `arm`.
inline Vec2 cross(double spin, const Vec2& arm) { return {-spin * arm.y(), spin * arm.x()}; }

/// True if both coordinates are finite.
inline bool is_finite(const Vec2& p) { return std::isfinite(p.x()) && std::isfinite(p.y()); }

/// Axis-parallel box x0 <= x <= x1, y0 <= y <= y1. A default-constructed box is empty.
struct Box {
  double x0 = std::numeric_limits<double>::infinity();
  double y0 = std::numeric_limits<double>::infinity();
  double x1 = -std::numeric_limits<double>::infinity();
  double y1 = -std::numeric_limits<double>::infinity();

  /// Extends the box so that it contains the point (x, y).
  void include(double x, double y) {
    x0 = std::min(x0, x), y0 = std::min(y0, y);
    x1 = std::max(x1, x), y1 = std::max(y1, y);
  }
  void include(const Vec2& p) { include(p.x(), p.y()); }
  /// Extends the box so that it contains the other one.
  void include(const Box& other) {
    x0 = std::min(x0, other.x0), y0 = std::min(y0, other.y0);
    x1 = std::max(x1, other.x1), y1 = std::max(y1, other.y1);
  }
  /// The box with every side moved outwards by `margin`.
  [[nodiscard]] Box grown(double margin) const {
    return {x0 - margin, y0 - margin, x1 + margin, y1 + margin};
  }
  /// The longer of the two side lengths.
  [[nodiscard]] double extent() const { return std::max(x1 - x0, y1 - y0); }
};

/// The smallest box that contains a list of points, or a segment between two of them.
template <class Points>
Box box_of(const Points& points) {
  Box box;
  for (const Vec2& p : points) box.include(p);
  return box;
}
inline Box box_of(const Vec2& a, const Vec2& b) {
  Box box;
  box.include(a), box.include(b);
  return box;
}

/// True if the boxes have no point in common. Comparisons with NaN are false, so a box with a NaN
/// never counts as apart from another one.
inline bool apart(const Box& a, const Box& b) {
  return a.x1 < b.x0 || b.x1 < a.x0 || a.y1 < b.y0 || b.y1 < a.y0;
}

/// Returns an origin near the box for local coordinates. It lies on a grid so coarse that the
/// subtraction of the origin from a coordinate inside the box is exact. For an empty box, and for a
/// box that lies around zero, the origin is zero.
inline Vec2 local_origin(const Box& box) {
  const double extent = box.extent();
  if (!(extent > 0)) return Vec2::Zero();
  const double grid = std::ldexp(1.0, std::ilogb(extent) + 3);  // 4 to 8 times the extent
  return {grid * std::round((box.x0 + box.x1) / 2 / grid),
          grid * std::round((box.y0 + box.y1) / 2 / grid)};
}

}  // namespace apothem
