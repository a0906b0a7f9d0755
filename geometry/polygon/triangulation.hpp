// The triangulation of polygons.
#pragma once

#include <array>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/polygon_with_holes.hpp"

namespace apothem {

/// Indices of three vertices in counter-clockwise order.
using Triangle = std::array<int, 3>;

/// Returns the triangles of the constrained Delaunay triangulation of the polygon's inside, as
/// indices of the polygon's vertices. No points are added.
std::vector<Triangle> triangulate(const Polygon& polygon);

/// The same of a polygon with holes. The indices are those of the vertices of the outer ring and
/// then of the holes, one ring after the other; a vertex in which rings touch has the first one of
/// its indices.
std::vector<Triangle> triangulate(const PolygonWithHoles& polygon);

}  // namespace apothem
