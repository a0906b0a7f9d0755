// Rotation of a vector.
#pragma once

#include "geometry/polygon/point.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

/// `p` turned counter-clockwise by `angle` (rad).
inline Vec2 turned(const Vec2& p, double angle) {
  const auto [s, c] = sine_cosine(angle);
  return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
}

}  // namespace apothem
