// The step loop.
//
//   damp, kick (Eq. 18) -> drift (Eq. 17) -> every term adds its forces -> dashpots of contacts ->
//   kick, damp (Eq. 20) -> ledger
//
// The terms of a scene are those that it needs (term.hpp). Forces are summed in the order of the
// list, and within contact pair by pair in ascending order: the same scene gives the same bits for
// any number of threads and whenever the search runs.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lib/dynamics/energy_guard.hpp"
#include "lib/dynamics/population.hpp"
#include "lib/dynamics/results.hpp"
#include "lib/dynamics/step_control.hpp"
#include "lib/dynamics/term.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/execution/phase_timer.hpp"
#include "lib/model/forecast.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/model/state.hpp"

namespace apothem {

class FrictionMemory;
struct ContactNumbers;
class ContactTerm;
class Elements;
class Equilibrium;
class ImplicitSteps;
class Islands;

class Simulation {
 public:
  /// Throws Unrunnable if a fixed step is above the stability limit or bodies overlap too deeply.
  /// With an automatic step, `frames` equal intervals of the run get a whole number of steps each.
  /// The model must outlive this object. `stop`: asked again and again while the bodies settle; if
  /// it says so, throws Stopped.
  Simulation(const Model& model, const TimeSettings& time, int frames, int threads,
             const std::function<bool()>& stop = {});
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Puts a term at the end of the list, before the first step; or after a checkpoint has been
  /// loaded that was written with the same term, which must then follow from the state alone.
  void add(std::unique_ptr<Term> term);

  /// One step of velocity Verlet, or an implicit one of the length of several, which ends at the
  /// first step at or after `horizon` (s) at the latest. Throws Unstable; the state is then not to
  /// be trusted.
  void step(double horizon = HUGE_VAL);

  /// Brings all bodies to rest under their loads before the first step, as the constructor does
  /// where the settings say so. Throws Unrunnable if they find no equilibrium, and Stopped.
  void settle(const std::function<bool()>& stop);

  /// Lets bodies leave, and others come with the velocities of their model. What that does to
  /// energies and momenta is booked as work and impulses from outside.
  void change_population(std::span<const BodyIndex> leave, std::span<const BodyIndex> come);
  /// Gives all coordinates that forces can move these velocities, laid out like State::v. What that
  /// does to energies and momenta is booked as work and impulses from outside.
  void set_velocities(std::span<const double> velocities);
  /// Of scenes where bodies come or go; null in others.
  [[nodiscard]] const Population* population() const { return population_.get(); }

  /// Static scenes: the next load step, which brings loads, supports and prescribed bodies to where
  /// they are at `time`. Not complete if `stop`, asked after each step of relaxation, says so:
  /// the state has not changed then, and the next call goes on with the relaxation. Throws Unstable
  /// if it finds no equilibrium; the state is then not to be trusted.
  LoadStep balance(double time, const std::function<bool()>& stop = {});
  /// The same, but only to an equilibrium near the last one: see Equilibrium::find_near. The state
  /// has not changed if it finds none.
  LoadStep balance_near(double time, const std::function<bool()>& stop,
                        std::vector<double>& motion);

  /// Finds the derivative of minus all forces by the coordinates at the present places, where
  /// friction sticks, and what of the forces on coordinates that can move is out of balance (N and
  /// N m). Returns false if a term does not know its derivative. The simulation is afterwards as
  /// before.
  bool linearise(Tangent& tangent, std::vector<double>& out_of_balance);

  /// Takes over what contacts of another simulation remember, by the numbers of this one's
  /// contacts, before the first step.
  void inherit(const FrictionMemory& memory);
  [[nodiscard]] ContactNumbers contact_numbers() const;

  /// All that changes while a simulation runs: enough to continue it bit for bit. What is loaded
  /// must belong to the same model and settings; throws ArchiveMismatch if it cannot.
  void fields(Archive& archive);
  /// After `fields` has been loaded.
  void refresh();

  /// Its vectors stay where they are in memory while the simulation lives, so that others may look
  /// at them.
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const DegreesOfFreedom& degrees_of_freedom() const { return dofs_; }
  [[nodiscard]] double step_size() const { return step_choice().step; }
  /// How the step was chosen; its limit changes if contacts turn out stiffer.
  [[nodiscard]] const StepChoice& step_choice() const { return control_->choice(); }
  [[nodiscard]] const StepChanges& step_changes() const { return control_->changes(); }
  /// Of scenes with implicit steps; null in others.
  [[nodiscard]] const ImplicitCounts* implicit_counts() const;
  /// Of scenes whose bodies may rest while others move (islands.hpp); null in others.
  [[nodiscard]] const Islands* islands() const { return islands_.get(); }

