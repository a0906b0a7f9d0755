// Regions bounded by closed lines, and points that lie deep inside them.
#pragma once

#include <optional>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The closed lines around a region, with the region on their left: outer ones and holes.
struct Loops {
  std::vector<std::vector<Vec2>> rings;  ///< vertices of each line, m
  Box box;                               ///< around all of them
};

/// Distance of a point from the lines, m.
double distance(const Loops& loops, const Vec2& point);

/// A vertex of `a` that lies inside `b`, farther than `reach` (m) from its lines, if there is one.
std::optional<Vec2> deep_vertex(const Loops& a, const Loops& b, double reach);

/// The smallest thickness of the region, m, or `most` if it is nowhere thinner: the length of a way
/// from an edge straight inwards to another edge. Where this grows in proportion to the length of
/// the boundary between both ends, as in a wedge or a round end, it is not counted.
double smallest_thickness(const std::vector<std::vector<Vec2>>& rings, double most);

/// A reflex corner of a region with an angle below 84 degrees between its sides outside.
struct InnerCorner {
  Vec2 place;     ///< m
  double angle;   ///< between its sides outside of the region, rad
  double height;  ///< distance from its sides at which its bisector leaves the region, m
};

/// The one with the least `height`, if this is below `most` (m).
std::optional<InnerCorner> lowest_inner_corner(const std::vector<std::vector<Vec2>>& rings,
                                               double most);

}  // namespace apothem
