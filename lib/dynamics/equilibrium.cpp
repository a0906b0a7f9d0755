// Dynamic relaxation with kinetic damping (docs/theory.md, Step): explicit steps of length kStep,
// and all nodes stop whenever the kinetic energy has passed a maximum (Barnes 1988). The masses are
// not the bodies' own but m_i = 1.1/4 (SUM_j |K_ij| + contacts), with a unit of time that makes the
// stability limit 1 or more: every node then moves as fast as its own stiffness allows. Loads,
// supports and prescribed bodies move to their new places over the first steps. A little damping in
// proportion to the stiffness is needed besides: stopped every two steps, a mode whose period is
// four steps, as those of stiff contacts are, would ring on and stop all others too early.

#include "apothem/dynamics/equilibrium.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "apothem/dynamics/unstable.hpp"
#include "apothem/mesh/measure.hpp"

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

Equilibrium::Equilibrium(const Model& model, const DegreesOfFreedom& dofs, const Terms& terms,
                         double tolerance)
    : model_(model),
      dofs_(dofs),
      terms_(terms),
      tolerance_(tolerance),
      first_(dofs.layout().node(0)),
      shortest_edge_(HUGE_VAL),
      lambda_(model.bodies.size()),
      body_loads_(model.deformables.size()) {
  const size_t n = dofs.layout().size() - first_;
  for (std::vector<double>* v :
       {&stiffness_.elastic, &mass_, &inverse_, &rest_, &drive_, &velocity_, &outside_}) {
    v->assign(n, 0);
  }
  stiffness_.contact.assign(n / 2, 0);
  if (!dofs.weight().empty()) {
    const std::span<const double> weight = dofs.layout().of_nodes(dofs.weight());
    weight_.assign(weight.begin(), weight.end());
  }
  Box scene;
  for (const DeformableBody& body : model.deformables) {
    shortest_edge_ = std::min(shortest_edge_, mesh_quality(body.mesh).shortest_edge);
    for (const Vec2& x : body.mesh.nodes) scene.include(x.x(), x.y());
  }
  far_ = kFar * scene.extent();
}

// So many steps that nothing moves more than a stride in one.
double Equilibrium::ramp(double from, double until) const {
  double longest = 0;
  for (const DegreesOfFreedom::Driven& d : dofs_.driven()) {
    if (d.coordinate < first_) continue;
    const auto axis = static_cast<size_t>(d.axis);
    const std::array<double, 3> a = d.motion->displacement(from);
    const std::array<double, 3> b = d.motion->displacement(until);
    longest = std::max(longest, std::abs(b[axis] - a[axis]) + d.arm.norm() * std::abs(b[2] - a[2]));
  }
  for (const RigidBody& body : model_.bodies) {
    if (body.motion != Motion::prescribed) continue;
    const std::array<double, 3> a = body.history.displacement(from);
    const std::array<double, 3> b = body.history.displacement(until);
    longest = std::max(longest,
                       std::hypot(b[0] - a[0], b[1] - a[1]) + body.reach() * std::abs(b[2] - a[2]));
  }
  return std::max(kRamp, std::ceil(longest / (kStride * shortest_edge_)));
}

void Equilibrium::find_forces(State& state) {
  std::ranges::fill(state.layout.of_rigid(state.f), 0.);
  Stopwatch off;
  for (const auto& term : terms_) term->add_forces({state, state.v, 0, lambda_, off, 0, true});
  for (size_t c = 0; c < rest_.size(); ++c) rest_[c] = held(c) ? 0 : state.f[first_ + c];
  for (size_t c = 0; c < weight_.size(); ++c) rest_[c] += weight_[c];
}

void Equilibrium::find_masses(const State& state) {
  std::fill(stiffness_.elastic.begin(), stiffness_.elastic.end(), 0.);
  std::fill(stiffness_.contact.begin(), stiffness_.contact.end(), 0.);
  for (const auto& term : terms_) term->add_stiffness(state, stiffness_);
  revision_ = revision();
  for (size_t c = 0; c < mass_.size(); ++c) {
    mass_[c] = kMass * (stiffness_.elastic[c] + stiffness_.contact[c / 2]);
    inverse_[c] = held(c) ? 0 : 1 / mass_[c];
  }
}

