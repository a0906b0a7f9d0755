// The friction spring of an edge in a step, as formulas for numbers and for numbers that carry
// derivatives. This header is private to outline_friction.
#pragma once

#include <algorithm>
#include <cmath>

#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/contact/mesh/common_normals.hpp"

namespace apothem {

struct OutlineSpringStep {
  const PairLaw& law;
  double dt;     ///< s
  bool limited;  ///< if false, springs keep forces above their limits
};

/// The fraction of a long step for which a new contact was closed; motion before that is no slip.
/// `width` (m) and `depth` (m^2) are the sums of the lengths of its pieces, and of their depths
/// along these.
template <class Real>
Real closed_fraction(const SpringContactOf<Real>& contact, const Real& width, const Real& depth,
                     double dt) {
  const Real approach =
      -(contact.nx * contact.rate_x + contact.ny * contact.rate_y) / contact.normal * Real(dt);
  const Real mean = depth / width;
  return approach > mean ? mean / approach : Real(1.);
}

/// Finds the force of the spring, which follows the part `fraction` of the slip of the step.
template <class Real>
void follow_slip(const OutlineSpringStep& step, const Real& fraction,
                 SpringContactOf<Real>& contact) {
  const Real pressed = contact.pressed + Real(contact.push_before);
  const Real rate = contact.slip();
  const CoulombSpring<Real> spring{
      contact.stiffness,
      step.limited ? FrictionLimit<Real>::of(step.law)(pressed, rate) : Real(HUGE_VAL)};
  contact.followed = contact.stiffness * fraction;
  contact.friction = spring.after(contact.carried, rate * fraction * Real(step.dt));
}

}  // namespace apothem
