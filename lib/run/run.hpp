// A scene that runs: model, simulation, schedule, outputs and checkpoint in one object.
//
//   Run run(read_scene("scene.json"), {.folder = "out/scene"});
//   run.run();
//
// The program, the tests, `apothem reproduce` and programs of a user's own drive this object.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/dynamics/quiet_motion.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/output/file_list.hpp"
#include "lib/output/frames.hpp"
#include "lib/output/history.hpp"
#include "lib/run/applied_force.hpp"
#include "lib/run/checkpoint.hpp"
#include "lib/run/collapse.hpp"
#include "lib/run/start.hpp"
#include "lib/run/stop_watch.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {

struct RunSettings {
  std::string folder = {};  ///< of the results; empty: no files are written
  int threads = 1;
  bool resume = false;     ///< continue from the checkpoint of the folder, which must be there
  bool overwrite = false;  ///< results of an earlier run in the folder may be replaced
  /// Folder of another run whose last state bodies of the same name and shape begin with; empty:
  /// none. With `resume` the run must have begun there.
  std::string from = {};
  std::optional<double> from_time = {};  ///< s; the time that this state must have
  /// File of Run::save() to go on from; empty: none. It goes without `resume` and `from`. Results
  /// in the folder begin there.
  std::string saved = {};
  /// Asked after every step, within load steps, and while bodies settle at the start: true stops
  /// the run, which can go on later.
  std::function<bool()> stop_if = {};
  /// Names of files that the caller is going to write to the folder, besides those of the run.
  std::vector<std::string> other_files = {};
};

/// Says when the next record is due; a record falls on the first step at or after its time.
class Schedule {
 public:
  explicit Schedule(double interval = 0, std::int64_t next = 1)
      : interval_(interval), next_(next) {}
  [[nodiscard]] std::int64_t next() const { return next_; }
  /// Of the next record, s.
  [[nodiscard]] double time() const { return static_cast<double>(next_) * interval_; }
  /// `time` and step size in s.
  bool due(double time, double step);

 private:
  double interval_;
  std::int64_t next_;
};

class Run {
 public:
  enum class Status { running, done, interrupted, unstable, failed };

  /// Throws SceneError if the scene cannot be run, if the folder holds results or no checkpoint
  /// against the settings, or if there is no other run to begin with; SystemFailure if files cannot
  /// be written; Stopped if stop_if says so while bodies settle. No other process may write to the
  /// folder from here to finish().
  Run(Scene scene, const RunSettings& settings);
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Adds a force of the user's own, before the first step: see AppliedForce. `name`: what it is in
  /// words. A run that goes on from a file needs the forces of the same names again before it
  /// steps. Throws std::logic_error after the first step.
  void add_force(const std::string& name, AppliedForce::Function function);

  /// One step, or load step, with the records that are due after it. False, without a step, if the
  /// run is at its end, has been stopped by a rule of the scene, or was asked to stop during a load
  /// step, which the next call goes on with. Throws Unstable and SystemFailure.
  bool step();
  /// Steps until a time in s, by default the end of the scene, until it is asked to stop, or until
  /// a rule of the scene stops the run. Files stay open. Throws Unstable and SystemFailure.
  void advance(std::optional<double> until = {});
  /// Closes a run as run() does.
  Status finish();
  /// Closes a run that cannot go on for a reason from outside, with that reason in run.json.
  void fail(std::string message);
  /// Advances, or until the run becomes unstable; then closes the run: files are complete, a run
  /// that is not at its end leaves a checkpoint, and at its end the expectations of the scene are
  /// judged. Throws SystemFailure.
  Status run(std::optional<double> until = {});
  /// Called after every step; its exceptions are passed on and do no harm.
  void on_step(std::function<void()> call) { on_step_ = std::move(call); }
  /// Called every so many steps, and after every load step.
  void on_progress(std::function<void(const Run&)> call) { on_progress_ = std::move(call); }

