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

// Where a scene comes from that a state was written with.
struct SavedScene {
  std::string file, text;
  void fields(Archive& archive) { archive("file", file)("text", text); }
};

// Calls load(archive) for the file of a state.
template <class Load>
void with_state(const std::string& name, const Load& load) {
  std::error_code error_code;
  if (!std::filesystem::exists(name, error_code)) {
    const std::string folder = std::filesystem::path(name).parent_path().string();
    const bool ended = name == state_file(folder, StateFile::checkpoint) &&
                       std::filesystem::exists(state_file(folder, StateFile::final), error_code);
    throw SceneError(name, 0, "",
                     ended ? "the run has ended, so there is no checkpoint to resume from; give "
                             "--overwrite in place of --resume to run it anew"
                           : "there is no checkpoint to resume from; run without --resume, and "
                             "with --overwrite where there are results");
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

void write_state(const std::string& file, const Scene& scene, const std::string& scene_hash,
                 Simulation& simulation, RunProgress& progress, bool with_scene) {
  std::string hash = scene_hash;
  std::vector<Setting> settings = scene.settings;
  ModelRecord record = record_of(simulation);
  write_file(file, [&](const auto& sink) {
    JsonWriter archive(sink);
    if (with_scene) {
      SavedScene saved{std::filesystem::absolute(scene.file).string(), scene.text};
      archive("scene", saved);
    }
    archive("scene_hash", hash)("settings", settings)("model", record)("progress", progress)(
        "simulation", simulation);
    archive.finish();
    sink("\n");
  });
}

RunProgress read_progress(const std::string& file) {
  RunProgress progress;
  with_state(file, [&](Archive& archive) { archive("progress", progress); });
  return progress;
}

std::vector<Setting> settings_of_checkpoint(const std::string& folder) {
  std::vector<Setting> settings;
  with_state(state_file(folder, StateFile::checkpoint),
             [&](Archive& archive) { archive("settings", settings); });
  return settings;
}

Scene read_saved_scene(const std::string& file) {
  SavedScene saved;
  std::vector<Setting> settings;
  with_state(file, [&](Archive& archive) { archive("scene", saved)("settings", settings); });
  return read_scene_text(std::move(saved.text), saved.file, settings);
}

void read_state(const std::string& file, const std::string& scene_hash, Simulation& simulation,
                RunProgress& progress) {
  with_state(file, [&](Archive& archive) {
    std::string hash;
    archive("scene_hash", hash);
    if (hash != scene_hash) {
      throw SceneError(file, 0, "",
                       "belongs to another scene, or the scene or its settings have been changed; "
                       "run it anew");
    }
    archive("progress", progress)("simulation", simulation);
    require_fitting(simulation, progress);
  });
  simulation.refresh();
}

void require_histories(const std::string& folder, const RunProgress& progress) {
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
