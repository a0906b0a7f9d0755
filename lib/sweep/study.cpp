#include "lib/sweep/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lib/output/files.hpp"
#include "lib/run/checkpoint.hpp"
#include "lib/run/exit_code.hpp"
#include "lib/run/hash.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kNote = "/sweep.json";

void take_away(const std::string& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) throw SystemFailure(file, error.value());
}

// The content of a JSON file; no object if it is absent or damaged.
Json json_of(const std::string& file) {
  return Json::parse(find_text(file), nullptr, /*allow_exceptions=*/false);
}

// All strings in a JSON value.
void add_strings(const JsonValue& value, std::vector<std::string>& strings) {
  if (value.type() == JsonValue::Type::string) strings.push_back(value.string());
  for (const JsonValue& item : value.items()) add_strings(item, strings);
}

// Hashes the files that strings name, relative to the scene. Which strings name files is a matter
// of the scene's reader; one that only looks like it costs no more than a needless repetition.
void add_files(const JsonValue& value, const fs::path& folder,
               std::map<std::string, std::string>& files) {
  constexpr size_t kLongestName = 4096;  // bytes, as of Linux
  std::vector<std::string> strings;
  add_strings(value, strings);
  for (const std::string& name : strings) {
    if (name.empty() || name.size() > kLongestName || files.count(name)) continue;
    std::error_code error;
    const fs::path file = folder / name;
    if (!fs::is_regular_file(file, error)) continue;
    try {
      files[name] = text_hash(read_text(file.string()));
    } catch (const SceneError&) {
      // The run itself says what is wrong with it.
    }
  }
}

RunState state_of_exit(const Json& ending) {
  if (ending.value("signal", 0) != 0) return RunState::crashed;
  switch (ending.value("exit_code", -1)) {
    case exit_code::done:
    case exit_code::missed:
      return RunState::done;
    case exit_code::bad_input:
      return RunState::refused;
    case exit_code::unstable:
      return RunState::unstable;
    case exit_code::system_failed:
      return RunState::failed;
    case exit_code::interrupted:
      return RunState::interrupted;
    default:
      return RunState::crashed;
  }
}

// Of a run whose end nobody has noted: what its own files say.
RunState state_of_files(const std::string& folder) {
  const Json json = json_of(folder + "/run.json");
  if (!json.is_object()) return RunState::interrupted;
  for (const RunState state : {RunState::done, RunState::unstable, RunState::failed}) {
    if (json.value("status", "") == name_of(state)) return state;
  }
  return RunState::interrupted;
}

}  // namespace

const char* name_of(RunState state) {
  constexpr std::array kNames{"missing",  "changed", "interrupted", "done",
                              "unstable", "failed",  "refused",     "crashed"};
  return kNames[static_cast<size_t>(state)];
}

bool has_failed(RunState state) {
  return state == RunState::unstable || state == RunState::failed || state == RunState::refused ||
         state == RunState::crashed;
}

Study::Study(StudySettings settings, Plan plan)
    : settings_(std::move(settings)), plan_(std::move(plan)) {
  for (const Setting& s : settings_.fixed) {
    const std::vector<Setting>& varied = plan_.runs.front().settings;
    if (std::ranges::find(varied, s.path, &Setting::path) == varied.end()) continue;
    throw SceneError(
        "--set",
        fmt::format("\"{}\" is varied; leave it out of --set or of the variations", s.path));
  }
  find_beginnings();
  for (const PlannedRun& run : plan_.runs) static_cast<void>(from_of(run));  // throws without one
  const std::string text = read_text(settings_.scene, kLargestJson);
  const fs::path folder = fs::path(settings_.scene).parent_path();
  JsonValue document = parse_json(text, settings_.scene);
  for (const Setting& s : settings_.fixed) apply_setting(document, s, settings_.scene);
  add_files(document, folder, files_);
  common_ = text_hash(text);
  for (const Setting& s : settings_.fixed) common_ += "\n" + s.text();
  common_ += "\nfrom " + settings_.from;
  for (const auto& [name, hash] : files_) common_ += fmt::format("\n{} {}", name, hash);
  for (const PlannedRun& run : plan_.runs) {
    for (const Setting& s : run.settings) {
      if (s.value.find('"') == std::string::npos) continue;
      add_files(parse_json(s.value, settings_.scene), folder, files_);
    }
  }
}

