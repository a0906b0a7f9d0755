// The triangle with constant strain, which also shows the interface of all element structs.
#pragma once

#include <span>

#include "geometry/polygon/point.hpp"
#include "lib/fem/response.hpp"

namespace apothem {

/// The three-node triangle.
///
/// Interface of all element structs. A kernel works on one element, or on kLanes of them if the
/// number type N is Pack. `d` are the numbers that prepare() has stored, `u` and `v` the
/// displacements (m) and velocities (m/s) of the corners, `material` a Response.
struct Tri3 {
  /// Number of corners; 0 if any number is allowed.
  static constexpr int kCorners = 3;
  /// Number of values that prepare() stores for an element with that many corners.
  static int stored(int) { return 5; }

  /// Stores the edge vectors A and B from the first corner (m) and 1/det (1/m^2). `x` are the
  /// corners, counter-clockwise, in m. Number k goes to out[k * kLanes].
  static void prepare(std::span<const Vec2> x, const Elastic&, double, double* out) {
    const Vec2 a = x[1] - x[0], b = x[2] - x[0];
    const double values[] = {a.x(), a.y(), b.x(), b.y(), 1 / cross(a, b)};
    for (int k = 0; k < 5; ++k) out[k * kLanes] = values[k];
  }

  /// Displacement gradient.
  template <class N>
  static APOTHEM_INLINE Tensor<N> gradient(const Stored<N>& d, const Point<N>* u) {
    const N w = d[4];
    return outer(u[1] - u[0], Point<N>{w * d[3], -w * d[2]}) +
           outer(u[2] - u[0], Point<N>{-w * d[1], w * d[0]});
  }

  /// Writes the internal forces on the corners, N, into `f`, and adds the power that damping
  /// dissipates, W, to `power`.
  template <class R, class N>
  static APOTHEM_INLINE void force(const Stored<N>& d, const R& material, int, const Point<N>* u,
                                   const Point<N>* v, Point<N>* f, N& power) {
    Tensor<N> rate{};
    if constexpr (R::kDamped) rate = gradient(d, v);
    const Tensor<N> h = gradient(d, u);
    const Tensor<N> p = material.stress(h, rate);
    const N half(0.5 * material.thickness);
    if constexpr (R::kDamped) power += half / d[4] * material.damping_power(h, rate);
    f[1] = half * (p * Point<N>{d[3], -d[2]});
    f[2] = half * (p * Point<N>{-d[1], d[0]});
    f[0] = Point<N>{-f[1].x - f[2].x, -f[1].y - f[2].y};
  }

  /// Strain energy, J.
  template <class R, class N>
  static APOTHEM_INLINE N energy(const Stored<N>& d, const R& material, int, const Point<N>* u) {
    return N(0.5 * material.thickness) / d[4] * material.law.energy(gradient(d, u));
  }

  /// Mean displacement gradient over the element.
  template <class N>
  static Tensor<N> mean_gradient(const Stored<N>& d, int, const Point<N>* u) {
    return gradient(d, u);
  }
};

}  // namespace apothem
