// Unstructured mesh of any polygon with holes.
#pragma once

#include <vector>

#include "geometry/polygon.hpp"
#include "geometry/polygon_mesh.hpp"
#include "mesh/mesh.hpp"

namespace apothem {

/// Elements of about `size` (m): triangles of that mean edge length (see delaunay_mesh), or convex
/// quadrilaterals of about its square in area, made from twice as large triangles of which pairs
/// are joined before all are cut into three or four, then smoothed. The first nodes are the
/// vertices of the outline and of the holes, bit for bit. Groups as in add_outline_groups; edges
/// have the numbers of the outline as it was given. Throws InvalidPolygon and std::invalid_argument
/// as delaunay_mesh does, InvalidMesh if the elements cannot be told apart so far from the origin.
Mesh fill_mesh(const Polygon& outline, const std::vector<Polygon>& holes, double size,
               ElementShape shape);

/// The cells of a tiling of `region` (as in_world gives them) as elements, with the same groups.
Mesh mesh_of_cells(const Polygon& region, const PolygonMesh& cells);

/// Elements as cells.
PolygonMesh cells_of_mesh(const Mesh& mesh);

}  // namespace apothem
