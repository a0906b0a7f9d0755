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

}  // namespace apothem
