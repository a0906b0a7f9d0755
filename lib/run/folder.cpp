#include "lib/run/folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "lib/output/frames.hpp"
#include "lib/output/run_folder.hpp"
#include "lib/output/vtu_file.hpp"
#include "lib/run/checkpoint.hpp"
#include "lib/scene/json.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

// The files of every run, besides its frames.
const Names& results_of_runs() {
  static const Names names = [] {
    Names all{"run.json"};
    std::ranges::copy(frame_lists(), std::back_inserter(all));
    std::ranges::copy(kHistoryFiles, std::back_inserter(all));
    all.insert(all.end(),
               {"names.csv", "final.json", "checkpoint.json", "checkpoint.previous.json"});
    return all;
  }();
  return names;
}

// A link counts, even one to nothing.
bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

std::string in(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / name).string();
}

Names names_of(const FolderPlan& plan) {
  Names names = results_of_runs();
  names.insert(names.end(), plan.others.begin(), plan.others.end());
  return names;
}

// Files of a run of an earlier version, which has left no list: those of every run, if its frames
// are there, and what its series list.
std::set<std::string> unlisted_results(const std::string& folder) {
  std::set<std::string> names;
  if (!is_there(in(folder, "frames.pvd")) || !is_there(folder + "/names.csv")) return names;
  names.insert(results_of_runs().begin(), results_of_runs().end());
  names.insert("picture.png");
  for (const std::string& list : frame_lists()) {
    if (!is_there(in(folder, list))) continue;
    try {
      for (const auto& [time, file] : read_pvd(in(folder, list))) names.insert(file);
    } catch (const ResultsError&) {
      // Files that no list names stay.
    }
  }
  return names;
}

// Names in the folder that earlier runs have made there. What else a list says is not heeded.
std::set<std::string> own_files(const std::string& folder, const FileList& list,
                                const Names& results) {
  std::set<std::string> all = list.identity().empty()
                                  ? unlisted_results(folder)
                                  : std::set(list.names().begin(), list.names().end());
  std::set<std::string> own;
  for (const std::string& name : all) {
    const bool result = std::ranges::find(results, name) != results.end();
    if (result || name == "picture.png" || is_frame_file(name)) own.insert(name);
  }
  return own;
}

void refuse_link(const std::string& folder) {
  const fs::path frames = fs::path(folder) / "frames";
  std::error_code error;
  if (!fs::is_symlink(frames, error)) return;
  throw SceneError(
      frames.string(),
      "is a link, which is not followed out of the folder of results; take it away, or "
      "choose another folder");
}

// A file of somebody else that has the name of one of this run.
void refuse_others(const std::string& folder, const Names& results,
                   const std::set<std::string>& own) {
  const auto refuse = [&](const std::string& name) {
    throw SceneError(in(folder, name),
                     "is in the way: the run would write a file of this name, and this one is not "
                     "of an earlier run; move it, or choose another folder");
  };
  for (const std::string& name : results) {
    if (own.count(name) == 0 && is_there(in(folder, name))) refuse(name);
  }
  std::error_code error;
  Names frames;
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "frames", error)) {
    const std::string name = "frames/" + entry.path().filename().string();
    if (is_frame_file(name) && own.count(name) == 0) frames.push_back(name);
  }
  if (!frames.empty()) refuse(*std::ranges::min_element(frames));
}

void refuse_inputs(const std::string& folder, const Names& files, const Names& inputs) {
  for (const std::string& name : files) {
    const std::string file = in(folder, name);
    for (const std::string& input : inputs) {
      std::error_code error;
      if (!is_there(file) || !fs::equivalent(file, input, error) || error) continue;
      throw SceneError(file,
                       "is read by this run, which would replace it; choose another folder for the "
                       "results");
    }
  }
}

// What has been written half of a file stands beside it.
Names with_halves(const std::string& folder, const std::set<std::string>& own) {
  Names files;
  for (const std::string& name : own) {
    for (const std::string& file : {name, name + ".partial"}) {
      if (is_there(in(folder, file))) files.push_back(file);
    }
  }
  return files;
}

