// The nodes of deformable bodies in the step: internal forces, loads, supports, and their part of
// the ledgers. The same velocity Verlet scheme as for rigid bodies.
#pragma once

#include <span>
#include <vector>

#include "apothem/dynamics/ledger.hpp"
#include "apothem/dynamics/surface_contact.hpp"
#include "apothem/dynamics/time_step.hpp"
#include "apothem/fem/finite_elements.hpp"
#include "apothem/model/model.hpp"
#include "apothem/model/state.hpp"

namespace apothem {

/// What a checkpoint needs to continue the bookkeeping.
struct DeformableBalance {
  double load_work = 0;            ///< of loads and moving supports, J
  double mass_damping_loss = 0;    ///< J
  double summed_damping_loss = 0;  ///< of the elements, J
  double damping_power = 0;        ///< at the last step, W
};

class Deformables {
 public:
  /// Fills the nodal arrays of the state with the start at time 0.
  Deformables(const Model& model, State& state, int threads);

  /// Largest stable step, with damping.
  [[nodiscard]] const StepLimit& limit() const { return limit_; }

  /// The parts of a step, in the order of Simulation::step.
  void damp(State& state, double h);
  void kick(State& state, double h) const;
  /// `state.time` is that of the end of the drift.
  void drift(State& state, double dt);
  /// Internal forces, loads at `state.time` and contacts; books the work since the drift.
  void find_forces(State& state, double dt, const SurfaceContact* contact);
  /// Of each node, kg; 0 where it is held.
  [[nodiscard]] std::vector<double> free_mass() const;

  // Static scenes:
  /// Moves supports to where they are at `state.time`.
  void place_supports(State& state) const;
  /// Internal forces, loads at `state.time` and contacts; books nothing.
  void find_static_forces(State& state, const SurfaceContact* contact);
  /// The weight of each coordinate that is not held, N; empty without gravity.
  [[nodiscard]] const std::vector<double>& weights() const { return weight_; }
  [[nodiscard]] bool held(size_t coordinate) const { return inverse_mass_[coordinate] == 0; }
  /// Loads and reactions of moving supports on each coordinate, N.
  [[nodiscard]] std::vector<double> outside_forces(const State& state) const;
  void add_load_work(double work) { balance_.load_work += work; }

  /// J.
  [[nodiscard]] double kinetic(const State& state) const;
  /// Kinetic, strain and gravity energy, damping loss and work of loads.
  [[nodiscard]] Energies energies(const State& state, double dt);
  [[nodiscard]] Impulse momentum(const State& state) const;
  /// From loads, supports, gravity and mass damping since the last call.
  [[nodiscard]] Impulse take_impulse();

  [[nodiscard]] const FiniteElements& elements() const { return elements_; }
  /// How far the supports move between two times at most, m.
  [[nodiscard]] double largest_support_move(double from, double until) const;
  /// An element that has turned inside out, as `the element at (1, 2) m of "beam"`; empty if none.
  [[nodiscard]] std::string inverted(const State& state) const;

  [[nodiscard]] const DeformableBalance& balance() const { return balance_; }
  void restore(const DeformableBalance& balance, const State& state);

 private:
  struct Driven {
    int coordinate;  // in the nodal arrays
    int axis;
    const MotionHistory* motion;
  };
  void start(State& state) const;
  void hold(const DeformableBody& body);
  void find_limit(const State& state);
  void add_loads(State& state) const;
  void apply_loads(const State& state);
  void book(const State& state, double h);
  /// Moment of the weights at these places about the origin; over displacements, what they add.
  [[nodiscard]] double weight_torque(std::span<const double> place) const;

  const Model& model_;
  FiniteElements elements_;
  std::vector<double> inverse_mass_;  // per coordinate, 0 where held
  std::vector<double> acceleration_;  // of gravity on free coordinates; empty without gravity
  std::vector<double> weight_;        // the same as forces, N
  std::vector<double> start_;         // of the nodes in the mesh as given, m
  double start_torque_ = 0;           // of the weights there, N m
  double torque_ = 0;                 // of the weights now
  std::vector<int> held_;             // coordinates
  std::vector<Driven> driven_;
  // Loads at the present time: force and place of each coordinate they act on.
  std::vector<std::pair<int, Vec2>> loads_;
  Vec2 free_mass_ = Vec2::Zero();  // of coordinates that gravity moves
  StepLimit limit_{0, ""};
  DeformableBalance balance_;
  double first_damping_power_ = 0;
  Impulse impulse_;
};

}  // namespace apothem
