// Upper bounds of the stiffness of contacts, for the stable time step.
//
// Velocity Verlet is stable below 2/sqrt(lambda). A contact of two bodies has the stiffness K <=
// k_n (l_a/r_b + l_b/r_a), where l is the length of a body's own boundary inside the other body
// (docs/theory.md, Normal contact), spread over a strip across the line of action. On a body with
// inverse masses 1/m, 1/I the strip of breadth w at the lever arm e has
//   lambda/K = largest eigenvalue of [1/m, e/sqrt(m I); ., (e^2 + w^2/12)/I].
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/execution/pack.hpp"

namespace apothem {

/// lambda/K of one body, 1/kg, as explained above. `inverse_mass` holds 1/m, 1/m and 1/I; `arm` and
/// `breadth` are in m.
inline double strip_mobility(const std::array<double, 3>& inverse_mass, double arm,
                             double breadth) {
  const double translation = std::max(inverse_mass[0], inverse_mass[1]);
  const double spread = breadth * breadth / 12 * inverse_mass[2];
  const double mean = (translation + arm * arm * inverse_mass[2] + spread) / 2;
  return mean + std::sqrt(std::max(mean * mean - translation * spread, 0.0));
}

/// The stiffness of the contacts of a rigid body for its displacement (x, y) and rotation, N/m, N
/// and N m.
template <class Real>
struct BodyStiffnessOf {
  Real xx = Real(0.), xy = Real(0.), yy = Real(0.), xt = Real(0.), yt = Real(0.), tt = Real(0.);

  /// Adds a spring of the stiffness `k` (N/m) along the unit vector (nx, ny) with the lever arm
  /// `arm` (m).
  APOTHEM_INLINE void add(const Real& k, const Real& nx, const Real& ny, const Real& arm) {
    const Real x = k * nx, y = k * ny;
    xx = xx + x * nx;
    xy = xy + x * ny;
    yy = yy + y * ny;
    xt = xt + x * arm;
    yt = yt + y * arm;
    tt = tt + k * arm * arm;
  }
  APOTHEM_INLINE void add(const BodyStiffnessOf& other, const Real& times) {
    xx = xx + times * other.xx;
    xy = xy + times * other.xy;
    yy = yy + times * other.yy;
    xt = xt + times * other.xt;
    yt = yt + times * other.yt;
    tt = tt + times * other.tt;
  }
};

using BodyStiffness = BodyStiffnessOf<double>;

/// The largest eigenvalue of the stiffness over the inertia, 1/s^2, for the inverse masses 1/m,
/// 1/m, 1/I.
double rate_of(const BodyStiffness& stiffness, const std::array<double, 3>& inverse_mass);
/// An upper bound of `rate_of` that is faster to compute.
double rate_bound_of(const BodyStiffness& stiffness, const std::array<double, 3>& inverse_mass);

/// Upper bound of the squared frequency w^2, 1/s^2, of a boundary node of the mass `mass` (kg) and
/// the tributary length `tributary_length` (m; half of the edges at it) that touches potentials
/// whose slopes 1/r_c and 1/r_t have the sum `slopes`, 1/m (docs/theory.md, Step). `stiffness` is
/// k_n times the thickness, N/m. With a mass of 1 the result is a stiffness in N/m.
inline double node_rate(double stiffness, double slopes, double tributary_length, double mass = 1) {
  return 2 * stiffness * slopes * tributary_length / mass;
}

}  // namespace apothem