std::string Study::folder_of(const PlannedRun& run) const {
  return settings_.folder + "/runs/" + run.key;
}

std::vector<Setting> Study::settings_of(const PlannedRun& run) const {
  std::vector<Setting> all = settings_.fixed;
  all.insert(all.end(), run.settings.begin(), run.settings.end());
  return all;
}

// What a run is made of, without reading its bodies: that may take long and may fail.
std::string Study::identity_of(const PlannedRun& run) const {
  std::string text = common_;
  for (const Setting& s : run.settings) {
    text += fmt::format("\n{}={}", s.path, s.value);
    if (s.value.find('"') == std::string::npos) continue;
    std::vector<std::string> strings;
    add_strings(parse_json(s.value, settings_.scene), strings);
    for (const std::string& name : strings) {
      if (const auto file = files_.find(name); file != files_.end()) text += "\n" + file->second;
    }
  }
  return text_hash(text);
}

std::string Study::from_of(const PlannedRun& run) const {
  if (beginnings_.empty()) return settings_.from;
  const std::vector<Setting> own = settings_of(run);
  // What all runs of that study have in common and this one leaves to the scene does not matter.
  const auto common = [&](const Setting& s) {
    return std::ranges::all_of(beginnings_, [&](const auto& beginning) {
      return std::ranges::any_of(beginning.second, [&](const Setting& t) {
        return t.path == s.path && t.value == s.value;
      });
    });
  };
  const auto fits = [&](const Setting& s) {
    // The last setting of a path holds.
    const auto same = std::ranges::find(own.rbegin(), own.rend(), s.path, &Setting::path);
    return same == own.rend() ? common(s) : Json::parse(same->value) == Json::parse(s.value);
  };
  std::vector<std::string> found;
  for (const auto& [folder, settings] : beginnings_) {
    if (std::ranges::all_of(settings, fits)) found.push_back(folder);
  }
  if (found.size() == 1) return found.front();
  throw SceneError(
      settings_.from,
      fmt::format("{} finished runs of this study have the values of \"{}\"; one has to, "
                  "so that the run can begin with it",
                  found.size(), run.key));
}

// The finished runs of a study whose folder stands in place of that of a run, with their settings.
void Study::find_beginnings() {
  std::error_code error;
  const std::string runs = settings_.from + "/runs";
  if (settings_.from.empty() || !fs::is_directory(runs, error)) return;
  for (const auto& entry : fs::directory_iterator(runs)) {
    const std::string folder = entry.path().string();
    const Json json = json_of(folder + "/run.json");
    if (!json.is_object() || json.value("status", "") != "done") continue;
    std::vector<Setting>& settings = beginnings_[folder];
    for (const auto& [path, value] : json["set"].items()) settings.push_back({path, value.dump()});
  }
  if (beginnings_.empty()) {
    throw SceneError(settings_.from, "holds a study without a finished run; do its runs first");
  }
}

RunState Study::state_of(const PlannedRun& run) const {
  const std::string folder = folder_of(run);
  const Json note = json_of(folder + kNote);
  if (!note.is_object()) {
    const bool results = file_exists(folder + "/run.json") || has_checkpoint(folder);
    return results ? RunState::changed : RunState::missing;
  }
  if (note.value("identity", "") != identity_of(run)) return RunState::changed;
  return note.contains("ended") ? state_of_exit(note["ended"]) : state_of_files(folder);
}

std::string Study::message_of(const PlannedRun& run) const {
  const Json note = json_of(folder_of(run) + kNote);
  if (!note.is_object() || !note.contains("ended")) return "";
  return note["ended"].value("message", "");
}

void Study::begin_run(const PlannedRun& run, bool resume) const {
  const std::string folder = folder_of(run);
  create_folder(folder);
  take_away(folder + "/run.json");
  if (!resume) remove_checkpoint(folder);
  write_file(folder + kNote, Json{{"identity", identity_of(run)}}.dump(2) + "\n");
}

void Study::end_run(const PlannedRun& run, const RunEnding& ending) const {
  Json note{{"identity", identity_of(run)}};
  Json& ended = note["ended"];
  ended["exit_code"] = ending.exit_code;
  if (ending.signal != 0) ended["signal"] = ending.signal;
  if (!ending.message.empty()) ended["message"] = ending.message;
  write_file(folder_of(run) + kNote,
             note.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace apothem
