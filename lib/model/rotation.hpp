// Rotation of a vector.
#pragma once

#include <cmath>

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// `p` turned counter-clockwise by `angle` (rad).
inline Vec2 turned(const Vec2& p, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

}  // namespace apothem
