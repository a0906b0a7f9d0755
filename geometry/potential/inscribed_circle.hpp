// Largest circle inside any simple polygon.
#pragma once

#include "apothem/geometry/polygon/polygon.hpp"
#include "apothem/geometry/potential/potential.hpp"

namespace apothem {

/// The largest circle inside the polygon, with all its centres: isolated ones, and the two ends of
/// each segment of centres (a corridor), one after the other. Radii that differ by less than 1e-13
/// of the radius plus 4e-15 of the polygon's size count as equal. Throws InvalidPolygon if the
/// polygon is thinner than double precision resolves. Convex polygons of few edges:
/// inscribed_circle.
InscribedCircle largest_inscribed_circle(const Polygon& polygon);

}  // namespace apothem
