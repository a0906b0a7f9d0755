// Dynamic relaxation with kinetic damping (theory: Sec. 5.4): explicit steps of length kStep, and
// all nodes stop whenever the kinetic energy has passed a maximum (Barnes 1988). The masses are not
// the bodies' own but m_i = 1.1/4 (SUM_j |K_ij| + contacts), with a unit of time that makes the
// stability limit 1 or more: every node then moves as fast as its own stiffness allows. Loads,
// supports and prescribed bodies move to their new places over the first steps. A little damping in
// proportion to the stiffness is needed besides: stopped every two steps, a mode whose period is
// four steps, as those of stiff contacts are, would ring on and stop all others too early.

#include "apothem/dynamics/equilibrium.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "apothem/dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr double kMass = 1.1 / 4;
constexpr double kStep = 0.75;
constexpr double kLag = 0.1;      // of the force's change over a step, added to it: -K v times kLag
constexpr double kStride = 0.02;  // of the shortest edge, per step: no contact is jumped over
constexpr double kNoise =
    4 * std::numeric_limits<double>::epsilon();  // of places and displacements
constexpr double kFar = 100;                     // of the scene's size: there a body is lost
constexpr int kCheckedEvery = 10;
constexpr int kRenewedEvery = 200;  // steps between looks at the stiffness
constexpr double kRamp = 50;        // steps
constexpr std::int64_t kMostSteps = 300'000;

}  // namespace

Equilibrium::Equilibrium(const Model& model, Deformables& deformables, SurfaceContact* contact,
                         double tolerance)
    : model_(model),
      deformables_(deformables),
      contact_(contact),
      tolerance_(tolerance),
      weight_(deformables.weights()),
      body_loads_(model.deformables.size()) {
  const size_t n = 2 * static_cast<size_t>(deformables.elements().node_count());
  for (std::vector<double>* v :
       {&element_, &mass_, &inverse_, &rest_, &drive_, &velocity_, &outside_}) {
    v->assign(n, 0);
  }
  surface_.assign(n / 2, 0);
  Box scene;
  for (const DeformableBody& body : model.deformables) {
    for (const Vec2& x : body.mesh.nodes) scene.include(x.x(), x.y());
  }
  far_ = kFar * scene.extent();
}

// So many steps that nothing moves more than a stride in one.
double Equilibrium::ramp(double from, double until) const {
  double longest = deformables_.largest_support_move(from, until);
  for (const RigidBody& body : model_.bodies) {
    if (body.motion != Motion::prescribed) continue;
    double radius = 0;
    for (const Vec2& v : body.potential.vertices) radius = std::max(radius, v.norm());
    const std::array<double, 3> a = body.history.displacement(from);
    const std::array<double, 3> b = body.history.displacement(until);
    longest =
        std::max(longest, std::hypot(b[0] - a[0], b[1] - a[1]) + radius * std::abs(b[2] - a[2]));
  }
  return std::max(kRamp, std::ceil(longest / (kStride * deformables_.elements().shortest_edge())));
}

void Equilibrium::place(State& state) const {
  deformables_.place_supports(state);
  for (size_t i = 0; i < model_.bodies.size(); ++i) {
    const RigidBody& body = model_.bodies[i];
    if (body.motion != Motion::prescribed) continue;
    const std::array<double, 3> u = body.history.displacement(state.time);
    state.position[3 * i] = body.position.x() + u[0];
    state.position[3 * i + 1] = body.position.y() + u[1];
    state.position[3 * i + 2] = body.angle + u[2];
  }
}

void Equilibrium::find_forces(State& state) {
  if (contact_) contact_->evaluate(state);
  deformables_.find_static_forces(state, contact_);
  for (size_t c = 0; c < rest_.size(); ++c) {
    rest_[c] = deformables_.held(c) ? 0 : state.node_force[c];
  }
  for (size_t c = 0; c < weight_.size(); ++c) rest_[c] += weight_[c];
}

