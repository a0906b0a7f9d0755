// Friction of a contact patch of two rigid bodies in a step, as formulas for numbers and for packs
// of numbers. A patch gets the same bits either way (docs/theory.md, Friction).
#pragma once

#include <array>

#include "geometry/integrals/edge_integral.hpp"
#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/contact/law/pair_vector.hpp"
#include "lib/contact/law/stiffness.hpp"

namespace apothem {

/// The derivative of the force of a patch by the depth, for unit stiffness. The boundary of each
/// body inside the other one has the extent `breadth` of the patch across the force; the ratio of
/// its length to this extent says how it is inclined, and so how its potential, of the given slope,
/// rises along the force. This is exact for flat faces and for corners against each other.
template <class Real>
APOTHEM_INLINE Real growth_of(const Real& breadth, const Real& length_a, const Real& slope_a,
                              const Real& length_b, const Real& slope_b) {
  const auto rise = [&](const Real& slope, const Real& length) APOTHEM_LAMBDA -> Real {
    return slope * select(length > breadth, Real(breadth / length), Real(1.));
  };
  return breadth * (rise(slope_a, length_a) + rise(slope_b, length_b));
}

/// A patch and its bodies in a step.
template <class Real>
struct PatchStep {
  // The integrals of the patch for unit stiffness, see PairIntegral.
  VectorOf<Real> force;
  Real moment_a, moment_b, weight;
  VectorOf<Real> centre;
  Real slopes;  // length of each boundary in the patch times the slope of the other potential,
                // summed
  // The derivative of the force by the depth, see growth_of.
  Real growth;
  Real force_error;         // round-off error of the force, m
  VectorOf<Real> between;   // the mass centre of a minus that of b, m
  PairVectorOf<Real> rate;  // velocities of the bodies, half a step before the end of the step
  Truth<Real> begins;       // true if the pair had no patch in the step before
  // The contact law. Stiffnesses are multiplied by the thickness, N/m.
  Real normal_stiffness;
  FrictionLimit<Real> limit;
  Real stiffness_ratio;  // stiffness of the friction spring over that of the contact, or 0
  Real constant;         // stiffness of the friction spring if the ratio is 0
  // The friction spring in the step before: its force, N, its stiffness, N/m, the normal force of
  // the dashpot, N, and the friction on the bodies.
  Real spring, stiffness_before, push;
  PairVectorOf<Real> friction_before;

  // Values that find_direction computes.
  Real size;                  // magnitude of the force for unit stiffness, m
  Truth<Real> has_direction;  // true if the force has a meaningful direction
  VectorOf<Real> normal;      // the direction of the force
  VectorOf<Real> point;       // the loading point relative to the mass centre of a, m

