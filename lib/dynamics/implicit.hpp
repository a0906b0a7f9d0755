// Long steps in time: staggered backward Euler, for slow motion and rest.
//
//   M (q1 - q0 - h w0) / h^2 = f(q1),   w1 = w0 + h M^-1 f(q1),   v1 = w1 + (h/2) M^-1 f(q1)
//
// w is the velocity half a step back, so that free flight and steady sliding are exact. These are
// Newmark's equations with beta = 1 and gamma = 3/2 (N. M. Newmark 1959). No step is too long for
// stability; what a step takes from vibrations that it does not follow is its numerical loss.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/dynamics/equilibrium.hpp"
#include "lib/dynamics/quiet_motion.hpp"
#include "lib/dynamics/results.hpp"
#include "lib/dynamics/step_control.hpp"
#include "lib/dynamics/term.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"

namespace apothem {

class ContactTerm;

/// Chooses and takes implicit steps. They last whole numbers of ticks, the steps that velocity
/// Verlet takes, so that the times of the output are met.
class ImplicitSteps {
 public:
  using Terms = Equilibrium::Terms;
  /// All must outlive this object. `contact` may be null.
  ImplicitSteps(const Model& model, const TimeSettings& time, DegreesOfFreedom& dofs,
                const Terms& terms, ContactTerm* contact);

  /// Whether an implicit step is to be tried from this state. With the scheme `auto` that is so
  /// where no body would move noticeably over a number of ticks of dt (s).
  [[nodiscard]] bool due(const State& state, double dt) const;
  /// Whether nothing has moved in the last step and nothing can begin to move, so that the next one
  /// would be the same. Bodies of prescribed motion must stay where they are until then.
  [[nodiscard]] bool is_frozen(const State& state) const;
  /// Something has changed from outside.
  void disturb() { rests_ = stays_ = false; }
  /// Counts a step that was not computed for that.
  void count_rest(std::int64_t ticks);
  /// Tries steps of at most `most` ticks, until one is as accurate as asked. Returns its ticks,
  /// with the state at its end, whose velocities and forces are not set, and the friction of
  /// contacts tried there. Returns 0 if only steps would do that are not worth it, with the state
  /// as it was; terms have then to be refreshed. Throws Unstable if the scheme is `implicit` and
  /// there is no such step.
  std::int64_t try_step(State& state, const StepControl& control, std::int64_t most);
  /// After such a step: how the coordinates have moved in it.
  [[nodiscard]] StepMotion motion(const State& state);
  /// After such a step, when the forces at its end are in `state`: its velocities. Returns the
  /// state of the middle of the step, with its mean velocities.
  const State& finish(State& state);
  [[nodiscard]] const State& before() const { return before_; }
  /// After such a step of ticks of dt (s): the energies, with what it has taken. With the scheme
  /// `auto` a phase ends where a body moves noticeably, or where more has been taken, since a phase
  /// has last ended for that, than by motion that nobody notices.
  void follow(const State& state, double dt, const Energies& energies);
  /// Whether the next step is probably an implicit one as well.
  [[nodiscard]] bool running() const { return running_; }
  /// Of the last step, s.
  [[nodiscard]] double length() const { return h_; }

  [[nodiscard]] const ImplicitCounts& counts() const { return counts_; }
  void fields(Archive& archive);

 private:
  void begin(const State& state);
  void accept(std::int64_t ticks);
  [[noreturn]] void refuse() const;
  [[nodiscard]] double longest(const State& state) const;
  bool attempt(State& state, double time);
  [[nodiscard]] double error() const;
  [[nodiscard]] double farthest(const State& state) const;
  [[nodiscard]] bool is_balanced(const State& state) const;
  void balance_spins(State& state) const;
  void give_up(std::int64_t step);

  const DegreesOfFreedom& dofs_;
  DegreesOfFreedom& moves_;
  const Terms& terms_;
  ContactTerm* contact_;
  Equilibrium equilibrium_;
  QuietMotion quiet_;
  bool automatic_;  // velocity Verlet is taken between
  bool fixed_;      // the steps are one tick each
  std::int64_t ticks_ = 1;
  bool running_ = false;         // the last step was an implicit one
  bool rests_ = false;           // what has moved in it is hardly more than rounding
  bool stays_ = false;           // nothing has moved at all, and no force has changed
  std::int64_t next_try_ = 0;    // number of the step from which on another try is made
  std::int64_t wait_;            // steps between tries
  std::int64_t least_wait_ = 0;  // doubled each time that too much energy has been taken
  std::int64_t phase_from_ = 0;  // number of the step at which this phase has begun
  double accuracy_;
  double loss_from_ = 0, work_from_ = 0;  // when a phase last ended for its energy, J
  ImplicitCounts counts_;
  std::optional<Unstable> refused_;  // why the last step that was tried did not do, if it is known
  // Of the step that is tried.
  State before_, middle_;
  std::vector<double> acceleration_, base_;  // at its start, m/s^2; see Equilibrium::step
  std::vector<double> moved_;                // its mean velocities, m/s
  double h_ = 0;                             // its length, s
};

}  // namespace apothem
