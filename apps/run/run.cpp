// apothem run: the terminal, the signals and the messages of a run.

#include "lib/run/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/commands.hpp"
#include "apps/process/signals.hpp"
#include "apps/process/status_line.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/output/files.hpp"
#include "lib/output/run_picture.hpp"
#include "lib/run/folder.hpp"
#include "lib/run/hash.hpp"
#include "lib/run/other_run.hpp"
#include "lib/run/summary.hpp"
#include "lib/system/clock.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

// How far a run has come; with a bar on a terminal.
std::string progress_of(const Run& run, double end, double seconds, bool bar) {
  const double time = run.state().time;
  const double share = std::min(time / end, 1.0);
  const std::string text = fmt::format(
      "t = {:.4g} of {:.4g} s ({:3.0f} %), {:.3g} steps/s, {} contacts, {:.0f} s left", time, end,
      100 * share, static_cast<double>(run.simulation().own_steps()) / seconds,
      run.simulation().counts().touching_now, share > 0 ? seconds * (1 - share) / share : 0);
  constexpr int kWidth = 24;
  const int full = static_cast<int>(kWidth * share);
  return bar ? fmt::format("[{:#<{}}{:.<{}}] {}", "", full, "", kWidth - full, text) : text;
}

void print_load_step(const Run& run) {
  const LoadStep& step = run.load_steps().back();
  const TimeSettings& time = run.scene().time;
  const std::string of = time.automatic_load_steps ? fmt::format("to t = {:.6g} s", step.time)
                                                   : fmt::format("of {}", time.load_steps);
  fmt::print(stderr, "load step {} {}: {} {}, residual {:.2g}, sum of forces {:.2g} on \"{}\"\n",
             run.state().step, of, step.iterations,
             step.relaxed ? "steps of relaxation" : "iterations", step.residual, step.imbalance,
             run.scene().model.name_of(step.worst));
}

// What ended the run before its time, and bodies that have come or left.
void print_ends(const Run& run) {
  if (run.stopped_by() == kStoppedOutside) {
    fmt::print("stopped at t = {:.6g} s: a body left the world\n", run.state().time);
  } else if (!run.stopped_by().empty() && run.stopped_by() != kStoppedCollapse) {
    fmt::print("stopped at t = {:.6g} s by the rule \"{}\"\n", run.state().time, run.stopped_by());
  }
  const Population* population = run.simulation().population();
  if (!population) return;
  const auto say = [](std::int64_t bodies, const char* what) {
    if (bodies > 0) fmt::print("{} {} {}\n", bodies, bodies == 1 ? "body" : "bodies", what);
  };
  say(population->come(), "came in");
  say(population->left(), "left the world");
}

// The error of the energy. Load steps of a static run give off energy, so that they have none.
std::string error_of(const Run& run) {
  if (run.scene().time.statics) return "";
  const Extremes extremes = run.simulation().extremes();
  const double share = extremes.energy_error / extremes.energy_in_play;
  return fmt::format(
      ", energy error {:.3g} J{}", extremes.energy_error,
      std::isfinite(share) ? fmt::format(", {:.1g} of the energy in play", share) : "");
}

std::string window_of(const Reduction& of) {
  std::string text;
  if (of.from) text += fmt::format(" from t = {:g} s", *of.from);
  if (of.until) text += fmt::format(" until t = {:g} s", *of.until);
  return text;
}

void print_outcome(const Expectation& e, const Outcome& outcome) {
  const std::string unit = e.unit.empty() || e.unit == "1" ? "" : " " + e.unit;
  fmt::print("  {} {} {}{} = {:.10g}{}, expected {:.10g} +- {:.2g}{}{}\n",
             outcome.met ? "ok    " : "MISSED", kTakesInWords[static_cast<size_t>(e.take)],
             e.quantity, window_of(e), outcome.value, unit, e.value, e.tolerance, unit,
             e.label.empty() ? "" : ": " + e.label);
}

