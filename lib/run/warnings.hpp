// What a user should know about a run that went to its end: its results may not be worth what they
// seem. Such warnings are printed at the end of a run and stand in run.json.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/dynamics/results.hpp"
#include "lib/model/model.hpp"

namespace apothem {

/// One whole sentence for each reason to doubt; each names the remedy.
std::vector<std::string> warnings_of(const Model& model, const Extremes& extremes,
                                     std::span<const LoadStep> steps = {});

}  // namespace apothem
