// Energy and momentum ledgers: what the integrator cannot account for is an error, and is reported.
#pragma once

#include "lib/dynamics/degrees_of_freedom.hpp"
#include "lib/model/state.hpp"

namespace apothem {

class Ledger {
 public:
  explicit Ledger(const DegreesOfFreedom& dofs) : dofs_(dofs) {}

  /// Balances start here. `terms`: the energies of all terms.
  void start(const State& state, const Energies& terms);

  /// The impulses of gravity and of whatever holds coordinates, and the work of prescribed motion,
  /// with the forces in `state`: of the half of a step before the drift, and of the half after it.
  void book_before_drift(const State& state, double dt);
  void book_after_drift(const State& state, double dt);
  /// The same for an implicit step of h (s), whose forces at its end have acted all along
  /// (implicit.hpp).
  void book_implicit(const State& before, const State& after, double h);
  /// Energy that long steps have taken from vibrations, J.
  void add_numerical_loss(double loss) { numerical_loss_ += loss; }
  /// An impulse, or work, from outside that no reaction tells of.
  void add_impulse(const Impulse& impulse) { outer_.add(impulse); }
  void add_work(double work) { work_ += work; }

  /// The energies of all terms with those that the ledger knows itself, and the total error.
  [[nodiscard]] Energies close(const State& state, const Energies& terms) const;
  [[nodiscard]] Momenta momenta(const State& state) const;

  void fields(Archive& archive) {
    archive("initial_energy", initial_energy_)("initial_momentum", initial_)("impulse", outer_)(
        "external_work", work_)("numerical_loss", numerical_loss_);
  }
  /// After `fields` has been loaded.
  void refresh(const State& state) { weight_ = dofs_.weight_sum(state); }

 private:
  void book(const State& state, double h);

  const DegreesOfFreedom& dofs_;
  double initial_energy_ = 0;
  Impulse initial_;            // momentum at the start
  Impulse outer_;              // impulses from outside since then
  double work_ = 0;            // of loads and prescribed motion, J
  double numerical_loss_ = 0;  // J
  Impulse weight_;             // of gravity where the bodies are, N and N m
};

}  // namespace apothem
