// Exact predicates on points with double coordinates (CGAL's filtered exact kernel).
//
// Laws, for finite coordinates, without any tolerance:
//   orientation(a, b, c) = orientation(b, c, a) = -orientation(b, a, c)
//   segments_meet(a, b, c, d) = segments_meet(c, d, a, b) = segments_meet(b, a, c, d)
#pragma once

#include <vector>

#include "geometry/point.hpp"

namespace apothem {

/// +1: a, b, c turn left; -1: right; 0: exactly collinear.
int orientation(const Vec2& a, const Vec2& b, const Vec2& c);

/// True when the closed segments ab and cd share at least one point.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d);

/// True when p lies inside the simple ring (of either sense), not on it.
bool strictly_inside(const std::vector<Vec2>& ring, const Vec2& p);

}  // namespace apothem