void print_summary(const Run& run) {
  const State& state = run.state();
  const Scene& scene = run.scene();
  const Extremes extremes = run.simulation().extremes();
  const StepChanges& changes = run.simulation().step_changes();
  const bool changed = changes.shortened + changes.lengthened > 0;
  fmt::print("{}: {} {}{} of {:.6g} s, t = {:.6g} s, results in {}\n", scene.model.name, state.step,
             scene.time.statics ? "load steps" : "steps", changed ? ", the last one" : "",
             run.simulation().step_size(), state.time, run.settings().folder);
  print_ends(run);
  if (!run.beginning().folder.empty()) {
    const std::vector<std::string> others = not_moved(scene.model, run.beginning());
    fmt::print("began with {} bodies of {} at t = {:.6g} s{}\n", run.beginning().bodies.size(),
               run.beginning().folder, run.beginning().time,
               others.empty() ? "" : fmt::format("; as in the scene: {}", fmt::join(others, ", ")));
  }
  if (changes.shortened > 0) {
    const StepChange& first = changes.first.front();
    fmt::print(
        "step shortened {} times, first at t = {:.6g} s by the contacts of \"{}\", and lengthened "
        "{} times; shortest {:.6g} s\n",
        changes.shortened, first.time, scene.model.name_of(first.body), changes.lengthened,
        changes.shortest);
  }
  const ContactLaw& law = scene.model.contact;
  fmt::print("largest penetration {:.9g} m ({:.3g} % of an inradius{}), contact force {:.9g} N{}\n",
             extremes.penetration.value, 100 * extremes.relative_penetration.value,
             law.penetration ? fmt::format(" with k_n = {:g} Pa", law.normal_stiffness) : "",
             extremes.force.value, error_of(run));
  if (!run.load_steps().empty()) {
    const LoadStep& last = run.load_steps().back();
    const auto worst =
        static_cast<BodyIndex>(std::ranges::max_element(last.off) - last.off.begin());
    fmt::print(
        "force balance: of all bodies \"{}\" is farthest from it, by {:.3g} N, {:.2g} of the "
        "load\n",
        scene.model.name_of(worst), last.off[worst],
        imbalance_of_load(last, static_cast<size_t>(worst)));
  }
  for (size_t i = 0; i < run.outcomes().size(); ++i) {
    print_outcome(scene.expectations[i], run.outcomes()[i]);
  }
}

// Time that another scheme would probably have saved, where it is worth a word.
void print_saving(const Run& run) {
  constexpr double kMostly = .5, kWorth = .5;  // s
  const double share = run.quiet_share().value_or(0);
  const double saved = share * (run.seconds() - run.output_seconds());
  if (run.status() != Run::Status::done || share < kMostly || saved < kWorth) return;
  fmt::print(
      "at rest, or nearly, in {:.0f} % of the steps: with \"scheme\": \"auto\" in \"time\" the run "
      "would have taken about {:.2g} s less, see docs/how-to/rest.md\n",
      100 * share, saved);
}

// Those from number `first` on. Returns how many there are.
size_t print_warnings(const Run& run, size_t first) {
  for (size_t i = first; i < run.warnings().size(); ++i) {
    fmt::print(stderr, "apothem: warning: {}\n", run.warnings()[i]);
  }
  return run.warnings().size();
}

int exit_code_of(const Run& run, bool verify) {
  switch (run.status()) {
    case Run::Status::unstable:
      return exit_code::unstable;
    case Run::Status::interrupted:
      return exit_code::interrupted;
    default:
      break;
  }
  if (run.collapse() && !run.seeks_collapse()) return exit_code::unstable;
  const auto missed = [](const Outcome& o) { return !o.met; };
  return verify && std::ranges::any_of(run.outcomes(), missed) ? exit_code::missed
                                                               : exit_code::done;
}

// What run.json holds, and where it is.
void print_json(const Run& run) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(summary_text(run));
  json["message"] = run.message();
  json["folder"] = run.settings().folder;
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

constexpr const char* kPicture = "picture.png";

// The results stand without a picture, too. False if the system has failed.
bool draw_end(const std::string& folder, bool quiet) {
  const std::string file = folder + "/" + kPicture;
  try {
    const RunFolder results(folder);
    write_file(file, draw_fields(picture_of(results, {strip(results, 1)}), PictureFormat::png));
    if (!quiet) fmt::print("picture of the end: {}\n", file);
  } catch (const ResultsError& error) {
    fmt::print(stderr, "apothem: no picture: {}\n", error.what());
  } catch (const std::exception& error) {
    fmt::print(stderr, "apothem: no picture: {}\n", error.what());
    return false;
  }
  return true;
}

std::string folder_of(const RunOptions& options, const Scene& scene) {
  return options.folder.empty() ? "out/" + scene.model.name : options.folder;
}

// Of the run that has left a state in the folder.
std::vector<Setting> settings_in(const std::string& folder) {
  StateOrigin origin;
  const std::string final = state_file(folder, StateFile::final);
  if (has_checkpoint(folder)) {
    use_checkpoint(folder, [&](const std::string& file) { origin = origin_of(file); });
  } else if (file_exists(final)) {
    origin = origin_of(final);
  }
  return origin.settings;
}

