// The length of one polygon's boundary inside another polygon, with exact decisions.
#pragma once

#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// Returns the length, in m, of those parts of the boundary of `polygon` that have points of
/// `other` immediately on their inner side. They are the parts of the boundary of the overlap that
/// belong to `polygon`. Where edges of both polygons lie on each other, they count if both polygons
/// lie on the same side, and do not if the polygons lie on opposite sides. Whether edges lie on
/// each other is decided exactly for the coordinates as they are given; the length is rounded.
/// Takes a time proportional to the product of the numbers of vertices.
double boundary_inside(const Polygon& polygon, const Polygon& other);

}  // namespace apothem
