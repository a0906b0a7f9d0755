// checkpoint.json: where a run stopped, so that it continues bit for bit as if it never had.
#pragma once

#include <string>
#include <vector>

#include "apothem/dynamics/simulation.hpp"
#include "apothem/output/history.hpp"

namespace apothem {

/// What a run keeps besides its simulation.
struct Progress {
  std::vector<double> history_sizes = std::vector<double>(kHistoryFiles.size());  ///< bytes
  std::vector<double> frame_times;                                                ///< s
  std::int64_t next_row = 1, next_frame = 1;
  std::vector<LoadStep> load_steps;  ///< of static runs

  void fields(Archive& archive) {
    archive.sized("history_sizes", history_sizes);
    archive("frame_times", frame_times)("next_row", next_row)("next_frame", next_frame)(
        "load_steps", load_steps);
  }
};

/// Throws SystemFailure; an older checkpoint is then intact.
void write_checkpoint(const std::string& folder, const std::string& scene_hash,
                      Simulation& simulation, Progress& progress);

/// Loads a simulation and what belongs to it. Throws SceneError if there is no checkpoint, if it is
/// damaged or belongs to another scene, or if the histories it continues are not there any more.
void read_checkpoint(const std::string& folder, const std::string& scene_hash,
                     Simulation& simulation, Progress& progress);

void remove_checkpoint(const std::string& folder);

}  // namespace apothem
