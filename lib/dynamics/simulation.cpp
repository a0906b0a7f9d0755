#include "apothem/dynamics/simulation.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace apothem {
namespace {

constexpr double kSkin = 0.1;  // of the mean body size
constexpr std::int64_t kTimedEvery = 64;
constexpr std::int64_t kWatchedEvery = 64;  // steps between looks at the energy in play
constexpr double kDeepestPhi = 0.95;  // beyond it an edge is about to cross the other's centre
constexpr double kOvershoot = 1.05;   // of a step just below the limit: see tighten_step

// Bodies that a force can move; a contact between two others would change nothing.
std::vector<bool> responsive(const Model& model) {
  std::vector<bool> result;
  for (const RigidBody& body : model.bodies) {
    const std::array<double, 3> w = body.inverse_mass();
    result.push_back(w[0] + w[1] + w[2] > 0);
  }
  return result;
}

// Energy that round-off alone may move: lifting every body, and pressing contacts, by a few
// roundings of the scene's size.
double energy_noise(const Model& model) {
  Box scene;
  double weight = 0;
  for (const RigidBody& body : model.bodies) {
    scene.include(body.position.x(), body.position.y());
    for (const Vec2& v : body.potential.vertices) {
      scene.include(body.position.x() + v.x(), body.position.y() + v.y());
    }
    if (body.motion == Motion::free) weight += body.mass * model.gravity.norm();
  }
  for (const DeformableBody& body : model.deformables) {
    for (const Vec2& x : body.mesh.nodes) scene.include(x.x(), x.y());
  }
  const double shift = 1e-12 * scene.extent();
  return weight * shift + model.stiffness() * shift * shift;
}

double skin(const Model& model) {
  double area = 0;
  int count = 0;
  for (const RigidBody& body : model.bodies) {
    if (!body.can_move()) continue;
    area += body.area;
    ++count;
  }
  return count > 0 ? kSkin * std::sqrt(area / count) : 0;
}

// Adds the time since the last lap to a phase; costs nothing in steps that are not timed.
class Stopwatch {
 public:
  Stopwatch(bool on, std::array<double, kPhaseNames.size()>& seconds) : on_(on), seconds_(seconds) {
    if (on_) last_ = std::chrono::steady_clock::now();
  }
  void lap(Phase phase) {
    if (!on_) return;
    const auto now = std::chrono::steady_clock::now();
    seconds_[static_cast<size_t>(phase)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  bool on_;
  std::array<double, kPhaseNames.size()>& seconds_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace

Simulation::Simulation(const Model& model, const TimeSettings& time, int frames, int threads)
    : model_(model), search_(responsive(model), skin(model)), contact_(threads) {
  double inradius = HUGE_VAL;
  for (int i = 0; i < static_cast<int>(model.bodies.size()); ++i) {
    const RigidBody& body = model.bodies[i];
    shapes_.add(body.potential);
    inradius = std::min(inradius, body.inradius);
    inradius_.push_back(body.inradius);
    slope_.push_back(body.potential.steepest);
    if (body.can_move()) moving_.push_back(i);
    if (body.motion == Motion::prescribed) driven_.push_back(i);
    const std::array<double, 3> start{body.position.x(), body.position.y(), body.angle};
    std::array<double, 3> rate{body.velocity.x(), body.velocity.y(), body.spin};
    if (body.motion == Motion::prescribed) rate = body.history.rate(0);
    const bool falls = body.motion == Motion::free;
    inverse_masses_.push_back(body.inverse_mass());
    for (int k = 0; k < 3; ++k) {
      state_.position.push_back(start[k]);
      state_.remainder.push_back(0);
      state_.velocity.push_back(rate[k]);
      state_.force.push_back(0);
      moved_.push_back(0);
      inverse_mass_.push_back(inverse_masses_.back()[k]);
      acceleration_.push_back(falls && k < 2 && !body.held[k] ? model.gravity[k] : 0);
    }
    shapes_.place(i, start[0], start[1], start[2]);
  }
  if (TangentialContact::needed(model.contact)) {
    std::vector<int> material;
    for (const RigidBody& body : model.bodies) material.push_back(body.material);
    tangential_.emplace(model.contact, model.thickness, material, inverse_masses_);
  }
  if (!model.deformables.empty()) deformables_.emplace(model, state_, threads);
  if (SurfaceContact::needed(model)) surface_.emplace(model, state_, threads);
  if (FoldWatch::needed(model)) folds_.emplace(model);
  if (time.statics && deformables_) {
    equilibrium_.emplace(model, *deformables_, surface_ ? &*surface_ : nullptr, time.tolerance);
  }
  stiffness_.resize(model.bodies.size());
  largest_stride_ = kLargestStride * inradius;
  energy_noise_ = energy_noise(model);
  choose_step(time, frames);
  try {
    if (surface_) {
      surface_->evaluate(state_);
      surface_->add_to_nodes(state_.node_force);
    }
    find_forces(false, state_.velocity, 0);
    if (time.settled) settle();
  } catch (const Unstable& error) {
    throw Unrunnable(error.what(), "bodies", worst_body_);
  }
  const double energy = contact_energy();
  ledger_.emplace(model_, state_, energy,
                  deformables_ ? deformables_->energies(state_, dt_) : Energies{},
                  deformables_ ? deformables_->momentum(state_) : Impulse{});
}

void Simulation::choose_step(const TimeSettings& time, int frames) {
  limit_ = contact_step_limit(model_);
  const double contact_target = time.safety * limit_.step;
  StepLimit elements = deformables_ ? deformables_->limit() : StepLimit{HUGE_VAL, ""};
  if (surface_) {
    const double rate = surface_->rate(deformables_->free_mass());
    elements = {2 / std::hypot(2 / elements.step, rate), "elements and their contacts"};
  }
  if (elements.step < limit_.step) limit_ = elements;
  stability_limit_ = limit_.step;
  if (time.statics) {
    dt_ = time.end / time.load_steps;
    limit_ = {dt_, "load steps"};
    return;
  }
  automatic_ = !time.fixed_step;
  safety_ = time.safety;
  const auto require_progress = [&] {
    if (dt_ > 0 && std::isfinite(dt_) && time.end + dt_ > time.end) return;
    throw Unrunnable(
        fmt::format("a step of {:.3g} s ({}) makes no progress towards the end at {:.3g} s; "
                    "check the magnitudes of time, stiffness, masses and speeds",
                    dt_, limit_.reason, time.end),
        "time", -1);
  };
  if (!automatic_) {
    dt_ = *time.fixed_step;
    if (dt_ > limit_.step) {
      throw Unrunnable(
          fmt::format("{} s is above the stability limit of {:.6g} s ({}); give a smaller "
                      "step or \"auto\"",
                      dt_, limit_.step, limit_.reason),
          "time/step", -1);
    }
    require_progress();
    return;
  }
  double target = contact_target;
  element_safety_ = time.element_safety.value_or(surface_ ? .2 : .5);
  if (element_safety_ * elements.step < target) {
    target = element_safety_ * elements.step;
    limit_ = elements;
  }
  const StepLimit motion = motion_step_limit(model_);
  if (motion.step < target) {
    limit_ = motion;
    target = motion.step;
  }
  const double interval = time.end / std::max(frames, 1);
  if (std::min(interval, time.longest_step) <= target) {
    target = std::min(interval, time.longest_step);
    limit_ = {target, "interval of the output"};
  }
  dt_ = interval / std::max(std::ceil(interval / target * (1 - 1e-12)), 1.0);
  require_progress();
}

Snapshot Simulation::snapshot() const {
  return {state_,
          ledger_->balance(),
          limit_,
          dt_,
          base_time_,
          base_step_,
          extremes_,
          counts_,
          energy_in_play_,
          tangential_ ? tangential_->memory() : TangentialMemory{},
          mass_damping_loss_,
          deformables_ ? deformables_->balance() : DeformableBalance{},
          surface_ ? surface_->memory() : SlipMemory{},
          equilibrium_ ? equilibrium_->memory() : EquilibriumMemory{}};
}

void Simulation::restore(const Snapshot& s) {
  state_ = s.state;
  ledger_->restore(s.balance);
  limit_ = s.limit;
  dt_ = s.step_size;
  base_time_ = s.base_time;
  base_step_ = s.base_step;
  extremes_ = s.extremes;
  counts_ = s.counts;
  energy_in_play_ = s.energy_in_play;
  mass_damping_loss_ = s.mass_damping_loss;
  if (tangential_) tangential_->restore(s.tangential);
  if (deformables_) deformables_->restore(s.deformables, state_);
  if (surface_) surface_->restore(s.slips, state_);
  if (equilibrium_) equilibrium_->restore(s.equilibrium);
  for (int i = 0; i < shapes_.size(); ++i) {
    const double* x = &state_.position[3 * static_cast<size_t>(i)];
    shapes_.place(i, x[0], x[1], x[2]);
  }
  search_.search(shapes_, state_.position);
  contact_.evaluate(shapes_, state_.position, search_.pairs());
  steps_before_ = state_.step;
}

void Simulation::step() {
  const bool timed = state_.step % kTimedEvery == 0;
  Stopwatch clock(timed, timed_seconds_);
  if (model_.contact.mass_damping > 0) damp(dt_ / 2);
  if (deformables_) deformables_->damp(state_, dt_ / 2);
  kick(dt_ / 2);
  drift();
  clock.lap(Phase::integrate);
  if (surface_) {
    surface_->evaluate(state_);
    surface_->slide(state_, dt_);
    clock.lap(Phase::contact);
  }
  if (deformables_) {
    deformables_->find_forces(state_, dt_, surface_ ? &*surface_ : nullptr);
    clock.lap(Phase::elements);
  }
  find_forces(timed, state_.velocity, dt_);
  Stopwatch again(timed, timed_seconds_);
  kick(dt_ / 2);
  for (const int i : driven_) {
    const std::array<double, 3> rate = model_.bodies[i].history.rate(state_.time);
    std::copy(rate.begin(), rate.end(), state_.velocity.begin() + 3 * i);
  }
  ledger_->half_step(state_, dt_ / 2, moved_);
  if (model_.contact.mass_damping > 0) damp(dt_ / 2);
  if (deformables_) {
    deformables_->damp(state_, dt_ / 2);
    ledger_->add_impulse(deformables_->take_impulse());
  }
  tighten_step();
  again.lap(Phase::integrate);
  timed_steps_ += timed;
  if (state_.step % kWatchedEvery == 0) watch();
}

LoadStep Simulation::balance(double time, const std::function<bool()>& stop) {
  const Snapshot before = snapshot();
  for (const int i : driven_) {
    const RigidBody& body = model_.bodies[i];
    const std::array<double, 3> from = body.history.displacement(state_.time);
    const std::array<double, 3> until = body.history.displacement(time);
    for (int k = 0; k < 3; ++k) moved_[3 * i + k] = until[k] - from[k];
  }
  ledger_->half_step(state_, 0, moved_);
  const LoadStep result = equilibrium_->find(state_, time, stop);
  if (!result.complete) {
    restore(before);
    return result;
  }
  if (folds_) folds_->look(state_);
  for (const int i : driven_) {
    const std::array<double, 3> rate = model_.bodies[i].history.rate(time);
    std::copy(rate.begin(), rate.end(), state_.velocity.begin() + 3 * i);
  }
  find_forces(false, state_.velocity, 0);
  ledger_->half_step(state_, 0, moved_);
  return result;
}

void Simulation::watch() {
  // Energies may be asked for at the top of a bounce, where all there was is in the height.
  const double kinetic =
      ledger_->kinetic(state_) + (deformables_ ? deformables_->kinetic(state_) : 0);
  energy_in_play_ = std::max(energy_in_play_, kinetic);
  if (!deformables_) return;
  const std::string element = deformables_->inverted(state_);
  if (!element.empty()) {
    throw Unstable(
        fmt::format("{} has turned inside out {}: the load is more than the material "
                    "can bear, or the step is too long; reduce the load or time.safety",
                    element, at_time()));
  }
  if (folds_) folds_->look(state_);
}

void Simulation::kick(double h) {
  const size_t n = state_.velocity.size();
  for (size_t k = 0; k < n; ++k) {
    state_.velocity[k] += h * (inverse_mass_[k] * state_.force[k] + acceleration_[k]);
  }
  if (deformables_) deformables_->kick(state_, h);
}

// C = alpha M for free bodies: v' = -alpha v solved exactly over h, so that any alpha is stable.
void Simulation::damp(double h) {
  const double rest = std::exp(-model_.contact.mass_damping * h);
  Impulse impulse;
  for (const int i : moving_) {
    const RigidBody& body = model_.bodies[i];
    if (body.motion != Motion::free) continue;
    double* v = &state_.velocity[3 * static_cast<size_t>(i)];
    const double* x = &state_.position[3 * static_cast<size_t>(i)];
    const double kinetic =
        (body.mass * (v[0] * v[0] + v[1] * v[1]) + body.inertia * v[2] * v[2]) / 2;
    mass_damping_loss_ += kinetic * (1 - rest * rest);
    const double lost = rest - 1;
    impulse.x += lost * body.mass * v[0];
    impulse.y += lost * body.mass * v[1];
    impulse.angular += lost * (body.mass * (x[0] * v[1] - x[1] * v[0]) + body.inertia * v[2]);
    for (int k = 0; k < 3; ++k) v[k] *= rest;
  }
  ledger_->add_impulse(impulse);
}

void Simulation::drift() {
  ++state_.step;
  state_.time = base_time_ + static_cast<double>(state_.step - base_step_) * dt_;
  for (const int i : driven_) {
    const RigidBody& body = model_.bodies[i];
    const std::array<double, 3> u = body.history.displacement(state_.time);
    const std::array<double, 3> goal{body.position.x() + u[0], body.position.y() + u[1],
                                     body.angle + u[2]};
    for (int k = 0; k < 3; ++k) {
      moved_[3 * i + k] = goal[k] - state_.position[3 * i + k];
      // Of the half step, as free bodies have it: slips then sum to the displacement.
      state_.velocity[3 * i + k] = moved_[3 * i + k] / dt_;
    }
  }
  ledger_->half_step(state_, dt_ / 2, moved_);
  double stride = 0;
  int farthest = -1;
  for (const int i : moving_) {
    double* x = &state_.position[3 * static_cast<size_t>(i)];
    const double* v = &state_.velocity[3 * static_cast<size_t>(i)];
    if (inverse_masses_[i][0] + inverse_masses_[i][1] + inverse_masses_[i][2] > 0) {
      // Compensated sum (Kahan): at constant velocity every step rounds the same way, and the
      // angular momentum of a million steps would show it.
      double* r = &state_.remainder[3 * static_cast<size_t>(i)];
      for (int k = 0; k < 3; ++k) {
        const double dx = dt_ * v[k] + r[k];
        const double sum = x[k] + dx;
        r[k] = dx - (sum - x[k]);
        x[k] = sum;
      }
    }
    const double far =
        std::max(std::abs(v[0]), std::abs(v[1])) + std::abs(v[2]) * shapes_.radius(i);
    if (far > stride) {
      stride = far;
      farthest = i;
    }
  }
  for (const int i : driven_) {
    for (int k = 0; k < 3; ++k) state_.position[3 * i + k] += moved_[3 * i + k];
  }
  if (deformables_) deformables_->drift(state_, dt_);
  if (stride * dt_ > largest_stride_ && shapes_.size() > 1) {
    throw Unstable(
        fmt::format("body \"{}\" moves {:.3g} m in one step {}, more than a quarter of the "
                    "smallest inradius: contacts would be missed; reduce time.step or "
                    "time.safety",
                    name(farthest), stride * dt_, at_time()));
  }
}

void Simulation::find_forces(bool timed, const std::vector<double>& slip, double dt) {
  Stopwatch clock(timed, timed_seconds_);
  for (const int i : moving_) {
    const double* x = &state_.position[3 * static_cast<size_t>(i)];
    shapes_.place(i, x[0], x[1], x[2]);
  }
  clock.lap(Phase::place);
  search_if_stale();
  clock.lap(Phase::search);
  contact_.evaluate(shapes_, state_.position, search_.pairs());
  if (tangential_) {
    tangential_->update(shapes_, state_.position, slip, dt, search_.pairs(), contact_.integrals());
  }
  clock.lap(Phase::contact);
  gather();
  clock.lap(Phase::gather);
}

void Simulation::search_if_stale() {
  if (!search_.stale(shapes_, state_.position)) return;
  for (size_t k = 0; k < state_.position.size(); ++k) {
    if (std::isfinite(state_.position[k])) continue;
    worst_body_ = static_cast<int>(k / 3);
    throw Unstable(
        fmt::format("position of body \"{}\" is not finite {}: the run has become unstable; "
                    "reduce time.step or time.safety",
                    name(worst_body_), at_time()));
  }
  search_.search(shapes_, state_.position);
  ++counts_.searches;
}

// Beyond this depth the potential falls again and the bodies would pass through each other.
bool Simulation::too_deep(int a, int b, const PairIntegral& pair) const {
  if (!(pair.largest_phi <= kDeepestPhi)) return true;
  if (pair.own_length_a + pair.own_length_b < std::min(inradius_[a], inradius_[b])) return false;
  const double* xa = &state_.position[3 * static_cast<size_t>(a)];
  const double* xb = &state_.position[3 * static_cast<size_t>(b)];
  const Vec2 offset(xa[0] - xb[0], xa[1] - xb[1]);
  return shapes_.top_inside(a, xa[2], b, offset) || shapes_.top_inside(b, xb[2], a, -offset);
}

void Simulation::gather() {
  std::fill(state_.force.begin(), state_.force.end(), 0.0);
  std::fill(stiffness_.begin(), stiffness_.end(), 0.0);
  const std::vector<BoxPair>& pairs = search_.pairs();
  const std::vector<PairIntegral>& integrals = contact_.integrals();
  const double k_n = model_.stiffness();
  int touching = 0;
  for (size_t p = 0; p < pairs.size(); ++p) {
    const PairIntegral& pair = integrals[p];
    if (!pair.touching()) continue;
    ++touching;
    const auto [a, b] = pairs[p];
    double* fa = &state_.force[3 * static_cast<size_t>(a)];
    double* fb = &state_.force[3 * static_cast<size_t>(b)];
    const double fx = k_n * pair.force.x();
    const double fy = k_n * pair.force.y();
    fa[0] += fx;
    fa[1] += fy;
    fa[2] += k_n * pair.moment_a;
    fb[0] -= fx;
    fb[1] -= fy;
    fb[2] += k_n * pair.moment_b;

    if (too_deep(a, b, pair)) {
      worst_body_ = std::max(a, b);
      throw Unstable(fmt::format(
          "bodies \"{}\" and \"{}\" overlap {} {}: {}", name(a), name(b),
          pair.largest_phi > kDeepestPhi ? "up to the singular area of one of them (phi = 1)"
                                         : "as deep as the centre of one of them",
          at_time(),
          state_.step == 0
              ? "move them apart"
              : "the contact is too soft for this load; raise contact.normal_stiffness"));
    }
    const double force = std::sqrt(fx * fx + fy * fy);
    if (pair.penetration > extremes_.penetration.value) {
      extremes_.penetration = {pair.penetration, state_.time, a, b};
    }
    if (force > extremes_.force.value) extremes_.force = {force, state_.time, a, b};
    if (force > 0) {
      const double k = k_n * (pair.own_length_a * slope_[b] + pair.own_length_b * slope_[a]);
      const double both = inverse_mass_[3 * a] + inverse_mass_[3 * a + 2] > 0 &&
                                  inverse_mass_[3 * b] + inverse_mass_[3 * b + 2] > 0
                              ? 2
                              : 1;
      // No lever is longer than the body; where pushes from two sides cancel, M/F says nothing.
      const auto arm = [&](int body, double moment) {
        return std::min(std::abs(k_n * moment) / force, shapes_.radius(body));
      };
      stiffness_[a] +=
          both * k * strip_mobility(inverse_masses_[a], arm(a, pair.moment_a), pair.breadth);
      stiffness_[b] +=
          both * k * strip_mobility(inverse_masses_[b], arm(b, pair.moment_b), pair.breadth);
    }
  }
  if (tangential_) gather_tangential();
  if (surface_) gather_surfaces();
  counts_.candidate_pairs += static_cast<std::int64_t>(pairs.size());
  counts_.touching_pairs += touching;
  counts_.touching_now = touching + (surface_ ? static_cast<int>(surface_->touching()) : 0);
  worst_stiffness_ = 0;
  for (size_t i = 0; touching > 0 && i < stiffness_.size(); ++i) {
    if (stiffness_[i] > worst_stiffness_) {
      worst_stiffness_ = stiffness_[i];
      worst_body_ = static_cast<int>(i);
    }
  }
}

void Simulation::gather_surfaces() {
  surface_->add_to_bodies(state_.force);
  counts_.candidate_pairs += static_cast<std::int64_t>(surface_->candidates());
  counts_.touching_pairs += static_cast<std::int64_t>(surface_->touching());
  if (surface_->penetration() > extremes_.penetration.value) {
    const auto [a, b] = surface_->deepest();
    extremes_.penetration = {surface_->penetration(), state_.time, a, b};
  }
}

void Simulation::gather_tangential() {
  for (const TangentialForce& t : tangential_->forces()) {
    const auto [a, b] = search_.pairs()[t.pair];
    double* fa = &state_.force[3 * static_cast<size_t>(a)];
    double* fb = &state_.force[3 * static_cast<size_t>(b)];
    fa[0] += t.force.x();
    fa[1] += t.force.y();
    fa[2] += t.moment_a;
    fb[0] -= t.force.x();
    fb[1] -= t.force.y();
    fb[2] += t.moment_b;
    const bool both = inverse_mass_[3 * a] + inverse_mass_[3 * a + 2] > 0 &&
                      inverse_mass_[3 * b] + inverse_mass_[3 * b + 2] > 0;
    for (const int i : {a, b}) {
      stiffness_[i] += (both ? 2 : 1) * t.stiffness * strip_mobility(inverse_masses_[i], t.arm, 0);
    }
  }
}

// The limit known before the run holds for two bodies flat on each other; a body squeezed between
// several is stiffer. An automatic step then shrinks by whole halves and never grows again: a step
// that follows the contact would make the energy drift. The bound counts the short flanks of a flat
// contact as well, which do not press: a fixed step may exceed it by a little.
void Simulation::tighten_step() {
  const double largest = automatic_ ? safety_ : kOvershoot;
  if (!(dt_ * dt_ * worst_stiffness_ > 4 * largest * largest)) return;
  const double limit = 2 / std::sqrt(worst_stiffness_);
  if (!automatic_) {
    throw Unstable(
        fmt::format("the step of {} s is above the stability limit of {:.6g} s of the "
                    "contacts of body \"{}\" {}; give a smaller time.step or \"auto\"",
                    dt_, limit, name(worst_body_), at_time()));
  }
  base_time_ = state_.time;
  base_step_ = state_.step;
  while (dt_ > safety_ * limit) dt_ /= 2;
  stability_limit_ = limit;
  limit_ = {limit, fmt::format("contacts of \"{}\" {}", name(worst_body_), at_time())};
}

std::string Simulation::at_time() const {
  return fmt::format("at t = {:.9g} s (step {})", state_.time, state_.step);
}

}  // namespace apothem
