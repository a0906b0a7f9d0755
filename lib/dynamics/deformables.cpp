#include "apothem/dynamics/deformables.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "apothem/fem/spectrum.hpp"

namespace apothem {
namespace {

std::vector<ElementSet> element_sets(const Model& model) {
  std::vector<ElementSet> sets;
  for (const DeformableBody& body : model.deformables) {
    const Material& m = model.materials[body.material];
    sets.push_back({body.element, &body.mesh, body.first_node, m.elastic, m.density,
                    model.thickness, m.stiffness_damping});
  }
  return sets;
}

}  // namespace

Deformables::Deformables(const Model& model, State& state, int threads)
    : model_(model), elements_(element_sets(model), threads) {
  const auto nodes = static_cast<size_t>(elements_.node_count());
  for (std::vector<double>* v : {&state.displacement, &state.node_velocity, &state.node_force}) {
    v->assign(2 * nodes, 0);
  }
  for (const double m : elements_.mass()) inverse_mass_.insert(inverse_mass_.end(), 2, 1 / m);
  if (model.gravity != Vec2::Zero()) {
    for (size_t i = 0; i < nodes; ++i) {
      acceleration_.insert(acceleration_.end(), {model.gravity.x(), model.gravity.y()});
    }
  }
  for (const DeformableBody& body : model.deformables) {
    hold(body);
    for (const Vec2& x : body.mesh.nodes) start_.insert(start_.end(), {x.x(), x.y()});
  }
  weight_ = acceleration_;
  for (size_t c = 0; c < weight_.size(); ++c) {
    if (inverse_mass_[c] > 0) weight_[c] /= inverse_mass_[c];
  }
  torque_ = start_torque_ = weight_torque(start_);
  for (size_t c = 0; c < 2 * nodes; ++c) {
    if (inverse_mass_[c] > 0) free_mass_[static_cast<int>(c % 2)] += 1 / inverse_mass_[c];
  }
  start(state);
  find_limit(state);
  apply_loads(state);
  const double power = elements_.force(state.displacement, state.node_velocity, state.node_force);
  add_loads(state);
  first_damping_power_ = balance_.damping_power = power;
}

void Deformables::hold(const DeformableBody& body) {
  for (const Support& support : body.supports) {
    for (const int node : support.nodes) {
      for (int axis = 0; axis < 2; ++axis) {
        if (!support.held[axis]) continue;
        const int c = 2 * (body.first_node + node) + axis;
        if (inverse_mass_[c] > 0) held_.push_back(c);
        inverse_mass_[c] = 0;
        if (!acceleration_.empty()) acceleration_[c] = 0;
        if (!support.motion.velocity.empty()) driven_.push_back({c, axis, &support.motion});
      }
    }
  }
}

void Deformables::start(State& state) const {
  for (const DeformableBody& body : model_.deformables) {
    const auto n = static_cast<int>(body.mesh.nodes.size());
    double mass = 0;
    Vec2 centre = Vec2::Zero();
    for (int i = 0; i < n; ++i) {
      const double m = elements_.mass()[body.first_node + i];
      mass += m;
      centre += m * body.mesh.nodes[i];
    }
    centre /= mass;
    for (int i = 0; i < n; ++i) {
      const Vec2 v = body.velocity + cross(body.spin, Vec2(body.mesh.nodes[i] - centre));
      for (int axis = 0; axis < 2; ++axis) {
        const size_t c = 2 * static_cast<size_t>(body.first_node + i) + axis;
        if (inverse_mass_[c] > 0) state.node_velocity[c] = v[axis];
      }
    }
  }
  for (const Driven& d : driven_) {
    state.node_velocity[d.coordinate] = d.motion->rate(0)[d.axis];
  }
}

void Deformables::find_limit(const State& state) {
  const double lambda = largest_eigenvalue(elements_, state.displacement, inverse_mass_);
  if (!(lambda > 0)) {
    limit_ = {HUGE_VAL, "no element can move"};
    return;
  }
  const double w = std::sqrt(lambda);
  double beta = 0;
  for (const DeformableBody& body : model_.deformables) {
    beta = std::max(beta, model_.materials[body.material].stiffness_damping);
  }
  // Damping lags behind by half a step (T. Belytschko et al. 2014, Sec. 6.2).
  const double ratio = beta * w / 2;
  limit_ = {2 / (w * (std::sqrt(1 + ratio * ratio) + ratio)),
            ratio > 0 ? "elements and their damping" : "elements"};
}

void Deformables::damp(State& state, double h) {
  for (const DeformableBody& body : model_.deformables) {
    const double damping =
        model_.materials[body.material].mass_damping + model_.contact.mass_damping;
    if (damping == 0) continue;
    const double rest = std::exp(-damping * h);
    const size_t first = 2 * static_cast<size_t>(body.first_node);
    for (size_t c = first; c < first + 2 * body.mesh.nodes.size(); ++c) {
      if (inverse_mass_[c] == 0) continue;
      const double mass = 1 / inverse_mass_[c];
      double& v = state.node_velocity[c];
      balance_.mass_damping_loss += mass * v * v / 2 * (1 - rest * rest);
      const double lost = mass * v * (rest - 1);
      const double arm = start_[c ^ 1] + state.displacement[c ^ 1];
      if (c % 2 == 0) {
        impulse_.x += lost;
        impulse_.angular -= arm * lost;
      } else {
        impulse_.y += lost;
        impulse_.angular += arm * lost;
      }
      v *= rest;
    }
  }
}

void Deformables::kick(State& state, double h) const {
  const size_t n = inverse_mass_.size();
  double* v = state.node_velocity.data();
  const double* f = state.node_force.data();
  if (acceleration_.empty()) {
    for (size_t c = 0; c < n; ++c) v[c] += h * (inverse_mass_[c] * f[c]);
  } else {
    for (size_t c = 0; c < n; ++c) v[c] += h * (inverse_mass_[c] * f[c] + acceleration_[c]);
  }
}

void Deformables::drift(State& state, double dt) {
  for (const Driven& d : driven_) {
    // The velocity that arrives where the motion is at the end of the step.
    const double goal = d.motion->displacement(state.time)[d.axis];
    state.node_velocity[d.coordinate] = (goal - state.displacement[d.coordinate]) / dt;
  }
  book(state, dt / 2);
  // A driven coordinate has no momentum of its own; the other one of its node keeps it, and is
  // carried along.
  for (const Driven& d : driven_) {
    const int other = d.coordinate ^ 1;
    if (inverse_mass_[other] == 0) continue;
    const double p = state.node_velocity[other] / inverse_mass_[other];
    impulse_.angular += (d.axis == 0 ? dt : -dt) * state.node_velocity[d.coordinate] * p;
  }
  double* u = state.displacement.data();
  const double* v = state.node_velocity.data();
  const size_t n = state.displacement.size();
  for (size_t c = 0; c < n; ++c) u[c] += dt * v[c];
}

void Deformables::add_loads(State& state) const {
  for (const auto& [node, force] : loads_) {
    state.node_force[2 * static_cast<size_t>(node)] += force.x();
    state.node_force[2 * static_cast<size_t>(node) + 1] += force.y();
  }
}

std::vector<double> Deformables::free_mass() const {
  std::vector<double> mass(elements_.mass());
  for (size_t i = 0; i < mass.size(); ++i) {
    if (inverse_mass_[2 * i] == 0 && inverse_mass_[2 * i + 1] == 0) mass[i] = 0;
  }
  return mass;
}

void Deformables::find_forces(State& state, double dt, const SurfaceContact* contact) {
  balance_.damping_power =
      elements_.force(state.displacement, state.node_velocity, state.node_force);
  balance_.summed_damping_loss += dt * balance_.damping_power;
  apply_loads(state);
  add_loads(state);
  if (contact) contact->add_to_nodes(state.node_force);
  torque_ = start_torque_ + weight_torque(state.displacement);
  book(state, dt / 2);
  for (const Driven& d : driven_) {
    state.node_velocity[d.coordinate] = d.motion->rate(state.time)[d.axis];
  }
}

void Deformables::place_supports(State& state) const {
  for (const Driven& d : driven_) {
    state.displacement[d.coordinate] = d.motion->displacement(state.time)[d.axis];
    state.node_velocity[d.coordinate] = d.motion->rate(state.time)[d.axis];
  }
}

void Deformables::find_static_forces(State& state, const SurfaceContact* contact) {
  elements_.force(state.displacement, state.node_velocity, state.node_force);
  apply_loads(state);
  add_loads(state);
  if (contact) contact->add_to_nodes(state.node_force);
}

std::vector<double> Deformables::outside_forces(const State& state) const {
  std::vector<double> outside(inverse_mass_.size(), 0);
  for (const auto& [node, force] : loads_) {
    outside[2 * static_cast<size_t>(node)] += force.x();
    outside[2 * static_cast<size_t>(node) + 1] += force.y();
  }
  for (const Driven& d : driven_) outside[d.coordinate] -= state.node_force[d.coordinate];
  return outside;
}

double Deformables::largest_support_move(double from, double until) const {
  double largest = 0;
  for (const Driven& d : driven_) {
    largest = std::max(largest, std::abs(d.motion->displacement(until)[d.axis] -
                                         d.motion->displacement(from)[d.axis]));
  }
  return largest;
}

void Deformables::restore(const DeformableBalance& balance, const State& state) {
  balance_ = balance;
  apply_loads(state);
  torque_ = start_torque_ + weight_torque(state.displacement);
}

void Deformables::apply_loads(const State& state) {
  loads_.clear();
  for (const DeformableBody& body : model_.deformables) {
    for (const DeadLoad& load : body.dead_loads) {
      const double factor = load.history.at(state.time);
      for (size_t i = 0; i < load.nodes.size(); ++i) {
        loads_.emplace_back(body.first_node + load.nodes[i], factor * load.forces[i]);
      }
    }
    for (const PressureLoad& load : body.pressures) {
      const double p = load.pressure * model_.thickness * load.history.at(state.time);
      const auto place = [&](int node) -> Vec2 {
        const size_t c = 2 * static_cast<size_t>(body.first_node + node);
        return body.mesh.nodes[node] + Vec2(state.displacement[c], state.displacement[c + 1]);
      };
      for (const auto& [a, b] : load.edges) {
        const Vec2 along = place(b) - place(a);
        const Vec2 half = p / 2 * Vec2(-along.y(), along.x());
        loads_.emplace_back(body.first_node + a, half);
        loads_.emplace_back(body.first_node + b, half);
      }
    }
  }
}

// Half a step's work and impulses of what acts from outside, with the velocity of the half step.
void Deformables::book(const State& state, double h) {
  const auto place = [&](int node) -> Vec2 {
    const size_t c = 2 * static_cast<size_t>(node);
    return {start_[c] + state.displacement[c], start_[c + 1] + state.displacement[c + 1]};
  };
  for (const auto& [node, force] : loads_) {
    const size_t c = 2 * static_cast<size_t>(node);
    balance_.load_work +=
        h * (force.x() * state.node_velocity[c] + force.y() * state.node_velocity[c + 1]);
    impulse_.x += h * force.x();
    impulse_.y += h * force.y();
    impulse_.angular += h * cross(place(node), force);
  }
  for (const int c : held_) {
    // Supports take what acts on the coordinates that they hold.
    const double reaction = -state.node_force[c];
    const Vec2 x = place(c / 2);
    if (c % 2 == 0) {
      impulse_.x += h * reaction;
      impulse_.angular -= h * x.y() * reaction;
    } else {
      impulse_.y += h * reaction;
      impulse_.angular += h * x.x() * reaction;
    }
  }
  for (const Driven& d : driven_) {
    balance_.load_work -= h * state.node_force[d.coordinate] * state.node_velocity[d.coordinate];
  }
  if (acceleration_.empty()) return;
  const Vec2& g = model_.gravity;
  impulse_.x += h * g.x() * free_mass_.x();
  impulse_.y += h * g.y() * free_mass_.y();
  impulse_.angular += h * torque_;
}

// In four sums, so that none waits for the one before.
double Deformables::weight_torque(std::span<const double> place) const {
  std::array<double, 4> sum{};
  const size_t n = weight_.size(), whole = n - n % 8;
  for (size_t c = 0; c < whole; c += 8) {
    for (size_t k = 0; k < 4; ++k) {
      const size_t x = c + 2 * k;
      sum[k] += place[x] * weight_[x + 1] - place[x + 1] * weight_[x];
    }
  }
  for (size_t x = whole; x < n; x += 2) {
    sum[0] += place[x] * weight_[x + 1] - place[x + 1] * weight_[x];
  }
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

double Deformables::kinetic(const State& state) const {
  double sum = 0;
  for (size_t c = 0; c < inverse_mass_.size(); ++c) {
    const double v = state.node_velocity[c];
    if (inverse_mass_[c] > 0) sum += v * v / inverse_mass_[c] / 2;
  }
  return sum;
}

Energies Deformables::energies(const State& state, double dt) {
  Energies e;
  e.kinetic = kinetic(state);
  for (size_t c = 0; c < acceleration_.size(); ++c) {
    if (inverse_mass_[c] > 0)
      e.gravity -= acceleration_[c] * state.displacement[c] / inverse_mass_[c];
  }
  e.strain = elements_.strain_energy(state.displacement);
  e.external_work = balance_.load_work;
  // Of the last force only half a step has acted (-dt/2 [v.C.v] since the start), and each power
  // was taken with the velocity half a step before its force: SUM v.C.a dt^2/2 = dt/4 [v.C.v].
  e.damping_loss = balance_.mass_damping_loss + balance_.summed_damping_loss -
                   dt / 4 * (balance_.damping_power - first_damping_power_);
  return e;
}

Impulse Deformables::momentum(const State& state) const {
  Impulse p;
  for (const DeformableBody& body : model_.deformables) {
    for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
      const size_t c = 2 * (body.first_node + i);
      const Vec2 x = body.mesh.nodes[i] + Vec2(state.displacement[c], state.displacement[c + 1]);
      const double px = inverse_mass_[c] > 0 ? state.node_velocity[c] / inverse_mass_[c] : 0;
      const double py =
          inverse_mass_[c + 1] > 0 ? state.node_velocity[c + 1] / inverse_mass_[c + 1] : 0;
      p.x += px;
      p.y += py;
      p.angular += x.x() * py - x.y() * px;
    }
  }
  return p;
}

Impulse Deformables::take_impulse() {
  const Impulse taken = impulse_;
  impulse_ = {};
  return taken;
}

std::string Deformables::inverted(const State& state) const {
  const FiniteElements::Collapse worst = elements_.smallest_ratio(state.displacement);
  if (worst.ratio > 0) return "";
  const DeformableBody& body = model_.deformables[worst.set];
  Vec2 centre = Vec2::Zero();
  const std::span<const int> nodes = body.mesh.element(worst.element);
  for (const int node : nodes) centre += body.mesh.nodes[node] / static_cast<double>(nodes.size());
  centre += model_.origin;
  return fmt::format("the element at ({:.6g}, {:.6g}) m of \"{}\"", centre.x(), centre.y(),
                     body.name);
}

}  // namespace apothem
