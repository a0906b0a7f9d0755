// What a touching pair of rigid bodies does to its bodies: the force, and how stiff the contact
// holds them, as formulas for numbers and for packs of them.
#pragma once

#include <array>

#include "lib/contact/law/pair_vector.hpp"
#include "lib/contact/law/patch_laws.hpp"
#include "lib/contact/law/stiffness.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// What contacts do to a rigid body: the force, N, its moment about the mass centre, N m, how they
/// resist its displacement, and what of the force and the moment friction and damping do.
struct BodyLoad {
  double x = 0, y = 0, moment = 0;
  BodyStiffness held;
  std::array<double, 3> beside = {};

  void add(const BodyLoad& other) {
    x += other.x;
    y += other.y;
    moment += other.moment;
    held.add(other.held, 1);
    for (size_t k = 0; k < 3; ++k) beside[k] += other.beside[k];
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

  /// Adds to `springs`, how friction springs hold a body, how the contact does.
  APOTHEM_INLINE void hold(const PatchStep<Real>& p, BodyStiffnessOf<Real>& a,
                           BodyStiffnessOf<Real>& b) const {
    const Real zero(0.), one(1.);
    const Real stiffness = p.normal_stiffness * p.slopes;  // as Contact::stiffness
    // Of the pushes of the edges: 1 if all have one direction.
    const Real share = p.size / p.weight;
    const Real aligned = select(share < one, share, one);
    const Real aside = square_root(one - aligned * aligned);
    const Real across = aside * aside * stiffness;
    // Flanks give way along the force: each edge resists by the cosine of its angle to it. Where
    // the pushes of the edges cancel, the force has no direction that says anything.
    const Real along = select(aligned > aside, aligned, aside) * stiffness;
    const Truth<Real> pushes = p.size > zero;
    const VectorOf<Real> normal{select(pushes, p.normal.x, zero), select(pushes, p.normal.y, zero)};
    const VectorOf<Real> tangent = normal.turned();
    // Where the resultant acts says little: boundary that is hardly inside is as stiff as any
    // other.
    const VectorOf<Real> at = middle * tangent;
    const Real spread = along * breadth * breadth / Real(12.);
    const auto body = [&](BodyStiffnessOf<Real>& springs, const VectorOf<Real>& point,
                          const VectorOf<Real>& centre) APOTHEM_LAMBDA {
      BodyStiffnessOf<Real> sum;
      sum.add(along, normal.x, normal.y, point.cross(normal));
      sum.add(across, tangent.x, tangent.y, centre.cross(tangent));
      sum.tt = sum.tt + spread;
      springs.add(sum, one);
    };
    body(a, at, p.centre);
    body(b, at + p.between, p.centre + p.between);
  }
};

}  // namespace apothem
