// Viscous damping and friction of a contact patch of two rigid bodies in a step, as formulas for
// numbers and for packs of them: a patch has the same bits either way (docs/theory.md, Friction).
#pragma once

#include <array>

#include "geometry/integrals/edge_integral.hpp"
#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/contact/law/pair_vector.hpp"
#include "lib/contact/law/stiffness.hpp"

namespace apothem {

/// What the damping of a patch remembers.
template <class Real>
struct DamperOf {
  PairVectorOf<Real> elastic;  ///< the normal force
  PairVectorOf<Real> damping;  ///< along the normal, its own force
  Real tangential = Real(0.);  ///< and that beside the friction spring, along the tangent, N
  Real stiffness = Real(0.);   ///< bound of the normal stiffness, N/m

  void fields(Archive& archive) {
    archive("elastic", elastic)("damping", damping)("tangential", tangential)("stiffness",
                                                                              stiffness);
  }
};

/// A patch and its bodies in a step.
template <class Real>
struct PatchStep {
  // The integrals of the patch for unit stiffness, see PairIntegral.
  VectorOf<Real> force;
  Real moment_a, moment_b, weight;
  VectorOf<Real> centre;
  Real slopes;  // the lengths of both boundaries in it, each times the slope of the other potential
  Real force_error;  // round-off of the force, m
  // The bodies: the mass centre of a minus that of b, m, and inverse masses, 1/kg and 1/(kg m^2).
  VectorOf<Real> between;
  std::array<Real, 3> inverse_mass_a, inverse_mass_b;
  PairVectorOf<Real> rate;         // in the half step now
  PairVectorOf<Real> rate_before;  // in the one before
  Truth<Real> touched;             // the bodies touched in the step before
  Truth<Real> begins;              // the pair had no patch in the step before
  // The law. Stiffnesses are times the thickness, N/m.
  Real normal_stiffness, tangential_stiffness, coefficient, normal_ratio, tangential_ratio;
  Real spring;                         // the force of the friction spring before, N
  PairVectorOf<Real> friction_before;  // what it did to the bodies

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
  /// Time constant 2 ratio/omega of a dashpot beside a spring of the stiffness `k` (N/m) along the
  /// unit vector n through the point, s; 0 where nothing can move.
  [[nodiscard]] APOTHEM_INLINE Real damping_time(const Real& ratio, const Real& k,
                                                 const VectorOf<Real>& n) const {
    const auto mobility = [&](const std::array<Real, 3>& w, const VectorOf<Real>& arm)
        __attribute__((always_inline)) {
      const Real lever = arm.cross(n);
      return w[0] * n.x * n.x + w[1] * n.y * n.y + w[2] * lever * lever;
    };
    const Real omega2 =
        k * (mobility(inverse_mass_a, point) + mobility(inverse_mass_b, point + between));
    return select(omega2 > Real(0.), Real(2.) * ratio / square_root(omega2), Real(0.));
  }
};

/// beta times the rate of the resultant and its moments at the end of a step of dt (s), beta = 2
/// ratio/omega with the contact's present stiffness and the two bodies' mobility, and never so much
/// that the contact would pull. With dt = 0 it keeps its force.
template <class Real>
APOTHEM_INLINE void damp(const PatchStep<Real>& p, double dt, DamperOf<Real>& damper) {
  const Real& k = p.normal_stiffness;
  const PairVectorOf<Real> elastic =
      k * PairVectorOf<Real>{p.force.x, p.force.y, p.moment_a, p.moment_b};
  PairVectorOf<Real> rise = elastic - damper.elastic;
  // The moments before were in balance where the bodies were then. What is left over where they are
  // now goes half and half to both, so that the damping keeps the angular momentum.
  const Real rest = p.between.cross(rise.plane()) + (rise.a + rise.b);
  rise.a = rise.a - rest / Real(2.);
  rise.b = rise.b - rest / Real(2.);
  // The pair may touch already with another patch, or have touched in the run before.
  const Truth<Real> is_new = (damper.elastic.x == Real(0.)) & (damper.elastic.y == Real(0.));
  const VectorOf<Real> before = (damper.elastic + damper.damping).plane();
  const Real stiffness = k * p.slopes;
  const Real stiffness_before = damper.stiffness;
  damper.elastic = elastic;
  damper.stiffness = stiffness;
  // A first look, perhaps with the memory of another run: as springs do, it keeps its force.
  if (!(dt > 0)) return;
  const Real size = k * p.size, step(dt);
  const Real time = p.damping_time(p.normal_ratio, stiffness, p.normal);
  // A patch that is new has risen from nothing since its bodies have met, not in the whole step.
  const Real approach = -p.slip(p.rate).dot(p.normal);
  const Truth<Real> met = is_new & (approach * step * stiffness > size);
  const Real since = select(met, size / (stiffness * approach), step);
  // The force has risen with the mean stiffness of the step; at its end the stiffness is another.
  const Truth<Real> known = stiffness_before > Real(0.);
  const Real grown =
      select(is_new, Real(1.),
             select(known, Real(2.) * stiffness / (stiffness + stiffness_before), Real(1.)));
  PairVectorOf<Real> damping = time * grown / since * rise;
  // This is the rate half a step ago. Until now the bodies have been accelerated as before, and by
  // the change of this force, with the damping itself. `gained`: half a step of the acceleration
  // before, m/s.
  const Real gained =
      select(p.touched, -p.slip(p.rate - p.rate_before).dot(p.normal) / Real(2.), Real(0.));
  const Real half = p.normal_ratio * Real(2.) * p.normal_ratio / time * step;  // of its own rate
  const Real early = damping.plane().dot(p.normal);
  const Real now = (early + time * stiffness * gained - half * (size - before.dot(p.normal))) /
                   (Real(1.) + half);
  damping = damping + p.force_at_point((now - early) * p.normal);
  // Damping takes the whole force and no more.
  damping = select(-now > size, size / -now, Real(1.)) * damping;
  damper.damping = damping.where(p.has_direction & (time > Real(0.)));
}

/// The part of a step after which a patch that is new has closed: its mean depth over the
/// approach.
template <class Real>
APOTHEM_INLINE Real closed_share(const PatchStep<Real>& p, double dt) {
  const Real approach = -p.slip(p.rate).dot(p.normal) * Real(dt);
  const Real depth = p.size / p.slopes;
  return select(p.begins & (approach > depth), depth / approach, Real(1.));
}

/// What acts in a patch beside the normal force.
template <class Real>
struct PatchForces {
  PairVectorOf<Real> all, damping;          ///< everything; the damping of it
  Real spring = Real(0.), lost = Real(0.);  ///< force of the friction spring, N; what it loses, J
  VectorOf<Real> tangent;                   ///< along which it acts; zero without a direction
  BodyStiffnessOf<Real> held_a, held_b;     ///< how the spring holds the bodies
};

/// The paper's law (Eqs. 10-14): one spring per patch, at right angles to its normal force. As a
/// number along the tangent it turns with the contact by itself (Eq. 13). Friction on a opposes a's
/// slip against b: the sign of Eq. 12 is a misprint. It slips in the part `share` of the step dt
/// (s). If `damped`, the dashpot beside the spring acts up to Coulomb's limit.
template <class Real>
APOTHEM_INLINE void rub(const PatchStep<Real>& p, bool damped, double dt, const Real& share,
                        DamperOf<Real>& damper, PatchForces<Real>& forces) {
  const VectorOf<Real> tangent = p.normal.turned();
  const VectorOf<Real> velocity = p.slip(p.rate);
  const Real along = velocity.dot(tangent);
  // The tangent is only as exact as the force: what it makes of an approach is no slip.
  const Real seen = along * p.size;
  const Truth<Real> noise = seen * seen <= velocity.dot(velocity) * (p.force_error * p.force_error);
  const Real slip = select(noise, Real(0.), along);
  const CoulombSpring<Real> spring{
      p.tangential_stiffness,
      p.coefficient * (p.normal_stiffness * p.force + damper.damping.plane()).size()};
  const Real& k = spring.stiffness;
  // The point at which it acts moves: in the first half of the step it is still where it was.
  const Real power_before = p.friction_before.power(p.rate);
  const Real slip_before = select(p.spring * p.spring > Real(0.), power_before / p.spring, slip);
  const Real next = spring.after(p.spring, Real(.5) * (slip + slip_before) * (share * Real(dt)));
  forces.spring = select(p.has_direction, next, Real(0.));
  // What it loses is what it takes from the bodies and does not store.
  forces.lost = -Real(dt / 2) * (power_before + forces.spring * along) -
                (forces.spring * forces.spring - p.spring * p.spring) / (Real(2.) * k);
  forces.tangent = {select(p.has_direction, tangent.x, Real(0.)),
                    select(p.has_direction, tangent.y, Real(0.))};
  forces.all = forces.all + p.force_at_point(forces.spring * tangent).where(p.has_direction);
  const Real held = select(p.has_direction, k, Real(0.));
  forces.held_a.add(held, forces.tangent.x, forces.tangent.y,
                    select(p.has_direction, p.point.cross(tangent), Real(0.)));
  forces.held_b.add(held, forces.tangent.x, forces.tangent.y,
                    select(p.has_direction, (p.point + p.between).cross(tangent), Real(0.)));
  if (!damped) return;
  // A first look, perhaps with the memory of another run, keeps the force of the dashpot.
  if (dt > 0) {
    const Real time = p.damping_time(p.tangential_ratio, k, tangent);
    damper.tangential = spring.dashpot(forces.spring, time, slip);
  }
  damper.tangential =
      select(p.has_direction & (p.tangential_ratio > Real(0.)), damper.tangential, Real(0.));
  const PairVectorOf<Real> beside =
      p.force_at_point(damper.tangential * tangent).where(p.has_direction);
  forces.all = forces.all + beside;
  forces.damping = forces.damping + beside;
}

/// A step of dt (s) of a patch with friction or damping or both, whose direction has been found.
/// `forces` are zero before.
template <class Real>
APOTHEM_INLINE void step_patch(const PatchStep<Real>& p, bool rough, bool damped, double dt,
                               DamperOf<Real>& damper, PatchForces<Real>& forces) {
  if (damped) {
    damp(p, dt, damper);
    forces.all = forces.damping = damper.damping;
  } else {
    damper = {};
  }
  if (rough) rub(p, damped, dt, closed_share(p, dt), damper, forces);
}

/// The damping of a pair at the end of a step.
template <class Real>
struct PairDampingOf {
  PairVectorOf<Real> damping{};  ///< the force of all its patches
  PairVectorOf<Real> rate{};     ///< of the bodies in the last half step

  void fields(Archive& archive) { archive("damping", damping)("rate", rate); }
};

}  // namespace apothem