void Equilibrium::find_masses(const State& state) {
  deformables_.elements().stiffness_sums(state.displacement, element_);
  std::fill(surface_.begin(), surface_.end(), 0.);
  if (contact_) {
    contact_->add_stiffness(surface_);
    searches_ = contact_->searches();
  }
  for (size_t c = 0; c < mass_.size(); ++c) {
    mass_[c] = kMass * (element_[c] + surface_[c / 2]);
    inverse_[c] = deformables_.held(c) ? 0 : 1 / mass_[c];
  }
}

void Equilibrium::check_shapes(const State& state) const {
  for (const DeformableBody& body : model_.deformables) {
    for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
      const size_t c = 2 * (body.first_node + i);
      if (std::max(std::abs(state.displacement[c]), std::abs(state.displacement[c + 1])) < far_) {
        continue;
      }
      throw Unstable(
          fmt::format("\"{}\" has moved {:.3g} m at t = {:.9g} s (load step {}) and finds no "
                      "equilibrium: nothing holds it against its loads; support it, or press it "
                      "against another body",
                      body.name, std::hypot(state.displacement[c], state.displacement[c + 1]),
                      state.time, state.step));
    }
  }
  const std::string element = deformables_.inverted(state);
  if (element.empty()) return;
  throw Unstable(
      fmt::format("{} has turned inside out at t = {:.9g} s (load step {}): the load is more than "
                  "the material can bear; reduce it, or raise time.load_steps",
                  element, state.time, state.step));
}

// Whether the residual, and the sum of the forces on each body, are small against the loads.
bool Equilibrium::reached(const State& state, LoadStep& result) {
  const std::vector<double> outside = deformables_.outside_forces(state);
  double loads = 0, residual = 0, noise = 0, most = -1;
  result.imbalance = result.load = 0;
  result.worst = 0;
  result.off.assign(model_.deformables.size(), 0);
  bool balanced = true;
  for (size_t b = 0; b < model_.deformables.size(); ++b) {
    const DeformableBody& body = model_.deformables[b];
    Vec2 sum = Vec2::Zero();
    double sizes = 0, own_noise = 0, own_residual = 0;
    for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
      for (int axis = 0; axis < 2; ++axis) {
        const size_t c = 2 * (body.first_node + i) + axis;
        // What acts from outside; at supports their reaction.
        double f = outside[c] + (weight_.empty() ? 0 : weight_[c]);
        if (deformables_.held(c)) f = -state.node_force[c];
        loads += f * f;
        sizes += std::abs(f);
        own_residual += rest_[c] * rest_[c];
        sum[axis] += rest_[c];
        const double rounded = element_[c] * std::abs(state.displacement[c]) +
                               surface_[c / 2] * std::abs(body.mesh.nodes[i][axis]);
        own_noise += rounded * rounded;
      }
    }
    result.load += sizes;
    if (contact_) {
      const BodyForce f = contact_->on_deformable(static_cast<int>(b));
      sizes += std::hypot(f.fx, f.fy);
    }
    body_loads_[b] = std::max(body_loads_[b], sizes);
    noise += own_noise;
    residual += own_residual;
    if (own_residual > most) {
      most = own_residual;
      result.restless = static_cast<int>(b);
    }
    const double off = result.off[b] = sum.norm();
    balanced = balanced && off <= tolerance_ * body_loads_[b] + kNoise * std::sqrt(own_noise);
    if (off > result.imbalance * body_loads_[b]) {
      result.imbalance = off / body_loads_[b];
      result.worst = static_cast<int>(b);
    }
  }
  if (contact_) {
    rigid_force_.assign(3 * model_.bodies.size(), 0);
    contact_->add_to_bodies(rigid_force_);
    for (size_t k = 0; k < rigid_force_.size(); ++k) {
      if (k % 3 < 2) loads += rigid_force_[k] * rigid_force_[k];
    }
  }
  loads_ = std::max(loads_, std::sqrt(loads));
  residual = std::sqrt(residual);
  result.residual = loads_ > 0 ? residual / loads_ : 0;
  return balanced && residual <= tolerance_ * loads_ + kNoise * std::sqrt(noise);
}

