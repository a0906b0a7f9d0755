// The whole state of a run in a file: checkpoint.json says where a run was stopped, so that it
// continues bit for bit as if it never had; final.json is where it has ended, for runs that begin
// there.
#pragma once

#include <string>
#include <vector>

#include "apothem/dynamics/body_start.hpp"
#include "apothem/dynamics/simulation.hpp"
#include "apothem/output/history.hpp"
#include "apothem/run/stop_watch.hpp"
#include "apothem/scene/scene.hpp"

namespace apothem {

/// Where the bodies of a run have begun, if not where its scene puts them.
struct Beginning {
  std::string folder;             ///< of the other run; empty: the scene's places
  double time = 0;                ///< of the other run, s
  std::vector<BodyStart> bodies;  ///< the others begin as the scene says
  void fields(Archive& archive) { archive("folder", folder)("time", time)("bodies", bodies); }
};

/// What a run keeps besides its simulation.
struct RunProgress {
  std::vector<double> history_sizes = std::vector<double>(kHistoryFiles.size());  ///< bytes
  std::vector<double> frame_times;                                                ///< s
  std::int64_t next_row = 1, next_frame = 1;
  std::vector<LoadStep> load_steps;  ///< of static runs
  Beginning beginning;
  StopWatch* stop_watch = nullptr;  ///< of the run; null while there is none

  void fields(Archive& archive) {
    archive.sized("history_sizes", history_sizes);
    archive("frame_times", frame_times)("next_row", next_row)("next_frame", next_frame)(
        "load_steps", load_steps)("beginning", beginning);
    if (stop_watch) archive("stop_watch", *stop_watch);
  }
};

enum class StateFile { checkpoint, final };
std::string state_file(const std::string& folder, StateFile kind);

/// Throws SystemFailure; an older file is then intact.
void write_state(const std::string& folder, StateFile kind, const Scene& scene,
                 const std::string& scene_hash, Simulation& simulation, RunProgress& progress);

/// What the checkpoint in a folder says about the run, before there is a simulation. Throws
/// SceneError if there is no checkpoint, or if it is damaged.
RunProgress read_progress(const std::string& folder);
/// The settings of the run that has left the checkpoint. Throws as read_progress().
std::vector<Setting> settings_of_checkpoint(const std::string& folder);

/// Loads a simulation and what belongs to it. Throws SceneError if there is no checkpoint, if it is
/// damaged or belongs to another scene, or if the histories it continues are not there any more.
void read_checkpoint(const std::string& folder, const std::string& scene_hash,
                     Simulation& simulation, RunProgress& progress);

void remove_checkpoint(const std::string& folder);

}  // namespace apothem
