#include "apps/python/driver.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "lib/dynamics/unstable.hpp"

namespace apothem::python {
namespace {

// Between two looks for Ctrl-C. To look takes Python's lock, which another thread may hold.
constexpr std::chrono::milliseconds kLook{100};

// How long the end of Python waits for a step, or for a callback that does not return.
constexpr std::chrono::seconds kEnd{10};

// Threads that step a run now, and whether Python is about to end.
std::atomic<int> turns = 0;
std::atomic<bool> ending = false;

}  // namespace

void Driver::stop_all() {
  ending = true;
  const py::gil_scoped_release release;
  const auto end = std::chrono::steady_clock::now() + kEnd;
  while (turns > 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

const Run& SharedRun::look() const {
  if (phase == Phase::idle || thread == std::this_thread::get_id()) return run;
  throw std::runtime_error("the simulation is running in another thread");
}

Driver::Driver(Scene scene, RunSettings settings) {
  settings.stop_if = [this] { return interrupted(); };
  try {
    shared_ = std::make_shared<SharedRun>(std::move(scene), settings);
  } catch (const Stopped&) {
    throw_interrupt();
    throw;
  }
  shared_->run.on_step([this] { call_after_step(); });
}

Driver::~Driver() {
  try {
    if (!shared_->run.settings().folder.empty()) close();
  } catch (const std::exception& error) {
    const py::error_scope kept;  // the simulation may go because of another error
    PyErr_SetString(PyExc_RuntimeError, error.what());
    PyErr_WriteUnraisable(nullptr);
  }
}

void Driver::require_sound() const {
  if (closed_) throw std::runtime_error("the simulation is closed");
  if (!broken_.empty()) {
    throw std::runtime_error(
        "a force callback has failed in the middle of a step, so the state is "
        "not to be trusted: begin anew, or resume from a saved state");
  }
  const Run& run = shared_->run;
  if (run.status() == Run::Status::unstable) throw Unstable(run.message());
}

Run& Driver::change() {
  require_sound();
  static_cast<void>(look());
  if (shared_->phase == Phase::stepping) {
    throw std::runtime_error("not in the middle of a step: a force callback only adds forces");
  }
  return shared_->run;
}

// Lets this thread step the run, with Python's lock released. An interrupt comes before whatever
// else has happened in the same step.
template <class Work>
void Driver::take_turn(const Work& work) {
  if (shared_->phase != Phase::idle) {
    throw std::runtime_error(
        "the simulation is running already: callbacks and other threads "
        "must not step or run it");
  }
  require_sound();
  if (ending) throw std::runtime_error("Python is about to end");
  interrupt_.reset();
  shared_->phase = Phase::stepping;
  shared_->thread = std::this_thread::get_id();
  ++turns;
  std::exception_ptr failure;
  {
    const py::gil_scoped_release release;
    try {
      work(shared_->run);
    } catch (...) {
      failure = std::current_exception();
    }
  }
  --turns;
  shared_->phase = Phase::idle;
  throw_interrupt();
  if (failure) std::rethrow_exception(failure);
}

void Driver::throw_interrupt() {
  if (interrupt_) throw py::error_already_set(std::move(*std::exchange(interrupt_, nullptr)));
}

std::int64_t Driver::step(std::int64_t count) {
  if (count < 0) throw std::invalid_argument("n must not be negative");
  std::int64_t done = 0;
  take_turn([&](Run& run) {
    while (done < count && !(count > 1 && interrupted()) && run.step()) ++done;
  });
  return done;
}

bool Driver::run(std::optional<double> until) {
  if (until && std::isnan(*until)) throw std::invalid_argument("until must be a time in s");
  take_turn([&](Run& run) { run.advance(until); });
  return shared_->run.stopped_by().empty();
}

void Driver::close() {
  if (closed_) return;
  if (shared_->phase != Phase::idle) throw std::runtime_error("the simulation is running");
  closed_ = true;
  if (broken_.empty()) {
    shared_->run.finish();
  } else {
    shared_->run.fail("a force callback has failed: " + broken_);
  }
}

// Whether Python has been interrupted; its handler of the signal may raise an exception.
bool Driver::interrupted() {
  if (interrupt_ || ending) return true;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_look_) return false;
  next_look_ = now + kLook;
  const py::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() == 0) return false;
  interrupt_ = std::make_unique<py::error_already_set>();
  return true;
}

void Driver::add_force(const py::function& callback, const std::string& name) {
  Run& run = change();
  callbacks_.push_back({callback, 0});
  const size_t number = callbacks_.size() - 1;
  const Phase before = std::exchange(shared_->phase, Phase::stepping);
  shared_->thread = std::this_thread::get_id();
  try {
    run.add_force(
        name, [this, number](const State&, std::span<double> force) { call_force(number, force); });
  } catch (...) {
    shared_->phase = before;
    if (broken_.empty()) callbacks_.pop_back();
    throw;
  }
  shared_->phase = before;
}

void Driver::call_force(size_t callback, std::span<double> force) {
  const py::gil_scoped_acquire acquire;
  if (callback >= callbacks_.size()) return;  // the garbage collector has been here
  const auto call = [&] {
    std::ranges::fill(force, 0.);
    callbacks_[callback].function(shared_from_this(), Forces{shared_, force});
  };
  try {
    try {
      call();
    } catch (py::error_already_set& error) {
      // The step is finished first. The force depends on the state alone: it can be asked again.
      if (interrupt_ || !error.matches(PyExc_KeyboardInterrupt)) throw;
      interrupt_ = std::make_unique<py::error_already_set>(std::move(error));
      call();
    }
  } catch (const std::exception& error) {
    broken_ = error.what();
    throw;
  }
}

void Driver::add_step_callback(const py::function& callback, std::int64_t every) {
  if (every < 1) throw std::invalid_argument("every must be at least 1 step");
  static_cast<void>(change());
  callbacks_.push_back({callback, every});
}

void Driver::call_after_step() {
  const std::int64_t step = shared_->run.state().step;
  const size_t count = callbacks_.size();  // a callback may add others, which begin later
  for (size_t i = 0; i < count && i < callbacks_.size(); ++i) {
    if (callbacks_[i].every == 0 || step % callbacks_[i].every != 0) continue;
    const py::gil_scoped_acquire acquire;
    shared_->phase = Phase::between;
    try {
      callbacks_[i].function(shared_from_this());
    } catch (...) {
      shared_->phase = Phase::stepping;
      throw;
    }
    shared_->phase = Phase::stepping;
  }
}

int Driver::traverse(visitproc visit, void* arg) const {
  for (const Callback& callback : callbacks_) Py_VISIT(callback.function.ptr());
  return 0;
}

}  // namespace apothem::python
