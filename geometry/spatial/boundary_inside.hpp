// The length of one polygon's boundary inside another polygon, and the area of their overlap, with
// exact decisions.
#pragma once

#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// Returns the length, in m, of those parts of the boundary of `polygon` that have points of
/// `other` immediately on their inner side. They are the parts of the boundary of the overlap that
/// belong to `polygon`. Where edges of both polygons lie on each other, they count if both polygons
/// lie on the same side, and do not if the polygons lie on opposite sides. Whether edges lie on
/// each other is decided exactly for the coordinates as they are given; the length is rounded. For
/// usual polygons it takes about n log n steps.
double boundary_inside(const Polygon& polygon, const Polygon& other);

/// Returns the area of the overlap of two polygons, in m^2, from the same decisions: the sum over
/// the boundary of the overlap, by Green's theorem. Where edges lie on each other, those of a
/// count.
double area_inside(const Polygon& a, const Polygon& b);

}  // namespace apothem
