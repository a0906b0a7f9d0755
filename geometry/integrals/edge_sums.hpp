// The integrals of phi along edges. This header is private to the integrals.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/polygon/segment_moments.hpp"

namespace apothem::edge_detail {

// The integrals of phi of y along the edges of x, in the frame of y, without the sign of Eq. 7.
// Positions and moments are relative to y's reference point.
struct Half {
  double fx = 0, fy = 0;              // SUM n INT phi ds, m
  double moment = 0;                  // SUM INT phi (x cross n) ds, m^2
  double weight = 0, wx = 0, wy = 0;  // SUM INT phi ds, m, and SUM INT phi x ds, m^2
  double length = 0;                  // length of the edges of x inside y, m
  double largest = 0;                 // largest phi along the edges
  std::uint64_t inside = 0;           // vertices of x inside y: see PairIntegral

  // Counts vertex i as inside.
  void enter(int i) { inside ^= std::uint64_t{1} << (i % 64); }
  void add(const Half& other) {
    fx += other.fx, fy += other.fy;
    moment += other.moment;
    weight += other.weight, wx += other.wx, wy += other.wy;
    length += other.length;
    largest = std::max(largest, other.largest);
  }
};

// Adds the integrals along one edge. `m` has the moments of phi over the parameter of the edge, and
// `inside` is the share of the edge that lies inside the other polygon.
template <class Edge>
inline void accumulate(const Edge& edge, const SegmentMoments<double>& m, double inside,
                       Half& half) {
  const double qx = edge.qx, qy = edge.qy, ex = edge.ex, ey = edge.ey;
  const double length = std::sqrt(ex * ex + ey * ey);
  half.fx += ey * m.sum;
  half.fy -= ex * m.sum;
  half.moment -= (qx * ex + qy * ey) * m.sum + (ex * ex + ey * ey) * m.first;
  half.weight += length * m.sum;
  half.wx += length * (qx * m.sum + ex * m.first);
  half.wy += length * (qy * m.sum + ey * m.first);
  half.length += length * inside;
  half.largest = std::max(half.largest, m.largest);
}

}  // namespace apothem::edge_detail
