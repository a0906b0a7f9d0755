// apothem run: joins scene, simulation and output; the loop over the steps.

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apothem/output/files.hpp"
#include "apothem/output/frames.hpp"
#include "apothem/output/history.hpp"
#include "checkpoint.hpp"
#include "commands.hpp"
#include "plan.hpp"
#include "version.hpp"

namespace apothem {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

volatile std::sig_atomic_t interrupted = 0;

// Ctrl-C asks the loop to finish its step.
void install_signal_handlers() {
  struct sigaction action = {};
  action.sa_handler = [](int) { interrupted = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::uint64_t fnv1a(const void* data, size_t size, std::uint64_t hash = 0xcbf29ce484222325U) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3U;
  return hash;
}

// The scene as read, with the polygons and meshes that stand in files of their own.
std::string scene_hash(const Scene& scene) {
  std::uint64_t hash = fnv1a(scene.text.data(), scene.text.size());
  for (const RigidBody& body : scene.model.bodies) {
    for (const Vec2& v : body.potential.vertices) hash = fnv1a(v.data(), 2 * sizeof(double), hash);
  }
  for (const DeformableBody& body : scene.model.deformables) {
    for (const Vec2& v : body.mesh.nodes) hash = fnv1a(v.data(), 2 * sizeof(double), hash);
  }
  return fmt::format("fnv1a64:{:016x}", hash);
}

// The bits of the final state: equal for any number of threads.
std::string state_hash(const State& state) {
  std::uint64_t hash = fnv1a(&state.time, sizeof state.time);
  for (const std::vector<double>* v :
       {&state.position, &state.velocity, &state.force, &state.displacement, &state.node_velocity,
        &state.node_force}) {
    hash = fnv1a(v->data(), v->size() * sizeof(double), hash);
  }
  return fmt::format("fnv1a64:{:016x}", hash);
}

// A folder with results in it is never touched unless the user says so, and then only our files.
void prepare_folder(const std::string& folder, bool overwrite) {
  namespace fs = std::filesystem;
  constexpr std::array ours{"run.json",    "frames.pvd", "contacts.pvd", "surfaces.pvd",
                            "history.csv", "energy.csv", "momentum.csv", "checkpoint.json"};
  std::vector<fs::path> old;
  std::error_code error;
  for (const char* name : ours) {
    if (fs::exists(fs::path(folder) / name, error)) old.push_back(fs::path(folder) / name);
  }
  if (!old.empty() && !overwrite) {
    throw SceneError(
        folder, 0, "",
        fmt::format("already holds results ({}); give --overwrite, or another folder with -o",
                    old.front().filename().string()));
  }
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "frames", error)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".vtu") && (name.starts_with("bodies_") || name.starts_with("contacts_") ||
                                   name.starts_with("surfaces_"))) {
      old.push_back(entry.path());
    }
  }
  for (const fs::path& path : old) {
    fs::remove(path, error);
    if (error) throw SystemFailure(path.string(), error.value());
  }
  create_folder(folder);
}

// One line on a terminal, redrawn; a plain line every few seconds elsewhere.
class Progress {
 public:
  Progress(bool on, double end)
      : on_(on),
        terminal_(isatty(STDERR_FILENO) != 0),
        end_(end),
        start_(Clock::now()),
        last_(start_) {}

  void update(const Simulation& simulation) {
    if (!on_) return;
    const Clock::time_point now = Clock::now();
    if (now - last_ <
        (terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(5000))) {
      return;
    }
    last_ = now;
    const State& state = simulation.state();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double share = std::min(state.time / end_, 1.0);
    const std::string text = fmt::format(
        "t = {:.4g} of {:.4g} s ({:3.0f} %), {:.3g} steps/s, {} contacts, {:.0f} s left",
        state.time, end_, 100 * share, static_cast<double>(simulation.own_steps()) / seconds,
        simulation.counts().touching_now, share > 0 ? seconds * (1 - share) / share : 0);
    if (!terminal_) {
      fmt::print(stderr, "{}\n", text);
      return;
    }
    constexpr int kWidth = 24;
    const int full = static_cast<int>(kWidth * share);
    fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {}", "", full, "", kWidth - full, text);
    std::fflush(stderr);
    drawn_ = true;
  }

  void clear() const {
    if (drawn_) fmt::print(stderr, "\r\033[K");
  }

