// Newton's method for equilibria: K dx = r with the exact tangent K of all terms and the forces r
// out of balance, at the end of a load step or, where that is too far, of shares of it. Prescribed
// motion enters the first iteration of a share by its columns of K, so that no element is torn at
// first.

#include <algorithm>
#include <cmath>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/equilibrium.hpp"
#include "lib/dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr int kMostIterations = 30;       // for a share of a load step
constexpr double kLeastLoadShare = 1e-4;  // of a load step
// The same where a body has left its place: a shorter share leads it the same way.
constexpr double kLeastShareOfDeparted = 0.1, kLeastShareOfWeight = 0.01;
constexpr double kUnpressed = 1e-3;  // of the weight: contact forces that do not carry it
constexpr double kFalling = 0.1;     // iterations that reduce the residual more are worth it
// Of the implicit steps by which contacts are found.
constexpr int kMostInStep = 20, kMostOfAll = 2000, kMostHalvings = 6, kMostShortened = 12,
              kMostShortenedNear = 25, kEasy = 4;
constexpr double kStepTolerance = 1e-3;  // of the residual at the start of the step
constexpr double kLonger = 3, kShorter = 5;
constexpr double kGivenWay = 1e-3;  // of the residual once prescribed motion has come
// Of the residual, between looks at an implicit step.
constexpr double kProgress = 0.9;
constexpr int kLookEvery = 10, kFirstLook = 2;
// The same where bodies settle. They may have to go a long way, over many steps: these are found
// less exactly, and their length follows from the iterations that they take.
constexpr int kMostInSettling = 10, kMostOfSettling = 10000, kEasySettling = 3, kFairSettling = 6;
constexpr double kSettlingTolerance = .1, kLittleLonger = 1.5;
constexpr double kPolish = 1e-6;     // of the shift, from an equilibrium to round-off
constexpr double kReach = 0.5;       // of a rigid body's inradius
constexpr double kNearReach = 1e-3;  // of that, where the equilibrium is near
constexpr double kNodeReach = 8;     // of the shortest edge
// Of the residual in an iteration. Rigid bodies meet and part with all their stiffness.
constexpr double kMeshGrowth = 100;
// Of a step in time: forces out of balance over all forces, and places.
constexpr double kStepResidual = 1e-7, kRoundedPlaces = 4e-16;
// Pivots nearer to zero are round-off, of the largest one.
constexpr double kPivotNoise = 1e-11;

}  // namespace

void Equilibrium::NewtonPath::fields(Archive& archive) {
  archive("until", until)("done", done)("step", step)("damped", damped)("growing", growing)("shift",
                                                                                            shift);
  archive("iteration", iteration)("all", all)("in_step", in_step)("shortened", shortened);
  archive("residual", residual)("at_start", at_start)("looked_at", looked_at)("in_vain", in_vain);
  archive("polishing", polishing)("setting_out", setting_out);
  archive.sized("x_done", x_done).sized("base", base).sized("x", x);
}

bool Equilibrium::find_tangent(const State& state) {
  tangent_.clear();
  tangent_known_ = std::ranges::all_of(
      terms_, [&](const auto& term) { return term->add_tangent(state, tangent_); });
  return tangent_known_;
}

// Steps of Newton's method along K + M/h^2 from the places `path.base`: those of an implicit Euler
// step of h without velocities. Without a shift they lead to the equilibrium at once.
double Equilibrium::shifted_residual(const State& state, const NewtonPath& path) {
  double sum = 0;
  for (size_t c = 0; c < rest_.size(); ++c) {
    if (held(c)) continue;
    const double inertia = dofs_.mass(c);
    drive_[c] = rest_[c] - path.shift * inertia * (state.x[c] - path.base[c]);
    sum += drive_[c] * drive_[c] / inertia;
  }
  return std::sqrt(sum);
}

