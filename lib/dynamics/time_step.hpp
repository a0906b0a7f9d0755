// Stability limit of the explicit step for rigid bodies in contact.
//
// Velocity Verlet is stable below 2/sqrt(lambda). A contact of two bodies has the stiffness
// K <= k_n (l_a/r_b + l_b/r_a), l the own boundary inside the other body (theory: Sec. 2), spread
// over a strip across the line of action. On a body with inverse masses 1/m, 1/I the strip of
// breadth w at the lever arm e has
//   lambda/K = largest eigenvalue of [1/m, e/sqrt(m I); ., (e^2 + w^2/12)/I].
#pragma once

#include <array>
#include <string>

#include "apothem/contact/placed_shapes.hpp"
#include "apothem/model/model.hpp"

namespace apothem {

/// lambda/K of one body, see above; 1/kg. `inverse_mass` is RigidBody::inverse_mass().
double strip_mobility(const std::array<double, 3>& inverse_mass, double arm, double breadth);

/// A bound on the time step and what sets it.
struct StepLimit {
  double step;         ///< s, infinite if nothing limits it
  std::string reason;  ///< e.g. `contact of "falling" with "target"`
};

/// lambda / (k_n x sum of the slopes 1/r) of a body that lies flat on its worst edge, m/kg.
double flat_mobility(const RigidBody& body);

/// Limit known before the run: every pair that can meet lies flat on each other along its stiffest
/// edges. Vertex contacts are softer.
StepLimit contact_step_limit(const Model& model);

/// Fraction of the smallest inradius that a body may move in one step without risking to miss a
/// contact.
inline constexpr double kLargestStride = 0.25;

/// Limit so that no body moves farther than that in one step, at the speeds the scene starts with
/// or gains by falling through its own height.
StepLimit motion_step_limit(const Model& model);

}  // namespace apothem