 private:
  bool on_;
  bool terminal_;
  bool drawn_ = false;
  double end_;
  Clock::time_point start_;
  Clock::time_point last_;
};

// Says when the next record is due; a record falls on the first step at or after its time.
class Schedule {
 public:
  Schedule(double interval, std::int64_t next) : interval_(interval), next_(next) {}
  [[nodiscard]] std::int64_t next() const { return next_; }
  bool due(double time, double step) {
    if (!(time >= static_cast<double>(next_) * interval_ - 1e-6 * step)) return false;
    next_ = static_cast<std::int64_t>(std::floor(time / interval_ + 1e-6)) + 1;
    return true;
  }

 private:
  double interval_;
  std::int64_t next_;
};

class Run {
 public:
  Run(const RunOptions& options, const Scene& scene)
      : options_(options),
        scene_(scene),
        simulation_(make_simulation(scene, options.threads,
                                    options.resume ? Start::snapshot : Start::scene)),
        end_(std::min(options.until.value_or(scene.time.end), scene.time.end)),
        folder_(options.folder.empty() ? "out/" + scene.model.name : options.folder),
        scene_hash_(scene_hash(scene)) {}

  int execute() {
    Checkpoint from;
    if (options_.resume) {
      from = read_checkpoint(folder_, scene_hash_, simulation_.snapshot());
      simulation_.restore(from.snapshot);
    } else {
      prepare_folder(folder_, options_.overwrite);
    }
    start_ = Clock::now();
    int code = exit_code::done;
    try {
      HistoryWriter history(folder_, scene_.model, scene_.output, from.history_sizes);
      FrameWriter frames(folder_, scene_.model, from.frame_times);
      code = scene_.time.statics ? load_steps(history, frames, from) : loop(history, frames, from);
    } catch (const Unstable& error) {
      code = exit_code::unstable;
      status_ = "unstable";
      message_ = error.what();
    } catch (const SystemFailure& error) {
      status_ = "failed";
      message_ = error.what();
      try {
        write_summary();
      } catch (const SystemFailure&) {
        // The message below is about the first failure.
      }
      throw;
    }
    if (code == exit_code::done) judge();
    write_summary();
    if (!message_.empty()) fmt::print(stderr, "apothem: {}: {}\n", scene_.file, message_);
    if (!options_.quiet) print_summary();
    return code == exit_code::done && options_.verify && missed_ > 0 ? exit_code::missed : code;
  }

 private:
  void write(HistoryWriter& history, bool row, FrameWriter& frames, bool picture) {
    const Clock::time_point before = Clock::now();
    if (row) {
      history.add(simulation_.state(), simulation_.energies(), simulation_.momenta(),
                  {simulation_.friction(), simulation_.deformable_forces(), simulation_.node_mass(),
                   simulation_.stresses(scene_.output.points),
                   scene_.output.track_surfaces.empty() ? std::vector<SurfaceRecord>{}
                                                        : simulation_.surfaces()});
    }
    if (picture) {
      history.flush();
      frames.write(simulation_.state(), simulation_.contacts(), simulation_.stresses(),
                   simulation_.surfaces());
    }
    output_seconds_ += std::chrono::duration<double>(Clock::now() - before).count();
  }

  int load_steps(HistoryWriter& history, FrameWriter& frames, const Checkpoint& from) {
    const std::int64_t count = scene_.time.load_steps;
    load_steps_ = from.load_steps;
    if (!options_.resume) write(history, true, frames, true);
    const auto time_of = [&](std::int64_t i) {
      return i < count ? scene_.time.end * static_cast<double>(i) / static_cast<double>(count)
                       : scene_.time.end;
    };
    const auto next = [&] { return simulation_.state().step + 1; };
    const auto left = [&] { return next() <= count && time_of(next()) <= end_ * (1 + 1e-12); };
    while (left()) {
      const LoadStep step = simulation_.balance(time_of(next()), [] { return interrupted != 0; });
      if (!step.complete) break;
      load_steps_.push_back(step);
      write(history, true, frames, true);
      if (options_.quiet) continue;
      fmt::print(stderr,
                 "load step {} of {}: {} steps of relaxation, residual {:.2g}, sum of forces "
                 "{:.2g} on \"{}\"\n",
                 simulation_.state().step, count, step.iterations, step.residual, step.imbalance,
                 scene_.model.deformables[step.worst].name);
    }
    history.flush();
    if (next() > count) {
      remove_checkpoint(folder_);
    } else {
      checkpoint(history, frames, 1, 1);
    }
    return ended(!left());
  }