// What the rounding of places leaves of the residual: they are answered with the stiffness of the
// contacts. A step that ends there is found as exactly as it can be.
double Equilibrium::rounded_residual(const State& state) const {
  double sum = 0;
  for (RigidIndex i = 0; i < state.layout.rigid_bodies; ++i) {
    const size_t first = state.layout.rigid(i);
    const double place = std::abs(state.x[first]) + std::abs(state.x[first + 1]) + radius()[i];
    for (size_t c = first; c < first + 3; ++c) {
      if (held(c)) continue;
      const double rounded = kRoundedPlaces * (c == first + 2 ? place / radius()[i] : place);
      sum += rounded * rounded * lambda_[i] * lambda_[i] * dofs_.mass(c);
    }
  }
  return std::sqrt(sum);
}

// The share of a step in which no point moves farther than its reach.
double Equilibrium::shortened(const std::vector<double>& step) const {
  double longest = 1;
  for (size_t c = 0; c < step.size(); ++c)
    longest = std::max(longest, std::abs(step[c]) / reach(c));
  return 1 / longest;
}

// How far a coordinate moves in one iteration, so that no contact is jumped over, m or rad.
double Equilibrium::reach(size_t c) const {
  return (c < first_ ? kReach : kNodeReach) * lengths_.of(c);
}

// The first shift: with it nothing moves farther than its reach by the forces out of balance. If
// there are none yet, they are those that prescribed motion brings, where it presses as far as it
// goes.
double Equilibrium::first_shift() const {
  const auto shift_of = [&](auto force) {
    double shift = 0;
    for (size_t c = 0; c < rest_.size(); ++c) {
      if (!held(c)) shift = std::max(shift, force(c) / dofs_.mass(c) / reach(c));
    }
    return near_ ? shift / kNearReach : shift;
  };
  const double shift = shift_of([&](size_t c) { return std::abs(rest_[c]); });
  if (shift > 0) return shift;
  return shift_of([&](size_t c) {
    const double stiffness = c < first_ ? flat_[c / 3] : model_.stiffness();
    return stiffness * driven_way_ * (c < first_ && c % 3 == 2 ? radius()[c / 3] : 1);
  });
}

// K + M/h^2 at the present places, and its solution. In the first iteration of a share prescribed
// coordinates come to their new places by their columns of K.
bool Equilibrium::find_step(State& state, const NewtonPath& path, bool first) {
  if (!find_tangent(state)) return false;
  step_ = drive_;
  std::ranges::fill(moves_, 0.);
  if (first) {
    const std::vector<double> places = state.x;
    dofs_.place_driven(state);
    for (size_t c = 0; c < places.size(); ++c) moves_[c] = state.x[c] - places[c];
    for (const Tangent::Entry& e : tangent_.entries()) {
      step_[static_cast<size_t>(e.row)] -= e.value * moves_[static_cast<size_t>(e.column)];
    }
  }
  for (size_t c = 0; c < step_.size(); ++c) shift_[c] = path.shift * dofs_.mass(c);
  put_on_rails();
  for (const auto& [body, along] : rails_) {
    const size_t c = 3 * static_cast<size_t>(body);
    step_[c] = along.dot(Vec2(step_[c], step_[c + 1]));
  }
  if (!solver_.factorise(tangent_, first_, free_, shift_)) return false;
  solver_.solve(step_, step_);
  for (const auto& [body, along] : rails_) {
    const size_t c = 3 * static_cast<size_t>(body);
    step_[c + 1] = along.y() * step_[c];
    step_[c] = along.x() * step_[c];
  }
  return true;
}

// Says which coordinates the system has. A body on a rail has one for its place: its x.
void Equilibrium::put_on_rails() {
  for (size_t c = 0; c < free_.size(); ++c) free_[c] = !held(c);
  for (const auto& [body, along] : rails_) {
    const size_t c = 3 * static_cast<size_t>(body);
    tangent_.put_on_rail(c, along.x(), along.y());
    free_[c + 1] = 0;
  }
}

// The forces of a state that is tried; false if it is out of the range of the method.
bool Equilibrium::try_forces(State& state) {
  try {
    find_forces(state);
    return true;
  } catch (const Unstable&) {
    return false;
  }
}

// After the last iteration from an equilibrium to round-off, which was worse than those before.
Equilibrium::Verdict Equilibrium::finish_polishing(State& state, LoadStep& result,
                                                   const NewtonPath& path) {
  state.x = path.base;
  return try_forces(state) && reached(state, result) ? Verdict::found : Verdict::failed;
}

