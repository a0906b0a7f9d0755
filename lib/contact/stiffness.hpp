// Bounds of the stiffness of contacts, for the stable time step.
//
// Velocity Verlet is stable below 2/sqrt(lambda). A contact of two bodies has the stiffness
// K <= k_n (l_a/r_b + l_b/r_a), l the own boundary inside the other body (docs/theory.md, Normal
// contact), spread over a strip across the line of action. On a body with inverse masses 1/m, 1/I
// the strip of breadth w at the lever arm e has
//   lambda/K = largest eigenvalue of [1/m, e/sqrt(m I); ., (e^2 + w^2/12)/I].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace apothem {

/// lambda/K of one body, 1/kg: see above. `inverse_mass`: 1/m, 1/m, 1/I; arm and breadth in m.
inline double strip_mobility(const std::array<double, 3>& inverse_mass, double arm,
                             double breadth) {
  const double translation = std::max(inverse_mass[0], inverse_mass[1]);
  const double spread = breadth * breadth / 12 * inverse_mass[2];
  const double mean = (translation + arm * arm * inverse_mass[2] + spread) / 2;
  return mean + std::sqrt(std::max(mean * mean - translation * spread, 0.0));
}

/// A bound of lambda of one body, 1/s^2, with the normal stiffness `normal` at the lever arm `arm`
/// over the breadth and tangential springs of the stiffness `tangential`, N/m, at most at the arm
/// `tangential_arm`. The two act across each other: on the place of the body only the larger one
/// counts.
inline double contact_rate(const std::array<double, 3>& inverse_mass, double normal, double arm,
                           double breadth, double tangential, double tangential_arm) {
  const double inverse = std::max(inverse_mass[0], inverse_mass[1]);
  const double moment = normal * arm, tangential_moment = tangential * tangential_arm;
  const double translation = std::max(normal, tangential) * inverse;
  const double rotation =
      (moment * arm + normal * breadth * breadth / 12 + tangential_moment * tangential_arm) *
      inverse_mass[2];
  const double coupling =
      (moment * moment + tangential_moment * tangential_moment) * inverse * inverse_mass[2];
  const double half = (translation - rotation) / 2;
  return (translation + rotation) / 2 + std::sqrt(half * half + coupling);
}

/// Bound of w^2, 1/s^2, for a boundary node of the mass `mass` (kg) with half of the edges at it as
/// `share` (m) that touches potentials of the slopes 1/r_c and 1/r_t, 1/m (docs/theory.md, Step).
/// `stiffness`: k_n times the thickness, N/m. With a mass of 1 it is a stiffness in N/m.
inline double node_rate(double stiffness, double slopes, double share, double mass = 1) {
  return 2 * stiffness * slopes * share / mass;
}

}  // namespace apothem
