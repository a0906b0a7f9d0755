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

/// A force that a program has added to a run.
struct AddedForce {
  std::string name;
  void fields(Archive& archive) { archive("name", name); }
  bool operator==(const AddedForce&) const = default;
};

/// What a run keeps besides its simulation.
struct RunProgress {
  std::vector<double> history_sizes = std::vector<double>(kHistoryFiles.size());  ///< bytes
  std::vector<double> frame_times;                                                ///< s
  std::int64_t next_row = 1, next_frame = 1;
  std::vector<LoadStep> load_steps;  ///< of static runs
  Beginning beginning;
  std::vector<AddedForce> forces;
  StopWatch* stop_watch = nullptr;  ///< of the run; null while there is none

  void fields(Archive& archive) {
    archive.sized("history_sizes", history_sizes);
    archive("frame_times", frame_times)("next_row", next_row)("next_frame", next_frame)(
        "load_steps", load_steps)("beginning", beginning)("forces", forces);
    if (stop_watch) archive("stop_watch", *stop_watch);
  }
};

enum class StateFile { checkpoint, final };
std::string state_file(const std::string& folder, StateFile kind);

/// Writes a state to a file, and the text of the scene as well if asked to. Throws SystemFailure;
/// an older file is then intact.
void write_state(const std::string& file, const Scene& scene, const std::string& scene_hash,
                 Simulation& simulation, RunProgress& progress, bool with_scene = false);

/// What the file of a state says about the run, before there is a simulation. Throws SceneError if
/// there is none, or if it is damaged.
RunProgress read_progress(const std::string& file);
/// The settings of the run that has left the checkpoint in a folder. Throws as read_progress().
std::vector<Setting> settings_of_checkpoint(const std::string& folder);
/// The scene of a state that was written with its scene. Throws as read_progress(), and as
/// read_scene().
Scene read_saved_scene(const std::string& file);

/// Loads a simulation and what belongs to it. Throws SceneError if there is no such file, or if it
/// is damaged or belongs to another scene.
void read_state(const std::string& file, const std::string& scene_hash, Simulation& simulation,
                RunProgress& progress);
/// Throws SceneError if the histories in a folder that a run goes on with are not there any more.
void require_histories(const std::string& folder, const RunProgress& progress);

void remove_checkpoint(const std::string& folder);

}  // namespace apothem
