// Where a scene that starts settled begins: at rest under its loads, contacts pressed and friction
// springs loaded. Bodies that are given a velocity slide in equilibrium: their friction is at its
// limit against that velocity, and only what it leaves free (the other directions, and the
// rotation) comes to rest. Rigid bodies only.
#pragma once

#include <functional>
#include <span>

#include "lib/dynamics/degrees_of_freedom.hpp"
#include "lib/model/model.hpp"

namespace apothem {

struct SettledStart {
  const Model& model;
  const DegreesOfFreedom& dofs;
  State& state;                       ///< is brought to rest; keeps the velocities that are given
  const std::vector<double>& lambda;  ///< of each body's contacts after a search for forces, 1/s^2
  double stability_limit;             ///< known before the run, s
};

/// `find_forces`: fills state.f and lambda; its arguments are the velocities that friction follows
/// over a time in s. Throws Unrunnable if a body does not come to rest, and Stopped if `stop`,
/// asked at each step, says so.
void settle(const SettledStart& start,
            const std::function<void(std::span<const double>, double)>& find_forces,
            const std::function<bool()>& stop = {});

}  // namespace apothem
