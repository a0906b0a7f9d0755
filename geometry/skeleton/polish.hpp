// The correction of a skeleton's nodes. This header is private to the construction of the straight
// skeleton.
#pragma once

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// Moves every inner node by the shortest way onto the planes of its faces, and sets the height of
/// the roof. This removes the errors of the construction's arithmetic and of moved vertices. In
/// directions that the planes do not determine, nodes are not moved.
void polish(Skeleton& skeleton, const Polygon& polygon);

}  // namespace apothem
