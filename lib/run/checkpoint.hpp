// The whole state of a run in a file: checkpoint.json says where a run was stopped, so that it
// continues bit for bit as if it never had, and checkpoint.previous.json is the one before;
// final.json is where it has ended, for runs that begin there.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lib/dynamics/body_start.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/output/history.hpp"
#include "lib/run/load_path.hpp"
#include "lib/run/rigid_limit.hpp"
#include "lib/run/stop_watch.hpp"
#include "lib/scene/scene.hpp"

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

/// The part of a history that a checkpoint goes with.
struct HistoryPart {
  std::string file;
  std::int64_t size = 0;  ///< bytes
  std::string checksum;
  void fields(Archive& archive) { archive("file", file)("size", size)("checksum", checksum); }
};

/// What a run keeps besides its simulation.
struct RunProgress {
  std::vector<HistoryPart> histories;  ///< of kHistoryFiles; empty: of a run without files
  std::vector<double> frame_times;     ///< s
  std::int64_t next_row = 1, next_frame = 1;
  std::int64_t last_row = -1, last_frame = -1;  ///< steps of the last ones
  std::vector<LoadStep> load_steps;             ///< of static runs
  LoadPath load_path;                           ///< likewise
  std::int64_t looks = 0, quiet_looks = 0;      ///< at the motion, and where nobody would notice it
  RigidLimit rigid;                             ///< of scenes that ask for it
  Beginning beginning;
  std::vector<AddedForce> forces;
  StopWatch* stop_watch = nullptr;  ///< of the run; null while there is none

  void fields(Archive& archive) {
    archive("histories", histories)("frame_times", frame_times)("next_row", next_row)(
        "next_frame", next_frame)("last_row", last_row)("last_frame", last_frame)(
        "load_steps", load_steps)("looks", looks)("quiet_looks", quiet_looks)(
        "load_path", load_path)("rigid", rigid)("beginning", beginning)("forces", forces);
    if (stop_watch) archive("stop_watch", *stop_watch);
  }
};

enum class StateFile { checkpoint, previous, final };
std::string state_file(const std::string& folder, StateFile kind);
/// Whether there is a checkpoint in a folder, whole or damaged.
bool has_checkpoint(const std::string& folder);

/// Writes a state to a file, and the text of the scene as well if asked to. It ends with its
/// checksum and outlasts a machine that stops. Throws SystemFailure; an older file is then intact.
void write_state(const std::string& file, const Scene& scene, const std::string& scene_hash,
                 Simulation& simulation, RunProgress& progress, bool with_scene = false);

/// Before a checkpoint is written: keeps the last one as the previous one. Throws SystemFailure.
void keep_checkpoint(const std::string& folder);

/// What the file of a state says about the run, before there is a simulation. Throws SceneError if
/// there is none, or if it is damaged.
RunProgress read_progress(const std::string& file);
/// The settings, and the hash of the scene, of the run that has left a state. Throws as
/// read_progress().
struct StateOrigin {
  std::vector<Setting> settings;
  std::string scene_hash;
};
StateOrigin origin_of(const std::string& file);
/// Calls use(file) for the checkpoint in a folder or, if it throws SceneError, for the previous
/// one. Returns what was wrong with the first one, or nothing. Throws what the first call has
/// thrown if the second one throws as well.
std::string use_checkpoint(const std::string& folder,
                           const std::function<void(const std::string&)>& use);
/// The scene of a state that was written with its scene. Throws as read_progress(), and as
/// read_scene().
Scene read_saved_scene(const std::string& file);

/// Loads a simulation and what belongs to it. Throws SceneError if there is no such file, or if it
/// is damaged or belongs to another scene.
void read_state(const std::string& file, const std::string& scene_hash, Simulation& simulation,
                RunProgress& progress);
/// The histories in a folder that a run goes on with, which need not end there. Throws SceneError
/// if they are not as they were.
HistoryWriter::Parts required_histories(const std::string& folder, const RunProgress& progress);
/// Throws SceneError if the first line of history.csv in the folder is not `header`.
void refuse_other_columns(const std::string& folder, const std::string& header);

/// Both of them.
void remove_checkpoint(const std::string& folder);

}  // namespace apothem
