// The methods for the contact of two polygons, by name.
#pragma once

#include <array>
#include <string_view>

#include "geometry/integrals/edge_integral.hpp"
#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"

namespace apothem {

/// Integrals along the edges; Eq. 8 on the overlap polygon; or that with 100 digits.
inline constexpr std::array<std::string_view, 3> kPairMethods{"edge", "overlap", "exact"};

/// The contact of two polygons by one of these methods. Throws InvalidPolygon as make_potential
/// does.
PairResult evaluate_pair(std::string_view method, const Polygon& a, const Polygon& b,
                         const PotentialChoice& choice);

/// The loading point of a result, in the coordinates of the polygons' vertices, m.
Vec2 world_loading_point(const PairIntegral& pair, const Polygon& a);

}  // namespace apothem
