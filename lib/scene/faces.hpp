// The faces into which lines divide the plane, as joints divide rock into blocks.
#pragma once

#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The closed faces between lines (m), from below upwards: for each its outer ring and its holes.
/// The lines may cross. An end that is within `tolerance` (m) of a vertex or a line is moved there.
/// What bounds no face, like a joint that ends inside of a block, is left out. Neighbours share
/// their vertices exactly. Throws std::runtime_error if GDAL was built without GEOS.
std::vector<std::vector<std::vector<Vec2>>> faces_between(std::vector<std::vector<Vec2>> lines,
                                                          double tolerance);

}  // namespace apothem
