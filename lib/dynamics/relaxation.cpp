// Dynamic relaxation with kinetic damping (docs/theory.md, Step): explicit steps of length kStep,
// and all nodes stop whenever the kinetic energy has passed a maximum (Barnes 1988). The masses are
// not the bodies' own but m_i = 1.1/4 (SUM_j |K_ij| + contacts), with a unit of time that makes the
// stability limit 1 or more: every node then moves as fast as its own stiffness allows. Loads,
// supports and prescribed bodies move to their new places over the first steps. A little damping in
// proportion to the stiffness is needed besides: stopped every two steps, a mode whose period is
// four steps, as those of stiff contacts are, would ring on and stop all others too early. Rigid
// bodies are held by their contacts only, whose stiffness changes: their scaled masses follow it at
// once where it grows.

#include <fmt/format.h>

#include <cmath>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/equilibrium.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kMass = 1.1 / 4;
constexpr double kStep = 0.75;
constexpr double kLag = 0.1;      // of the force's change over a step, added to it: -K v times kLag
constexpr double kStride = 0.02;  // of the shortest length, per step: no contact is jumped over
constexpr int kCheckedEvery = 10;
constexpr int kRenewedEvery = 200;  // steps between looks at the stiffness
constexpr double kRamp = 50;        // steps
constexpr double kLeast = 1e-3;     // of a rigid body's mass if it lay flat on another one
constexpr std::int64_t kMostSteps = 300'000, kMostAfterNewton = 60'000;

}  // namespace

// So many steps that nothing moves more than a stride in one.
double Equilibrium::ramp(double from, double until) const {
  return std::max(kRamp, std::ceil(driven_way(from, until) / (kStride * lengths_.shortest())));
}

// The longest way of a driven coordinate or of a point of a prescribed body, m.
double Equilibrium::driven_way(double from, double until) const {
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
                       hypotenuse(b[0] - a[0], b[1] - a[1]) + body.reach() * std::abs(b[2] - a[2]));
  }
  return longest;
}

void Equilibrium::find_masses(const State& state) {
  for (std::vector<double>* v : {&stiffness_.elastic, &stiffness_.contact, &stiffness_.rigid}) {
    std::ranges::fill(*v, 0.);
  }
  for (const auto& term : terms_) term->add_stiffness(state, stiffness_);
  searches_ = searches();
  for (size_t c = 0; c < first_; ++c) mass_[c] = 0;
  raise_masses();
  for (size_t c = first_; c < mass_.size(); ++c) {
    const size_t node = c - first_;
    mass_[c] = kMass * (stiffness_.elastic[node] + stiffness_.contact[node / 2]);
    inverse_[c] = held(c) ? 0 : 1 / mass_[c];
  }
}

// Of rigid bodies whose contacts have become stiffer; their energy stays what it is.
void Equilibrium::raise_masses() {
  for (size_t c = 0; c < first_; ++c) {
    if (held(c)) continue;
    const size_t body = c / 3;
    const double inertia = dofs_.mass(c);
    const double least = kLeast * kMass * flat_[body] * inertia / model_.bodies[body].mass;
    double stiffness = stiffness_.rigid[c] + lambda_[body] * inertia;
    if (pushed_[c]) stiffness += stiffness_.rigid[c % 3 == 0 ? c + 1 : c - 1];  // obliquely
    const double needed = std::max(least, kMass * stiffness);
    if (!(needed > mass_[c])) continue;
    velocity_[c] *= std::sqrt(mass_[c] / needed);
    mass_[c] = needed;
    inverse_[c] = 1 / needed;
  }
  for (const Rail& rail : rails_) {  // one mass for both, so that they keep their directions
    const size_t c = 3 * static_cast<size_t>(rail.body);
    const double both = std::max(mass_[c], mass_[c + 1]);
    for (const size_t at : {c, c + 1}) {
      if (mass_[at] > 0) velocity_[at] *= std::sqrt(mass_[at] / both);
      mass_[at] = both;
      inverse_[at] = 1 / both;
    }
  }
}