// One share of a load step, which ends at `time`. With a shift it is found in steps of growing h.
Equilibrium::Verdict Equilibrium::find_share(State& state, const State& before, double time,
                                             NewtonPath& path, const std::function<bool()>& stop,
                                             LoadStep& result) {
  state.time = time;
  bool known = false;  // whether the forces are those of the present places
  for (;; ++path.iteration, ++path.all) {
    if (path.all > (settling_ ? kMostOfSettling : kMostOfAll)) return Verdict::failed;
    bool fine = known || try_forces(state);
    if (path.iteration == 0) begin_share(state, path);
    double now = fine ? shifted_residual(state, path) : HUGE_VAL;
    fine = fine && std::isfinite(now);
    if (fine && !path.sets_out()) {
      const bool good = reached(state, result);
      if (path.polishing && !(now < kFalling * path.residual)) {
        if (good && now <= path.residual) return Verdict::found;
        return finish_polishing(state, result, path);
      }
      if (good) {
        begin_polishing(state, path);
        now = shifted_residual(state, path);
      }
    }
    if (fine && is_step_found(state, path, now)) {
      if (!stays(state, before, path)) return Verdict::failed;
      begin_longer_step(state, path);
      now = shifted_residual(state, path);
    }
    if (fine) note_residual(now, path);
    fine = fine && !is_stuck(path) && find_step(state, path, path.sets_out());
    if (!fine) {
      if (path.polishing) return finish_polishing(state, result, path);
      if (!path.damped || !begin_shorter_step(state, path)) return Verdict::failed;
      known = false;
      continue;
    }
    known = go(state, path);
    ++path.in_step;
    if (stop && stop()) {
      ++path.iteration, ++path.all;
      return Verdict::stopped;
    }
  }
}

// Whether the bodies of an equilibrium are within the range of the method.
bool Equilibrium::is_sound(const State& state) const {
  try {
    check_shapes(state);
    return true;
  } catch (const Unstable&) {
    return false;
  }
}

void Equilibrium::begin_share(const State& state, NewtonPath& path) {
  path.polishing = false;
  path.setting_out = true;
  path.base = state.x;
  if (path.damped) path.shift = first_shift();
  path.in_step = path.shortened = 0;
}

void Equilibrium::begin_polishing(const State& state, NewtonPath& path) {
  path.polishing = true;
  path.setting_out = false;
  path.base = state.x;
  path.shift *= kPolish;
  path.in_step = 0;
}

// Prescribed motion comes with the first iteration of a share, and brings forces that are mostly
// gone once bodies have given way.
void Equilibrium::note_residual(double residual, NewtonPath& path) const {
  if (path.in_step == 0) {
    path.at_start = residual;
  } else if (path.in_step == 1 && path.setting_out && driven_way_ > 0) {
    path.at_start = std::max(path.at_start, kGivenWay * residual);
  }
  if (path.in_step % kLookEvery == kFirstLook) {
    path.in_vain = path.in_step > kFirstLook && !(residual < kProgress * path.looked_at);
    path.looked_at = residual;
  }
  path.residual = residual;
}

// Whether a step has taken its iterations, or goes round in circles.
bool Equilibrium::is_stuck(const NewtonPath& path) const {
  if (!path.damped) return path.in_step == kMostIterations;
  if (!path.polishing && path.in_step > kFirstLook && path.in_vain) return true;
  return path.in_step == (settling_ && !path.polishing ? kMostInSettling : kMostInStep);
}

// Whether this is the end of an implicit step, where the residual is `now`.
bool Equilibrium::is_step_found(const State& state, const NewtonPath& path, double now) const {
  if (!path.damped || path.polishing || path.in_step == 0) return false;
  const double tolerance = settling_ ? kSettlingTolerance : kStepTolerance;
  return now <= std::max(tolerance * path.at_start, rounded_residual(state));
}