void take_away(const std::string& folder, const Names& files) {
  for (const std::string& name : files) {
    std::error_code error;
    fs::remove(fs::path(folder) / name, error);
    if (error) throw SystemFailure(in(folder, name), error.value());
  }
}

void add_strings(const JsonValue& value, std::set<std::string>& strings) {
  if (value.type() == JsonValue::Type::string) strings.insert(value.string());
  for (const JsonValue& item : value.items()) add_strings(item, strings);
}

std::string status_in(const std::string& folder) {
  try {
    const auto json = nlohmann::json::parse(find_text(folder + "/run.json"), nullptr, false);
    return json.is_object() ? json.value("status", "") : "";
  } catch (const nlohmann::json::exception&) {
    return "";
  }
}

}  // namespace

std::vector<std::string> inputs_of(const Scene& scene, const std::vector<std::string>& others) {
  Names files{scene.file};
  std::set<std::string> strings;
  add_strings(scene.document, strings);
  const fs::path folder = fs::path(scene.file).parent_path();
  for (const std::string& name : strings) {
    std::error_code error;
    if (!name.empty() && fs::is_regular_file(folder / name, error)) {
      files.push_back((folder / name).string());
    }
  }
  files.insert(files.end(), others.begin(), others.end());
  return files;
}

void lock_folder(FileList& list, const std::string& folder) {
  if (list.lock()) {
    if (!list.is_other_file()) return;
    throw SceneError(
        folder + "/" + FileList::kName,
        "is in the way: it is no list of the files of a run, which has this name; move "
        "it, or choose another folder");
  }
  throw SceneError(folder,
                   "is in use: another run is writing its results there; wait until it has ended, "
                   "or choose another folder");
}

void prepare_folder(const std::string& folder, const FolderPlan& plan, FileList& list) {
  lock_folder(list, folder);
  const Names results = names_of(plan);
  const std::set<std::string> own = own_files(folder, list, results);
  Names old = with_halves(folder, own);
  refuse_link(folder);
  refuse_inputs(folder, results, plan.inputs);
  refuse_inputs(folder, old, plan.inputs);
  const auto result = std::ranges::find_first_of(results, old);
  if (result != results.end() && !plan.overwrite) {
    throw SceneError(
        folder,
        fmt::format("already holds results ({}); {}give --overwrite to replace them (in Python: "
                    "overwrite=True), or choose another folder",
                    *result, has_checkpoint(folder) ? "--resume continues them, " : ""));
  }
  refuse_others(folder, results, own);
  take_away(folder, old);
  list.begin(plan.identity, names_of(plan));
}

void reopen_folder(const std::string& folder, const FolderPlan& plan, FileList& list) {
  lock_folder(list, folder);
  refuse_link(folder);
  const Names results = names_of(plan);
  const std::set<std::string> own = own_files(folder, list, results);
  refuse_others(folder, results, own);
  Names halves = with_halves(folder, own);
  std::erase_if(halves, [](const std::string& name) { return !name.ends_with(".partial"); });
  take_away(folder, halves);
  if (list.identity().empty()) list.begin(plan.identity, Names(own.begin(), own.end()));
  list.add(results);
}

Found look_into(const std::string& folder, const std::string& hash) {
  if (has_checkpoint(folder)) return Found::checkpoint;
  const std::string final = state_file(folder, StateFile::final);
  const std::string status = status_in(folder);
  if (is_there(final) && status == "done") {
    return origin_of(final).scene_hash == hash ? Found::ended : Found::other;
  }
  const bool results = std::ranges::any_of(
      results_of_runs(), [&](const std::string& name) { return is_there(in(folder, name)); });
  if (!results) return Found::nothing;
  if (!is_there(folder + "/" + FileList::kName)) return Found::other;
  const FileList list(folder);
  const bool same = list.identity() == hash;
  return same && (status.empty() || status == "failed") ? Found::broken_off : Found::other;
}

}  // namespace apothem
