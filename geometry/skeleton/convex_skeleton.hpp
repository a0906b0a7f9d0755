// The straight skeleton of a convex polygon. This header is private to the construction of the
// straight skeleton.
#pragma once

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/skeleton_parts.hpp"

namespace apothem {

/// Returns the nodes and faces of the skeleton of a convex polygon.
SkeletonParts shrink_convex(const Polygon& polygon);

}  // namespace apothem
