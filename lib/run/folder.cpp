#include "apothem/run/folder.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <vector>

#include "apothem/output/files.hpp"
#include "apothem/scene/error.hpp"

namespace apothem {

void prepare_folder(const std::string& folder, bool overwrite) {
  namespace fs = std::filesystem;
  constexpr std::array ours{"run.json",        "frames.pvd",  "outlines.pvd", "contacts.pvd",
                            "surfaces.pvd",    "history.csv", "energy.csv",   "momentum.csv",
                            "checkpoint.json", "final.json"};
  std::vector<fs::path> old;
  std::error_code error;
  for (const char* name : ours) {
    if (fs::exists(fs::path(folder) / name, error)) old.push_back(fs::path(folder) / name);
  }
  if (!old.empty() && !overwrite) {
    const bool resumable = fs::exists(fs::path(folder) / "checkpoint.json", error);
    throw SceneError(
        folder, 0, "",
        fmt::format("already holds results ({}); give {}--overwrite, or another folder with -o",
                    old.front().filename().string(), resumable ? "--resume to continue, " : ""));
  }
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "frames", error)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".vtu") &&
        (name.starts_with("bodies_") || name.starts_with("outlines_") ||
         name.starts_with("contacts_") || name.starts_with("surfaces_"))) {
      old.push_back(entry.path());
    }
  }
  for (const fs::path& path : old) {
    fs::remove(path, error);
    if (error) throw SystemFailure(path.string(), error.value());
  }
  create_folder(folder);
}

}  // namespace apothem
