// apothem sweep: many runs of one scene with varied values, and their tables.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <thread>

#include "apps/commands.hpp"
#include "apps/process/status_line.hpp"
#include "apps/sweep/run_pool.hpp"
#include "lib/output/files.hpp"
#include "lib/scene/scene.hpp"
#include "lib/sweep/snakefile.hpp"
#include "lib/sweep/tables.hpp"
#include "lib/text/decimal.hpp"

namespace apothem {
namespace {

namespace fs = std::filesystem;

// Part `index` of `count`, from 1.
struct Shard {
  size_t index = 1, count = 1;
};

Shard shard_of(const std::string& text) {
  if (text.empty()) return {};
  const size_t slash = text.find('/');
  const auto index = find_count(text.substr(0, slash));
  const auto count = find_count(slash == std::string::npos ? "" : text.substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count) {
    throw UsageError(
        "--shard", fmt::format("\"{}\" is no part; write I/N with I from 1 to N, like 2/8", text));
  }
  return {static_cast<size_t>(*index), static_cast<size_t>(*count)};
}

std::optional<SurvivalChoice> survival_of(const std::string& text) {
  if (text.empty()) return {};
  const size_t colon = text.rfind(':');
  SurvivalChoice choice{text.substr(0, colon), ""};
  if (colon != std::string::npos) choice.event = text.substr(colon + 1);
  if (choice.measure.empty() || (colon != std::string::npos && choice.event.empty())) {
    throw UsageError("--survival",
                     fmt::format("\"{}\" names no measures; write MEASURE or MEASURE:EVENT, like "
                                 "discharged:jam",
                                 text));
  }
  return choice;
}

Plan plan_of(const SweepOptions& options) {
  VariationTable table;
  if (!options.table.empty()) table = read_variation_table(options.table);
  std::vector<Variation> variations;
  for (const std::string& text : options.vary)
    variations.push_back(parse_variation(text, "--vary"));
  return make_plan(table, variations);
}

void require_folder_of_run(const std::string& from) {
  std::error_code error;
  if (from.empty() || fs::is_directory(from, error)) return;
  const std::string folder = from.substr(0, from.rfind('@'));
  if (fs::is_directory(folder, error)) return;
  throw UsageError("--from", fmt::format("there is no folder \"{}\"; give that of a run", folder));
}

// What is wrong with the first run is wrong before any run has begun.
Study study_of(const SweepOptions& options) {
  require_folder_of_run(options.from);
  Plan plan = plan_of(options);
  StudySettings settings{options.scene, settings_of(options.set, options.scene), options.from,
                         options.folder};
  std::vector<Setting> first = settings.fixed;
  const std::vector<Setting>& varied = plan.runs.front().settings;
  first.insert(first.end(), varied.begin(), varied.end());
  const Scene scene = read_scene(options.scene, first);
  if (settings.folder.empty()) settings.folder = "out/" + scene.model.name + "-sweep";
  return {std::move(settings), std::move(plan)};
}

int jobs_of(const SweepOptions& options) {
  if (options.jobs > 0) return options.jobs;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::vector<const PlannedRun*> runs_of(const Plan& plan, const Shard& shard) {
  std::vector<const PlannedRun*> runs;
  for (size_t i = shard.index - 1; i < plan.runs.size(); i += shard.count) {
    runs.push_back(&plan.runs[i]);
  }
  return runs;
}

// `before`: the runs that were done before.
std::string progress_in_words(const RunPool::Progress& p, size_t before) {
  const size_t ended = p.ended + p.skipped, total = before + p.total;
  std::string text = fmt::format("{} of {} runs, {} running", before + ended, total, p.running);
  if (p.failed > 0) text += fmt::format(", {} failed", p.failed);
  if (p.ended > 0) {
    text += fmt::format(", {:.0f} s left", p.seconds / static_cast<double>(p.ended) *
                                               static_cast<double>(p.total - ended));
  }
  return text;
}

int list_runs(const Study& study, const std::vector<const PlannedRun*>& runs) {
  for (const PlannedRun* run : runs) {
    fmt::print("{:<11} {}\n", name_of(study.state_of(*run)), run->key);
  }
  return exit_code::done;
}

std::string absolute(const std::string& path) {
  return fs::absolute(path).lexically_normal().string();
}

int write_workflow(const Study& study, const SweepOptions& options) {
  survival_of(options.survival);  // throws if it cannot be read
  const StudySettings& settings = study.settings();
  WorkflowParts parts;
  parts.folder = absolute(settings.folder);
  if (parts.folder.find_first_of("{}") != std::string::npos) {
    throw UsageError("--output", fmt::format("\"{}\" has braces, which Snakemake takes for "
                                             "wildcards; choose another folder",
                                             parts.folder));
  }
  std::vector<std::string>& words = parts.command;
  words = {fs::read_symlink("/proc/self/exe").string(), "sweep", absolute(settings.scene)};
  parts.inputs.push_back(absolute(settings.scene));
  for (const std::string& text : options.vary) words.insert(words.end(), {"--vary", text});
  if (!options.table.empty()) {
    words.insert(words.end(), {"--table", absolute(options.table)});
    parts.inputs.push_back(absolute(options.table));
  }
  for (const Setting& s : settings.fixed) words.insert(words.end(), {"--set", s.text()});
  if (!settings.from.empty()) words.insert(words.end(), {"--from", absolute(settings.from)});
  if (!options.survival.empty()) words.insert(words.end(), {"--survival", options.survival});
  if (options.retry_failed) words.emplace_back("--retry-failed");
  words.insert(words.end(), {"--quiet", "-o", parts.folder});
  parts.jobs = std::max(1, options.jobs);
  // By default each part has four runs for each of its cores, as long as these are not too many.
  const size_t runs = study.plan().runs.size(), at_once = 4 * static_cast<size_t>(parts.jobs);
  parts.shards = options.shards > 0 ? static_cast<size_t>(options.shards)
                                    : std::min<size_t>((runs + at_once - 1) / at_once, 100);
  parts.shards = std::min(parts.shards, runs);
  create_folder(settings.folder);
  const std::string file = settings.folder + "/Snakefile";
  write_file(file, snakefile(parts));
  if (!options.quiet) {
    fmt::print("{} runs in {} parts: snakemake -s {} -j {}\n", runs, parts.shards, file,
               std::max(1u, std::thread::hardware_concurrency()));
  }
  return exit_code::done;
}

void print_failures(const Plan& plan, const std::vector<RunRecord>& records) {
  constexpr size_t kShown = 20;
  size_t failures = 0;
  for (size_t i = 0; i < records.size(); ++i) {
    if (!has_failed(records[i].state) || ++failures > kShown) continue;
    fmt::print(stderr, "apothem: {}: {}: {}\n", plan.runs[i].key, name_of(records[i].state),
               records[i].message);
  }
  if (failures > kShown) {
    fmt::print(stderr, "apothem: and {} more runs that have failed, see runs.csv\n",
               failures - kShown);
  }
  if (failures > 0) fmt::print(stderr, "apothem: --retry-failed repeats the runs that failed\n");
}

std::string counts_in_words(const std::map<RunState, size_t>& counts) {
  std::vector<std::string> parts;
  parts.reserve(counts.size());
  for (const auto& [state, count] : counts) {
    parts.push_back(fmt::format("{} {}", count, name_of(state)));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Does the runs of one part of a study, and makes the tables.
class Sweep {
 public:
  Sweep(const SweepOptions& options, const Study& study)
      : options_(options), study_(study), survival_(survival_of(options.survival)) {}

  int execute(const std::vector<const PlannedRun*>& runs) {
    const std::vector<const PlannedRun*> left = left_to_do(runs);
    RunPool pool(study_, jobs_of(options_), options_.retry_failed);
    StatusLine line;
    const bool whole = pool.work(left, [&](const RunPool::Progress& progress) {
      if (options_.quiet || !line.is_due()) return;
      line.show(progress_in_words(progress, runs.size() - left.size()));
    });
    line.clear();
    std::map<RunState, size_t> counts;
    for (const PlannedRun* run : runs) ++counts[study_.state_of(*run)];
    const bool all = runs.size() == study_.plan().runs.size();
    if (all || is_complete()) {
      make_tables();
    } else if (!options_.quiet) {
      fmt::print("part {}: {}; tables follow when all parts are there\n", options_.shard,
                 counts_in_words(counts));
    }
    if (!whole || counts.count(RunState::interrupted)) {
      fmt::print(stderr, "apothem: interrupted; the same command continues\n");
      return exit_code::interrupted;
    }
    const auto failed = [](const auto& count) { return has_failed(count.first); };
    return std::ranges::any_of(counts, failed) ? exit_code::missed : exit_code::done;
  }

  /// The tables of what there is. Returns 1 unless all runs are done.
  int collect() {
    const std::map<RunState, size_t> counts = make_tables();
    return counts.size() == 1 && counts.count(RunState::done) ? exit_code::done : exit_code::missed;
  }

 private:
  std::vector<const PlannedRun*> left_to_do(const std::vector<const PlannedRun*>& runs) {
    std::vector<const PlannedRun*> left;
    size_t changed = 0;
    for (const PlannedRun* run : runs) {
      const RunState state = study_.state_of(*run);
      if (state == RunState::done || (has_failed(state) && !options_.retry_failed)) continue;
      if (state == RunState::changed) ++changed;
      left.push_back(run);
    }
    if (changed > 0) {
      fmt::print(stderr,
                 "apothem: {} of {} runs are done anew, because the scene, its files or settings "
                 "have changed\n",
                 changed, runs.size());
    }
    return left;
  }

  [[nodiscard]] bool is_complete() const {
    const std::vector<PlannedRun>& runs = study_.plan().runs;
    return std::ranges::all_of(runs, [&](const PlannedRun& run) {
      const RunState state = study_.state_of(run);
      return state == RunState::done || has_failed(state);
    });
  }

  std::map<RunState, size_t> make_tables() {
    std::vector<RunRecord> records;
    records.reserve(study_.plan().runs.size());
    std::map<RunState, size_t> counts;
    for (const PlannedRun& run : study_.plan().runs) {
      records.push_back(read_record(study_, run));
      ++counts[records.back().state];
    }
    const std::optional<Plotted> plotted = write_tables(study_, records, survival_);
    print_failures(study_.plan(), records);
    if (plotted == Plotted::failed) {
      throw std::runtime_error("summary.png: gnuplot failed, see its message");
    }
    if (options_.quiet) return counts;
    fmt::print("{} runs: {}; tables in {}/runs.csv and summary.csv\n", records.size(),
               counts_in_words(counts), study_.settings().folder);
    if (plotted == Plotted::no_gnuplot) {
      fmt::print("no picture: install gnuplot-nox\n");
    }
    return counts;
  }

  const SweepOptions& options_;
  const Study& study_;
  std::optional<SurvivalChoice> survival_;
};

}  // namespace

int sweep_command(const SweepOptions& options) {
  const Shard shard = shard_of(options.shard);
  const Study study = study_of(options);
  if (!options.workflow.empty()) return write_workflow(study, options);
  const std::vector<const PlannedRun*> runs = runs_of(study.plan(), shard);
  if (options.dry_run) return list_runs(study, runs);
  Sweep sweep(options, study);
  return options.collect ? sweep.collect() : sweep.execute(runs);
}

}  // namespace apothem
