#include "apothem/run/checkpoint.hpp"

#include <algorithm>
#include <filesystem>

#include "apothem/output/files.hpp"
#include "apothem/run/json_archive.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {
namespace {

std::string file(const std::string& folder) { return folder + "/checkpoint.json"; }

void require_fitting(const Simulation& simulation, const Progress& progress) {
  const size_t bodies = simulation.model().deformables.size();
  const auto fits = [&](const LoadStep& s) {
    return s.off.size() == bodies && s.worst >= 0 && static_cast<size_t>(s.worst) < bodies;
  };
  if (!std::all_of(progress.load_steps.begin(), progress.load_steps.end(), fits)) {
    throw ArchiveMismatch("load_steps");
  }
  if (!(simulation.step_size() > 0)) throw ArchiveMismatch("step_size");
}

}  // namespace

void write_checkpoint(const std::string& folder, const std::string& scene_hash,
                      Simulation& simulation, Progress& progress) {
  JsonWriter archive;
  std::string hash = scene_hash;
  archive("scene_hash", hash)("progress", progress)("simulation", simulation);
  write_file(file(folder), archive.json().dump() + "\n");
}

void read_checkpoint(const std::string& folder, const std::string& scene_hash,
                     Simulation& simulation, Progress& progress) {
  const std::string name = file(folder);
  std::error_code error_code;
  if (!std::filesystem::exists(name, error_code)) {
    throw SceneError(name, 0, "", "there is no checkpoint to resume from; run without --resume");
  }
  std::string hash;
  try {
    const nlohmann::json json = nlohmann::json::parse(read_text(name));
    JsonLoader archive(json);
    archive("scene_hash", hash);
    if (hash != scene_hash) {
      throw SceneError(name, 0, "",
                       "belongs to another scene, or the scene has been changed; run it anew");
    }
    archive("progress", progress)("simulation", simulation);
    require_fitting(simulation, progress);
  } catch (const nlohmann::json::exception& error) {
    throw SceneError(name, 0, "", std::string("is not a checkpoint: ") + error.what());
  } catch (const ArchiveMismatch&) {
    throw SceneError(name, 0, "", "is damaged: its state does not fit the scene; run it anew");
  }
  simulation.refresh();
  for (size_t i = 0; i < kHistoryFiles.size(); ++i) {
    const std::string history = folder + "/" + kHistoryFiles[i];
    const auto length = std::filesystem::file_size(history, error_code);
    if (error_code || static_cast<double>(length) < progress.history_sizes[i]) {
      throw SceneError(history, 0, "",
                       "is missing or shorter than the checkpoint says; run it anew");
    }
  }
}

void remove_checkpoint(const std::string& folder) {
  std::error_code ignored;  // a checkpoint left behind does no harm
  std::filesystem::remove(file(folder), ignored);
}

}  // namespace apothem