// A run that goes on keeps the settings it was started with, unless they are given again.
Scene scene_of(const RunOptions& options) {
  Scene scene = read_scene(options.scene, settings_of(options.set, options.scene));
  if (!options.resume || !options.set.empty()) return scene;
  const std::vector<Setting> before = settings_in(folder_of(options, scene));
  return before.empty() ? scene : read_scene(options.scene, before);
}

// --resume goes on, or begins where there is nothing to go on from: the same command can be given
// again and again until the run has ended. What is no part of this run stays, and is an error.
void choose_start(Found found, RunSettings& settings) {
  settings.resume = found == Found::checkpoint || found == Found::other;
  settings.overwrite = found == Found::broken_off;
}

// A run that had ended before this call.
int report_ended(const RunOptions& options, const std::string& folder) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(read_text(folder + "/run.json"));
  if (options.json) {
    json["message"] = "";
    json["folder"] = folder;
    fmt::print("{}\n", json.dump(2));
  } else if (!options.quiet) {
    fmt::print("the run has ended before, results in {}\n", folder);
  }
  std::fflush(stdout);
  int code = exit_code::done;
  for (const auto& expectation : json["expectations"]) {
    if (options.verify && !expectation.value("met", false)) code = exit_code::missed;
  }
  const bool drawn = file_exists(folder + "/" + kPicture);
  if (options.picture && !drawn && !draw_end(folder, options.quiet || options.json)) {
    return exit_code::system_failed;
  }
  return code;
}

// --from DIR, or DIR@TIME if there is no folder of that name.
void read_from(const std::string& text, RunSettings& settings) {
  settings.from = text;
  const size_t at = text.rfind('@');
  std::error_code error;
  if (at == std::string::npos || std::filesystem::is_directory(text, error)) return;
  try {
    settings.from_time = parse_decimal(text.substr(at + 1));
  } catch (const BadNumber& bad) {
    throw UsageError("--from", fmt::format("the time behind @: {}", bad.what()));
  }
  settings.from.resize(at);
}

}  // namespace

std::vector<Setting> settings_of(const std::vector<std::string>& texts, const std::string& scene) {
  std::vector<Setting> settings;
  settings.reserve(texts.size());
  for (const std::string& text : texts) settings.push_back(parse_setting(text, scene));
  return settings;
}

int run_command(const RunOptions& options) {
  Scene scene = scene_of(options);
  RunSettings settings{folder_of(options, scene), options.threads, options.resume,
                       options.overwrite};
  if (!options.from.empty()) read_from(options.from, settings);
  if (options.picture) settings.other_files = {kPicture};
  if (options.resume) {
    const Found found = look_into(settings.folder, scene_hash(scene));
    if (found == Found::ended) return report_ended(options, settings.folder);
    choose_start(found, settings);
  }
  Finishing signals;  // Ctrl-C asks the run to finish its step
  settings.stop_if = [&] { return signals.asked(); };
  Run run(std::move(scene), settings);
  const double end = std::min(options.until.value_or(run.scene().time.end), run.scene().time.end);
  const Clock::time_point start = Clock::now();
  StatusLine line;
  if (!options.quiet) {
    run.on_progress([&](const Run& now) {
      if (now.scene().time.statics) {
        print_load_step(now);
      } else if (line.is_due()) {
        line.show(progress_of(now, end, seconds_since(start), line.on_terminal()));
      }
    });
  }
  if (!options.quiet && !options.json && !settings.resume) {
    const std::string overlaps = describe_overlaps(run.simulation());
    if (!overlaps.empty()) fmt::print(stderr, "overlaps at the start: {}\n", overlaps);
  }
  if (settings.resume && options.until && run.state().time >= *options.until) {
    fmt::print(stderr, "apothem: --until {:g} s: the run in {} is already at t = {:.9g} s\n",
               *options.until, settings.folder, run.state().time);
  }
  const size_t known = options.json ? 0 : print_warnings(run, 0);
  try {
    run.advance(options.until);
  } catch (const Unstable&) {
    // Its status and message say so.
  }
  signals.take_time();
  run.finish();
  line.clear();
  if (!run.message().empty()) {
    fmt::print(stderr, "apothem: {}: {}\n", run.scene().file, run.message());
  }
  if (options.json) {
    print_json(run);
  } else if (!options.quiet) {
    print_summary(run);
    print_saving(run);
  }
  std::fflush(stdout);
  if (!options.json) print_warnings(run, known);
  const int code = exit_code_of(run, options.verify);
  if (!options.picture || draw_end(settings.folder, options.quiet || options.json)) return code;
  return code == exit_code::done ? exit_code::system_failed : code;
}

}  // namespace apothem
