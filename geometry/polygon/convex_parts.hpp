// A polygon as convex parts, for all that fills convex polygons only.
#pragma once

#include <vector>

#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// Divides a polygon along diagonals into convex parts: counter-clockwise lists of vertices, at
/// most four times as many as necessary. No points are added. A convex polygon is one part that
/// begins at vertex 0.
std::vector<std::vector<int>> convex_parts(const Polygon& polygon);

}  // namespace apothem
