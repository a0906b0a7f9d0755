// The faces into which lines divide the plane, as joints divide rock into blocks.
#pragma once

#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The lines (m), of which each end, one after the other, has been moved to the nearest vertex of
/// any line that is within `tolerance` (m), the last one of several as near, or else into the first
/// segment of another line within the tolerance, which gets a vertex there.
std::vector<std::vector<Vec2>> snap_ends(std::vector<std::vector<Vec2>> lines, double tolerance);

/// The closed faces between lines (m), from below upwards: for each its outer ring and its holes.
/// The lines may cross. Their ends are snapped as snap_ends() does. What bounds no face, like a
/// joint that ends inside of a block, is left out. Neighbours share their vertices exactly. Throws
/// std::runtime_error if GDAL was built without GEOS.
std::vector<std::vector<std::vector<Vec2>>> faces_between(std::vector<std::vector<Vec2>> lines,
                                                          double tolerance);

}  // namespace apothem
