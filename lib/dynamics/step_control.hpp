// The automatic step while a scene runs.
//
// The limit known before the run holds for two bodies flat on each other; a body squeezed between
// several is stiffer. The step is then halved at once, as often as it takes. It is doubled again
// after the contacts have been soft enough for some time, never beyond the step of the start and
// only where the longer steps meet the times of the output. Every change of the step changes the
// energy that the integrator keeps by a little; where shortening soon follows lengthening, the time
// to wait doubles, so that a step does not follow the contacts to and fro.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/dynamics/time_step.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// A change of the automatic step.
struct StepChange {
  double time = 0;        ///< s
  std::int64_t step = 0;  ///< number of the last step before it
  double size = 0;        ///< from now on, s
  RigidIndex body = -1;   ///< whose contacts have become stiffer; -1: longer again
  void fields(Archive& archive) { archive("time", time)("step", step)("size", size)("body", body); }
};

/// All changes of a run.
struct StepChanges {
  std::int64_t shortened = 0, lengthened = 0;
  double shortest = 0;            ///< s
  std::vector<StepChange> first;  ///< the first ones, at most 1000
  void fields(Archive& archive) {
    archive("shortened", shortened)("lengthened", lengthened)("shortest", shortest)("first", first);
  }
};

class StepControl {
 public:
  StepControl(const Model& model, const TimeSettings& time, const StepBounds& bounds, int frames,
              bool node_contact);

  [[nodiscard]] const StepChoice& choice() const { return choice_; }
  [[nodiscard]] const StepChanges& changes() const { return changes_; }

  /// Counts more steps in the state, and finds its time.
  void advance(State& state, std::int64_t steps = 1);
  /// The time so many steps after the state, s.
  [[nodiscard]] double time_after(const State& state, std::int64_t steps) const {
    return base_time_ + static_cast<double>(state.step + steps - base_step_) * choice_.step;
  }
  /// After a step, with the bound of stiffness over inertia of each rigid body's contacts, 1/s^2.
  /// Throws Unstable if a fixed step is above the limit.
  void follow(const State& state, std::span<const double> lambda);
  /// The smallest lambda on which it depends what `follow` does, 1/s^2.
  [[nodiscard]] double deciding_lambda() const {
    return halvings_ > 0 ? soft_lambda() : largest_lambda();
  }

  void fields(Archive& archive);

 private:
  /// Above the one the step is shortened; up to the other one twice the step would do. 1/s^2.
  [[nodiscard]] double largest_lambda() const;
  [[nodiscard]] double soft_lambda() const;
  void shorten(const State& state, double limit, RigidIndex body);
  void lengthen(const State& state);
  void change(const State& state, double size, RigidIndex body);

  const Model& model_;
  bool automatic_;
  StepChoice choice_;
  double safety_ = 0;
  double base_time_ = 0;  // time = base_time + (step - base_step) step size
  std::int64_t base_step_ = 0;
  int halvings_ = 0;       // of the step of the start
  std::int64_t part_ = 0;  // steps of this size since the last whole step of the start
  std::int64_t soft_ = 0;  // steps in a row after which a longer one would have done
  std::int64_t patience_;  // how many of these it takes
  std::int64_t lengthened_ = -1'000'000'000;  // number of the last step before that
  StepChanges changes_;
};

}  // namespace apothem
