// The step loop.
//
//   kick (Eq. 18) -> drift (Eq. 17) -> contacts of meshes -> elements, loads -> place rigid shapes
//   -> find pairs -> contact forces -> kick (Eq. 20)
//
// Velocity Verlet in kick-drift-kick form: symplectic, so energy oscillates with order dt^2 and
// does not drift, and momenta are kept to round-off. Forces are summed pair by pair in ascending
// order: the same scene gives the same bits for any number of threads and whenever the search runs.
#pragma once

#include <array>
#include <functional>
#include <stdexcept>
#include <vector>

#include "apothem/contact/normal.hpp"
#include "apothem/contact/pair_search.hpp"
#include "apothem/contact/tangential.hpp"
#include "apothem/dynamics/deformables.hpp"
#include "apothem/dynamics/equilibrium.hpp"
#include "apothem/dynamics/fold_watch.hpp"
#include "apothem/dynamics/ledger.hpp"
#include "apothem/dynamics/surface_contact.hpp"
#include "apothem/dynamics/time_step.hpp"
#include "apothem/dynamics/unstable.hpp"
#include "apothem/model/model.hpp"
#include "apothem/model/settings.hpp"
#include "apothem/model/state.hpp"

namespace apothem {

/// Parts of the step, for the timings in run.json.
enum class Phase { integrate, elements, place, search, contact, gather };
inline constexpr std::array kPhaseNames{"integrate", "elements", "place",
                                        "search",    "contact",  "gather"};

struct Peak {
  double value = 0;
  double time = 0;
  int a = -1, b = -1;
};

/// Largest values over all steps so far.
struct Extremes {
  Peak penetration;         ///< extent of the overlap of a pair along its force, m
  Peak force;               ///< size of the contact force of a pair, N
  double energy_error = 0;  ///< largest |total_error| of the energies asked for, J
};

struct Counts {
  std::int64_t searches = 0;
  std::int64_t candidate_pairs = 0;  ///< summed over the steps; of meshes edges and faces
  std::int64_t touching_pairs = 0;
  int touching_now = 0;
};

/// All that changes while a simulation runs: enough to continue it bit for bit.
struct Snapshot {
  State state;
  Balance balance;
  StepLimit limit{0, ""};
  double step_size = 0;
  double base_time = 0;  ///< time = base_time + (step - base_step) step_size
  std::int64_t base_step = 0;
  Extremes extremes;
  Counts counts;
  double energy_in_play = 0;
  TangentialMemory tangential = {};
  double mass_damping_loss = 0;
  DeformableBalance deformables = {};
  SlipMemory slips = {};
  EquilibriumMemory equilibrium = {};
};

class Simulation {
 public:
  /// Throws Unrunnable if a fixed step is above the stability limit or bodies overlap too deeply.
  /// With an automatic step, `frames` equal intervals of the run get a whole number of steps each.
  Simulation(const Model& model, const TimeSettings& time, int frames, int threads);

  /// One step. Throws Unstable; the state is then not to be trusted.
  void step();

  /// Static scenes: the next load step, which brings loads, supports and prescribed bodies to where
  /// they are at `time`. Not complete if `stop`, asked after each step of relaxation, says so:
  /// nothing has changed then. Throws Unstable if it finds no equilibrium; the state is then not to
  /// be trusted.
  LoadStep balance(double time, const std::function<bool()>& stop = {});

