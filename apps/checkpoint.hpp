// checkpoint.json: where a run stopped, so that it continues bit for bit as if it never had.
#pragma once

#include <string>
#include <vector>

#include "apothem/dynamics/simulation.hpp"
#include "apothem/output/history.hpp"

namespace apothem {

struct Checkpoint {
  std::string scene_hash;
  Snapshot snapshot;
  HistoryWriter::Sizes history_sizes{};
  std::vector<double> frame_times;
  std::int64_t next_row = 1, next_frame = 1;
  std::vector<LoadStep> load_steps;  ///< of static runs
};

/// Throws SystemFailure; an older checkpoint is then intact.
void write_checkpoint(const std::string& folder, const Checkpoint& checkpoint);

/// Throws SceneError if there is none, if it is damaged, if it belongs to another scene (whose
/// arrays have other sizes than `like`) or if the histories it continues are not there any more.
Checkpoint read_checkpoint(const std::string& folder, const std::string& scene_hash,
                           const Snapshot& like);

void remove_checkpoint(const std::string& folder);

}  // namespace apothem
