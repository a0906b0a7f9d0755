// The material as an element sees it: elastic stress and, where there is damping, stress
// proportional to the strain rate (Rayleigh's beta). The rate is that of Green's strain over the
// way that the nodes have gone with their velocities, so that a rigid rotation is not damped,
// however far it has turned within a step.
#pragma once

#include "lib/fem/material.hpp"

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
  double lag;        ///< velocities are those of a time this much before the displacements, s

  Response(const Law& elastic, const Elastic& e, double stiffness_damping, double slice,
           double behind = 0)
      : law(elastic), hooke(e), beta(stiffness_damping), thickness(slice), lag(behind) {}

  /// First Piola-Kirchhoff stress, Pa, at the displacement gradient h. `rate`, 1/s, is the rate of
  /// h; it is read only if there is damping.
  template <class N>
  APOTHEM_INLINE Tensor<N> stress(const Tensor<N>& h, const Tensor<N>& rate) const {
    if constexpr (!damped) return law.stress(h);
    return law.stress(h) + N(beta) * first_piola(h, hooke(strain_rate(h, rate)));
  }
  /// Power that damping dissipates per reference volume, W/m^3.
  template <class N>
  APOTHEM_INLINE N damping_power(const Tensor<N>& h, const Tensor<N>& rate) const {
    const Symmetric<N> e = strain_rate(h, rate);
    return N(beta) * product(hooke(e), e);
  }
  /// The value, `lag` ago, of a vector or tensor that is `now` and changes with the given rate.
  template <template <class> class T, class N>
  APOTHEM_INLINE T<N> before(const T<N>& now, const T<N>& rate) const {
    return now + N(-lag) * rate;
  }

 private:
  // From -2 lag to 0 Green's strain changes by 2 lag times this, without any error.
  template <class N>
  APOTHEM_INLINE Symmetric<N> strain_rate(const Tensor<N>& h, const Tensor<N>& rate) const {
    return green_strain_rate(before(h, rate), rate);
  }
};

}  // namespace apothem