void Equilibrium::refuse_relaxation(const State& state, const LoadStep& result) const {
  throw Unstable(fmt::format(
      "no equilibrium at t = {:.9g} s (load step {}) after {} steps of relaxation: "
      "forces out of balance are {:.3g} of the loads, most of them on \"{}\", and the sum of "
      "the forces on \"{}\" is {:.3g} of its own, where {:g} is allowed; support what can move "
      "freely, {}",
      state.time, state.step, result.iterations, result.residual, model_.name_of(result.unbalanced),
      model_.name_of(result.worst), result.imbalance, tolerance_,
      settling_ ? "or leave out time.start"
                : "reduce the load, or raise time.load_steps or time.tolerance"));
}

// Of a node, or of any point of a rigid body.
double Equilibrium::speed(size_t c) const {
  const double v = std::abs(velocity_[c]);
  return c < first_ && c % 3 == 2 ? v * radius()[c / 3] : v;
}

void Equilibrium::move(State& state, bool first) {
  const size_t n = velocity_.size();
  double kinetic = 0, fastest = 0;
  for (size_t c = 0; c < n; ++c) {
    drive_[c] = first ? rest_[c] : rest_[c] + kLag * (rest_[c] - last_[c]);
    velocity_[c] += kStep * (inverse_[c] * drive_[c]);
    kinetic += mass_[c] * velocity_[c] * velocity_[c];
    fastest = std::max(fastest, speed(c));
  }
  if (kinetic < kinetic_ || first) {
    kinetic = fastest = 0;
    for (size_t c = 0; c < n; ++c) {
      // Half a step: velocities are those between the steps.
      velocity_[c] = kStep / 2 * (inverse_[c] * drive_[c]);
      kinetic += mass_[c] * velocity_[c] * velocity_[c];
      fastest = std::max(fastest, speed(c));
    }
  }
  const double most = kStride * lengths_.shortest() / kStep;
  if (searches_ > 0 && fastest > most) {
    const double slower = most / fastest;
    for (double& v : velocity_) v *= slower;
    kinetic *= slower * slower;
  }
  kinetic_ = kinetic;
  last_ = rest_;
  for (size_t c = 0; c < n; ++c) state.x[c] += kStep * velocity_[c];
}

LoadStep Equilibrium::relax(State& state, const State& before, double time,
                            const std::function<bool()>& stop) {
  const double steps = ramp(state.time, time);
  LoadStep result{time};
  result.relaxed = true;
  std::int64_t step = 0;
  slips_from_ = before.x;
  ++state.step;
  if (pause_ && pause_->until == time) {
    state.time = pause_->time, state.x = pause_->x, state.v = pause_->v;
    step = pause_->steps;
    searches_ = searches();
  } else {
    // The scaled masses depend on what is near: the same bits from a checkpoint.
    if (contact_) contact_->forget_search();
  }
  pause_.reset();
  for (;; ++step) {
    const double share = std::min(1., static_cast<double>(step + 1) / steps);
    if (state.time != time) {
      state.time = share < 1 ? before.time + share * (time - before.time) : time;
      dofs_.place_driven(state);
      dofs_.follow(state);
    }
    find_forces(state);
    if (step % kRenewedEvery == 0 || searches() != searches_) {
      find_masses(state);
    } else {
      raise_masses();
    }
    if (step % kRenewedEvery == 0) check_shapes(state);
    if (share == 1 && step % kCheckedEvery == 0) {
      result.iterations = step;
      if (reached(state, result)) break;
      if (!std::isfinite(result.residual)) {
        refuse_diverged(state, model_.name_of(std::max(result.unbalanced, 0)));
      }
      if (after_newton_ && step >= kMostAfterNewton) refuse(state, result);
      if (step >= kMostSteps) refuse_relaxation(state, result);
    }
    move(state, step == 0);
    if (stop && stop()) {
      result.complete = false;
      pause_ = {state.time, time, step + 1, state.x, state.v};
      return result;
    }
  }
  check_shapes(state);
  keep(true, result);
  return result;
}

}  // namespace apothem
