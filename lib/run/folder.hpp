// The folder of a run's results.
#pragma once

#include <string>

namespace apothem {

/// Creates the folder. Results in it are never touched unless `overwrite` says so, and then only
/// our own files. Throws SceneError and SystemFailure.
void prepare_folder(const std::string& folder, bool overwrite);

}  // namespace apothem