std::int64_t Equilibrium::revision() const {
  std::int64_t sum = 0;
  for (const auto& term : terms_) sum += term->revision();
  return sum;
}

void Equilibrium::refuse_diverged(const State& state, const std::string& body) const {
  throw Unstable(
      fmt::format("the relaxation of \"{}\" diverges at t = {:.9g} s (load step {}): the load of "
                  "one step is too much for it; raise time.load_steps or reduce the load",
                  body, state.time, state.step));
}

void Equilibrium::check_shapes(const State& state) const {
  for (const DeformableBody& body : model_.deformables) {
    for (NodeIndex i = 0; i < static_cast<NodeIndex>(body.mesh.nodes.size()); ++i) {
      const Vec2 u = state.node(body.first_node + i);
      if (!is_finite(u)) refuse_diverged(state, body.name);
      if (std::max(std::abs(u.x()), std::abs(u.y())) < far_) continue;
      throw Unstable(
          fmt::format("\"{}\" has moved {:.3g} m at t = {:.9g} s (load step {}) and finds no "
                      "equilibrium: nothing holds it against its loads; support it, or press it "
                      "against another body",
                      body.name, u.norm(), state.time, state.step));
    }
  }
  for (const auto& term : terms_) term->watch(state);
}

// Loads on nodes, and the reactions of supports with prescribed motion, N.
std::vector<double> Equilibrium::given_forces(const State& state) const {
  std::vector<double> forces(rest_.size(), 0);
  for (const auto& term : terms_) term->add_given_forces(forces);
  for (const DegreesOfFreedom::Driven& d : dofs_.driven()) {
    if (d.coordinate >= first_) forces[d.coordinate - first_] -= state.f[d.coordinate];
  }
  return forces;
}

// Whether the sum of the forces on a body is small against its loads; adds to the sums of a look.
bool Equilibrium::body_balanced(const State& state, DeformableIndex b,
                                const std::vector<double>& outside, LoadStep& result) {
  const DeformableBody& body = model_.deformables[b];
  Vec2 sum = Vec2::Zero();
  double sizes = 0, noise = 0, residual = 0;
  for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      const size_t c = 2 * (static_cast<size_t>(body.first_node) + i) + static_cast<size_t>(axis);
      // What acts from outside; at supports their reaction.
      double f = outside[c] + (weight_.empty() ? 0 : weight_[c]);
      if (held(c)) f = -state.f[first_ + c];
      sum_loads_ += f * f;
      sizes += std::abs(f);
      residual += rest_[c] * rest_[c];
      sum[axis] += rest_[c];
      const double rounded = stiffness_.elastic[c] * std::abs(state.x[first_ + c]) +
                             stiffness_.contact[c / 2] * std::abs(body.mesh.nodes[i][axis]);
      noise += rounded * rounded;
    }
  }
  result.load += sizes;
  for (const auto& term : terms_) {
    const Vec2 force = term->force_on(b);
    sizes += std::hypot(force.x(), force.y());
  }
  body_loads_[b] = std::max(body_loads_[b], sizes);
  sum_noise_ += noise;
  sum_residual_ += residual;
  if (residual > most_) {
    most_ = residual;
    result.unbalanced = b;
  }
  const double off = result.off[b] = sum.norm();
  if (off > result.imbalance * body_loads_[b]) {
    result.imbalance = off / body_loads_[b];
    result.worst = b;
  }
  return off <= tolerance_ * body_loads_[b] + kNoise * std::sqrt(noise);
}

