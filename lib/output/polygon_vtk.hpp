// Writes for ParaView: the roof and the singular area of a polygon; a tiling.
#pragma once

#include <string>

#include "geometry/meshing/polygon_mesh.hpp"
#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/singular_area.hpp"

namespace apothem {

/// Writes two files into a folder, which is created if necessary:
/// - faces.vtu: the faces of the roof, cut where phi = 1; point data: roof_height (m), phi; cell
///   data: edge (index in the list of vertices that the user gave), plateau (1 where phi = 1);
/// - singular_area.vtu: the singular area as polygons, lines and vertices.
/// `reference` is the reference length r in m. Throws SystemFailure.
void write_polygon_vtk(const std::string& folder, const Polygon& polygon, const Skeleton& skeleton,
                       const SingularArea& singular, double reference);

/// Writes a tiling as a .vtu file of convex polygons with shared points, with the cell data `cell`
/// (index), `part` (of a cell that is not convex) and `area` (of the whole cell, m^2). Throws
/// SystemFailure.
void write_mesh(const std::string& file, const PolygonMesh& mesh);

}  // namespace apothem
