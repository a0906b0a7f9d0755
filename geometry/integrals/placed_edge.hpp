// An edge of a polygon in the frame of another one. This header is private to the integrals.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/integrals/placed_potential.hpp"

namespace apothem::edge_detail {

// An edge of x in the frame of y: its start (px, py), the same relative to y's reference point
// (qx, qy), and the vector (ex, ey) to its end.
template <class Real>
struct BasicEdge {
  BasicEdge(const PlacedPotential& x, const PlacedPotential& y, int e, double dx, double dy)
      : px(Real(x.x[e]) + dx),
        py(Real(x.y[e]) + dy),
        qx(px - y.reference.x()),
        qy(py - y.reference.y()),
        ex(Real(x.x[x.end(e)]) - x.x[e]),
        ey(Real(x.y[x.end(e)]) - x.y[e]) {
    shorten(y);
  }
  Real px, py, qx, qy, ex, ey;
  Real first = 0, last = 1;  // the part of the whole edge that is represented
  bool shortened = false;    // whether it is less than the whole edge

  /// Position on the whole edge, from 0 to 1, of the parameter s of the represented part.
  [[nodiscard]] Real fraction(Real s) const { return first + s * (last - first); }

 private:
  // Reduces an edge that is much longer than y to the part around the foot of the perpendicular
  // from y's reference point. On a floor of a kilometre, a parameter that runs over the whole edge
  // could not resolve the few millimetres that lie inside y.
  void shorten(const PlacedPotential& y) {
    constexpr double kLong = 8;
    const Real length2 = ex * ex + ey * ey;
    if (!(length2 > kLong * kLong * y.radius * y.radius) || y.radius == 0) return;
    const Real length = std::sqrt(length2);
    const Real tx = ex / length;
    const Real ty = ey / length;
    const Real foot = -(tx * qx + ty * qy);  // foot, from the start of the edge
    const Real height = tx * qy - ty * qx;   // from the line to the reference point
    const Real from = foot - 2 * y.radius;
    const Real until = foot + 2 * y.radius;
    if (until <= 0 || from >= length) return;
    const Real end_x = until >= length ? qx + ex : -ty * height + 2 * y.radius * tx;
    const Real end_y = until >= length ? qy + ey : tx * height + 2 * y.radius * ty;
    if (from > 0) {
      qx = -ty * height - 2 * y.radius * tx;
      qy = tx * height - 2 * y.radius * ty;
    }
    px = qx + y.reference.x();
    py = qy + y.reference.y();
    ex = end_x - qx;
    ey = end_y - qy;
    first = std::max(Real(0), from / length);
    last = std::min(Real(1), until / length);
    shortened = true;
  }
};
using PlacedEdge = BasicEdge<double>;

}  // namespace apothem::edge_detail
