// The circles that touch two features of an outline, for trees of boxes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/polygon/point.hpp"
#include "geometry/spatial/strip.hpp"

namespace apothem {

/// A circle that touches two features, each of which is a point or a straight line, and where it
/// touches them.
struct TouchingCircle {
  Vec2 centre = Vec2::Zero();
  double radius = 0;
  Vec2 one = Vec2::Zero(), other = Vec2::Zero();
  bool empty = false;  ///< whether nothing is known to be inside it

  /// Whether another circle is in this one, up to a tolerance.
  [[nodiscard]] bool holds(const TouchingCircle& circle, double tolerance) const {
    return (circle.centre - centre).norm() + circle.radius <= radius + tolerance;
  }
};

/// The points inside all circles that touch the same two features, from the circle `first` to
/// `last`, and a few more: `slack` is more than the round-off of positions. What is in a circle
/// that is known to be empty does not count.
///
/// They are inside one of these two, or in the quadrilateral of the four points where these touch
/// the features. For another such circle crosses `first` on the line through the middles between
/// the points where both touch a feature, which is where tangents to both have the same length. So
/// what it has outside `first` is on one side of that line, what it has outside `last` on one side
/// of another one, and both lines cut the quadrilateral.
class TouchingCircles {
 public:
  TouchingCircles(const TouchingCircle& first, const TouchingCircle& last, double slack)
      : circles_{first, last}, corners_{first.one, last.one, last.other, first.other} {
    slack_ = slack;
    for (TouchingCircle& circle : circles_) {
      circle.radius += slack;
      const Vec2 size(circle.radius, circle.radius);
      around_.include(circle.centre - size);
      around_.include(circle.centre + size);
      is_finite_ = is_finite_ && std::isfinite(circle.radius) && is_finite(circle.other);
    }
    for (const Vec2& corner : corners_) between_.include(corner);
    between_ = between_.grown(slack);
    around_.include(between_);
  }

  /// False only if none of the points is both in the box and in the slab.
  [[nodiscard]] bool meets(const Box& box, const Slab& slab) const {
    if (!is_finite_) return true;
    if (apart(box, around_)) return false;
    return reaches(circles_[0], box, slab) || reaches(circles_[1], box, slab) ||
           (crosses_between(box) && crosses_between(slab));
  }

 private:
  static bool reaches(const TouchingCircle& circle, const Box& box, const Slab& slab) {
    if (circle.empty) return false;
    const double x = std::max({0., box.x0 - circle.centre.x(), circle.centre.x() - box.x1});
    const double y = std::max({0., box.y0 - circle.centre.y(), circle.centre.y() - box.y1});
    return x * x + y * y <= circle.radius * circle.radius &&
           slab.distance(circle.centre) <= circle.radius;
  }

  // Whether the box meets the quadrilateral: none of its sides separates them.
  [[nodiscard]] bool crosses_between(const Box& box) const {
    if (apart(box, between_)) return false;
    const Vec2 half((box.x1 - box.x0) / 2, (box.y1 - box.y0) / 2);
    const Vec2 centre = Vec2(box.x0, box.y0) + half;
    for (size_t i = 0; i < 4; ++i) {
      const Vec2 side = corners_[(i + 1) % 4] - corners_[i];
      const Vec2 normal(-side.y(), side.x());
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const Vec2& corner : corners_) {
        const double along = normal.dot(corner - centre);
        low = std::min(low, along), high = std::max(high, along);
      }
      const double reach =
          normal.cwiseAbs().dot(half) + slack_ * (std::abs(normal.x()) + std::abs(normal.y()));
      if (low > reach || high < -reach) return false;
    }
    return true;
  }

  [[nodiscard]] bool crosses_between(const Slab& slab) const {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Vec2& corner : corners_) {
      const double across = slab.normal.dot(corner);
      low = std::min(low, across), high = std::max(high, across);
    }
    return low <= slab.high + slack_ && high >= slab.low - slack_;
  }

  std::array<TouchingCircle, 2> circles_;
  std::array<Vec2, 4> corners_;
  Box around_, between_;
  double slack_;
  bool is_finite_ = true;
};

}  // namespace apothem
