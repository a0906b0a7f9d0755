#include "lib/dynamics/implicit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/dynamics/contact_term.hpp"

namespace apothem {
namespace {

// Implicit steps are worth it from so many ticks on, and are tried with twice as many.
constexpr std::int64_t kFirst = QuietMotion::kSteps, kWorth = kFirst / 2;
constexpr std::int64_t kLookEvery = 64;  // ticks between looks whether to try
constexpr std::int64_t kFirstWait = 512, kLongestWait = 1 << 16;
constexpr double kFarthest = .2;  // of an inradius, which a step may lead over
// Bodies rest that move less in a step, in parts of an inradius, with less force out of balance, in
// parts of the forces.
constexpr double kRest = 1e-10, kBalanced = 1e-5;
// Forces of stiff contacts at the end of a step tell of vibrations that have not died out: a step
// that is three times as long as the one before makes them grow (docs/theory.md, "Implicit steps").
constexpr double kMostLonger = 2, kMostShorter = 5, kLessAgain = .5, kReserve = .8;

}  // namespace

ImplicitSteps::ImplicitSteps(const Model& model, const TimeSettings& time, DegreesOfFreedom& dofs,
                             const Terms& terms, ContactTerm* contact)
    : dofs_(dofs),
      moves_(dofs),
      terms_(terms),
      contact_(contact),
      equilibrium_(model, dofs, terms, contact, 0),
      quiet_(model, dofs, time.accuracy),
      automatic_(time.scheme == TimeScheme::automatic),
      fixed_(time.fixed_step.has_value()),
      wait_(kFirstWait),
      accuracy_(time.accuracy) {
  const size_t size = dofs.layout().size();
  acceleration_.assign(size, 0);
  base_.assign(size, 0);
}

bool ImplicitSteps::due(const State& state, double dt) const {
  if (!automatic_ || running_) return true;
  return state.step >= next_try_ && state.step % kLookEvery == 0 && quiet_.holds(state, dt);
}

bool ImplicitSteps::is_frozen(const State& state) const {
  return running_ && stays_ && !fixed_ && dofs_.driven().empty() &&
         std::ranges::all_of(state.v, [](double v) { return v == 0; }) &&
         std::ranges::none_of(terms_, [](const auto& t) { return t->changes_with_time(); });
}

void ImplicitSteps::count_rest(std::int64_t ticks) {
  ++counts_.steps;
  counts_.ticks += ticks;
}

// So that no body moves farther than a part of its inradius, s.
double ImplicitSteps::longest(const State& state) const {
  double fastest = 0;
  for (size_t c = 0; c < state.v.size(); ++c) {
    fastest = std::max(fastest, std::abs(state.v[c]) / equilibrium_.lengths().of(c));
  }
  return kFarthest / fastest;
}

// Sets out from `state`.
void ImplicitSteps::begin(const State& state) {
  before_ = state;
  if (!running_) rests_ = stays_ = false;
  for (size_t c = 0; c < acceleration_.size(); ++c) {
    const double gravity = dofs_.acceleration().empty() ? 0 : dofs_.acceleration()[c];
    acceleration_[c] = rests_ ? 0 : dofs_.inverse_mass()[c] * state.f[c] + gravity;
  }
  if (running_) return;
  ticks_ = automatic_ ? kFirst : 1;
  phase_from_ = state.step;
}

std::int64_t ImplicitSteps::try_step(State& state, const StepControl& control, std::int64_t most) {
  begin(state);
  const double dt = control.choice().step;
  most = std::clamp<std::int64_t>(std::int64_t(std::min(longest(state) / dt, 1e15)), 1, most);
  for (;;) {
    // The ticks that are left are shared out evenly.
    const std::int64_t wanted = fixed_ ? 1 : std::clamp<std::int64_t>(ticks_, 1, most);
    const std::int64_t parts = (most + wanted - 1) / wanted;
    const std::int64_t ticks = fixed_ ? 1 : (most + parts - 1) / parts;
    h_ = static_cast<double>(ticks) * dt;
    const std::int64_t iterations = equilibrium_.iterations();
    const bool found = attempt(state, control.time_after(before_, ticks));
    counts_.iterations += equilibrium_.iterations() - iterations;
    const double off = found ? error() : HUGE_VAL;
    const bool good = found && (off <= 1 || ticks == 1);
    const double share = found ? kReserve / std::sqrt(off) : 0;
    const double longer = std::clamp(share, 1 / kMostShorter, good ? kMostLonger : kLessAgain);
    ticks_ = std::max<std::int64_t>(1, std::int64_t(static_cast<double>(ticks) * longer));
    if (good) {
      accept(ticks);
      return ticks;
    }
    ++counts_.rejected;
    if (ticks == 1 || (automatic_ && ticks_ < kWorth)) break;
  }
  state = before_;
  if (!automatic_) refuse();
  give_up(before_.step);
  return 0;
}

void ImplicitSteps::accept(std::int64_t ticks) {
  ++counts_.steps;
  counts_.ticks += ticks;
  if (automatic_ && ticks_ < kWorth) {
    give_up(before_.step + ticks);  // after this step
  } else if (!running_) {
    ++counts_.phases;
    running_ = true;
  }
}

void ImplicitSteps::refuse() const {
  if (refused_) throw Unstable(*refused_);
  throw Unstable(fmt::format(
      "Newton's method finds no places at the end of a step of {:.3g} s {}: {}", h_,
      at_time(before_),
      fixed_ ? "give a smaller time.step or \"auto\""
             : fmt::format("bodies may be about to pass through each other; {}, or take the scheme "
                           "\"verlet\"",
                           stiffening(equilibrium_.model().contact))));
}

// Goes on with velocity Verlet, the longer the shorter this phase was.
void ImplicitSteps::give_up(std::int64_t step) {
  const bool lasted = step - phase_from_ >= wait_;
  rests_ = stays_ = false;
  wait_ = std::max(least_wait_, lasted ? kFirstWait : std::min(2 * wait_, kLongestWait));
  next_try_ = step + wait_;
  running_ = false;
}

// The moments of a pair's forces balance where the bodies are at the end of the step, and act on
// the bodies where they were at its start: what is left turns both of them.
void ImplicitSteps::balance_spins(State& state) const {
  if (!contact_ || rests_) return;
  const RigidIndex rigid = state.layout.rigid_bodies;
  for (const ContactRecord& contact : contact_->contacts().records()) {
    if (contact.b >= rigid) continue;
    const size_t a = state.layout.rigid(contact.a), b = state.layout.rigid(contact.b);
    const auto way = [&](size_t c) {
      return Vec2(state.x[c] - before_.x[c], state.x[c + 1] - before_.x[c + 1]);
    };
    const double twist = h_ * cross(way(a) - way(b), contact.normal + contact.tangential);
    const bool both = dofs_.can_move(a + 2) && dofs_.can_move(b + 2);
    for (const size_t c : {a + 2, b + 2}) {
      state.v[c] += dofs_.inverse_mass()[c] * (both ? twist / 2 : twist);
    }
  }
}

void ImplicitSteps::follow(const State& state, double dt, const Energies& e) {
  if (!automatic_ || !running_) return;
  const double work = e.external_work - e.gravity;
  const double still = accuracy_ * accuracy_ * (e.strain + e.contact);
  const double allowed = std::max(quiet_.energy(), still) + accuracy_ * std::abs(work - work_from_);
  const bool spent = e.numerical_loss - loss_from_ > allowed;
  if (spent) {
    loss_from_ = e.numerical_loss;
    work_from_ = work;
    // Vibrations must not be drained little by little.
    least_wait_ = std::max(2 * least_wait_, kFirstWait);
  }
  if (spent || !quiet_.holds(state, dt)) give_up(state.step);
}

// One step of h_ that ends at `time`.
bool ImplicitSteps::attempt(State& state, double time) {
  state = before_;
  state.time = time;
  refused_.reset();
  for (size_t c = 0; c < base_.size(); ++c) state.v[c] += h_ / 2 * acceleration_[c];
  moves_.steer(state, h_);
  moves_.drift(state, h_);
  for (size_t c = 0; c < base_.size(); ++c) {
    base_[c] = state.x[c] - h_ * h_ * acceleration_[c];
    // What presses on a body is found by the iteration; free flight is known.
    if (dofs_.can_move(c) && before_.f[c] != 0) state.x[c] = base_[c];
  }
  middle_.v = state.v;
  try {
    if (contact_) contact_->check_drift(state, h_);
    return equilibrium_.step(state, before_, base_, h_);
  } catch (const Unstable& error) {
    refused_ = error;
    return false;
  }
}

// How far the places and velocities of a step are off, over what the accuracy allows: the
// acceleration has changed over the step. Proportional to the square of its length.
double ImplicitSteps::error() const {
  double worst = 0;
  for (size_t c = 0; c < base_.size(); ++c) {
    if (!dofs_.can_move(c)) continue;
    const double change = equilibrium_.forces()[c] * dofs_.inverse_mass()[c] - acceleration_[c];
    const double speed = h_ * std::abs(change);
    worst = std::max(
        {worst, h_ * speed / quiet_.way(c), (speed / quiet_.speed(c)) * (speed / quiet_.speed(c))});
  }
  return worst;
}

// How far the step has led, in lengths of the bodies.
double ImplicitSteps::farthest(const State& state) const {
  double farthest = 0;
  for (size_t c = 0; c < base_.size(); ++c) {
    farthest =
        std::max(farthest, std::abs(state.x[c] - before_.x[c]) / equilibrium_.lengths().of(c));
  }
  return farthest;
}

// Whether the forces at the end of the step are as good as in balance.
bool ImplicitSteps::is_balanced(const State& state) const {
  double off = 0, all = 0;
  for (size_t c = 0; c < base_.size(); ++c) {
    if (!dofs_.can_move(c)) continue;
    const double weight = dofs_.weight().empty() ? 0 : dofs_.weight()[c];
    const double f = state.f[c] + weight;
    off += f * f * dofs_.inverse_mass()[c];
    all += (state.f[c] * state.f[c] + weight * weight) * dofs_.inverse_mass()[c];
  }
  return off < kBalanced * kBalanced * all;
}

StepMotion ImplicitSteps::motion(const State& state) {
  moved_.resize(state.x.size());
  for (size_t c = state.layout.node(0); c < moved_.size(); ++c) {
    moved_[c] = (state.x[c] - before_.x[c]) / h_;
  }
  return {h_, moved_};
}

// Forces are known to the rounding of places only. Where everything rests, velocities that followed
// them would never die out: they are 0.
const State& ImplicitSteps::finish(State& state) {
  const std::vector<double> half = middle_.v;
  const double way = farthest(state);
  rests_ = way <= kRest && is_balanced(state);
  stays_ = way == 0 && state.f == before_.f;
  middle_ = state;
  for (size_t c = 0; c < base_.size(); ++c) {
    const double gravity = dofs_.acceleration().empty() ? 0 : dofs_.acceleration()[c];
    const double a = dofs_.inverse_mass()[c] * state.f[c] + gravity;
    middle_.v[c] = rests_ && dofs_.can_move(c) ? 0 : half[c] + h_ * (a - acceleration_[c]);
    middle_.x[c] = (before_.x[c] + state.x[c]) / 2;
    state.v[c] = middle_.v[c] + (rests_ ? 0 : h_ / 2 * a);
  }
  balance_spins(state);
  moves_.follow(state);
  return middle_;
}

void ImplicitSteps::fields(Archive& archive) {
  archive("ticks", ticks_)("running", running_)("next_try", next_try_)("wait", wait_)("least_wait",
                                                                                      least_wait_);
  archive("phase_from", phase_from_)("rests", rests_)("stays", stays_)("loss_from", loss_from_)(
      "work_from", work_from_)("counts", counts_);
}

}  // namespace apothem
