// The straight skeleton of a polygon with coinciding events, exactly. This header is private to the
// construction of the straight skeleton.
//
// The front moves from one event to the next. At the time of an event, what the polygon has become
// is the interior of the region that the front encloses: edges without length and stretches where
// two edges have met are no part of its border, and where several parts of the border touch in a
// point, each edge that ends there continues with the edge that starts there and is its neighbour
// in that interior. So whatever happens at the same place and time is one event with one node, and
// its outcome depends on the region alone: not on an order, and not on how edges are numbered.
//
// As in wavefront.hpp, triangles inside the front find the events. At the time of an event all
// triangles that are flat then are taken out at once: those with a side without length become
// stretches, and of the others the corner between the two ends of the longest side divides what is
// behind that side. What has faced each other across them meets: triangles become neighbours, a
// triangle gets a side on the front, or two edges of the front end on a stretch. The triangles that
// are left around a place, from one edge of the front to the next, are a corner of the interior.
//
// Times and places have 100 digits. Where these cannot tell places apart, exact_planes.hpp has to
// agree that they are one, and where two edges have met, that they are parallel. Only vertices
// between edges in line that were no neighbours in the polygon are left to the 100 digits; they
// divide faces of the same plane and do not enter the roof.
#pragma once

#include <optional>

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/skeleton_parts.hpp"

namespace apothem {

/// Returns the nodes and faces of the polygon's skeleton, rounded as fine_frame.hpp says, or
/// nothing if the front got into a state that is not possible. For usual polygons it takes about n
/// log n steps and memory linear in n. `progress` is called after every hundred events and may
/// throw.
std::optional<SkeletonParts> exact_skeleton(const Polygon& polygon, const Progress& progress);

}  // namespace apothem
