// Lumped masses of elements.
#pragma once

#include <span>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The share of each corner in the area of an element, m^2; times density and thickness it is the
/// lumped mass. Triangles: one third each. Quadrilaterals: the integral of the bilinear shape
/// function (row-sum lumping), unless a corner would get nearly no share because the element is far
/// from convex. All other polygons: each triangle between an edge and the mean of the corners gives
/// half its area to each end of the edge, a corner gets at least a tenth of the mean share, and the
/// shares are then multiplied by an exponential of a linear function such that their centroid is
/// the element's. That is the positive solution of largest relative entropy. Sum and first moment
/// of the shares are those of the element, to round-off. `corners` go counter-clockwise, in m.
std::vector<double> corner_areas(std::span<const Vec2> corners);

}  // namespace apothem
