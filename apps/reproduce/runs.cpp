#include "apps/reproduce/runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/commands.hpp"
#include "apps/process/child_program.hpp"
#include "lib/output/files.hpp"
#include "lib/run/checkpoint.hpp"
#include "lib/run/hash.hpp"
#include "lib/scene/json.hpp"
#include "lib/system/clock.hpp"
#include "lib/text/csv.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

namespace fs = std::filesystem;

constexpr double kUsualSeconds = 2;  // of a scene about which nothing is known

// Weights for the time left; a scene that is not listed is taken to be quick.
std::map<std::string, double> usual_seconds(const std::string& data) {
  std::map<std::string, double> seconds;
  const std::string file = data + "/figures/seconds.csv";
  if (!file_exists(file)) return seconds;
  for (const CsvRow& row : read_csv(file)) {
    if (row.cells.size() != 2 || row.cells[0] == "scene") continue;
    try {
      seconds[row.cells[0]] = parse_decimal(row.cells[1]);
    } catch (const BadNumber& bad) {
      throw SceneError(file, row.line, "", bad.what());
    }
  }
  return seconds;
}

std::string in_words(double seconds) {
  return seconds < 100 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60);
}

std::string record_in(const std::string& folder) { return folder + "/reproduced.json"; }

void write_record(const std::string& folder, const std::string& key, bool ended, double seconds) {
  const nlohmann::ordered_json record{
      {"key", key}, {"ended", ended}, {"seconds", std::round(100 * seconds) / 100}};
  write_file(record_in(folder), record.dump(2) + "\n");
}

int interrupted() {
  fmt::print(stderr, "apothem: interrupted; the same command goes on where it stopped\n");
  return exit_code::interrupted;
}

}  // namespace

FigureRuns::FigureRuns(std::string data, std::string folder, std::string studies, int threads)
    : data_(std::move(data)),
      folder_(std::move(folder)),
      studies_(std::move(studies)),
      threads_(threads),
      usual_(usual_seconds(data_)) {}

FigureRuns::Planned FigureRuns::look(const std::string& name, const std::string& folder,
                                     const std::string& key) const {
  // Read when it is asked for, which is not where a figure is refused.
  static const std::string program = text_hash(read_text("/proc/self/exe"));
  Planned planned;
  planned.folder = folder;
  planned.key = text_hash(key + program);
  const auto usual = usual_.find(name);
  planned.seconds = usual == usual_.end() ? kUsualSeconds : usual->second;
  const auto record = nlohmann::json::parse(find_text(record_in(folder)), nullptr, false);
  if (!record.is_object() || record.value("key", "") != planned.key) return planned;
  planned.begun = true;
  planned.ended = record.value("ended", false);
  return planned;
}

void FigureRuns::begin(const std::string& name) const {
  const Planned& planned = planned_.at(name);
  create_folder(planned.folder);
  write_record(planned.folder, planned.key, false, 0);
}

void FigureRuns::keep(const std::string& figure, const std::string& name,
                      const std::string& status) {
  planned_.at(name).over = true;
  fmt::print("{}: {} {} (unchanged, not run again)\n", figure, name, status);
  std::fflush(stdout);
}

void FigureRuns::end(const std::string& figure, const std::string& name, const std::string& status,
                     double seconds) {
  Planned& planned = planned_.at(name);
  write_record(planned.folder, planned.key, true, seconds);
  planned.over = true;
  expected_ += planned.seconds, taken_ += seconds;
  fmt::print("{}: {} {} ({:.1f} s, about {} left)\n", figure, name, status, seconds, time_left());
  std::fflush(stdout);
}

void FigureRuns::plan(const std::vector<std::string>& scenes) {
  for (const std::string& scene : scenes) {
    if (planned_.count(scene)) continue;
    const std::string folder = folder_ + "/" + scene;
    const Scene read = read_scene(data_ + "/scenes/" + scene + ".json");
    Planned& planned = planned_[scene] = look(scene, folder, scene_hash(read));
    planned.ended = planned.ended && file_exists(folder + "/run.json");
  }
}

void FigureRuns::plan(const FigureStudy& study, bool quick) {
  if (planned_.count(study.name)) return;
  std::string key;
  for (const std::vector<std::string>& command : study.of(quick))
    key += command_line(command) + '\n';
  planned_[study.name] = look(study.name, studies_ + "/" + study.name, key);
}

std::string FigureRuns::time_left() const {
  double left = 0;
  for (const auto& [name, planned] : planned_) {
    if (!planned.ended && !planned.over) left += planned.seconds;
  }
  // This machine beside the one whose times are listed.
  if (expected_ > 0) left *= taken_ / expected_;
  return in_words(left);
}

int FigureRuns::run(const std::string& figure, const std::string& scene) {
  if (outcomes_.contains(scene)) return exit_code::done;
  plan({scene});
  const Planned& planned = planned_.at(scene);
  const Clock::time_point start = Clock::now();
  int code = exit_code::done;
  if (!planned.ended) {
    RunOptions run;
    run.scene = data_ + "/scenes/" + scene + ".json";
    run.folder = planned.folder;
    run.threads = threads_;
    run.quiet = true;
    run.resume = planned.begun && has_checkpoint(run.folder);
    run.overwrite = !run.resume;
    begin(scene);
    code = run_command(run);
    if (code == exit_code::interrupted) return interrupted();
  }
  const std::string& outcome = outcomes_[scene] = read_text(planned.folder + "/run.json");
  const std::string status = nlohmann::json::parse(outcome).at("status");
  unstable_ = unstable_ || status == "unstable";
  if (planned.ended) {
    keep(figure, scene, status);
  } else {
    end(figure, scene, status, seconds_since(start));
  }
  return code;
}

int FigureRuns::run(const std::string& figure, const FigureStudy& study, bool quick) {
  plan(study, quick);
  const Planned& planned = planned_.at(study.name);
  if (planned.over) return exit_code::done;
  // Sweeps see themselves whether their scenes have changed.
  const FigureStudy::Commands& commands = study.of(quick);
  const bool sweeps =
      std::ranges::all_of(commands, [](const auto& command) { return command[0] == "sweep"; });
  if (planned.ended && !sweeps) {
    keep(figure, study.name, "done");
    return exit_code::done;
  }
  const Clock::time_point start = Clock::now();
  if (!planned.begun) {
    std::error_code error;
    fs::remove_all(planned.folder, error);
    begin(study.name);
  }
  for (const std::vector<std::string>& command : commands) {
    std::vector<std::string> words = words_of(command, data_, planned.folder);
    words.insert(words.begin(), kProgramItself);
    const ProgramResult result = run_program(words);
    if (result.code == exit_code::interrupted || result.code == -SIGINT) return interrupted();
    if (result.code == exit_code::done) continue;
    fmt::print(stderr, "apothem: {}: {}: exit code {}\n{}", study.name, command_line(command),
               result.code, result.err);
    if (result.code != exit_code::missed) return exit_code::missed;
  }
  if (planned.ended) {
    keep(figure, study.name, "done");
  } else {
    end(figure, study.name, "done", seconds_since(start));
  }
  return exit_code::done;
}

}  // namespace apothem
