#include "apothem/dynamics/ledger.hpp"

namespace apothem {
namespace {

double total(const Energies& e) {
  return e.kinetic + e.strain + e.contact + e.gravity + e.friction_loss + e.damping_loss -
         e.external_work;
}

}  // namespace

Ledger::Ledger(const Model& model, const State& state, double contact_energy, const Energies& nodes,
               const Impulse& momentum_of_nodes)
    : model_(model) {
  for (int i = 0; i < static_cast<int>(model.bodies.size()); ++i) {
    const RigidBody& body = model.bodies[i];
    if (body.motion == Motion::free) {
      free_.push_back(i);
      if (body.held[0] || body.held[1] || body.held[2]) held_.push_back(i);
    } else {
      not_free_.push_back(i);
      if (body.motion == Motion::prescribed) driven_.push_back(i);
    }
  }
  balance_.initial_energy = total(terms(state, contact_energy, nodes));
  balance_.initial = momentum(state, momentum_of_nodes);
}

void Ledger::half_step(const State& state, double half_step, const std::vector<double>& moved) {
  Impulse outer;  // force and moment about the model's origin on the free bodies from outside
  const auto add = [&](const double* x, double fx, double fy, double moment) {
    outer.x += fx;
    outer.y += fy;
    outer.angular += x[0] * fy - x[1] * fx + moment;
  };
  for (const int i : not_free_) {  // action and reaction
    const size_t k = 3 * static_cast<size_t>(i);
    add(&state.position[k], -state.force[k], -state.force[k + 1], -state.force[k + 2]);
  }
  const Vec2& g = model_.gravity;
  if (g != Vec2::Zero()) {
    for (const int i : free_) {
      const double m = model_.bodies[i].mass;
      add(&state.position[3 * static_cast<size_t>(i)], m * g.x(), m * g.y(), 0);
    }
  }
  for (const int i : held_) {  // the support takes what would move a held coordinate
    const RigidBody& body = model_.bodies[i];
    const size_t k = 3 * static_cast<size_t>(i);
    add(&state.position[k], body.held[0] ? -(state.force[k] + body.mass * g.x()) : 0,
        body.held[1] ? -(state.force[k + 1] + body.mass * g.y()) : 0,
        body.held[2] ? -state.force[k + 2] : 0);
  }
  add_impulse({half_step * outer.x, half_step * outer.y, half_step * outer.angular});
  for (const int i : driven_) {
    for (size_t k = 3 * static_cast<size_t>(i), end = k + 3; k < end; ++k) {
      balance_.external_work -= state.force[k] * moved[k] / 2;
    }
  }
}

double Ledger::kinetic(const State& state) const {
  double sum = 0;
  for (const int i : free_) {
    const RigidBody& body = model_.bodies[i];
    const double* v = &state.velocity[3 * static_cast<size_t>(i)];
    sum += (body.mass * (v[0] * v[0] + v[1] * v[1]) + body.inertia * v[2] * v[2]) / 2;
  }
  return sum;
}

Energies Ledger::terms(const State& state, double contact_energy, const Energies& nodes) const {
  Energies e = nodes;
  e.kinetic += kinetic(state);
  for (const int i : free_) {
    const RigidBody& body = model_.bodies[i];
    const double* x = &state.position[3 * static_cast<size_t>(i)];
    // What rounding keeps out of the position counts: the fall may be far smaller than the height.
    const double* r = &state.remainder[3 * static_cast<size_t>(i)];
    e.gravity -= body.mass * (model_.gravity.x() * ((x[0] - body.position.x()) + r[0]) +
                              model_.gravity.y() * ((x[1] - body.position.y()) + r[1]));
  }
  e.contact = contact_energy;
  e.external_work += balance_.external_work;
  return e;
}

void Ledger::add_impulse(const Impulse& impulse) {
  balance_.impulse.x += impulse.x;
  balance_.impulse.y += impulse.y;
  balance_.impulse.angular += impulse.angular;
}

Energies Ledger::energies(const State& state, double contact_energy, const Dissipation& dissipation,
                          const Energies& nodes) const {
  Energies e = terms(state, contact_energy, nodes);
  e.friction_loss = dissipation.friction;
  e.damping_loss += dissipation.damping;
  e.total_error = total(e) - balance_.initial_energy;
  return e;
}

Impulse Ledger::momentum(const State& state, const Impulse& of_nodes) const {
  Impulse p = of_nodes;
  for (const int i : free_) {
    const RigidBody& body = model_.bodies[i];
    const double* v = &state.velocity[3 * static_cast<size_t>(i)];
    const double* x = &state.position[3 * static_cast<size_t>(i)];
    p.x += body.mass * v[0];
    p.y += body.mass * v[1];
    p.angular += body.mass * (x[0] * v[1] - x[1] * v[0]) + body.inertia * v[2];
  }
  return p;
}

Momenta Ledger::momenta(const State& state, const Impulse& of_nodes) const {
  const Impulse p = momentum(state, of_nodes);
  return {p.x,
          p.y,
          p.angular,
          p.x - balance_.initial.x - balance_.impulse.x,
          p.y - balance_.initial.y - balance_.impulse.y,
          p.angular - balance_.initial.angular - balance_.impulse.angular};
}

}  // namespace apothem
