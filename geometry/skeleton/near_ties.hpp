// Whether events of a front may have coincided. This header is private to the construction of the
// straight skeleton.
#pragma once

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// True if several events of the front may have happened at the same place and time, as far as the
/// polygon's skeleton can tell, which was made with lines moved by `movement` as a share of the
/// polygon's size: if an arc is not longer, or a node and an arc that does not end there are not
/// further apart, than a hundred times what such a movement does to the places of the nodes, at
/// most 1e-8 of the polygon's size; if more than three faces meet in a node; or if an arc is that
/// of a straight vertex.
bool has_near_ties(const Skeleton& skeleton, const Polygon& polygon, double movement);

}  // namespace apothem
