// Points in the order of a Hilbert curve: neighbours in the order are neighbours in the plane.
// D. Hilbert, Math. Annalen 38 (1891).
#pragma once

#include <vector>

#include "geometry/point.hpp"

namespace apothem {

/// The numbers of the points along a curve through 2^31 x 2^31 squares of their box; points of one
/// square by number. Points must be finite.
std::vector<int> hilbert_order(const std::vector<Vec2>& points);

}  // namespace apothem
