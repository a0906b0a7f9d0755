// The order of points along a Hilbert curve. Points that are neighbours in this order are
// neighbours in the plane. Source: D. Hilbert, Math. Annalen 38 (1891).
#pragma once

#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// Returns the indices of the points in the order of the curve, which passes through a grid of
/// 2^31 x 2^31 squares over the points' bounding square. Points in the same square are ordered by
/// index. All points must be finite; this is not checked.
std::vector<int> hilbert_order(const std::vector<Vec2>& points);

}  // namespace apothem