  int loop(HistoryWriter& history, FrameWriter& frames, const Checkpoint& from) {
    Progress progress(!options_.quiet, end_);
    Schedule rows(scene_.output.history_interval.value_or(scene_.time.end / 1000), from.next_row);
    Schedule pictures(scene_.time.end / std::max(scene_.output.frames, 1), from.next_frame);
    std::int64_t last_row = -1, last_picture = -1;  // steps
    const auto record = [&](bool row, bool picture) {
      row = row && last_row != simulation_.state().step;
      picture = picture && last_picture != simulation_.state().step;
      if (row) last_row = simulation_.state().step;
      if (picture) last_picture = simulation_.state().step;
      if (row || picture) write(history, row, frames, picture);
    };
    const auto save = [&] { checkpoint(history, frames, rows.next(), pictures.next()); };
    const auto reached = [&](double time) {
      return simulation_.state().time >= time - 1e-6 * simulation_.step_size();
    };
    Clock::time_point last_checkpoint = Clock::now();
    if (!options_.resume) record(true, true);
    try {
      while (!reached(end_) && !interrupted) {
        simulation_.step();
        const State& state = simulation_.state();
        const double step = simulation_.step_size();
        const bool last = reached(scene_.time.end);
        record(rows.due(state.time, step) || last,
               (pictures.due(state.time, step) && scene_.output.frames > 0) || last);
        if (state.step % 64 != 0) continue;
        progress.update(simulation_);
        const std::optional<double>& interval = scene_.output.checkpoint_interval;
        if (interval && Clock::now() - last_checkpoint > std::chrono::duration<double>(*interval)) {
          save();
          last_checkpoint = Clock::now();
        }
      }
      progress.clear();
      history.flush();
      if (reached(scene_.time.end)) {
        remove_checkpoint(folder_);
      } else {
        save();
        record(true, true);  // shows where the run stopped; a resumed run takes it back
        history.flush();
      }
    } catch (const Unstable&) {
      progress.clear();
      history.flush();
      throw;
    }
    return ended(reached(end_));
  }

  void checkpoint(HistoryWriter& history, const FrameWriter& frames, std::int64_t next_row,
                  std::int64_t next_frame) {
    history.flush();
    write_checkpoint(folder_, {scene_hash_, simulation_.snapshot(), history.sizes(), frames.times(),
                               next_row, next_frame, load_steps_});
  }

  int ended(bool all_done) {
    if (all_done) {
      status_ = "done";
      return exit_code::done;
    }
    status_ = "interrupted";
    message_ =
        fmt::format("interrupted at t = {:.9g} s; all files are complete, --resume continues",
                    simulation_.state().time);
    return exit_code::interrupted;
  }

  void judge() {
    for (const Expectation& expectation : scene_.expectations) {
      // A run that was cut short cannot be held to what lies behind its end.
      if (end_ < scene_.time.end) break;
      try {
        outcomes_.push_back(evaluate(expectation, folder_));
      } catch (const std::runtime_error&) {  // no row in its window
        outcomes_.push_back({std::nan(""), false});
      }
      missed_ += !outcomes_.back().met;
    }
  }

  [[nodiscard]] std::vector<std::string> names(const Peak& peak) const {
    if (peak.a < 0) return {};
    return {scene_.model.name_of(peak.a), scene_.model.name_of(peak.b)};
  }

