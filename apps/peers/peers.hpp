// Private header: overlap polygons by methods from outside this project, with which `apothem
// accuracy` compares its own. They compute the vertices in double precision in world coordinates;
// the results are relative to a.origin().
#pragma once

#include <vector>

#include "geometry/exact/overlap.hpp"
#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// The intersection of two polygons by Boost.Geometry. Throws what Boost throws.
std::vector<OverlapPolygon> boost_overlap(const Polygon& a, const Polygon& b);

/// The intersection by plain floating-point clipping without any tolerance: Sutherland & Hodgman
/// (1974) if both polygons are convex, as `convex` says, otherwise Greiner & Hormann (1998), which
/// does not handle degenerate positions. Throws std::runtime_error where the crossings that it
/// finds are inconsistent.
std::vector<OverlapPolygon> clip_overlap(const Polygon& a, const Polygon& b, bool convex);

}  // namespace apothem
