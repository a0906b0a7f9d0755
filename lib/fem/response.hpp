// What elements ask of their material: elastic stress, with stiffness-proportional damping if there
// is any. Rayleigh's beta acts on Green's strain rate, so that a rigid rotation is not damped.
#pragma once

#include "fem/material.hpp"

namespace apothem {

template <class Law, bool damped>
struct Response {
  static constexpr bool kDamped = damped;
  Law law;
  Hooke hooke;
  double beta;       ///< s
  double thickness;  ///< m

  Response(const Law& elastic, const Elastic& e, double stiffness_damping, double slice)
      : law(elastic), hooke(e), beta(stiffness_damping), thickness(slice) {}

  /// First Piola-Kirchhoff stress, Pa; `rate` is read where there is damping.
  template <class N>
  APOTHEM_INLINE Tensor<N> stress(const Tensor<N>& h, const Tensor<N>& rate) const {
    if constexpr (!damped) return law.stress(h);
    return law.stress(h) + N(beta) * first_piola(h, hooke(green_strain_rate(h, rate)));
  }
  /// Power that damping takes from a reference volume, W/m^3.
  template <class N>
  APOTHEM_INLINE N damping_power(const Tensor<N>& h, const Tensor<N>& rate) const {
    const Symmetric<N> e = green_strain_rate(h, rate);
    return N(beta) * product(hooke(e), e);
  }
};

}  // namespace apothem