// By how much the next implicit step is longer. Near a limit of the loads the way bends with every
// contact that begins to slip: a step that was hard to find is not followed by a longer one.
double Equilibrium::growth_after(const NewtonPath& path) const {
  if (settling_) {
    if (path.in_step <= kEasySettling) return kLonger;
    return path.in_step <= kFairSettling ? kLittleLonger : 1;
  }
  return !near_ || path.in_step <= kEasy ? kLonger : 1;
}

// Goes the step; where contacts may begin or end it is halved until the residual falls. Returns
// whether the forces there are known.
bool Equilibrium::go(State& state, const NewtonPath& path) {
  double share = path.damped ? shortened(step_) : 1;
  const double growth = model_.deformables.empty() ? 1 : kMeshGrowth;
  const std::vector<double> from = state.x;
  for (int halved = 0;; ++halved, share /= 2) {
    for (size_t c = 0; c < step_.size(); ++c) state.x[c] = from[c] + share * step_[c];
    if (!path.damped || path.polishing || path.sets_out()) return false;
    const bool fine = try_forces(state);
    if (halved == kMostHalvings) return fine;
    if (fine && shifted_residual(state, path) < growth * path.residual) return true;
  }
}

// Where bodies settle friction follows their way.
void Equilibrium::keep_slips(const State& state) {
  if (contact_) contact_->keep_trial();
  slips_from_ = state.x;
}

void Equilibrium::begin_longer_step(const State& state, NewtonPath& path) {
  path.base = state.x;
  if (settling_) keep_slips(state);
  const double growth = growth_after(path);
  path.shift /= growth * growth;
  path.in_step = 0;
  path.setting_out = false;
  if (!near_) path.shortened = 0;
}

// Again from where the step began.
bool Equilibrium::begin_shorter_step(State& state, NewtonPath& path) {
  if (++path.shortened > (near_ ? kMostShortenedNear : kMostShortened)) return false;
  state.x = path.base;
  if (!path.setting_out) dofs_.place_driven(state);
  path.shift *= kShorter * kShorter;
  path.in_step = 0;
  return true;
}

Equilibrium::Verdict Equilibrium::newton(State& state, const State& before, double time,
                                         const std::function<bool()>& stop, LoadStep& result) {
  // What tells round-off depends on what is near at the start of the load step, and on nothing
  // else.
  if (contact_) contact_->forget_search();
  slips_from_ = before.x;
  find_forces(state);
  find_masses(state);
  NewtonPath path;
  departed_ = -1;
  path.until = time;
  path.damped = contact_ != nullptr;
  path.growing = weight_grows_;
  path.x_done = state.x;
  if (newton_pause_ && newton_pause_->until == time) {
    path = std::move(*newton_pause_);
    state.x = path.x;
  }
  newton_pause_.reset();
  for (;;) {
    const double share = std::min(1., path.done + path.step);
    const double at = share < 1 ? before.time + share * (time - before.time) : time;
    share_of_weight_ = weight_grows_ ? share : 1;
    Verdict verdict = find_share(state, before, at, path, stop, result);
    if (verdict == Verdict::found && !is_sound(state)) verdict = Verdict::failed;
    if (verdict == Verdict::stopped) {
      path.x = state.x;
      newton_pause_ = std::move(path);
      return Verdict::stopped;
    }
    if (verdict == Verdict::failed && near_ && !weight_grows_) return verdict;
    path.iteration = 0;
    if (verdict == Verdict::found) {
      if (share == 1) break;
      path.done = share;
      path.x_done = state.x;
      path.step *= 2;
      departed_ = -1;
      continue;
    }
    state.x = path.x_done;
    path.step = (share - path.done) / 2;
    const double least = departed_ < 0   ? kLeastLoadShare
                         : weight_grows_ ? kLeastShareOfWeight
                                         : kLeastShareOfDeparted;
    const bool lost = weight_grows_ && departed_ >= 0 && departure_.is_lost;
    const bool whole = time == before.time && !weight_grows_;
    if (!tangent_known_) return Verdict::failed;
    if (path.step >= least && !lost && !whole) continue;
    if (path.damped) {
      if (!near_) note_end(state, before, path, result);
      return Verdict::failed;
    }
    // What lies beyond a limit of the loads is found on the way that the bodies go.
    path.damped = true;
    path.step = 1 - path.done;
  }
  result.iterations = path.all;
  result.negative_pivots = negative_pivots(state);
  return Verdict::found;
}