// Whether the residual, and the sum of the forces on each body, are small against the loads.
bool Equilibrium::reached(const State& state, LoadStep& result) {
  const std::vector<double> outside = given_forces(state);
  sum_loads_ = sum_residual_ = sum_noise_ = 0;
  most_ = -1;
  result.imbalance = result.load = 0;
  result.worst = 0;
  result.off.assign(model_.deformables.size(), 0);
  bool balanced = true;
  for (DeformableIndex b = 0; b < static_cast<DeformableIndex>(model_.deformables.size()); ++b) {
    balanced = body_balanced(state, b, outside, result) && balanced;
  }
  for (size_t c = 0; c < first_; ++c) {  // of contact on rigid bodies
    if (c % 3 < 2) sum_loads_ += state.f[c] * state.f[c];
  }
  loads_ = std::max(loads_, std::sqrt(sum_loads_));
  const double residual = std::sqrt(sum_residual_);
  result.residual = loads_ > 0 ? residual / loads_ : 0;
  return balanced && residual <= tolerance_ * loads_ + kNoise * std::sqrt(sum_noise_);
}

void Equilibrium::refuse(const State& state, const LoadStep& result) const {
  throw Unstable(fmt::format(
      "no equilibrium at t = {:.9g} s (load step {}) after {} steps of relaxation: nodal "
      "forces out of balance are {:.3g} of the loads, most of them on \"{}\", and the sum of "
      "the forces on \"{}\" is {:.3g} of its own, where time.tolerance is {:g}; support what "
      "can move freely, reduce the load, or raise time.load_steps or time.tolerance",
      state.time, state.step, result.iterations, result.residual,
      model_.deformables[result.unbalanced].name, model_.deformables[result.worst].name,
      result.imbalance, tolerance_));
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
  const double most = kStride * shortest_edge_ / kStep;
  if (revision_ > 0 && fastest > most) {
    const double slower = most / fastest;
    for (double& v : velocity_) v *= slower;
    kinetic *= slower * slower;
  }
  kinetic_ = kinetic;
  last_ = rest_;
  for (size_t c = 0; c < n; ++c) state.x[first_ + c] += kStep * velocity_[c];
}

LoadStep Equilibrium::find(State& state, Ledger& ledger, double time,
                           const std::function<bool()>& stop) {
  const State before = state;
  const double loads_before = loads_;
  const std::vector<double> body_loads_before = body_loads_;
  const double steps = ramp(state.time, time);
  LoadStep result{time};
  ++state.step;
  // The scaled masses depend on what is near: the same bits from a checkpoint.
  for (const auto& term : terms_) term->start_load_step();
  for (std::int64_t step = 0;; ++step) {
    const double share = std::min(1., static_cast<double>(step + 1) / steps);
    if (state.time != time) {
      state.time = share < 1 ? before.time + share * (time - before.time) : time;
      dofs_.place_driven(state);
      dofs_.follow(state);
    }
    find_forces(state);
    if (step % kRenewedEvery == 0 || revision() != revision_) find_masses(state);
    if (step % kRenewedEvery == 0) check_shapes(state);
    if (share == 1 && step % kCheckedEvery == 0) {
      result.iterations = step;
      if (reached(state, result)) break;
      if (!std::isfinite(result.residual)) {
        refuse_diverged(state, model_.deformables[std::max(result.unbalanced, 0)].name);
      }
      if (step >= kMostSteps) refuse(state, result);
    }
    move(state, step == 0);
    if (stop && stop()) {
      state = before;
      loads_ = loads_before;
      body_loads_ = body_loads_before;
      for (const auto& term : terms_) term->refresh(state);
      result.complete = false;
      return result;
    }
  }
  check_shapes(state);
  // The ledger itself knows the work of prescribed motion.
  std::vector<double> loads(rest_.size(), 0);
  for (const auto& term : terms_) term->add_given_forces(loads);
  double work = 0;
  for (size_t c = 0; c < loads.size(); ++c) {
    work += (outside_[c] + loads[c]) / 2 * (state.x[first_ + c] - before.x[first_ + c]);
  }
  ledger.add_work(work);
  outside_ = loads;
  return result;
}

}  // namespace apothem
