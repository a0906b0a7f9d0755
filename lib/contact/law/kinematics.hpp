// Where all bodies are and how they move, and where the forces on them go: views of the vectors of
// the state, which contact reads and adds to.
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
  /// The rates are differences from earlier places: bodies may have turned by finite angles.
  bool finite = false;
  /// The part of pose_rate that is slip alone, by which no body has turned; empty if there is none.
  std::span<const double> slip = {};
  /// An equilibrium is sought: no dashpot acts.
  bool still = false;
  /// The state has been loaded. Springs have the forces that they had, also where dashpots, which
  /// go by velocities of within the step, had raised their limits.
  bool restored = false;
};

struct ForceViews {
  std::span<double> rigid;  ///< N, N and the moment about the mass centre, N m, of each rigid body
  std::span<double> nodes;  ///< x, y of each node, N
  /// Of each rigid body: bound of w^2 of what its contacts hold, 1/s^2: see stiffness.hpp.
  std::span<double> lambda;
  double lambda_limit = 0;  ///< up to it lambda need not be sharp, 1/s^2
  /// What of `rigid` friction and damping do; empty if nobody asks.
  std::span<double> beside = {};
};

/// A body has a vertex that is not at a finite place.
class NotFinite : public std::domain_error {
 public:
  explicit NotFinite(BodyIndex body)
      : std::domain_error("a vertex of a body is not at a finite place"), body_(body) {}
  [[nodiscard]] BodyIndex body() const { return body_; }

 private:
  BodyIndex body_;
};

}  // namespace apothem
