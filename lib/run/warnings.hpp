// What a user should know about a run that went to its end: its results may not be worth what they
// seem. Such warnings are printed at the end of a run and stand in run.json.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/dynamics/results.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// One whole sentence for each reason to doubt; each names the remedy.
std::vector<std::string> warnings_of(const Model& model, const Extremes& extremes,
                                     std::span<const LoadStep> steps = {});

/// Names the rules that wait for rest in vain, because bodies fall that nothing is below; empty if
/// there are none.
std::string rules_in_vain(const Model& model, const std::vector<StopRule>& rules,
                          const State& state);

/// The sentence with the key of the scene that makes steps shorter in place of "the time step",
/// where it says to reduce that.
std::string with_key_of_step(std::string sentence, const TimeSettings& time);

}  // namespace apothem
