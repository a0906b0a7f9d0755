// The area of a ring of points.
#pragma once

#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The area that a ring goes round, m^2: negative if it turns clockwise; where it crosses itself,
/// parts count as often as it goes round them. 0 for fewer than three points.
inline double ring_area(const std::vector<Vec2>& ring) {
  double twice = 0;
  for (size_t i = 2; i < ring.size(); ++i) {
    twice += cross(Vec2(ring[i - 1] - ring[0]), Vec2(ring[i] - ring[0]));
  }
  return twice / 2;
}

}  // namespace apothem
