// The largest inscribed circle of any polygon, with or without holes.
#pragma once

#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"

namespace apothem {

/// Up to this number of edges of a convex polygon it is faster to clip every face by all edges than
/// to search.
inline constexpr int kFewEdges = 100;

/// Returns the radius of the largest circle inside the polygon, which no hole reaches into, and all
/// possible centres of such a circle: isolated ones, and the two ends of each segment of centres
/// (in a corridor with parallel walls), one after the other. Radii that differ by less than 1e-13
/// of the radius plus 4e-15 of the polygon's size count as equal. The circle is found in the
/// polygon's canonical pose (canonical_pose.hpp), so that neither numbering nor the order of holes
/// nor mirrors nor quarter turns nor powers of two matter: by inscribed_circle for convex polygons
/// with up to 100 edges, by a search for others. Throws InvalidPolygon if the polygon is thinner
/// than double precision resolves.
InscribedCircle largest_inscribed_circle(const Polygon& polygon, const Progress& progress = {});

}  // namespace apothem
