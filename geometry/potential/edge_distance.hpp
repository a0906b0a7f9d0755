// Distances from an edge. This header is private to the search for inscribed circles.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/polygon/point.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

/// A distance and its gradient.
struct Distance {
  double value;
  Vec2 gradient;
};

/// An edge of a polygon.
struct PolygonEdge {
  Vec2 start, end, direction;
  double length;

  PolygonEdge(const Vec2& a, const Vec2& b)
      : start(a), end(b), direction(b - a), length(hypotenuse(direction.x(), direction.y())) {
    direction /= length;
  }

  [[nodiscard]] double distance(const Vec2& p) const {
    const Vec2 d = p - start;
    const double along = direction.dot(d);
    if (along <= 0) return d.norm();
    return along >= length ? (p - end).norm() : std::abs(cross(direction, d));
  }

  [[nodiscard]] Distance distance_and_gradient(const Vec2& p) const {
    const Vec2 d = p - start;
    const double along = direction.dot(d);
    if (along > 0 && along < length) {
      const double across = cross(direction, d);
      const double sign = across < 0 ? -1 : 1;
      return {sign * across, sign * Vec2(-direction.y(), direction.x())};
    }
    const Vec2 arm = along <= 0 ? d : p - end;
    const double value = arm.norm();
    return {value, value > 0 ? Vec2(arm / value) : Vec2::Zero()};
  }

  /// The first s >= 0 at which the point x + s u is closer to the edge than `radius`, or infinity
  /// if there is none. u has unit length. The points of a line within that distance form one
  /// interval, which is the union of the intervals in the discs about the two ends of the edge and
  /// in the strip between them.
  [[nodiscard]] double first_hit(const Vec2& x, const Vec2& u, double radius) const {
    double enter = HUGE_VAL;
    double leave = -HUGE_VAL;
    const auto add = [&](double low, double high) {
      if (!(low < high)) return;
      enter = std::min(enter, low);
      leave = std::max(leave, high);
    };
    for (const Vec2& centre : {start, end}) {
      const double middle = u.dot(centre - x);
      const double half = radius * radius - std::pow(cross(u, centre - x), 2);
      if (half > 0) add(middle - std::sqrt(half), middle + std::sqrt(half));
    }
    double low = -HUGE_VAL;
    double high = HUGE_VAL;
    const auto clip = [&](double value, double slope, double least, double most) {
      if (slope == 0) {
        if (!(least < value && value < most)) high = -HUGE_VAL;
        return;
      }
      const auto [first, second] = std::minmax({(least - value) / slope, (most - value) / slope});
      low = std::max(low, first);
      high = std::min(high, second);
    };
    clip(direction.dot(x - start), direction.dot(u), 0, length);
    clip(cross(direction, x - start), cross(direction, u), -radius, radius);
    add(low, high);
    return leave > 0 ? std::max(enter, 0.0) : HUGE_VAL;
  }
};

}  // namespace apothem
