// The places of a skeleton's nodes without round-off but for the last rounding. This header is
// private to the construction of the straight skeleton.
#pragma once

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

/// Moves the inner nodes to where the planes of their faces meet, rounded as fine_frame.hpp says.
/// Returns false if a node does not have three faces, which alone determine it.
bool place_exactly(Skeleton& skeleton, const Polygon& polygon);

}  // namespace apothem