// Whether the contacts at the start do not carry the weight of the bodies.
bool Equilibrium::begins_unpressed(State& state, const State& before) {
  if (!contact_ || dofs_.weight().empty()) return false;
  slips_from_ = before.x;
  if (!try_forces(state)) return false;
  std::vector<double> pressed(body_loads_.size(), 0);
  contact_->add_force_sizes(pressed);
  double forces = 0, weights = 0;
  for (const double size : pressed) forces += size;
  for (const double w : dofs_.weight()) weights += std::abs(w);
  return forces < kUnpressed * weights;
}

void Equilibrium::begin_again(State& state, const State& before, const FrictionMemory& friction) {
  const std::int64_t step = state.step;
  state = before;
  state.step = step;
  if (!contact_) return;
  contact_->drop_trial();
  contact_->inherit(friction);
  contact_->refresh(state);
}

// Where weight has never acted, the equilibrium that is sought is the one to which the bodies come
// from where they are, while it grows. If there is none near, it is any that they come to.
Equilibrium::Verdict Equilibrium::search(State& state, const State& before, double time,
                                         const std::function<bool()>& stop, LoadStep& result) {
  const FrictionMemory friction = contact_ ? contact_->contacts().friction() : FrictionMemory();
  const bool paused = newton_pause_ && newton_pause_->until == time;
  const bool grows =
      paused ? newton_pause_->growing : before.step == 0 && begins_unpressed(state, before);
  if (grows) {
    near_ = weight_grows_ = true;
    const Verdict verdict = newton(state, before, time, stop, result);
    near_ = weight_grows_ = false;
    share_of_weight_ = 1;
    if (verdict != Verdict::failed) return verdict;
    begin_again(state, before, friction);
  }
  const Verdict verdict = newton(state, before, time, stop, result);
  if (verdict == Verdict::failed) begin_again(state, before, friction);
  return verdict;
}

// Whether an iteration that leads over `step` changes no more than the rounding of places.
bool Equilibrium::is_round_off(const State& state, const std::vector<double>& step) const {
  for (size_t c = 0; c < step.size(); ++c) {
    double place = std::abs(state.x[c]);
    if (c < first_) place += radius()[c / 3] / (c % 3 == 2 ? radius()[c / 3] : 1);
    if (std::abs(step[c]) > kRoundedPlaces * place) return false;
  }
  return true;
}

// The forces that act on what is free, as accelerations, in the norm of shifted_residual.
double Equilibrium::size_of_forces() const {
  double sum = 0;
  for (size_t c = 0; c < rest_.size(); ++c) {
    if (!held(c)) sum += (rest_[c] * rest_[c] + weight(c) * weight(c)) / dofs_.mass(c);
  }
  return std::sqrt(sum);
}

bool Equilibrium::step(State& state, const State& before, const std::vector<double>& base,
                       double h) {
  NewtonPath path;
  path.damped = true;
  path.shift = 1 / (h * h);
  path.base = base;
  slips_from_ = before.x;
  span_ = h;
  moved_.resize(before.x.size());
  double size = 0;
  bool known = false;
  for (int i = 0; i < kMostInStep; ++i) {
    if (!known) find_forces(state);
    path.residual = shifted_residual(state, path);
    if (!std::isfinite(path.residual)) return false;
    size = std::max(size, size_of_forces());
    if (path.residual <= kStepResidual * size) return true;
    if (i > 0 && is_round_off(state, step_)) return true;
    if (!find_step(state, path, false)) return false;
    known = go(state, path);
    ++iterations_;
  }
  return false;
}

// Of the tangent at the present places; -1 where that is not symmetric, and they do not tell.
int Equilibrium::negative_pivots(const State& state) {
  std::ranges::fill(shift_, 0.);
  if (!find_tangent(state)) return -1;
  put_on_rails();
  if (!solver_.factorise(tangent_, first_, free_, shift_)) return -1;
  return solver_.negative_pivots(kPivotNoise);
}

}  // namespace apothem
