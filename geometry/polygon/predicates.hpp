// Exact predicates on points with double coordinates. They are computed by CGAL's filtered exact
// kernel and need no tolerance.
//
// For finite coordinates they obey these laws:
//   orientation(a, b, c) = orientation(b, c, a) = -orientation(b, a, c)
//   segments_meet(a, b, c, d) = segments_meet(c, d, a, b) = segments_meet(b, a, c, d)
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// Returns +1 if the path a, b, c turns left, -1 if it turns right, and 0 if the three points are
/// exactly collinear.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

/// The smallest orientation() of three successive vertices of a ring: +1 where the boundary turns
/// left at every vertex, 0 where it also goes straight on, -1 where it turns right somewhere.
int smallest_turn(std::span<const Vec2> ring);

/// The order of points by x, then by y.
inline bool precedes(const Vec2& p, const Vec2& q) {
  return std::pair(p.x(), p.y()) < std::pair(q.x(), q.y());
}

/// True if the closed segments ab and cd have at least one point in common.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// True if no two edges of the ring meet anywhere but at their common vertex. The ring has three or
/// more distinct vertices and no spike. It takes about n log n steps.
bool is_simple(const std::vector<Vec2>& ring);

/// Returns +1 if p lies inside the simple ring, 0 if it lies on it, and -1 if it lies outside. The
/// ring may be clockwise or counter-clockwise.
int side_of_ring(std::span<const Vec2> ring, const Vec2& p);
/// True if p lies inside the simple ring and not on it.
inline bool strictly_inside(std::span<const Vec2> ring, const Vec2& p) {
  return side_of_ring(ring, p) > 0;
}

}  // namespace apothem
