#include "apothem/run/checkpoint.hpp"

#include <algorithm>
#include <filesystem>

#include "apothem/dynamics/inheritance.hpp"
#include "apothem/output/files.hpp"
#include "apothem/run/json_archive.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

static void describe(Archive& archive, Setting& setting) {
  archive("path", setting.path)("value", setting.value);
}

namespace {

void require_fitting(const Simulation& simulation, const RunProgress& progress) {
  const size_t bodies = simulation.model().bodies.size() + simulation.model().deformables.size();
  const auto fits = [&](const LoadStep& s) {
    return s.off.size() == bodies && s.worst >= 0 && static_cast<size_t>(s.worst) < bodies;
  };
  if (!std::all_of(progress.load_steps.begin(), progress.load_steps.end(), fits)) {
    throw ArchiveMismatch("load_steps");
  }
  if (!(simulation.step_size() > 0)) throw ArchiveMismatch("step_size");
}

// Calls load(archive) for the checkpoint in a folder.
template <class Load>
void with_checkpoint(const std::string& folder, const Load& load) {
  const std::string name = state_file(folder, StateFile::checkpoint);
  std::error_code error_code;
  if (!std::filesystem::exists(name, error_code)) {
    const bool ended = std::filesystem::exists(state_file(folder, StateFile::final), error_code);
    throw SceneError(name, 0, "",
                     ended ? "the run has ended, so there is no checkpoint to resume from; give "
                             "--overwrite in place of --resume to run it anew"
                           : "there is no checkpoint to resume from; run without --resume");
  }
  try {
    const nlohmann::json json = nlohmann::json::parse(read_text(name));
    JsonLoader archive(json);
    load(archive);
  } catch (const nlohmann::json::exception& error) {
    throw SceneError(name, 0, "", std::string("is not a checkpoint: ") + error.what());
  } catch (const ArchiveMismatch&) {
    throw SceneError(name, 0, "", "is damaged: its state does not fit the scene; run it anew");
  }
}

}  // namespace

std::string state_file(const std::string& folder, StateFile kind) {
  return folder + (kind == StateFile::final ? "/final.json" : "/checkpoint.json");
}

void write_state(const std::string& folder, StateFile kind, const Scene& scene,
                 const std::string& scene_hash, Simulation& simulation, RunProgress& progress) {
  std::string hash = scene_hash;
  std::vector<Setting> settings = scene.settings;
  ModelRecord record = record_of(simulation);
  write_file(state_file(folder, kind), [&](const auto& sink) {
    JsonWriter archive(sink);
    archive("scene_hash", hash)("settings", settings)("model", record)("progress", progress)(
        "simulation", simulation);
    archive.finish();
    sink("\n");
  });
}

RunProgress read_progress(const std::string& folder) {
  RunProgress progress;
  with_checkpoint(folder, [&](Archive& archive) { archive("progress", progress); });
  return progress;
}

std::vector<Setting> settings_of_checkpoint(const std::string& folder) {
  std::vector<Setting> settings;
  with_checkpoint(folder, [&](Archive& archive) { archive("settings", settings); });
  return settings;
}

void read_checkpoint(const std::string& folder, const std::string& scene_hash,
                     Simulation& simulation, RunProgress& progress) {
  with_checkpoint(folder, [&](Archive& archive) {
    std::string hash;
    archive("scene_hash", hash);
    if (hash != scene_hash) {
      throw SceneError(state_file(folder, StateFile::checkpoint), 0, "",
                       "belongs to another scene, or the scene or its settings have been changed; "
                       "run it anew");
    }
    archive("progress", progress)("simulation", simulation);
    require_fitting(simulation, progress);
  });
  simulation.refresh();
  for (size_t i = 0; i < kHistoryFiles.size(); ++i) {
    const std::string history = folder + "/" + kHistoryFiles[i];
    std::error_code error_code;
    const auto length = std::filesystem::file_size(history, error_code);
    if (error_code || static_cast<double>(length) < progress.history_sizes[i]) {
      throw SceneError(history, 0, "",
                       "is missing or shorter than the checkpoint says; run it anew");
    }
  }
}

void remove_checkpoint(const std::string& folder) {
  std::error_code ignored;  // a checkpoint left behind does no harm
  std::filesystem::remove(state_file(folder, StateFile::checkpoint), ignored);
}

}  // namespace apothem
