// Viscous damping of a contact patch of two rigid bodies (docs/theory.md, Friction).
#pragma once

#include <array>
#include <span>

#include "apothem/archive/archive.hpp"
#include "apothem/contact/kinematics.hpp"
#include "apothem/contact/surfaces.hpp"
#include "apothem/geometry/integrals/edge_integral.hpp"

namespace apothem {

/// A normal force that is so much smaller than the pressures it is the sum of has no direction
/// worth following.
inline constexpr double kNoResultant = 1e-9;

/// Direction in which friction acts: (-n_y, n_x), n the direction of the normal force; zero if
/// there is no normal force.
inline Vec2 tangent_of(const Vec2& normal_force) {
  const double size = normal_force.norm();
  return size > 0 ? Vec2(Vec2(-normal_force.y(), normal_force.x()) / size) : Vec2(Vec2::Zero());
}

/// How the two rigid bodies of a pair move.
struct PairRate {
  Vec2 velocity = Vec2::Zero();   ///< of the mass centre of a against that of b, m/s
  double spin_a = 0, spin_b = 0;  ///< rad/s

  PairRate operator-(const PairRate& other) const {
    return {velocity - other.velocity, spin_a - other.spin_a, spin_b - other.spin_b};
  }
  void fields(Archive& archive) {
    archive("velocity", velocity)("spin_a", spin_a)("spin_b", spin_b);
  }
};

/// A force on the first body of a pair, with its moments about the two mass centres.
struct PairForce {
  Vec2 force = Vec2::Zero();          ///< N
  double moment_a = 0, moment_b = 0;  ///< N m

  [[nodiscard]] double power(const PairRate& rate) const {  ///< W
    return force.dot(rate.velocity) + moment_a * rate.spin_a + moment_b * rate.spin_b;
  }
  PairForce& operator+=(const PairForce& other) {
    force += other.force;
    moment_a += other.moment_a;
    moment_b += other.moment_b;
    return *this;
  }
  friend PairForce operator*(double factor, const PairForce& f) {
    return {factor * f.force, factor * f.moment_a, factor * f.moment_b};
  }
  /// Adds it to the forces on all rigid bodies: x, y and the moment of each.
  void add_to(RigidIndex a, RigidIndex b, std::span<double> rigid) const {
    double* fa = &rigid[3 * static_cast<size_t>(a)];
    double* fb = &rigid[3 * static_cast<size_t>(b)];
    fa[0] += force.x();
    fa[1] += force.y();
    fa[2] += moment_a;
    fb[0] -= force.x();
    fb[1] -= force.y();
    fb[2] += moment_b;
  }
  void fields(Archive& archive) {
    archive("force", force)("moment_a", moment_a)("moment_b", moment_b);
  }
};

/// How the two rigid bodies of a pair move, and where they are.
struct PairMotion {
  PairMotion(const Surfaces& surfaces, const Kinematics& now, RigidIndex a, RigidIndex b)
      : between(surfaces.between(a, b)) {
    const double* va = &now.pose_rate[3 * static_cast<size_t>(a)];
    const double* vb = &now.pose_rate[3 * static_cast<size_t>(b)];
    rate = {{va[0] - vb[0], va[1] - vb[1]}, va[2], vb[2]};
  }
  PairRate rate;
  Vec2 between;  ///< mass centre of a minus that of b, m

  /// Velocity of a's material against b's at a point relative to a's mass centre, m/s.
  [[nodiscard]] Vec2 slip(const Vec2& point) const {
    return rate.velocity + cross(rate.spin_a, point) - cross(rate.spin_b, point + between);
  }
};

/// What the damping of a patch remembers.
struct PatchDamper {
  PairForce elastic;      ///< the normal force
  PairForce damping;      ///< along the normal, its own force
  double tangential = 0;  ///< and that beside the friction spring, along the tangent, N

  /// Adds a share of another one.
  void add(double share, const PatchDamper& other) {
    elastic += share * other.elastic;
    damping += share * other.damping;
    tangential += share * other.tangential;
  }
  void fields(Archive& archive) {
    archive("elastic", elastic)("damping", damping)("tangential", tangential);
  }
};

/// Time constant 2 ratio/omega of a dashpot beside a spring of the stiffness `k` (N/m) along the
/// unit vector n through a point relative to the mass centre of a, s; 0 where nothing can move.
double damping_time(double ratio, double k, const Surfaces& surfaces, RigidIndex a, RigidIndex b,
                    const Vec2& point, const Vec2& n, const PairMotion& motion);

/// beta times the rate of the resultant and its moments at the end of a step of dt (s), beta = 2
/// ratio/omega with the contact's present stiffness and the two bodies' mobility, and never so much
/// that the contact would pull. `rate_before`: of the bodies in the step before, if they touched.
/// With dt = 0 it keeps its force. `k`: normal stiffness times thickness, N/m.
void damp(double ratio, double k, const Surfaces& surfaces, RigidIndex a, RigidIndex b,
          const PairIntegral& patch, const PairMotion& motion, const PairRate* rate_before,
          double dt, PatchDamper& damper);

}  // namespace apothem
