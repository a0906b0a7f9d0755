// Positions and velocities of all bodies, and the forces on them: views of the vectors of the
// state, which contact reads and adds to.
#pragma once

#include <span>
#include <stdexcept>

#include "lib/mesh/indices.hpp"

namespace apothem {

struct Kinematics {
  std::span<const double> pose;           ///< x, y (m), angle (rad) of each rigid body
  std::span<const double> displacement;   ///< x, y of each node, m
  std::span<const double> pose_rate;      ///< m/s, m/s, rad/s of each rigid body
  std::span<const double> node_velocity;  ///< x, y of each node, m/s
  /// True if the rates are differences of positions, so that bodies may have turned by finite
  /// angles.
  bool finite = false;
  /// The part of pose_rate that is slip without rotation of a body; empty if there is none.
  std::span<const double> slip = {};
  /// True while an equilibrium is sought, so that no dashpot acts.
  bool still = false;
  /// True if the state has been loaded from a checkpoint. Springs then keep their stored forces,
  /// even where dashpots, which depend on velocities within the step, had raised their limits.
  bool restored = false;
};

struct ForceViews {
  std::span<double> rigid;  ///< N, N and the moment about the mass centre, N m, of each rigid body
  std::span<double> nodes;  ///< x, y of each node, N
  /// For each rigid body: upper bound of the squared frequency w^2 of its contact stiffness, 1/s^2,
  /// see stiffness.hpp.
  std::span<double> lambda;
  double lambda_limit = 0;  ///< lambda need not be sharp below this value, 1/s^2
  /// The part of `rigid` due to friction and damping; empty if it is not needed.
  std::span<double> beside = {};
};

/// Thrown if a vertex of a body has a coordinate that is not finite.
class NotFinite : public std::domain_error {
 public:
  explicit NotFinite(BodyIndex body)
      : std::domain_error("a vertex of a body is not at a finite place"), body_(body) {}
  [[nodiscard]] BodyIndex body() const { return body_; }

 private:
  BodyIndex body_;
};

}  // namespace apothem
