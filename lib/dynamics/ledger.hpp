// Energy and momentum ledgers: what the integrator cannot account for is an error, and is reported.
#pragma once

#include "apothem/model/model.hpp"
#include "apothem/model/state.hpp"

namespace apothem {

/// Momentum, or the time integral of a force.
struct Impulse {
  double x = 0, y = 0, angular = 0;
};

/// Energy that is gone for good since time 0, J.
struct Dissipation {
  double friction = 0, damping = 0;
};

/// What a checkpoint needs to continue the ledger.
struct Balance {
  double initial_energy = 0;
  Impulse initial;  ///< momentum at time 0
  Impulse impulse;  ///< from outside since then
  double external_work = 0;
};

class Ledger {
 public:
  /// `nodes`: the part of deformable bodies.
  Ledger(const Model& model, const State& state, double contact_energy, const Energies& nodes,
         const Impulse& momentum_of_nodes);

  /// Half a step's impulses on the free bodies, and the work of prescribed bodies over `moved`
  /// (their displacement in this step), with the forces in `state`. Called before and after the
  /// forces change.
  void half_step(const State& state, double half_step, const std::vector<double>& moved);

  /// An impulse from outside that no force in `state` tells of.
  void add_impulse(const Impulse& impulse);

  [[nodiscard]] Energies energies(const State& state, double contact_energy,
                                  const Dissipation& dissipation, const Energies& nodes) const;
  /// Of the free rigid bodies, J.
  [[nodiscard]] double kinetic(const State& state) const;
  [[nodiscard]] Momenta momenta(const State& state, const Impulse& of_nodes) const;

  [[nodiscard]] const Balance& balance() const { return balance_; }
  void restore(const Balance& balance) { balance_ = balance; }

 private:
  [[nodiscard]] Energies terms(const State& state, double contact_energy,
                               const Energies& nodes) const;
  [[nodiscard]] Impulse momentum(const State& state, const Impulse& of_nodes) const;

  const Model& model_;
  std::vector<int> free_, held_, driven_, not_free_;
  Balance balance_;
};

}  // namespace apothem