void Equilibrium::move(State& state, bool first) {
  const size_t n = velocity_.size();
  double kinetic = 0, fastest = 0;
  for (size_t c = 0; c < n; ++c) {
    drive_[c] = first ? rest_[c] : rest_[c] + kLag * (rest_[c] - last_[c]);
    velocity_[c] += kStep * (inverse_[c] * drive_[c]);
    kinetic += mass_[c] * velocity_[c] * velocity_[c];
    fastest = std::max(fastest, std::abs(velocity_[c]));
  }
  if (kinetic < kinetic_ || first) {
    kinetic = fastest = 0;
    for (size_t c = 0; c < n; ++c) {
      // Half a step: velocities are those between the steps.
      velocity_[c] = kStep / 2 * (inverse_[c] * drive_[c]);
      kinetic += mass_[c] * velocity_[c] * velocity_[c];
      fastest = std::max(fastest, std::abs(velocity_[c]));
    }
  }
  const double most = kStride * deformables_.elements().shortest_edge() / kStep;
  if (contact_ && fastest > most) {
    const double slower = most / fastest;
    for (double& v : velocity_) v *= slower;
    kinetic *= slower * slower;
  }
  kinetic_ = kinetic;
  last_ = rest_;
  for (size_t c = 0; c < n; ++c) state.displacement[c] += kStep * velocity_[c];
}

void Equilibrium::restore(const EquilibriumMemory& memory) {
  outside_ = memory.outside;
  loads_ = memory.loads;
  body_loads_ = memory.body_loads;
}

LoadStep Equilibrium::find(State& state, double time, const std::function<bool()>& stop) {
  const double from = state.time, steps = ramp(from, time);
  const std::vector<double> before = state.displacement;
  LoadStep result{time};
  ++state.step;
  // The scaled masses depend on what is near: the same bits from a checkpoint.
  if (contact_) contact_->forget_search();
  for (std::int64_t step = 0;; ++step) {
    const double share = std::min(1., static_cast<double>(step + 1) / steps);
    if (state.time != time) {
      state.time = share < 1 ? from + share * (time - from) : time;
      place(state);
    }
    find_forces(state);
    if (step % kRenewedEvery == 0 || (contact_ && contact_->searches() != searches_)) {
      find_masses(state);
    }
    if (step % kRenewedEvery == 0) check_shapes(state);
    if (share == 1 && step % kCheckedEvery == 0) {
      result.iterations = step;
      if (reached(state, result)) break;
      if (!std::isfinite(result.residual) || step >= kMostSteps) {
        throw Unstable(fmt::format(
            "no equilibrium at t = {:.9g} s (load step {}) after {} steps of relaxation: nodal "
            "forces out of balance are {:.3g} of the loads, most of them on \"{}\", and the sum of "
            "the forces on \"{}\" is {:.3g} of its own, where time.tolerance is {:g}; support what "
            "can move freely, reduce the load, or raise time.load_steps or time.tolerance",
            time, state.step, step, result.residual, model_.deformables[result.restless].name,
            model_.deformables[result.worst].name, result.imbalance, tolerance_));
      }
    }
    move(state, step == 0);
    if (stop && stop()) {
      result.complete = false;
      return result;
    }
  }
  check_shapes(state);
  const std::vector<double> outside = deformables_.outside_forces(state);
  double work = 0;
  for (size_t c = 0; c < outside.size(); ++c) {
    work += (outside_[c] + outside[c]) / 2 * (state.displacement[c] - before[c]);
  }
  deformables_.add_load_work(work);
  outside_ = outside;
  return result;
}

}  // namespace apothem