  void write_summary() {
    const Counts& counts = simulation_.counts();
    const Extremes& extremes = simulation_.extremes();
    const State& state = simulation_.state();
    const double steps = std::max(static_cast<double>(state.step), 1.0);
    const double wall = std::chrono::duration<double>(Clock::now() - start_).count();
    Json parts;
    const auto seconds = simulation_.phase_seconds();
    for (size_t i = 0; i < seconds.size(); ++i) parts[kPhaseNames[i]] = seconds[i];
    parts["output"] = output_seconds_;
    parts["total"] = wall;
    const auto peak = [&](const Peak& p) { return Json{{"time", p.time}, {"bodies", names(p)}}; };
    Json json{{"name", scene_.model.name},
              {"scene", scene_.file},
              {"scene_hash", scene_hash_},
              {"version", kVersion},
              {"status", status_},
              {"threads", options_.threads},
              {"time", state.time},
              {"steps", state.step},
              {"dt", simulation_.step_size()},
              {"dt_limited_by",
               scene_.time.fixed_step ? "time.step of the scene" : simulation_.limit().reason},
              {"stability_limit", simulation_.stability_limit()},
              {"steps_per_second", static_cast<double>(simulation_.own_steps()) / wall},
              {"wall_time", parts},
              {"pairs_per_step",
               {{"candidates", static_cast<double>(counts.candidate_pairs) / steps},
                {"touching", static_cast<double>(counts.touching_pairs) / steps}}},
              {"searches", counts.searches},
              {"largest_penetration", extremes.penetration.value},
              {"largest_penetration_at", peak(extremes.penetration)},
              {"largest_contact_force", extremes.force.value},
              {"largest_contact_force_at", peak(extremes.force)},
              {"largest_energy_error", extremes.energy_error},
              {"final_state_hash", state_hash(state)}};
    if (scene_.time.statics) {
      json.erase("steps_per_second");
      json["stability_limit"] = nullptr;
      Json& found = json["load_steps"] = Json::array();
      for (const LoadStep& s : load_steps_) {
        found.push_back({{"time", s.time},
                         {"iterations", s.iterations},
                         {"residual", s.residual},
                         {"imbalance", s.imbalance},
                         {"of", scene_.model.deformables[s.worst].name}});
      }
      Json& balance = json["balance"] = Json::array();
      if (!load_steps_.empty()) {
        const LoadStep& last = load_steps_.back();
        for (size_t i = 0; i < last.off.size(); ++i) {
          balance.push_back({{"body", scene_.model.deformables[i].name},
                             {"force", last.off[i]},
                             {"of_load", of_load(last, i)}});
        }
      }
    }
    if (!message_.empty()) json["message"] = message_;
    Json& list = json["expectations"] = Json::array();
    for (size_t i = 0; i < outcomes_.size(); ++i) {
      const Expectation& e = scene_.expectations[i];
      list.push_back({{"label", e.label},
                      {"quantity", e.quantity},
                      {"take", kTakes[static_cast<size_t>(e.take)]},
                      {"expected", e.value},
                      {"tolerance", e.tolerance},
                      {"value", outcomes_[i].value},
                      {"met", outcomes_[i].met}});
    }
    // JSON knows no infinity: where nothing limits the step, the limit is null.
    write_file(folder_ + "/run.json",
               json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  }

  static double of_load(const LoadStep& step, size_t body) {
    return step.load > 0 ? step.off[body] / step.load : 0;
  }

  void print_summary() const {
    const State& state = simulation_.state();
    const Extremes& extremes = simulation_.extremes();
    fmt::print("{}: {} {} of {:.6g} s, t = {:.6g} s, results in {}\n", scene_.model.name,
               state.step, scene_.time.statics ? "load steps" : "steps", simulation_.step_size(),
               state.time, folder_);
    fmt::print("largest penetration {:.9g} m, contact force {:.9g} N, energy error {:.3g} J\n",
               extremes.penetration.value, extremes.force.value, extremes.energy_error);
    if (!load_steps_.empty()) {
      const LoadStep& last = load_steps_.back();
      const auto worst = static_cast<size_t>(std::max_element(last.off.begin(), last.off.end()) -
                                             last.off.begin());
      fmt::print(
          "force balance: of all bodies \"{}\" is farthest from it, by {:.3g} N, {:.2g} of the "
          "load\n",
          scene_.model.deformables[worst].name, last.off[worst], of_load(last, worst));
    }
    for (size_t i = 0; i < outcomes_.size(); ++i) {
      const Expectation& e = scene_.expectations[i];
      fmt::print("  {} {:<24} {:>18.10g}   expected {:.10g} +- {:.2g}\n",
                 outcomes_[i].met ? "ok    " : "MISSED", e.quantity, outcomes_[i].value, e.value,
                 e.tolerance);
    }
  }

  const RunOptions& options_;
  const Scene& scene_;
  Simulation simulation_;
  double end_;
  std::string folder_;
  std::string scene_hash_;
  Clock::time_point start_;
  double output_seconds_ = 0;
  std::string status_ = "running";
  std::string message_;
  std::vector<LoadStep> load_steps_;
  std::vector<Outcome> outcomes_;
  int missed_ = 0;
};

}  // namespace

int run_command(const RunOptions& options) {
  install_signal_handlers();
  const Scene scene = read_scene(options.scene);
  return Run(options, scene).execute();
}

}  // namespace apothem
