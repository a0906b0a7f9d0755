// Private header: what `apothem check` estimates, and its plan as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/run/cost.hpp"
#include "lib/run/run.hpp"

namespace apothem {

/// What is not known from the scene alone.
struct PlanEstimates {
  std::optional<Trial> trial;  ///< of scenes that are not static
  bool damped = false;         ///< something but friction ends a motion
  bool dissipates = false;     ///< the same, or friction
  bool empty_history = false;  ///< nothing is tracked, and there are no regions
  std::vector<std::string> warnings;
};
PlanEstimates estimates_of(const Scene& scene);

/// What the scheme "auto" will probably do; empty with other schemes.
struct Phases {
  bool from_start = false;  ///< implicit steps from the first one on: nothing moves noticeably
  double until = 0;         ///< velocity Verlet at least until then, s
  std::string text;         ///< the same in words
};
Phases phases_of(const Scene& scene, const Simulation& simulation, bool dissipates);

/// Of the whole run by its trial, on one thread, s.
double run_seconds(const Scene& scene, const Simulation& simulation, const Trial& trial);

/// One object: what the table of `apothem check` says, in full.
std::string plan_json(const Scene& scene, const Simulation& simulation,
                      const PlanEstimates& estimates, const OutputCost& cost);

}  // namespace apothem
