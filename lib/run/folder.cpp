#include "apothem/run/folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "apothem/output/files.hpp"
#include "apothem/scene/error.hpp"

namespace apothem {

void prepare_folder(const std::string& folder, bool overwrite) {
  namespace fs = std::filesystem;
  constexpr std::array ours{"run.json",        "frames.pvd",   "outlines.pvd", "contacts.pvd",
                            "chains.pvd",      "roses.pvd",    "surfaces.pvd", "history.csv",
                            "energy.csv",      "momentum.csv", "names.csv",    "final.json",
                            "checkpoint.json", "picture.png"};
  constexpr std::array series{"bodies_", "outlines_", "contacts_",
                              "chains_", "roses_",    "surfaces_"};
  std::vector<fs::path> old;
  std::error_code error;
  for (const char* name : ours) {
    if (fs::exists(fs::path(folder) / name, error)) old.push_back(fs::path(folder) / name);
  }
  if (!old.empty() && !overwrite) {
    const bool resumable = fs::exists(fs::path(folder) / "checkpoint.json", error);
    throw SceneError(
        folder, 0, "",
        fmt::format("already holds results ({}); {}give --overwrite to replace them (in Python: "
                    "overwrite=True), or choose another folder",
                    old.front().filename().string(), resumable ? "--resume continues them, " : ""));
  }
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "frames", error)) {
    const std::string name = entry.path().filename().string();
    const auto starts_with = [&](const char* prefix) { return name.starts_with(prefix); };
    if (name.ends_with(".vtu") && std::any_of(series.begin(), series.end(), starts_with)) {
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
