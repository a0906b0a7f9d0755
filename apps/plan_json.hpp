// Private header: the plan of a run as JSON, for `apothem check --json`.
#pragma once

#include <string>

#include "apothem/run/run.hpp"

namespace apothem {

/// One object: what the table of `apothem check` says, in full.
std::string plan_json(const Scene& scene, const Simulation& simulation);

}  // namespace apothem
