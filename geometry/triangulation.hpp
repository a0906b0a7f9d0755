// Triangles of a simple polygon.
#pragma once

#include <array>
#include <vector>

#include "geometry/polygon.hpp"

namespace apothem {

/// Indices of three vertices, counter-clockwise.
using Triangle = std::array<int, 3>;

/// The constrained Delaunay triangulation of the inside: no points are added.
std::vector<Triangle> triangulate(const Polygon& polygon);

}  // namespace apothem
