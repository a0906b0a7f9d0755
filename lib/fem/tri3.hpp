// The triangle with constant strain.
#pragma once

#include <span>

#include "fem/response.hpp"
#include "geometry/point.hpp"

namespace apothem {

struct Tri3 {
  static constexpr int kCorners = 3;
  static int stored(int) { return 5; }

  /// Edge vectors A, B from the first corner, 1/det.
  static void prepare(std::span<const Vec2> x, const Elastic&, double, double* out) {
    const Vec2 a = x[1] - x[0], b = x[2] - x[0];
    const double values[] = {a.x(), a.y(), b.x(), b.y(), 1 / cross(a, b)};
    for (int k = 0; k < 5; ++k) out[k * kLanes] = values[k];
  }

  template <class N>
  static APOTHEM_INLINE Tensor<N> gradient(const Stored<N>& d, const Point<N>* u) {
    const N w = d[4];
    return outer(u[1] - u[0], Point<N>{w * d[3], -w * d[2]}) +
           outer(u[2] - u[0], Point<N>{-w * d[1], w * d[0]});
  }

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

  template <class R, class N>
  static APOTHEM_INLINE N energy(const Stored<N>& d, const R& material, int, const Point<N>* u) {
    return N(0.5 * material.thickness) / d[4] * material.law.energy(gradient(d, u));
  }

  /// Mean displacement gradient.
  template <class N>
  static Tensor<N> mean_gradient(const Stored<N>& d, int, const Point<N>* u) {
    return gradient(d, u);
  }
};

}  // namespace apothem
