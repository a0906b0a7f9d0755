// The spring of friction and the dashpot beside it, as formulas for numbers and for packs of them
// (the paper, Eqs. 12 and 14).
#pragma once

#include "lib/execution/pack.hpp"

namespace apothem {

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
  /// What a dashpot of the time constant `time` (s) adds to the force of the spring at a slip rate
  /// in m/s: together they stay within the limit. N.
  [[nodiscard]] APOTHEM_INLINE Real dashpot(const Real& force, const Real& time,
                                            const Real& rate) const {
    return within(force - time * stiffness * rate) - force;
  }
};

}  // namespace apothem
