// The law of friction and its spring, as formulas for numbers and for packs of numbers (the paper,
// Eqs. 12 and 14).
#pragma once

#include <cmath>

#include "lib/contact/law/law.hpp"
#include "lib/execution/pack.hpp"

namespace apothem {

/// The largest friction force: Coulomb's law (the paper, Eq. 14). It serves every kind of surface,
/// and the dashpot beside the spring. Another friction law is written here, with its parameters.
template <class Real>
struct FrictionLimit {
  Real coefficient = Real(0.);

  /// Calls f(parameter, value) for each parameter, where value(law) is that of a pair of bodies.
  template <class F>
  APOTHEM_INLINE void each_parameter(const F& f) {
    f(coefficient, [](const PairLaw& law) APOTHEM_LAMBDA { return law.friction.coefficient; });
  }
  [[nodiscard]] static FrictionLimit of(const PairLaw& law) {
    FrictionLimit limit;
    limit.each_parameter([&](Real& parameter, const auto& value) { parameter = Real(value(law)); });
    return limit;
  }
  /// A limit that no spring reaches.
  [[nodiscard]] static FrictionLimit infinite() { return {Real(1e30)}; }

  /// The largest force, N, for the normal force `pressed`, N, while the sides slip with the rate
  /// given last, m/s, on which Coulomb's law does not depend.
  [[nodiscard]] APOTHEM_INLINE Real operator()(const Real& pressed, const Real& /*slip*/) const {
    return coefficient * select(pressed > Real(0.), pressed, Real(0.));
  }
};

/// A spring along the tangent of a contact whose force never exceeds Coulomb's limit.
template <class Real>
struct CoulombSpring {
  Real stiffness;  ///< N/m
  Real limit;      ///< N

  [[nodiscard]] APOTHEM_INLINE Real within(const Real& force) const {
    return select(force < -limit, -limit, select(limit < force, limit, force));
  }
  /// The trial force, N, after a slip in m from the force `force`, without Coulomb's limit.
  [[nodiscard]] APOTHEM_INLINE Real trial(const Real& force, const Real& slip) const {
    return force - stiffness * slip;
  }
  /// The force after the slip, N, within Coulomb's limit.
  [[nodiscard]] APOTHEM_INLINE Real after(const Real& force, const Real& slip) const {
    return within(trial(force, slip));
  }
};

/// Whether a spring slides, up to round-off of its limit: its force is then a function of the
/// normal force, and not of the slip.
inline bool is_sliding(double force, double limit) {
  constexpr double kAtLimit = 1 - 1e-12;
  return std::abs(force) >= kAtLimit * limit;
}

/// The energy of a spring, J, from its force (N) and stiffness (N/m); 0 if the stiffness is 0.
template <class Real>
APOTHEM_INLINE Real spring_energy(const Real& force, const Real& stiffness) {
  return select(stiffness > Real(0.), force * force / (Real(2.) * stiffness), Real(0.));
}

}  // namespace apothem
