// Normal viscous damping of a contact patch of two rigid bodies (docs/theory.md, Friction).
#pragma once

#include <array>

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
struct PairMotion {
  PairMotion(const Surfaces& surfaces, const Kinematics& now, RigidIndex a, RigidIndex b)
      : between(surfaces.between(a, b)) {
    const double* va = &now.pose_rate[3 * static_cast<size_t>(a)];
    const double* vb = &now.pose_rate[3 * static_cast<size_t>(b)];
    velocity_a = {va[0], va[1]}, velocity_b = {vb[0], vb[1]};
    spin_a = va[2], spin_b = vb[2];
  }
  Vec2 velocity_a, velocity_b;  ///< of the mass centres, m/s
  double spin_a, spin_b;        ///< rad/s
  Vec2 between;                 ///< mass centre of a minus that of b, m

  /// Velocity of a's material against b's at a point relative to a's mass centre, m/s.
  [[nodiscard]] Vec2 slip(const Vec2& point) const {
    return velocity_a + cross(spin_a, point) - velocity_b - cross(spin_b, point + between);
  }
  /// Power of a force on a and its moments about the two mass centres, W.
  [[nodiscard]] double power(const Vec2& force, double moment_a, double moment_b) const {
    return force.dot(Vec2(velocity_a - velocity_b)) + moment_a * spin_a + moment_b * spin_b;
  }
};

/// What the damping of a patch remembers: its elastic force and its own, on the first body of the
/// pair, with the moments about the two mass centres.
struct PatchDamper {
  Vec2 normal = Vec2::Zero();           ///< N
  double moment_a = 0, moment_b = 0;    ///< N m
  Vec2 damping = Vec2::Zero();          ///< N
  double damping_a = 0, damping_b = 0;  ///< N m

  /// Adds a share of another one.
  void add(double share, const PatchDamper& other) {
    normal += share * other.normal;
    moment_a += share * other.moment_a;
    moment_b += share * other.moment_b;
    damping += share * other.damping;
    damping_a += share * other.damping_a;
    damping_b += share * other.damping_b;
  }
  void fields(Archive& archive) {
    archive("normal", normal)("moment_a", moment_a)("moment_b", moment_b)("damping", damping)(
        "damping_a", damping_a)("damping_b", damping_b);
  }
};

/// beta times the rate of the resultant and its moments, beta = 2 ratio/omega with the contact's
/// present stiffness and the two bodies' mobility, and never so much that the contact would pull.
/// With dt = 0 it keeps its force. `k`: normal stiffness times thickness, N/m. Returns the energy
/// that it takes from the bodies, J.
double damp(double ratio, double k, const Surfaces& surfaces, RigidIndex a, RigidIndex b,
            const PairIntegral& patch, const PairMotion& motion, double dt, PatchDamper& damper);

}  // namespace apothem
