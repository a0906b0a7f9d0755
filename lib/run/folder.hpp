// The folder of a run's results, and whose files are in it.
#pragma once

#include <string>
#include <vector>

#include "lib/output/file_list.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {

/// The files that a run reads: of its scene those that it names, and these.
std::vector<std::string> inputs_of(const Scene& scene, const std::vector<std::string>& others);

/// Locks the folder. Throws SceneError if another process is writing there, and SystemFailure.
void lock_folder(FileList& list, const std::string& folder);

/// What a run is going to do with a folder.
struct FolderPlan {
  std::string identity;             ///< of the run, for the list of its files
  bool overwrite = false;           ///< results of an earlier run may be replaced
  std::vector<std::string> inputs;  ///< files that must stay
  std::vector<std::string> others;  ///< names that are written there besides those of every run
};

/// Locks the folder, takes away the files of an earlier run if `overwrite` says so, and begins the
/// list of files anew. A file that no list of an earlier run names, and one that this run reads, is
/// never touched, nor is anything behind a link. Throws SceneError, with the folder as it was, if
/// there are such files in the way or results that may not be replaced; and SystemFailure.
void prepare_folder(const std::string& folder, const FolderPlan& plan, FileList& list);

/// Locks the folder of a run that goes on there, and takes away what an interruption has left half
/// written. Throws SceneError and SystemFailure.
void reopen_folder(const std::string& folder, const FolderPlan& plan, FileList& list);

/// What a run finds in a folder that may be one of its own.
enum class Found {
  nothing,     ///< no results
  checkpoint,  ///< it can go on
  broken_off,  ///< it has been killed before its first checkpoint, or the system has failed before
  ended,       ///< it is done
  other,       ///< results of another run, or of one that cannot go on
};
/// `hash`: of the scene of the run.
Found look_into(const std::string& folder, const std::string& hash);

}  // namespace apothem
