// A term: something that acts on bodies in a step - elements, loads, contact, damping.
//
// A scene has a short list of terms, those that it needs. The step, the static solver, the settled
// start, the ledger and the checkpoint go through the list and do not know who is on it. A term is
// asked a handful of times per step, never per pair or element.
#pragma once

#include <span>
#include <string>

#include "lib/dynamics/ledger.hpp"
#include "lib/dynamics/time_step.hpp"
#include "lib/execution/phase_timer.hpp"
#include "lib/model/state.hpp"
#include "lib/solver/tangent.hpp"

namespace apothem {

/// How all coordinates have moved in an implicit step.
struct StepMotion {
  double span = 0;                 ///< length of the step, s
  std::span<const double> v = {};  ///< mean velocities; those of rigid bodies are not read
};

/// What a term gets when it is asked for its forces.
struct Evaluation {
  State& state;                      ///< x where forces are asked for, v half a step before
  std::span<const double> velocity;  ///< what springs and dampers follow over dt
  double dt;                         ///< s; 0: nothing has moved since the last evaluation
  std::span<double> lambda;  ///< of each rigid body: bound of stiffness / inertia, 1/s^2; to add to
  PhaseTimer& clock;
  double lambda_limit = 0;  ///< up to it lambda need not be sharp, 1/s^2
  /// The static solver tries a state: nothing of it is recorded. `velocity` times `dt` is then the
  /// displacement since the start of the load step.
  bool trial = false;
  /// An equilibrium or the end of an implicit step is sought: no dashpot acts.
  bool still = false;
  /// The part of `velocity` that is slip alone, by which nothing has moved; may be empty.
  std::span<const double> slip = {};
  /// Of an implicit step, which the damping of elements follows; without it none acts where all is
  /// still.
  StepMotion step = {};
};

/// Bounds of the stiffness that acts on nodes, for the static solver.
struct NodeStiffness {
  std::vector<double> elastic;  ///< of each coordinate against its displacement, N/m
  std::vector<double> contact;  ///< of each node against its place, N/m
  std::vector<double> rigid;    ///< of x, y and angle of each rigid body by nodes, N/m and N m
};

class Term {
 public:
  virtual ~Term() = default;

  /// What it is and how much of it there is, in words for `apothem check`.
  [[nodiscard]] virtual std::string describe() const = 0;

  /// Adds the forces on rigid bodies and nodes to state.f, where those of the bodies begin at zero
  /// and those of the nodes with the elements' (Elements is the first term where there are nodes).
  /// Throws Unstable.
  virtual void add_forces(const Evaluation& /*evaluation*/) {}
  /// Slows bodies down over h (s), exactly for any h.
  virtual void damp(State& /*state*/, double /*h*/, Ledger& /*ledger*/) {}
  /// Work and impulses from outside over h (s), with the forces of the last evaluation and the
  /// velocities of the half step.
  virtual void book(const State& /*state*/, double /*h*/, Ledger& /*ledger*/) {}
  /// From time to time. Throws Unstable if a body is out of the range of the method.
  virtual void watch(const State& /*state*/) {}

  /// Adds its stored energy and the work from outside that it books itself, J. Not for every step.
  virtual void add_energies(const State& /*state*/, Energies& /*energies*/) {}
  /// Adds what it has dissipated so far to friction_loss and damping_loss, J; after steps of dt
  /// (s). Asked in every step.
  virtual void add_losses(double /*dt*/, Energies& /*energies*/) const {}
  /// What has been dissipated so far does not count.
  virtual void start_ledger() {}

  /// Lowers the bounds of the time step. Terms are asked in their order.
  virtual void bound_step(StepBounds& /*bounds*/) {}

  /// Whether its forces may change though nothing moves.
  [[nodiscard]] virtual bool changes_with_time() const { return false; }

  // For static runs:
  virtual void add_stiffness(const State& /*state*/, NodeStiffness& /*stiffness*/) {}
  /// Adds the derivative of minus its forces by the coordinates, where the last evaluation was.
  /// Returns false if it does not know it.
  virtual bool add_tangent(const State& /*state*/, Tangent& /*tangent*/) const { return true; }
  /// Adds given forces on nodes, N.
  virtual void add_given_forces(std::span<double> /*of_nodes*/) const {}

  /// What it remembers, for checkpoints.
  virtual void fields(Archive& /*archive*/) {}
  /// After `fields` has been loaded, with the state that belongs to it.
  virtual void refresh(const State& /*state*/) {}
};

}  // namespace apothem
