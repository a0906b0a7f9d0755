// The integrals of phi along edges. This header is private to the integrals.
#pragma once

#include <algorithm>
#include <cstdint>

#include "geometry/polygon/segment_moments.hpp"
#include "lib/execution/pack.hpp"

namespace apothem::edge_detail {

// The integrals of phi of y along edges of x, in the frame of y, without the sign of Eq. 7.
// Positions and moments are relative to y's reference point.
template <class Real>
struct EdgeSums {
  Real fx = 0, fy = 0;              // SUM n INT phi ds, m
  Real moment = 0;                  // SUM INT phi (x cross n) ds, m^2
  Real weight = 0, wx = 0, wy = 0;  // SUM INT phi ds, m, and SUM INT phi x ds, m^2
  Real length = 0;                  // length of the edges of x inside y, m
  Real largest = 0;                 // largest phi along the edges
};

// An edge of x in the frame of y: its start relative to y's reference point, and the vector to its
// end.
template <class Real>
struct EdgeFrame {
  Real qx, qy, ex, ey;
  // As in BasicEdge, for an edge that is not shortened.
  [[nodiscard]] Real fraction(const Real& s) const { return s; }
};

// The integrals along one edge. `m` has the moments of phi over the parameter of the edge, and
// `inside` is the fraction of the edge that lies inside the other polygon.
template <class Edge, class Real>
APOTHEM_INLINE EdgeSums<Real> along_edge(const Edge& edge, const SegmentMoments<Real>& m,
                                         const Real& inside) {
  const Real &qx = edge.qx, &qy = edge.qy, &ex = edge.ex, &ey = edge.ey;
  const Real length2 = ex * ex + ey * ey, length = square_root(length2);
  const Real zero(0.);  // added so that no result is -0
  return {.fx = zero + ey * m.sum,
          .fy = zero - ex * m.sum,
          .moment = zero - ((qx * ex + qy * ey) * m.sum + length2 * m.first),
          .weight = zero + length * m.sum,
          .wx = zero + length * (qx * m.sum + ex * m.first),
          .wy = zero + length * (qy * m.sum + ey * m.first),
          .length = length * inside,
          .largest = m.largest};
}

// The sums over all edges of a polygon.
struct Half : EdgeSums<double> {
  std::uint64_t inside = 0;  // bits of the vertices of x inside y, see PairIntegral

  // Counts vertex i as inside.
  void enter(int i) { inside ^= std::uint64_t{1} << (i % 64); }
  void add(const EdgeSums<double>& other) {
    fx += other.fx, fy += other.fy;
    moment += other.moment;
    weight += other.weight, wx += other.wx, wy += other.wy;
    length += other.length;
    largest = std::max(largest, other.largest);
  }
};

// The sums of a pair or of one of its patches, as in PairIntegral.
template <class Real>
struct PairSums {
  Real fx, fy, moment_a, moment_b, weight, centre_x = 0, centre_y = 0;
};

// Combines the integrals along the edges of a and of b. (rx, ry) is a's reference point relative
// to b's.
template <class Real>
APOTHEM_INLINE PairSums<Real> combine_sums(const EdgeSums<Real>& of_a, const EdgeSums<Real>& of_b,
                                           const Real& rx, const Real& ry) {
  // Each moment is about the reference point of the polygon that owns phi. The arm moves it to the
  // reference point of the other polygon.
  PairSums<Real> pair{.fx = of_b.fx - of_a.fx,
                      .fy = of_b.fy - of_a.fy,
                      .moment_a = of_b.moment - (of_a.moment - (rx * of_a.fy - ry * of_a.fx)),
                      .moment_b = of_a.moment - (of_b.moment + (rx * of_b.fy - ry * of_b.fx)),
                      .weight = of_a.weight + of_b.weight};
  if (!(pair.weight == Real(0.))) {
    pair.centre_x = (of_b.wx + (of_a.wx - rx * of_a.weight)) / pair.weight;
    pair.centre_y = (of_b.wy + (of_a.wy - ry * of_a.weight)) / pair.weight;
  }
  return pair;
}

}  // namespace apothem::edge_detail
