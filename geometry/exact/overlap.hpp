// Overlap polygons of two polygons (CGAL Boolean operations) and Eq. 8 of the paper on them: the
// second way to the numbers of edge_integral.hpp.
#pragma once

#include <vector>

#include "apothem/geometry/integrals/edge_integral.hpp"
#include "apothem/geometry/polygon/polygon.hpp"

namespace apothem {

/// How CGAL constructs intersection points. `inexact` is what people reach for first; it throws,
/// loses overlaps or crashes on ordinary pairs and is here to be measured, never to be relied on.
enum class Arithmetic { inexact, exact };

struct OverlapEdge {
  int edge_of_a;  ///< edge of a that it lies on, or -1
  int edge_of_b;  ///< edge of b that it lies on, or -1
};

/// One component of the overlap: counter-clockwise, without holes. Edge i runs from vertex i.
struct OverlapPolygon {
  std::vector<Vec2> vertices;      ///< relative to the origin asked for, rounded at the very end
  std::vector<OverlapEdge> edges;  ///< exact owners (empty with inexact constructions)
};

/// Components with non-zero area, for any two simple polygons, in coordinates relative to `origin`.
std::vector<OverlapPolygon> overlap_polygons(const Polygon& a, const Polygon& b, const Vec2& origin,
                                             Arithmetic arithmetic = Arithmetic::exact);

/// Eq. 8 with every ridge crossing among the points p_j, in double precision on the overlap
/// polygon. The potentials are those of make_potential (relative to the polygons' origins); moments
/// about the polygons' centroids, positions relative to a's centroid.
PairResult overlap_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                          const Potential& potential_b, Arithmetic arithmetic = Arithmetic::exact);

/// The same force and moments from overlap polygons that come from elsewhere, without the energy.
/// Edges without owners (an empty list) are integrated over both potentials, of which one is
/// round-off.
PairIntegral overlap_integral(const std::vector<OverlapPolygon>& overlap, const Vec2& origin,
                              const Polygon& a, const Potential& potential_a, const Polygon& b,
                              const Potential& potential_b);

/// The same for each component of the overlap by itself, with exact constructions.
std::vector<PairResult> overlap_patches(const Polygon& a, const Potential& potential_a,
                                        const Polygon& b, const Potential& potential_b);

}  // namespace apothem