  [[nodiscard]] Snapshot snapshot() const;
  /// Continues from a snapshot of the same model and settings.
  void restore(const Snapshot& snapshot);

  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] double step_size() const { return dt_; }
  /// An automatic step over the limit of the finite elements.
  [[nodiscard]] double element_safety() const { return element_safety_; }
  /// What limits the step.
  [[nodiscard]] const StepLimit& limit() const { return limit_; }
  /// Largest stable step of the contacts, s; infinite if nothing can touch.
  [[nodiscard]] double stability_limit() const { return stability_limit_; }
  /// Energies now. Throws Unstable if more than a tenth of the energy in play is unaccounted for.
  Energies energies();
  [[nodiscard]] Momenta momenta() const;
  [[nodiscard]] std::vector<ContactRecord> contacts() const;
  /// The sizes of the friction forces on each body, summed, N.
  [[nodiscard]] std::vector<double> friction() const {
    const size_t bodies = model_.bodies.size();
    return tangential_ ? tangential_->friction(bodies) : std::vector<double>(bodies);
  }
  /// What acts on each deformable body from contacts.
  [[nodiscard]] std::vector<BodyForce> deformable_forces() const;
  /// The boundary edges of bodies that take part in contact of deformable bodies.
  [[nodiscard]] std::vector<SurfaceRecord> surfaces() const;
  /// Mean stress of the elements of all deformable bodies.
  [[nodiscard]] std::vector<CauchyStress> stresses() const;
  /// Of the elements that hold the points.
  [[nodiscard]] std::vector<CauchyStress> stresses(const std::vector<TrackedPoint>& points) const;
  /// Of their nodes, kg.
  [[nodiscard]] const std::vector<double>& node_mass() const;
  [[nodiscard]] const Extremes& extremes() const { return extremes_; }
  [[nodiscard]] const Counts& counts() const { return counts_; }
  /// Seconds per phase over the whole run, extrapolated from the steps that were timed.
  [[nodiscard]] std::array<double, kPhaseNames.size()> phase_seconds() const;
  /// Steps taken by this object, without those before a snapshot.
  [[nodiscard]] std::int64_t own_steps() const { return state_.step - steps_before_; }

 private:
  void choose_step(const TimeSettings& time, int frames);
  void kick(double h);
  void drift();
  void damp(double h);
  /// `slip`: velocities that friction follows over dt.
  void find_forces(bool timed, const std::vector<double>& slip, double dt);
  void settle();
  void search_if_stale();
  [[nodiscard]] bool too_deep(int a, int b, const PairIntegral& pair) const;
  void gather();
  void gather_tangential();
  void gather_surfaces();
  void watch();
  void tighten_step();
  [[nodiscard]] double contact_energy() const;
  [[nodiscard]] std::string at_time() const;
  [[nodiscard]] const std::string& name(int body) const { return model_.bodies[body].name; }

  const Model& model_;
  State state_;
  std::vector<double> inverse_mass_, acceleration_;  // three entries per body
  std::vector<std::array<double, 3>> inverse_masses_;
  std::vector<double> inradius_, slope_;  // m, 1/m
  std::vector<int> moving_, driven_;
  PlacedShapes shapes_;
  PairSearch search_;
  NormalContact contact_;
  std::optional<TangentialContact> tangential_;  // only where there is friction or damping
  std::optional<Deformables> deformables_;       // only where there are finite elements
  std::optional<SurfaceContact> surface_;        // only where they can touch something
  std::optional<FoldWatch> folds_;               // only where contact would not notice
  std::optional<Equilibrium> equilibrium_;       // only in static scenes
  std::optional<Ledger> ledger_;
  std::vector<double> moved_;

  StepLimit limit_{0, ""};
  bool automatic_ = true;
  double safety_ = 0.1;
  double element_safety_ = 0;
  double dt_ = 0;
  double stability_limit_ = 0;
  double base_time_ = 0;
  std::int64_t base_step_ = 0;
  double largest_stride_ = 0;
  std::vector<double> stiffness_;  // lambda of each body's contacts, 1/s^2
  double worst_stiffness_ = 0;
  int worst_body_ = -1;

  Extremes extremes_;
  Counts counts_;
  double energy_in_play_ = 0;
  double energy_noise_ = 0;
  double mass_damping_loss_ = 0;
  std::int64_t steps_before_ = 0;  // of earlier legs of a resumed run
  std::array<double, kPhaseNames.size()> timed_seconds_{};
  std::int64_t timed_steps_ = 0;
};

}  // namespace apothem
