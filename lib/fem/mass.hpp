// Lumped mass.
#pragma once

#include <span>
#include <vector>

#include "geometry/point.hpp"

namespace apothem {

/// The share of each corner in the area of an element, m^2: one third for triangles, the integral
/// of the shape function (row sum) for quadrilaterals unless they are far from convex. Polygons
/// share the triangles around their mean corner, a tenth of the mean share at least; the shares are
/// then tilted exponentially so that their centroid is the element's (shares of largest entropy:
/// always positive). Sum and first moment are exact.
std::vector<double> corner_areas(std::span<const Vec2> corners);

}  // namespace apothem