  /// Throws Unstable if the run has made energy (energy_guard.hpp). Dynamic steps see to this by
  /// themselves; it is asked once more where a run ends.
  void check_energy();

  [[nodiscard]] Energies energies() const;
  /// The same for a record: no error that is written is larger than the largest of extremes().
  Energies energies_to_record();
  [[nodiscard]] Momenta momenta() const { return ledger_.momenta(state_); }
  [[nodiscard]] std::vector<ContactRecord> contacts() const;
  /// What acts on each body from contacts; rigid bodies first. Without forces on rigid ones, which
  /// the state holds.
  [[nodiscard]] std::vector<BodyForce> contact_forces() const;
  /// The boundary edges of bodies that take part in contact with meshes.
  [[nodiscard]] std::vector<SurfaceRecord> surfaces() const;
  /// Mean stress of the elements of all deformable bodies, and of those that hold the points.
  [[nodiscard]] std::vector<CauchyStress> stresses() const;
  [[nodiscard]] std::vector<CauchyStress> stresses(const std::vector<TrackedPoint>& points) const;
  /// Mass of each node, kg.
  [[nodiscard]] const std::vector<double>& node_mass() const;
  [[nodiscard]] Extremes extremes() const;
  [[nodiscard]] ContactCounts counts() const;
  /// The pairs of bodies that overlap now, the largest share first.
  [[nodiscard]] std::vector<PairDepth> overlaps() const;
  /// How deep bodies will probably press into each other; nothing if none can touch another one.
  [[nodiscard]] Forecast forecast() const;
  /// The terms of the scene, in their order.
  [[nodiscard]] const std::vector<std::unique_ptr<Term>>& terms() const { return terms_; }

  /// Seconds per part of the steps by velocity Verlet, extrapolated from those that were timed.
  [[nodiscard]] PhaseSeconds phase_seconds() const;
  /// Steps taken by this object, without those before a checkpoint.
  [[nodiscard]] std::int64_t own_steps() const { return state_.step - steps_before_; }

 private:
  void make_terms(int threads);
  void start_ledger();
  void finish_load_step(const State& before, double time);
  // Work and impulse from outside, with the error of energy and the momentum before they came.
  void book_change(double error, const Impulse& momentum);
  void take_step();
  bool take_implicit_step(double horizon);
  bool rest(std::int64_t ticks);
  void restore_forces();
  void take_absent_out();
  [[noreturn]] void explain(const Unstable& error) const;
  void damp(double h);
  void find_forces(std::span<const double> velocity, double dt, double lambda_limit = 0,
                   const StepMotion* implicit = nullptr);
  [[nodiscard]] bool needs_forces_before() const;
  bool finish_contact(double dt);
  void finish_look();
  void watch(bool always = false);
  void follow_rest(bool regular);
  void change_rest();
  void wake_all();
  void look_at_energy(bool last);
  [[noreturn]] void refuse_energy(EnergyGuard::Verdict verdict, double error, bool touched) const;
  [[nodiscard]] Energies losses() const;
  [[nodiscard]] Energies energies_of_terms() const;

  const Model& model_;
  std::unique_ptr<Elements> own_elements_;  // until it joins the terms
  DegreesOfFreedom dofs_;
  State state_;
  Ledger ledger_;
  std::vector<std::unique_ptr<Term>> terms_;
  Elements* elements_ = nullptr;              // of the terms: for reports
  ContactTerm* contact_ = nullptr;            // likewise
  std::unique_ptr<Equilibrium> equilibrium_;  // only in static scenes
  std::unique_ptr<ImplicitSteps> implicit_;   // only where the scheme asks for them
  std::unique_ptr<Islands> islands_;          // only where bodies may rest

  std::unique_ptr<Population> population_;  // only where bodies come or go
  std::optional<StepControl> control_;
  bool onsets_ = true;
  std::vector<double> forces_;  // at the start of the step; then at its end, without onsets
  std::vector<double> lambda_;  // of each rigid body's contacts: bound of stiffness/inertia, 1/s^2
  EnergyGuard guard_;
  std::int64_t touching_before_ =
      0;  // touching pairs, summed over the steps, at the last regular look
  std::int64_t steps_before_ = 0;  // of earlier legs of a resumed run
  PhaseTimer clock_;
  std::int64_t verlet_steps_ = 0, timed_steps_ = 0;  // of this object; the latter are some of them
};

}  // namespace apothem
