// Where all bodies are and how they move, and where the forces on them go: views of the vectors of
// the state, which contact reads and adds to.
#pragma once

#include <span>

namespace apothem {

struct Kinematics {
  std::span<const double> pose;           ///< x, y (m), angle (rad) of each rigid body
  std::span<const double> displacement;   ///< x, y of each node, m
  std::span<const double> pose_rate;      ///< m/s, m/s, rad/s of each rigid body
  std::span<const double> node_velocity;  ///< x, y of each node, m/s
};

struct ForceViews {
  std::span<double> rigid;  ///< N, N and the moment about the mass centre, N m, of each rigid body
  std::span<double> nodes;  ///< x, y of each node, N
};

}  // namespace apothem
