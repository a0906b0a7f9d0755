// The area of a ring of points, and its moments.
#pragma once

#include <vector>

#include "geometry/polygon/cyclic.hpp"
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

/// Area of a ring, m^2, and its first moment of area about a given origin, m^3.
struct RingMoments {
  double area = 0;
  Vec2 first = Vec2::Zero();
};
inline RingMoments ring_moments(const std::vector<Vec2>& ring, const Vec2& origin) {
  RingMoments m;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 p = ring[i] - origin, q = after(ring, i) - origin;
    m.area += cross(p, q) / 2;
    m.first += cross(p, q) * (p + q) / 6;
  }
  return m;
}

}  // namespace apothem
