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

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// lambda/K of one body, 1/kg: see above. `inverse_mass`: 1/m, 1/m, 1/I; arm and breadth in m.
inline double strip_mobility(const std::array<double, 3>& inverse_mass, double arm,
                             double breadth) {
  const double translation = std::max(inverse_mass[0], inverse_mass[1]);
  const double spread = breadth * breadth / 12 * inverse_mass[2];
  const double mean = (translation + arm * arm * inverse_mass[2] + spread) / 2;
  return mean + std::sqrt(std::max(mean * mean - translation * spread, 0.0));
}

/// How the contacts of a rigid body resist its displacement (x, y) and rotation, N/m, N and N m.
class BodyStiffness {
 public:
  /// A spring of the stiffness `k` (N/m) along a unit vector that has the lever `arm` (m).
  void add(double k, const Vec2& direction, double arm) {
    const double x = k * direction.x(), y = k * direction.y();
    xx_ += x * direction.x();
    xy_ += x * direction.y();
    yy_ += y * direction.y();
    xt_ += x * arm;
    yt_ += y * arm;
    tt_ += k * arm * arm;
  }
  /// Against rotation alone, N m.
  void add_rotation(double k) { tt_ += k; }
  void add(const BodyStiffness& other, double times) {
    xx_ += times * other.xx_;
    xy_ += times * other.xy_;
    yy_ += times * other.yy_;
    xt_ += times * other.xt_;
    yt_ += times * other.yt_;
    tt_ += times * other.tt_;
  }
  /// The largest eigenvalue of stiffness by inertia, 1/s^2, with the inverse masses 1/m, 1/m, 1/I.
  [[nodiscard]] double rate(const std::array<double, 3>& inverse_mass) const;
  /// Not less than `rate`, and faster.
  [[nodiscard]] double rate_bound(const std::array<double, 3>& inverse_mass) const;

 private:
  double xx_ = 0, xy_ = 0, yy_ = 0, xt_ = 0, yt_ = 0, tt_ = 0;
};

/// How stiff the contact of a pair, or a part of it, holds its two bodies.
struct PairStiffness {
  BodyStiffness a = {}, b = {};
};

/// Bound of w^2, 1/s^2, for a boundary node of the mass `mass` (kg) with half of the edges at it as
/// `share` (m) that touches potentials of the slopes 1/r_c and 1/r_t, 1/m (docs/theory.md, Step).
/// `stiffness`: k_n times the thickness, N/m. With a mass of 1 it is a stiffness in N/m.
inline double node_rate(double stiffness, double slopes, double share, double mass = 1) {
  return 2 * stiffness * slopes * share / mass;
}

}  // namespace apothem
