// Friction of a contact patch of two rigid bodies in a step, as formulas for numbers and for packs
// of them: a patch has the same bits either way (docs/theory.md, Friction).
#pragma once

#include <array>

#include "geometry/integrals/edge_integral.hpp"
#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/contact/law/pair_vector.hpp"
#include "lib/contact/law/stiffness.hpp"

namespace apothem {

/// A patch and its bodies in a step.
template <class Real>
struct PatchStep {
  // The integrals of the patch for unit stiffness, see PairIntegral.
  VectorOf<Real> force;
  Real moment_a, moment_b, weight;
  VectorOf<Real> centre;
  Real slopes;  // the lengths of both boundaries in it, each times the slope of the other potential
  // How the size of the force grows with the depth. The boundary of each body in the other one has
  // the breadth of the patch across the force, which says how it slopes, and so how its potential
  // rises along the force. Exact for flats and apexes on each other.
  Real growth;
  Real force_error;         // round-off of the force, m
  VectorOf<Real> between;   // the mass centre of a minus that of b, m
  PairVectorOf<Real> rate;  // of the bodies, in the half step now
  Truth<Real> begins;       // the pair had no patch in the step before
  // The law. Stiffnesses are times the thickness, N/m.
  Real normal_stiffness, coefficient;
  Real stiffness_ratio;  // of the friction spring over the contact, or 0 where it has
  Real constant;         // a stiffness of its own
  // The friction spring before: force, N, stiffness, N/m, and what it did to the bodies; and what
  // the dashpot across it added to the normal force, N.
  Real spring, stiffness_before, push;
  PairVectorOf<Real> friction_before;

  // What follows from it.
  Real size;                  // of the force for unit stiffness, m
  Truth<Real> has_direction;  // the force has a direction worth following
  VectorOf<Real> normal;      // this direction
  VectorOf<Real> point;       // where it acts, relative to the mass centre of a, m

  APOTHEM_INLINE void find_direction() {
    size = force.size();
    has_direction = size > Real(kNoResultant) * weight;
    normal = {force.x / size, force.y / size};
    // The same as loading_point().
    const Real off = (centre.cross(force) - moment_a) / size;
    const Truth<Real> acts = size > Real(kNoLineOfAction) * weight;
    point = {select(acts, centre.x - normal.y * off, centre.x),
             select(acts, centre.y + normal.x * off, centre.y)};
  }
  /// Velocity of a's material against b's at the point, m/s.
  [[nodiscard]] APOTHEM_INLINE VectorOf<Real> slip(const PairVectorOf<Real>& r) const {
    const VectorOf<Real> q = point + between;
    return {r.x - r.a * point.y + r.b * q.y, r.y + r.a * point.x - r.b * q.x};
  }
  [[nodiscard]] APOTHEM_INLINE PairVectorOf<Real> force_at_point(const VectorOf<Real>& f) const {
    return {f.x, f.y, point.cross(f), -(point + between).cross(f)};
  }
  /// How the normal force grows with the depth, N/m.
  [[nodiscard]] APOTHEM_INLINE Real stiffness() const { return normal_stiffness * growth; }
  [[nodiscard]] APOTHEM_INLINE Real tangential_stiffness() const {
    return select(stiffness_ratio > Real(0.), stiffness_ratio * stiffness(), constant);
  }
};

/// The part of a step after which a patch that is new has closed: its mean depth over the
/// approach.
template <class Real>
APOTHEM_INLINE Real closed_share(const PatchStep<Real>& p, double dt) {
  const Real approach = -p.slip(p.rate).dot(p.normal) * Real(dt);
  const Real depth = p.size / p.growth;
  return select(p.begins & (approach > depth), depth / approach, Real(1.));
}

/// What friction does in a patch.
template <class Real>
struct PatchFriction {
  PairVectorOf<Real> force;                 ///< on the bodies
  Real spring = Real(0.), lost = Real(0.);  ///< force of the spring, N; what it loses, J
  Real stiffness = Real(0.);                ///< of the spring, N/m
  VectorOf<Real> tangent;                   ///< along which it acts; zero without a direction
  BodyStiffnessOf<Real> held_a, held_b;     ///< how the spring holds the bodies
};

/// One spring per patch, at right angles to its normal force (Eqs. 10-14). As a number along the
/// tangent it turns with the contact by itself (Eq. 13). Friction on a opposes a's slip against b:
/// the sign of Eq. 12 is a misprint. Its stiffness goes with that of the contact: where it falls,
/// the force falls with it. Its direction has been found; it follows a step of dt (s).
template <class Real>
APOTHEM_INLINE void rub(const PatchStep<Real>& p, double dt, PatchFriction<Real>& friction) {
  const VectorOf<Real> tangent = p.normal.turned();
  const VectorOf<Real> velocity = p.slip(p.rate);
  const Real along = velocity.dot(tangent);
  // The tangent is only as exact as the force: what it makes of an approach is no slip.
  const Real seen = along * p.size;
  const Truth<Real> noise = seen * seen <= velocity.dot(velocity) * (p.force_error * p.force_error);
  const Real slip = select(noise, Real(0.), along);
  const Real normal = p.normal_stiffness * p.size + p.push;
  const CoulombSpring<Real> spring{select(p.has_direction, p.tangential_stiffness(), Real(0.)),
                                   friction_limit(p.coefficient, normal)};
  const Real& k = spring.stiffness;
  // The point at which it acts moves: in the first half of the step it is still where it was.
  const Real power_before = p.friction_before.power(p.rate);
  const Real slip_before = select(p.spring * p.spring > Real(0.), power_before / p.spring, slip);
  const Real kept = select(k < p.stiffness_before, k / p.stiffness_before, Real(1.)) * p.spring;
  const Real share = closed_share(p, dt) * Real(dt);
  const Real next = spring.after(kept, Real(.5) * (slip + slip_before) * share);
  friction.spring = select(p.has_direction, next, Real(0.));
  friction.stiffness = k;
  // What it loses is what it takes from the bodies and does not store.
  friction.lost = -Real(dt / 2) * (power_before + friction.spring * along) -
                  spring_energy(friction.spring, k) + spring_energy(p.spring, p.stiffness_before);
  friction.tangent = {select(p.has_direction, tangent.x, Real(0.)),
                      select(p.has_direction, tangent.y, Real(0.))};
  friction.force = p.force_at_point(friction.spring * tangent).where(p.has_direction);
  friction.held_a.add(k, friction.tangent.x, friction.tangent.y,
                      select(p.has_direction, p.point.cross(tangent), Real(0.)));
  friction.held_b.add(k, friction.tangent.x, friction.tangent.y,
                      select(p.has_direction, (p.point + p.between).cross(tangent), Real(0.)));
}

}  // namespace apothem
