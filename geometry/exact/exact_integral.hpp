// The oracle: exact overlap polygon, then every square root, inradius and integral in
// 100-digit arithmetic (Boost.Multiprecision). Slow; tests and `apothem contact --method exact`.
#pragma once

#include "apothem/geometry/integrals/edge_integral.hpp"
#include "apothem/geometry/polygon/polygon.hpp"

namespace apothem {

/// Same conventions as overlap_method; potentials are rebuilt from the polygons in high precision.
PairResult exact_method(const Polygon& a, const Polygon& b, const PotentialChoice& choice);

}  // namespace apothem
