// The Voronoi cells of a region as blocks that fill it.
#pragma once

#include <vector>

#include "geometry/meshing/voronoi.hpp"

namespace apothem {

/// The cells of a Voronoi mesh, which may be more than the options ask for at holes, in the
/// coordinates of the region. With a `gap` (m) every edge of the mesh opens by it: each cell
/// shrinks by half of it along its straight skeleton. Throws as voronoi_mesh does, and
/// std::invalid_argument if a cell is too small for the gap or would fall into parts.
std::vector<std::vector<Vec2>> voronoi_blocks(const Polygon& region, const VoronoiOptions& options,
                                              double gap);

}  // namespace apothem
