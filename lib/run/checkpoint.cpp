#include "lib/run/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "lib/dynamics/inheritance.hpp"
#include "lib/output/files.hpp"
#include "lib/run/hash.hpp"
#include "lib/run/json_archive.hpp"
#include "lib/run/sealed_file.hpp"
#include "lib/scene/json.hpp"

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
  if (!std::ranges::all_of(progress.load_steps, fits)) {
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
  if (!file_exists(name)) {
    const std::string folder = std::filesystem::path(name).parent_path().string();
    const bool ended = name == state_file(folder, StateFile::checkpoint) &&
                       file_exists(state_file(folder, StateFile::final));
    throw SceneError(name,
                     ended ? "the run has ended, so there is no checkpoint to resume from; give "
                             "--overwrite in place of --resume to run it anew"
                           : "there is no checkpoint to resume from; give --overwrite in place of "
                             "--resume to run it anew");
  }
  try {
    const nlohmann::json json = nlohmann::json::parse(read_sealed(name));
    JsonLoader archive(json);
    load(archive);
  } catch (const nlohmann::json::exception& error) {
    throw SceneError(name, std::string("is not a checkpoint: ") + error.what());
  } catch (const ArchiveMismatch&) {
    throw SceneError(name, "is damaged: its state does not fit the scene; run it anew");
  }
}

}  // namespace

std::string state_file(const std::string& folder, StateFile kind) {
  constexpr std::array kNames{"checkpoint.json", "checkpoint.previous.json", "final.json"};
  return folder + "/" + kNames[static_cast<size_t>(kind)];
}

bool has_checkpoint(const std::string& folder) {
  return file_exists(state_file(folder, StateFile::checkpoint)) ||
         file_exists(state_file(folder, StateFile::previous));
}

// At no time is there none: the last one gets a second name until the next one takes its place.
void keep_checkpoint(const std::string& folder) {
  namespace fs = std::filesystem;
  const std::string last = state_file(folder, StateFile::checkpoint);
  const std::string previous = state_file(folder, StateFile::previous);
  if (!file_exists(last)) return;
  std::error_code error;
  fs::remove(previous, error);
  fs::create_hard_link(last, previous, error);
  if (error) fs::rename(last, previous, error);  // a file system without second names
  if (error) throw SystemFailure(previous, error.value());
}

void write_state(const std::string& file, const Scene& scene, const std::string& scene_hash,
                 Simulation& simulation, RunProgress& progress, bool with_scene) {
  std::string hash = scene_hash, potentials = potentials_hash(simulation.model());
  std::vector<Setting> settings = scene.settings;
  ModelRecord record = record_of(simulation);
  write_sealed(file, [&](Archive& archive) {
    if (with_scene) {
      SavedScene saved{std::filesystem::absolute(scene.file).string(), scene.text};
      archive("scene", saved);
    }
    archive("scene_hash", hash)("potentials", potentials)("settings", settings)("model", record)(
        "progress", progress)("simulation", simulation);
  });
}

RunProgress read_progress(const std::string& file) {
  RunProgress progress;
  with_state(file, [&](Archive& archive) { archive("progress", progress); });
  return progress;
}

StateOrigin origin_of(const std::string& file) {
  StateOrigin origin;
  with_state(file, [&](Archive& archive) {
    archive("settings", origin.settings)("scene_hash", origin.scene_hash);
  });
  return origin;
}

std::string use_checkpoint(const std::string& folder,
                           const std::function<void(const std::string&)>& use) {
  const std::string last = state_file(folder, StateFile::checkpoint);
  const std::string previous = state_file(folder, StateFile::previous);
  try {
    use(last);
    return {};
  } catch (const SceneError& first) {
    if (!file_exists(previous)) throw;
    try {
      use(previous);
    } catch (const SceneError&) {
      // The first one is the one to be mended.
      throw first;
    }
    const auto* damaged = dynamic_cast<const Damaged*>(&first);
    return damaged ? damaged->fault() : first.what();
  }
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
    std::string hash, potentials;
    archive("scene_hash", hash);
    if (hash != scene_hash) {
      throw SceneError(file,
                       "belongs to another scene, or the scene or its settings have been changed; "
                       "run it anew");
    }
    archive("potentials", potentials);
    if (potentials != potentials_hash(simulation.model())) {
      throw SceneError(file,
                       "was written with other potentials of these polygons: their straight "
                       "skeletons were constructed by another version of apothem-skeleton; go on "
                       "with the version that began the run, or run it anew");
    }
    archive("progress", progress)("simulation", simulation);
    require_fitting(simulation, progress);
  });
  simulation.refresh();
}

namespace {

// The first line of the part that is no row of a table, in words; empty: all are.
std::string bad_line(const std::string& file, std::int64_t size) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  for (int number = 1; size > 0 && std::getline(stream, line); ++number) {
    size -= static_cast<std::int64_t>(line.size()) + 1;
    const auto odd = [&](unsigned char c) {
      return std::iscntrl(c) != 0 || (number > 1 && std::isalpha(c) != 0 && c != 'e');
    };
    if (line.empty() || std::ranges::any_of(line, odd)) {
      return fmt::format(", first seen in line {}", number);
    }
  }
  return {};
}

}  // namespace

HistoryWriter::Parts required_histories(const std::string& folder, const RunProgress& progress) {
  HistoryWriter::Parts parts;
  if (progress.histories.size() != parts.size()) {
    throw SceneError(folder, "holds a checkpoint of a run without histories; run it anew");
  }
  for (size_t i = 0; i < parts.size(); ++i) {
    const HistoryPart& kept = progress.histories[i];
    const std::string file = folder + "/" + kHistoryFiles[i];
    constexpr const char* kRemedy = "put the file back as it was, or run anew with --overwrite";
    std::error_code error;
    const auto fail = [&](const std::string& what) {
      throw SceneError(file, what + "; " + kRemedy);
    };
    if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(file, error))) {
      fail("is missing, so that the run cannot go on from its checkpoint");
    }
    parts[i] = part_of(file, kept.size);
    if (parts[i].size < kept.size) {
      fail(fmt::format("is shorter than the checkpoint says: {} bytes of {}", parts[i].size,
                       kept.size));
    }
    if (kept.file != kHistoryFiles[i] || parts[i].checksum.text() != kept.checksum) {
      fail(fmt::format("is not as the run has written it, in its first {} bytes{}", kept.size,
                       bad_line(file, kept.size)));
    }
  }
  return parts;
}

void refuse_other_columns(const std::string& folder, const std::string& header) {
  const std::string file = folder + "/" + kHistoryFiles[0];
  std::string first;
  std::ifstream stream(file, std::ios::binary);
  if (std::getline(stream, first); first + '\n' != header) {
    throw SceneError(file,
                     "has other columns than this version writes; go on with the version that "
                     "began the run, or run it anew with --overwrite");
  }
}

void remove_checkpoint(const std::string& folder) {
  std::error_code ignored;  // a checkpoint left behind does no harm
  // The last one goes last: a run that is killed in between goes on from there.
  for (const StateFile kind : {StateFile::previous, StateFile::checkpoint}) {
    std::filesystem::remove(state_file(folder, kind), ignored);
  }
}

}  // namespace apothem