  /// Writes all that it takes to go on from here bit for bit, the scene included, to a file. Forces
  /// of add_force() have to be added again. Throws SystemFailure; an older file is then intact.
  void save(const std::string& file);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] const RunSettings& settings() const { return settings_; }
  /// Where the bodies have begun.
  [[nodiscard]] const Beginning& beginning() const { return progress_.beginning; }
  [[nodiscard]] const std::string& hash_of_scene() const { return scene_hash_; }
  [[nodiscard]] Simulation& simulation() { return *simulation_; }
  [[nodiscard]] const Simulation& simulation() const { return *simulation_; }
  [[nodiscard]] const State& state() const { return simulation_->state(); }
  [[nodiscard]] Status status() const { return status_; }
  /// The rule of the scene that has ended the run before its time, or empty.
  [[nodiscard]] const std::string& stopped_by() const { return stopped_by_; }
  /// At its end, or stopped by a rule of the scene for good.
  [[nodiscard]] bool ended() const;
  /// Why the run has stopped; empty if it is done.
  [[nodiscard]] const std::string& message() const { return message_; }
  /// Reasons to doubt the results, as whole sentences: those of warn(), and at the end of run()
  /// what it has found itself, unless it is unstable (warnings.hpp). They stand in run.json.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  void warn(std::string sentence) { warnings_.push_back(std::move(sentence)); }
  /// The share of a run by velocity Verlet in which the scheme "auto" would probably have taken
  /// implicit steps (QuietMotion); nothing if the scene does not go with it.
  [[nodiscard]] std::optional<double> quiet_share() const;
  [[nodiscard]] const std::vector<LoadStep>& load_steps() const { return progress_.load_steps; }
  /// Of a static run whose loads could not be carried any more; else null.
  [[nodiscard]] const Collapse* collapse() const { return collapse_ ? &*collapse_ : nullptr; }
  /// Of scenes with rigid bodies in the limit; else without passes.
  [[nodiscard]] const RigidLimit& rigid_limit() const { return progress_.rigid; }
  /// Whether the scene asks for the load factor of its collapse, which is then a result.
  [[nodiscard]] bool seeks_collapse() const;
  /// One for each expectation of the scene, after a run to its end.
  [[nodiscard]] const std::vector<Outcome>& outcomes() const { return outcomes_; }
  /// One for each measure of the scene, after a run to its end; not finite where its window holds
  /// no row. Of a measure that asks what has stopped the run: 1 or 0.
  [[nodiscard]] const std::vector<double>& measures() const { return measures_; }
  /// Seconds of wall clock: in all, and for output.
  [[nodiscard]] double seconds() const;
  [[nodiscard]] double output_seconds() const { return output_seconds_; }
  /// Seconds of processors that this process has used since the run began.
  [[nodiscard]] double processor_seconds() const;

 private:
  HistoryWriter::Parts start();
  HistoryWriter::Parts resume();
  void prepare();
  void stiffen();
  void refuse_other_beginning() const;
  [[nodiscard]] bool reached(double time) const;
  void require_forces() const;
  void loop(double until);
  bool try_step();
  void dynamic_step();
  [[nodiscard]] bool is_look() const;
  [[nodiscard]] double horizon() const;
  bool load_step();
  bool automatic_load_step();
  void end_by_collapse(double upper, std::vector<double> motion);
  void write_mechanism();
  [[nodiscard]] double next_load_time() const;
  [[nodiscard]] double value_of(const Reduction& reduction) const;
  void record(bool row, bool frame);
  void write_row();
  void write_frame();
  void flush();
  void write(StateFile kind);
  void go_on(const std::string& file);
  void close();
  void judge();
  void look_for_stop();
  void look_for_rest();
  [[nodiscard]] bool asked_to_stop() const { return settings_.stop_if && settings_.stop_if(); }
  [[nodiscard]] bool checkpoint_due() const;
  void write_checkpoint();
  template <class Work>
  void note_failures(const Work& work);
  void update_progress();

  Scene scene_;
  RunSettings settings_;
  std::unique_ptr<Simulation> simulation_;
  std::string scene_hash_;
  RunProgress progress_;
  std::unique_ptr<FileList> files_;       // only with a folder
  std::optional<HistoryWriter> history_;  // likewise
  std::optional<FrameWriter> frames_;     // likewise
  Schedule rows_, pictures_;
  std::int64_t last_row_ = -1, last_frame_ = -1;  // steps
  std::int64_t step_before_ = 0;                  // before the last one
  std::function<void(const Run&)> on_progress_;
  std::function<void()> on_step_;
  std::vector<AddedForce> forces_;
  /// Of the run that goes on here, before its first step.
  std::optional<std::vector<AddedForce>> forces_before_;
  Status status_ = Status::running;
  std::string message_;
  std::vector<std::string> warnings_;
  std::vector<Outcome> outcomes_;
  std::vector<double> measures_;
  std::optional<QuietMotion> quiet_;  // watched by velocity Verlet, where "auto" would do
  StopWatch stop_watch_{scene_.model, scene_.stops};
  std::string stopped_by_;
  std::optional<Collapse> collapse_;
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_, last_checkpoint_;
  double processor_start_ = 0;
  double output_seconds_ = 0;
};

}  // namespace apothem
