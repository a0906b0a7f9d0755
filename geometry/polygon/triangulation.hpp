// The triangulation of a simple polygon.
#pragma once

#include <array>
#include <vector>

#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// Indices of three vertices in counter-clockwise order.
using Triangle = std::array<int, 3>;

/// Returns the triangles of the constrained Delaunay triangulation of the polygon's inside, as
/// indices of the polygon's vertices. No points are added.
std::vector<Triangle> triangulate(const Polygon& polygon);

}  // namespace apothem
