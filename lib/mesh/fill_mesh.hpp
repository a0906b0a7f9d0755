// Generates an unstructured mesh of a polygon with holes, and converts meshes to and from tilings.
#pragma once

#include <vector>

#include "geometry/meshing/polygon_mesh.hpp"
#include "geometry/polygon/polygon.hpp"
#include "lib/mesh/mesh.hpp"

namespace apothem {

/// A mesh with elements of about `size` (m). Triangles have that mean edge length (see
/// delaunay_mesh). Quadrilaterals are convex with about size^2 of area: larger triangles, with
/// edges of 2.2 x size, are joined in pairs where that makes good quadrilaterals, all elements are
/// cut into three or four quadrilaterals, and the nodes are smoothed. The first nodes are the
/// vertices of the outline and of the holes, bit for bit. Groups as in add_outline_groups; edges
/// are numbered as in the outline that the user gave. Throws InvalidPolygon and
/// std::invalid_argument as delaunay_mesh does, and InvalidMesh if elements degenerate because the
/// coordinates are too large for their size.
Mesh fill_mesh(const Polygon& outline, const std::vector<Polygon>& holes, double size,
               ElementShape shape);

/// The same of a polygon, with its holes.
Mesh fill_mesh(const Polygon& region, double size, ElementShape shape);

/// The cells of a tiling of `region`, in the coordinates of in_world(), as elements, with the
/// groups of fill_mesh.
Mesh mesh_of_cells(const Polygon& region, const PolygonMesh& cells);

/// The elements of a mesh as cells of a tiling; groups are lost.
PolygonMesh cells_of_mesh(const Mesh& mesh);

}  // namespace apothem
