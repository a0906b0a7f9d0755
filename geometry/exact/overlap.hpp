// The overlap polygons of two polygons, by CGAL's Boolean operations, and Eq. 8 of the paper on
// them. This is a second way to compute the integrals of edge_integral.hpp.
#pragma once

#include <vector>

#include "geometry/integrals/edge_integral.hpp"
#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// How CGAL constructs intersection points. `inexact` is the usual first choice; on ordinary pairs
/// it throws, loses overlaps or crashes. It exists to be compared with and must not be relied on.
enum class Arithmetic { inexact, exact };

/// The edges of the two polygons that an edge of the overlap lies on.
struct OverlapEdge {
  int edge_of_a;  ///< edge of a that it lies on, or -1
  int edge_of_b;  ///< edge of b that it lies on, or -1
};

/// A ring of the boundary of the overlap. Edge i starts at vertex i.
struct OverlapRing {
  std::vector<Vec2> vertices;      ///< vertices relative to a given origin, rounded only once, m
  std::vector<OverlapEdge> edges;  ///< exact; empty with inexact constructions
};

/// One component of the overlap: its outer ring, counter-clockwise, and its holes, clockwise. Two
/// polygons without holes have an overlap without holes.
struct OverlapPolygon : OverlapRing {
  std::vector<OverlapRing> holes{};
};

/// Returns the components of the overlap of two polygons that have a positive area, in coordinates
/// relative to `origin`. Throws std::runtime_error if inexact constructions fail.
std::vector<OverlapPolygon> overlap_polygons(const Polygon& a, const Polygon& b, const Vec2& origin,
                                             Arithmetic arithmetic = Arithmetic::exact);

/// Evaluates Eq. 8 in double precision on the overlap polygon. Every crossing with a ridge of the
/// potential is among the points p_j, since the trapezoid rule would be inexact otherwise. The
/// potentials are those of make_potential, relative to the polygons' origins. Moments are about the
/// polygons' centroids and positions are relative to the centroid of a. Throws std::runtime_error
/// if inexact constructions fail.
PairResult overlap_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                          const Potential& potential_b, Arithmetic arithmetic = Arithmetic::exact);

/// Evaluates Eq. 8 on given overlap polygons, without the energy. Their coordinates are relative to
/// `origin`. If their list of edges is empty, both potentials are integrated along every edge; the
/// one that vanishes there then contributes round-off.
PairIntegral overlap_integral(const std::vector<OverlapPolygon>& overlap, const Vec2& origin,
                              const Polygon& a, const Potential& potential_a, const Polygon& b,
                              const Potential& potential_b);

}  // namespace apothem
