// What a run of a study has found, from its run.json.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lib/sweep/study.hpp"

namespace apothem {

/// A value that a run has measured: a number, yes or no, or nothing.
using MeasuredValue = std::variant<std::monostate, bool, double>;

/// A row of the table of runs.
struct RunRecord {
  RunState state = RunState::missing;
  std::string stopped_by;                ///< name of the criterion that has stopped it; or empty
  std::optional<double> time;            ///< reached, s
  std::optional<double> wall_time;       ///< of its last process, s
  std::optional<double> processor_time;  ///< of all threads of its last process, s
  std::string scene_hash, final_state_hash;
  std::string message;  ///< why it has failed
  /// The `measures` of run.json, then the values of the expectations by their quantity. A name that
  /// is taken gets its take after it, then a number.
  std::vector<std::pair<std::string, MeasuredValue>> measures;
};

/// The record of a run as it stands on disk. A run that is done without a run.json counts as
/// failed.
RunRecord read_record(const Study& study, const PlannedRun& run);

/// Fills in what the text of a run.json says. Throws std::runtime_error if it is not one.
void parse_record(const std::string& text, RunRecord& record);

}  // namespace apothem
