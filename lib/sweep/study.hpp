// A study: a scene with a plan, and the folder that its runs share. Each run has a folder of its
// own, runs/KEY, in which sweep.json says what was started there and how it ended. Processes on
// several machines may work on different runs of one study at the same time: no file belongs to
// more than one run, and each is written under another name and then renamed.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lib/sweep/plan.hpp"

namespace apothem {

struct StudySettings {
  std::string scene;           ///< file
  std::vector<Setting> fixed;  ///< the same for all runs; those of the plan come after them
  /// DIR[@TIME] of the run that all runs begin with; or DIR of a study, of which each run begins
  /// with the finished run whose settings are among its own. Empty: none.
  std::string from;
  std::string folder;  ///< of the study
};

/// How a process that worked on a run has ended.
struct RunEnding {
  int exit_code = 0;    ///< of the program, if no signal has ended it
  int signal = 0;       ///< that has ended it; 0: none
  std::string message;  ///< what it said last, if it failed
};

/// What there is of a run.
enum class RunState : std::uint8_t {
  missing,      ///< not begun
  changed,      ///< there are results, but the scene, its files or settings have changed since
  interrupted,  ///< begun, and not at its end
  done,
  unstable,  ///< exit code 3
  failed,    ///< the system failed, exit code 4
  refused,   ///< the scene was refused, exit code 2
  crashed,   ///< ended by a signal, or otherwise unknown
};

/// The name of a state in tables.
const char* name_of(RunState state);
/// Whether a run in this state has ended without success; it is repeated only on request.
bool has_failed(RunState state);

class Study {
 public:
  /// Throws SceneError if the scene file cannot be read, if a path is both fixed and varied, or if
  /// a run finds none, or several, to begin with.
  Study(StudySettings settings, Plan plan);

  [[nodiscard]] const StudySettings& settings() const { return settings_; }
  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] std::string folder_of(const PlannedRun& run) const;
  /// The fixed ones and those of the run, in the order in which they apply.
  [[nodiscard]] std::vector<Setting> settings_of(const PlannedRun& run) const;
  /// DIR[@TIME] of the run that it begins with; empty: none.
  [[nodiscard]] std::string from_of(const PlannedRun& run) const;
  [[nodiscard]] RunState state_of(const PlannedRun& run) const;
  /// What sweep.json says about a run that has failed; else empty.
  [[nodiscard]] std::string message_of(const PlannedRun& run) const;

  /// Notes that work on a run begins. Takes away what says that it has ended, and, unless it goes
  /// on from its checkpoint, that as well. Throws SystemFailure.
  void begin_run(const PlannedRun& run, bool resume) const;
  /// Notes how it has ended. Throws SystemFailure.
  void end_run(const PlannedRun& run, const RunEnding& ending) const;

 private:
  [[nodiscard]] std::string identity_of(const PlannedRun& run) const;
  void find_beginnings();

  StudySettings settings_;
  Plan plan_;
  std::map<std::string, std::vector<Setting>> beginnings_;  // folders of runs to begin with
  std::string common_;                                      // identity of what all runs share
  std::map<std::string, std::string> files_;  // hashes of files that the scene and the plan name
};

}  // namespace apothem
