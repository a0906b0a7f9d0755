// The straight skeleton as the trace of a wavefront: the inside of the polygon is triangulated, its
// boundary moves inwards, and each event is the collapse of a triangle (Aichholzer & Aurenhammer
// 1998; Palfrader, Held & Huber 2012). For usual polygons it takes about n log n steps and memory
// linear in n. This header is private to the construction of the straight skeleton.
//
// The method has no cases for events that happen at the same place and time. It moves every vertex
// by about 1e-14 of the polygon's size in a random direction, so that there are none, and computes
// with 32 digits, which tells apart the events of the moved polygon. This is not a proof: the
// result has to be checked.
#pragma once

#include <optional>

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/skeleton_parts.hpp"

namespace apothem {

/// Largest movement of a vertex, as a share of the polygon's size. A vertex between two edges that
/// are parallel but for a movement d has the speed 1 / d, and its place has the error 1e-32 / d,
/// which has to be much smaller than d.
inline constexpr double kWavefrontMovement = 0x1p-46;

/// Returns the nodes and faces of the polygon's skeleton, with positions in the coordinates of the
/// polygon's vertices, or nothing if the front got into a state that is not possible. The polygon
/// should lie around the origin and have a size of about 1. The seed chooses the directions in
/// which the vertices are moved. `progress` is called every hundredth of the way and may throw.
std::optional<SkeletonParts> trace_wavefront(const Polygon& polygon, unsigned seed,
                                             const Progress& progress);

}  // namespace apothem
