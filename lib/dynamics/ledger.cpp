#include "lib/dynamics/ledger.hpp"

namespace apothem {
namespace {

double total(const Energies& e) {
  return e.kinetic + e.strain + e.contact + e.gravity + e.friction_loss + e.damping_loss +
         e.numerical_loss - e.external_work;
}

}  // namespace

void Ledger::start(const State& state, const Energies& terms) {
  outer_ = {};
  work_ = numerical_loss_ = initial_energy_ = 0;
  refresh(state);
  initial_energy_ = close(state, terms).total_error;
  initial_ = dofs_.momentum(state);
}

void Ledger::book(const State& state, double h) {
  outer_.add({h * weight_.x, h * weight_.y, h * weight_.angular});
  // What holds a coordinate takes the force on it.
  dofs_.add_reactions(state, h, outer_);
  for (const DegreesOfFreedom::Driven& d : dofs_.driven()) {
    work_ -= state.f[d.coordinate] * d.move / 2;
  }
}

void Ledger::book_before_drift(const State& state, double dt) {
  book(state, dt / 2);
  // A driven coordinate of a node has no momentum of its own; the other one keeps it, and is
  // carried along.
  const size_t rigid = state.layout.node(0);
  for (const DegreesOfFreedom::Driven& d : dofs_.driven()) {
    if (d.coordinate < rigid) continue;
    const size_t other = d.axis == 0 ? d.coordinate + 1 : d.coordinate - 1;
    if (!dofs_.can_move(other)) continue;
    const double p = state.v[other] * dofs_.mass(other);
    outer_.angular += (d.axis == 0 ? dt : -dt) * state.v[d.coordinate] * p;
  }
}

void Ledger::book_after_drift(const State& state, double dt) {
  refresh(state);
  book(state, dt / 2);
}

// The velocities that are reported are those of the end of the step: v1 - v0 = -h/2 a0 + 3h/2 a1.
void Ledger::book_implicit(const State& before, const State& after, double h) {
  const Impulse weight = weight_;
  dofs_.add_reactions(before, -h / 2, outer_);
  refresh(after);
  dofs_.add_reactions(after, 3 * h / 2, outer_);
  outer_.add({h / 2 * (3 * weight_.x - weight.x), h / 2 * (3 * weight_.y - weight.y),
              h / 2 * (weight.angular + weight_.angular)});
  for (const DegreesOfFreedom::Driven& d : dofs_.driven()) work_ -= after.f[d.coordinate] * d.move;
}

Energies Ledger::close(const State& state, const Energies& terms) const {
  Energies e = terms;
  e.kinetic = dofs_.kinetic(state);
  e.gravity = dofs_.gravity_energy(state);
  e.numerical_loss = numerical_loss_;
  e.external_work += work_;
  e.total_error = total(e) - initial_energy_;
  return e;
}

Momenta Ledger::momenta(const State& state) const {
  const Impulse p = dofs_.momentum(state);
  return {p.x,
          p.y,
          p.angular,
          p.x - initial_.x - outer_.x,
          p.y - initial_.y - outer_.y,
          p.angular - initial_.angular - outer_.angular};
}

}  // namespace apothem
