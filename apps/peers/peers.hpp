// Overlap polygons as other people would compute them: what the accuracy command measures against.
// Vertices are found in double world coordinates, then written relative to a's origin().
#pragma once

#include <vector>

#include "apothem/geometry/exact/overlap.hpp"
#include "apothem/geometry/polygon/polygon.hpp"

namespace apothem {

/// Boost.Geometry's intersection. Throws what Boost throws.
std::vector<OverlapPolygon> boost_overlap(const Polygon& a, const Polygon& b);

/// Plain floating-point clipping without any tolerance: Sutherland & Hodgman (1974) for two convex
/// polygons (`convex`: both are), else Greiner & Hormann (1998), which knows no degenerate
/// positions. Throws std::runtime_error where its crossings do not fit together.
std::vector<OverlapPolygon> clip_overlap(const Polygon& a, const Polygon& b, bool convex);

}  // namespace apothem
