// A run that Python drives: when it may be asked for what, its callbacks, and interrupts.
#pragma once

#include <memory>
#include <thread>

#include "apps/python/bindings.hpp"

namespace apothem::python {

/// A run, and who steps it now. Whatever shows a part of it keeps it alive, but not the callbacks,
/// which may refer to what shows it.
struct SharedRun {
  enum class Phase { idle, stepping, between };
  SharedRun(Scene scene, const RunSettings& settings) : run(std::move(scene), settings) {}
  /// The run, to look at: not while another thread steps it.
  [[nodiscard]] const Run& look() const;

  Run run;
  Phase phase = Phase::idle;
  std::thread::id thread;  ///< that steps it
};

class Driver : public std::enable_shared_from_this<Driver> {
 public:
  /// Throws as Run does, or the interrupt of Python that has stopped the search for a settled
  /// start.
  Driver(Scene scene, RunSettings settings);
  ~Driver();
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  /// The number of steps taken, less than `count` at the end of the run.
  std::int64_t step(std::int64_t count);
  /// False if the run has not come to the time, because a rule of the scene has stopped it.
  bool run(std::optional<double> until);
  void close();

  [[nodiscard]] const Run& look() const { return shared_->look(); }
  [[nodiscard]] const std::shared_ptr<SharedRun>& shared() const { return shared_; }
  /// The run between two steps, to change it.
  [[nodiscard]] Run& change();

  void add_force(const py::function& callback, const std::string& name);
  void add_step_callback(const py::function& callback, std::int64_t every);
  /// Of Python's garbage collector.
  int traverse(visitproc visit, void* argument) const;
  void clear() { callbacks_.clear(); }

  /// Stops all runs and waits for them, at most 10 s: before Python ends, which would end their
  /// threads within a step.
  static void stop_all();

 private:
  using Phase = SharedRun::Phase;
  template <class Work>
  void take_turn(const Work& work);
  void call_force(size_t callback, std::span<double> force);
  void call_after_step();
  [[nodiscard]] bool interrupted();
  void throw_interrupt();
  void require_sound() const;

  std::shared_ptr<SharedRun> shared_;
  struct Callback {
    py::function function;
    std::int64_t every;  ///< steps between two calls; 0: a force
  };
  std::vector<Callback> callbacks_;
  std::chrono::steady_clock::time_point next_look_;
  std::unique_ptr<py::error_already_set> interrupt_;
  std::string broken_;  // how a force has failed within a step
  bool closed_ = false;
};

/// What a force callback adds to: arrays over the coordinates of a state.
struct Forces {
  std::shared_ptr<SharedRun> run;
  std::span<double> values;
};

}  // namespace apothem::python
