// A polygon's roof for ParaView.
#pragma once

#include <string>

#include "geometry/polygon.hpp"
#include "geometry/singular_area.hpp"

namespace apothem {

/// Writes two files into a folder, which is created:
/// - faces.vtu: the faces of the roof, cut where phi = 1; points: roof_height (m), phi; cells: edge
///   (index into the ring as it was given), plateau (1 where phi = 1);
/// - singular_area.vtu: the singular area as polygons, lines and vertices.
/// `reference` is the length r in m. Throws SystemFailure.
void write_polygon_vtk(const std::string& folder, const Polygon& polygon, const Skeleton& skeleton,
                       const SingularArea& singular, double reference);

}  // namespace apothem
