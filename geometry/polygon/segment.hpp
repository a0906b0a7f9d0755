// The point of a segment, or of a closed line, that is nearest to a given point.
#pragma once

#include <algorithm>
#include <span>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/point.hpp"

namespace apothem {

struct NearestOnSegment {
  double share;      ///< position along the segment, from 0 to 1
  double distance2;  ///< squared distance of the point, m^2
};

/// `arm` is the point, and `along` the end of the segment, from the segment's start, m. A segment
/// may have no length.
inline NearestOnSegment nearest_on_segment(const Vec2& arm, const Vec2& along) {
  const double length2 = along.squaredNorm();
  const double share = length2 > 0 ? std::clamp(arm.dot(along) / length2, 0., 1.) : 0;
  return {share, (arm - share * along).squaredNorm()};
}

/// Distance of a point from the closed line through the points of a ring, m.
inline double distance_to_ring(std::span<const Vec2> ring, const Vec2& point) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < ring.size(); ++i) {
    least =
        std::min(least, nearest_on_segment(point - ring[i], after(ring, i) - ring[i]).distance2);
  }
  return std::sqrt(least);
}

}  // namespace apothem
