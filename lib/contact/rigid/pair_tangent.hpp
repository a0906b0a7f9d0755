// The tangent stiffness of the contact of two rigid bodies: the force of a patch, normal and
// friction, with its derivatives (geometry/integrals/pair_derivative.hpp).
#pragma once

#include "geometry/integrals/pair_derivative.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/law/pair_vector.hpp"
#include "lib/contact/surface/surfaces.hpp"
#include "lib/solver/tangent.hpp"

namespace apothem {

/// The friction of a patch in the state that is tried.
struct TriedFriction {
  Spring now;
  /// The spring before the trial; null in pairs with several patches, where it is not known.
  const Spring* before;
  bool begins;          ///< true if the pair had no patch before
  PairRate rate;        ///< displacements over dt
  double dt;            ///< s
  bool sticks = false;  ///< see Tangent::friction_sticks
};

/// The force of a patch on bodies a and b with its derivatives, N and N m. `friction` is null
/// without it. `thickness` is in m.
PairVectorOf<Moving> patch_force(const Surfaces& surfaces, double thickness, const PairLaw& law,
                                 RigidIndex a, RigidIndex b, const MovingIntegral& patch,
                                 const TriedFriction* friction);

/// Adds minus the derivatives of the force between two rigid bodies; body i has the coordinates 3 i
/// to 3 i + 2.
void add_pair_tangent(RigidIndex a, RigidIndex b, const PairVectorOf<Moving>& force,
                      Tangent& tangent);

}  // namespace apothem
