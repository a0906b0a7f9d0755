// Points, the 2-D cross product and boxes: the vocabulary of every other header.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {

using Vec2 = Eigen::Vector2d;

/// z component of a x b.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// spin x arm: the velocity (or lever) that a rotation about z gives at `arm`.
inline Vec2 cross(double spin, const Vec2& arm) { return {-spin * arm.y(), spin * arm.x()}; }

inline bool is_finite(const Vec2& p) { return std::isfinite(p.x()) && std::isfinite(p.y()); }

/// Axis-parallel box; the default one is empty.
struct Box {
  double x0 = std::numeric_limits<double>::infinity();
  double y0 = std::numeric_limits<double>::infinity();
  double x1 = -std::numeric_limits<double>::infinity();
  double y1 = -std::numeric_limits<double>::infinity();

  void include(double x, double y) {
    x0 = std::min(x0, x), y0 = std::min(y0, y);
    x1 = std::max(x1, x), y1 = std::max(y1, y);
  }
  [[nodiscard]] Box grown(double margin) const {
    return {x0 - margin, y0 - margin, x1 + margin, y1 + margin};
  }
  [[nodiscard]] double extent() const { return std::max(x1 - x0, y1 - y0); }
};

/// True when the boxes are apart; written so that NaN never says "apart".
inline bool apart(const Box& a, const Box& b) {
  return a.x1 < b.x0 || b.x1 < a.x0 || a.y1 < b.y0 || b.y1 < a.y0;
}

/// An origin near the box, on so coarse a grid that subtracting it from a coordinate inside the box
/// is exact; zero for a box around zero.
inline Vec2 local_origin(const Box& box) {
  const double extent = box.extent();
  if (!(extent > 0)) return Vec2::Zero();
  const double grid = std::ldexp(1.0, std::ilogb(extent) + 3);  // 4 to 8 times the scene
  return {grid * std::round((box.x0 + box.x1) / 2 / grid),
          grid * std::round((box.y0 + box.y1) / 2 / grid)};
}

}  // namespace apothem