  APOTHEM_INLINE void find_direction() {
    size = force.size();
    has_direction = size > Real(kNoResultant) * weight;
    normal = {force.x / size, force.y / size};
    // The formulas are those of loading_point().
    const Real off = (centre.cross(force) - moment_a) / size;
    const Truth<Real> acts = size > Real(kNoLineOfAction) * weight;
    point = {select(acts, centre.x - normal.y * off, centre.x),
             select(acts, centre.y + normal.x * off, centre.y)};
  }
  /// Velocity of the material of a relative to that of b at the loading point, m/s.
  [[nodiscard]] APOTHEM_INLINE VectorOf<Real> slip(const PairVectorOf<Real>& r) const {
    const VectorOf<Real> q = point + between;
    return {r.x - r.a * point.y + r.b * q.y, r.y + r.a * point.x - r.b * q.x};
  }
  [[nodiscard]] APOTHEM_INLINE PairVectorOf<Real> force_at_point(const VectorOf<Real>& f) const {
    return {f.x, f.y, point.cross(f), -(point + between).cross(f)};
  }
  /// The derivative of the normal force by the depth, N/m.
  [[nodiscard]] APOTHEM_INLINE Real stiffness() const { return normal_stiffness * growth; }
  [[nodiscard]] APOTHEM_INLINE Real tangential_stiffness() const {
    return select(stiffness_ratio > Real(0.), stiffness_ratio * stiffness(), constant);
  }
};

/// The fraction of a step for which a new patch has been closed: its mean depth over the approach
/// in the step.
template <class Real>
APOTHEM_INLINE Real closed_fraction(const PatchStep<Real>& p, double dt) {
  const Real approach = -p.slip(p.rate).dot(p.normal) * Real(dt);
  const Real depth = p.size / p.growth;
  return select(p.begins & (approach > depth), depth / approach, Real(1.));
}

/// The friction of a patch.
template <class Real>
struct PatchFriction {
  PairVectorOf<Real> force;                 ///< force on the bodies
  Real spring = Real(0.), lost = Real(0.);  ///< force of the spring, N; energy that it loses, J
  Real stiffness = Real(0.);                ///< of the spring, N/m
  VectorOf<Real> tangent;  ///< direction of the force; zero if the normal force has no direction
  BodyStiffnessOf<Real> body_stiffness_a, body_stiffness_b;  ///< of the spring for each body
};

/// Updates the friction spring of a patch, which acts at right angles to the normal force (Eqs.
/// 10-14), for a step of dt (s). As a signed number along the tangent it rotates with the contact
/// (Eq. 13). Friction on a opposes the slip of a against b: the sign of Eq. 12 is a misprint. The
/// stiffness follows that of the contact; where it falls, the force falls with it. find_direction
/// must have been called.
template <class Real>
APOTHEM_INLINE void rub(const PatchStep<Real>& p, double dt, PatchFriction<Real>& friction) {
  const VectorOf<Real> tangent = p.normal.turned();
  const VectorOf<Real> velocity = p.slip(p.rate);
  const Real along = velocity.dot(tangent);
  // The tangent is only as accurate as the direction of the force, so a small tangential part of an
  // approach velocity is not slip.
  const Real seen = along * p.size;
  const Truth<Real> noise = seen * seen < velocity.dot(velocity) * (p.force_error * p.force_error);
  const Real slip = select(noise, Real(0.), along);
  const Real normal = p.normal_stiffness * p.size + p.push;
  const CoulombSpring<Real> spring{select(p.has_direction, p.tangential_stiffness(), Real(0.)),
                                   p.limit(normal, slip)};
  const Real& k = spring.stiffness;
  // The loading point moves. In the first half of the step the old friction force still acts at the
  // old point.
  const Real power_before = p.friction_before.power(p.rate);
  const Real slip_before = select(p.spring * p.spring > Real(0.), power_before / p.spring, slip);
  const Real kept = select(k < p.stiffness_before, k / p.stiffness_before, Real(1.)) * p.spring;
  const Real duration = closed_fraction(p, dt) * Real(dt);
  const Real next = spring.after(kept, Real(.5) * (slip + slip_before) * duration);
  friction.spring = select(p.has_direction, next, Real(0.));
  friction.stiffness = k;
  // The spring loses the energy that it takes from the bodies and does not store.
  friction.lost = -Real(dt / 2) * (power_before + friction.spring * along) -
                  spring_energy(friction.spring, k) + spring_energy(p.spring, p.stiffness_before);
  friction.tangent = {select(p.has_direction, tangent.x, Real(0.)),
                      select(p.has_direction, tangent.y, Real(0.))};
  friction.force = p.force_at_point(friction.spring * tangent).where(p.has_direction);
  friction.body_stiffness_a.add(k, friction.tangent.x, friction.tangent.y,
                                select(p.has_direction, p.point.cross(tangent), Real(0.)));
  friction.body_stiffness_b.add(
      k, friction.tangent.x, friction.tangent.y,
      select(p.has_direction, (p.point + p.between).cross(tangent), Real(0.)));
}

}  // namespace apothem
