// The material as an element sees it: elastic stress and, where there is damping, stress
// proportional to the strain rate (Rayleigh's beta). The rate is that of Green's strain, so that a
// rigid rotation is not damped.
#pragma once

#include "apothem/fem/material.hpp"

namespace apothem {

/// The law `Law`, with stiffness-proportional damping if `damped`.
template <class Law, bool damped>
struct Response {
  static constexpr bool kDamped = damped;
  /// Elastic law.
  Law law;
  /// Elasticity that beta multiplies.
  Hooke hooke;
  double beta;       ///< Rayleigh's coefficient of stiffness-proportional damping, s
  double thickness;  ///< m

  Response(const Law& elastic, const Elastic& e, double stiffness_damping, double slice)
      : law(elastic), hooke(e), beta(stiffness_damping), thickness(slice) {}

  /// First Piola-Kirchhoff stress, Pa, at the displacement gradient h. `rate`, 1/s, is the rate of
  /// h; it is read only if there is damping.
  template <class N>
  APOTHEM_INLINE Tensor<N> stress(const Tensor<N>& h, const Tensor<N>& rate) const {
    if constexpr (!damped) return law.stress(h);
    return law.stress(h) + N(beta) * first_piola(h, hooke(green_strain_rate(h, rate)));
  }
  /// Power that damping dissipates per reference volume, W/m^3.
  template <class N>
  APOTHEM_INLINE N damping_power(const Tensor<N>& h, const Tensor<N>& rate) const {
    const Symmetric<N> e = green_strain_rate(h, rate);
    return N(beta) * product(hooke(e), e);
  }
};

}  // namespace apothem
