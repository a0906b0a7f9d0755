// The integrals of a pair with 100 digits, as a reference for all other methods. The overlap
// polygon is exact (CGAL); every square root, inscribed radius and integral is computed with 100
// digits (Boost.Multiprecision). It is slow and serves the tests and `apothem contact --method
// exact`.
#pragma once

#include "geometry/integrals/edge_integral.hpp"
#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// Computes the integrals of a pair with the conventions of overlap_method. The potentials are
/// computed again from the polygons with 100 digits. Only the radius of the largest inscribed
/// circle of a polygon that is not convex is taken in double precision. Throws InvalidPolygon where
/// make_potential does.
PairResult exact_method(const Polygon& a, const Polygon& b, const PotentialChoice& choice);

}  // namespace apothem
