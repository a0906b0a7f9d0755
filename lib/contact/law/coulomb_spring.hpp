// The spring of friction, as formulas for numbers and for packs of them (the paper, Eqs. 12 and
// 14).
#pragma once

#include "lib/execution/pack.hpp"

namespace apothem {

/// What friction holds where so much presses, N: Coulomb's law (the paper, Eq. 14), for every
/// surface and for the dashpot beside the spring. Another law of friction begins here.
template <class Real>
APOTHEM_INLINE Real friction_limit(const Real& coefficient, const Real& pressed) {
  return coefficient * select(pressed > Real(0.), pressed, Real(0.));
}

/// A spring along the tangent of a contact, whose force is never beyond Coulomb's limit.
template <class Real>
struct CoulombSpring {
  Real stiffness;  ///< N/m
  Real limit;      ///< N

  [[nodiscard]] APOTHEM_INLINE Real within(const Real& force) const {
    return select(force < -limit, -limit, select(limit < force, limit, force));
  }
  /// The force, N, that was `force` before a slip in m, if nothing held it back.
  [[nodiscard]] APOTHEM_INLINE Real trial(const Real& force, const Real& slip) const {
    return force - stiffness * slip;
  }
  /// The force after it, N.
  [[nodiscard]] APOTHEM_INLINE Real after(const Real& force, const Real& slip) const {
    return within(trial(force, slip));
  }
};

/// What a spring stores, J, from its force (N) and stiffness (N/m); 0 without a stiffness.
template <class Real>
APOTHEM_INLINE Real spring_energy(const Real& force, const Real& stiffness) {
  return select(stiffness > Real(0.), force * force / (Real(2.) * stiffness), Real(0.));
}

}  // namespace apothem
