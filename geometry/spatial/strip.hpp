// What is near a segment, for trees of boxes.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The points within a distance of the segment from a to b, and a few more behind its ends.
class Strip {
 public:
  Strip(const Vec2& a, const Vec2& b, double distance)
      : around_(box_of(a, b).grown(distance)), start_(a), distance_(distance) {
    const Vec2 side = b - a;
    const double length = side.norm();
    if (length > 0) normal_ = {-side.y() / length, side.x() / length};
  }

  /// False only if none of the points is in the box.
  [[nodiscard]] bool meets(const Box& box) const {
    if (apart(box, around_)) return false;
    const Vec2 half((box.x1 - box.x0) / 2, (box.y1 - box.y0) / 2);
    const Vec2 centre = Vec2(box.x0, box.y0) + half - start_;
    // More than the round-off of the normal and of what it is multiplied with.
    const double slack = 1e-15 * (half.norm() + centre.norm());
    return std::abs(normal_.dot(centre)) <= normal_.cwiseAbs().dot(half) + distance_ + slack;
  }

 private:
  Box around_;
  Vec2 start_;
  Vec2 normal_ = Vec2::Zero();
  double distance_;
};

/// The points p between two parallel lines: low <= normal . p <= high, where the normal is a unit
/// vector. By default these are all points.
struct Slab {
  Vec2 normal = Vec2::Zero();
  double low = -HUGE_VAL, high = HUGE_VAL;

  /// How far a point is from them.
  [[nodiscard]] double distance(const Vec2& p) const {
    const double along = normal.dot(p);
    return std::max({0., low - along, along - high});
  }
};

/// How far boxes are from the segment from a to b.
class SegmentDistance {
 public:
  SegmentDistance(const Vec2& a, const Vec2& b) : around_(box_of(a, b)), start_(a), end_(b) {
    const Vec2 side = b - a;
    const double length = side.norm();
    if (length > 0) normal_ = {-side.y() / length, side.x() / length};
  }

  /// No point of the box is nearer than this, up to round-off.
  [[nodiscard]] double least(const Box& box) const {
    const Vec2 gap(std::max({0., box.x0 - around_.x1, around_.x0 - box.x1}),
                   std::max({0., box.y0 - around_.y1, around_.y0 - box.y1}));
    const Vec2 half((box.x1 - box.x0) / 2, (box.y1 - box.y0) / 2);
    const Vec2 centre = Vec2(box.x0, box.y0) + half - start_;
    return std::max(gap.norm(), std::abs(normal_.dot(centre)) - normal_.cwiseAbs().dot(half));
  }
  /// The same of the points of a slab that are in the box.
  [[nodiscard]] double least(const Box& box, const Slab& slab) const {
    const double at_start = slab.normal.dot(start_), at_end = slab.normal.dot(end_);
    return std::max({least(box), slab.low - std::max(at_start, at_end),
                     std::min(at_start, at_end) - slab.high});
  }

 private:
  Box around_;
  Vec2 start_, end_;
  Vec2 normal_ = Vec2::Zero();
};

}  // namespace apothem
