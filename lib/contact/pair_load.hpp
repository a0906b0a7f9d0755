// What a touching pair of rigid bodies does to its bodies: the force, and how stiff the contact
// holds them, as formulas for numbers and for packs of them.
#pragma once

#include "apothem/contact/pair_vector.hpp"
#include "apothem/contact/patch_laws.hpp"
#include "apothem/contact/stiffness.hpp"
#include "apothem/mesh/indices.hpp"

namespace apothem {

/// What contacts do to a rigid body: the force, N, its moment about the mass centre, N m, and how
/// they resist its displacement.
struct BodyLoad {
  double x = 0, y = 0, moment = 0;
  BodyStiffness held;

  void add(const BodyLoad& other) {
    x += other.x;
    y += other.y;
    moment += other.moment;
    held.add(other.held, 1);
  }
};

/// The loads of a pair, with its friction and damping.
struct PairLoad {
  BodyLoad on_a, on_b;
  double normal;  ///< size of the normal force, N
  RigidIndex a, b;
};

/// A contact as a strip across its line of action, which holds the bodies of a pair.
template <class Real>
struct ContactStrip {
  Real breadth, middle;  // across the force: see PairIntegral

  /// Adds to `springs`, how friction springs hold a body, how the contact does. The displacements
  /// of both bodies add where both can move: K (x_a - x_b)^2 <= 2 K (x_a^2 + x_b^2).
  APOTHEM_INLINE void hold(const PatchStep<Real>& p, BodyStiffnessOf<Real>& a,
                           BodyStiffnessOf<Real>& b) const {
    const Real zero(0.), one(1.);
    const Real stiffness = p.normal_stiffness * p.slopes;  // as Contact::stiffness
    // Of the pushes of the edges: 1 if all have one direction.
    const Real share = p.size / p.weight;
    const Real aligned = select(share < one, share, one);
    const Real across = (one - aligned * aligned) * stiffness;
    const Truth<Real> pushes = p.size > zero;
    const VectorOf<Real> normal{select(pushes, p.normal.x, zero), select(pushes, p.normal.y, zero)};
    const VectorOf<Real> tangent = normal.turned();
    // Where the resultant acts says little: boundary that is hardly inside is as stiff as any
    // other.
    const VectorOf<Real> at = middle * tangent;
    const Real spread = stiffness * breadth * breadth / Real(12.);
    const auto moves = [&](const std::array<Real, 3>& w)
                           APOTHEM_LAMBDA { return w[0] + w[1] + w[2] > zero; };
    const Truth<Real> a_moves = moves(p.inverse_mass_a), b_moves = moves(p.inverse_mass_b);
    const Real times = select(a_moves & b_moves, Real(2.), one);
    const auto body = [&](BodyStiffnessOf<Real>& springs, const VectorOf<Real>& point,
                          const VectorOf<Real>& centre) APOTHEM_LAMBDA {
      BodyStiffnessOf<Real> sum;
      sum.add(stiffness, normal.x, normal.y, point.cross(normal));
      sum.add(across, tangent.x, tangent.y, centre.cross(tangent));
      sum.tt = sum.tt + spread;
      sum.add(springs, one);
      springs = {};
      springs.add(sum, times);
    };
    body(a, at, p.centre);
    body(b, at + p.between, p.centre + p.between);
  }
};

}  // namespace apothem
