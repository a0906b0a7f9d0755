// The point of a segment that is nearest to a given point.
#pragma once

#include <algorithm>

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

}  // namespace apothem
