// The load of a touching pair of rigid bodies on its bodies: the force and the stiffness of the
// contact, as formulas for numbers and for packs of numbers.
#pragma once

#include <array>

#include "lib/contact/law/pair_vector.hpp"
#include "lib/contact/law/patch_laws.hpp"
#include "lib/contact/law/stiffness.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// The load of contacts on a rigid body: the force, N, its moment about the mass centre, N m, the
/// stiffness of the contacts, and the parts of force and moment due to friction and damping.
struct BodyLoad {
  double x = 0, y = 0, moment = 0;
  BodyStiffness stiffness;
  std::array<double, 3> beside = {};

  void add(const BodyLoad& other) {
    x += other.x;
    y += other.y;
    moment += other.moment;
    stiffness.add(other.stiffness, 1);
    for (size_t k = 0; k < 3; ++k) beside[k] += other.beside[k];
  }
};

/// The loads of a pair, including friction and damping.
struct PairLoad {
  BodyLoad on_a, on_b;
  double normal;  ///< magnitude of the normal force, N
  RigidIndex a, b;
};

/// The stiffness of a contact, represented by a strip across its line of action.
template <class Real>
struct ContactStrip {
  Real breadth, middle;  // extent across the force and its middle, see PairIntegral

  /// Adds the stiffness of the contact to the stiffnesses of both bodies.
  APOTHEM_INLINE void add_stiffness(const PatchStep<Real>& p, BodyStiffnessOf<Real>& a,
                                    BodyStiffnessOf<Real>& b) const {
    const Real zero(0.), one(1.);
    const Real stiffness = p.normal_stiffness * p.slopes;  // see Contact::stiffness
    // The resultant over the sum of the magnitudes of the edges' forces: 1 if all have the same
    // direction.
    const Real alignment = p.size / p.weight;
    const Real aligned = select(alignment < one, alignment, one);
    const Real aside = square_root(one - aligned * aligned);
    const Real across = aside * aside * stiffness;
    // Each edge contributes with the cosine of its angle to the force, so that flanks contribute
    // less. Where the forces of the edges cancel, the direction of the resultant has no meaning.
    const Real along = select(aligned > aside, aligned, aside) * stiffness;
    const Truth<Real> pushes = p.size > zero;
    const VectorOf<Real> normal{select(pushes, p.normal.x, zero), select(pushes, p.normal.y, zero)};
    const VectorOf<Real> tangent = normal.turned();
    // The strip is centred at the middle of the extent and not at the loading point: boundary that
    // is hardly inside is as stiff as any other.
    const VectorOf<Real> middle_point = middle * tangent;
    const Real spread = along * breadth * breadth / Real(12.);
    const auto body = [&](BodyStiffnessOf<Real>& springs, const VectorOf<Real>& point,
                          const VectorOf<Real>& centre) APOTHEM_LAMBDA {
      BodyStiffnessOf<Real> sum;
      sum.add(along, normal.x, normal.y, point.cross(normal));
      sum.add(across, tangent.x, tangent.y, centre.cross(tangent));
      sum.tt = sum.tt + spread;
      springs.add(sum, one);
    };
    body(a, middle_point, p.centre);
    body(b, middle_point + p.between, p.centre + p.between);
  }
};

}  // namespace apothem
