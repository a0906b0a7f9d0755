// Newton's method for equilibria: K dx = r with the exact tangent K of all terms and the forces r
// out of balance, at the end of a load step or, where that is too far, of shares of it. Prescribed
// motion enters the first iteration of a share by its columns of K, so that no element is torn at
// first.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/dynamics/equilibrium.hpp"
#include "lib/dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr int kMostIterations = 30;   // for a share of a load step
constexpr double kLeastShare = 1e-4;  // of a load step
constexpr double kFalling = 0.1;      // iterations that reduce the residual more are worth it
// Pivots nearer to zero are round-off, of the largest one.
constexpr double kPivotNoise = 1e-11;

}  // namespace

bool Equilibrium::find_tangent(const State& state) {
  tangent_.clear();
  return std::ranges::all_of(terms_,
                             [&](const auto& term) { return term->add_tangent(state, tangent_); });
}

// The norm of the forces out of balance, N; moments count over the radius of their body.
double Equilibrium::residual() const {
  double sum = 0;
  for (size_t c = 0; c < rest_.size(); ++c) {
    const double r = c < first_ && c % 3 == 2 ? rest_[c] / radius_[c / 3] : rest_[c];
    sum += r * r;
  }
  return std::sqrt(sum);
}

// One share of a load step, which ends at `time`.
Equilibrium::Verdict Equilibrium::find_share(State& state, const State& before, double time,
                                             NewtonPath& path, const std::function<bool()>& stop,
                                             LoadStep& result) {
  for (;; ++path.iteration, ++path.all) {
    state.time = time;
    find_forces(state, before);
    const double residual_now = residual();
    if (!std::isfinite(residual_now)) return Verdict::failed;
    if (path.iteration > 0) {
      const bool good = reached(state, result);
      const bool falls = residual_now < kFalling * path.residual;
      if (good && !falls) return Verdict::found;
    }
    path.residual = residual_now;
    if (path.iteration == kMostIterations || !find_tangent(state)) return Verdict::failed;
    step_ = rest_;
    std::ranges::fill(moves_, 0.);
    if (path.iteration == 0) {
      std::vector<double> places = state.x;
      dofs_.place_driven(state);
      for (size_t c = 0; c < places.size(); ++c) moves_[c] = state.x[c] - places[c];
      for (const Tangent::Entry& e : tangent_.entries()) {
        step_[static_cast<size_t>(e.row)] -= e.value * moves_[static_cast<size_t>(e.column)];
      }
    }
    for (size_t c = 0; c < step_.size(); ++c) free_[c] = !held(c);
    std::ranges::fill(shift_, 0.);
    if (!solver_.factorise(tangent_, free_, shift_)) return Verdict::failed;
    solver_.solve(step_, step_);
    for (size_t c = 0; c < step_.size(); ++c) state.x[c] += step_[c];
    if (stop && stop()) {
      ++path.iteration, ++path.all;
      return Verdict::stopped;
    }
  }
}

Equilibrium::Verdict Equilibrium::newton(State& state, const State& before, double time,
                                         const std::function<bool()>& stop, LoadStep& result) {
  NewtonPath path;
  if (newton_pause_ && newton_pause_->until == time) {
    path = std::move(*newton_pause_);
    state.x = path.x;
  } else {
    path.until = time;
    path.x_done = state.x;
  }
  newton_pause_.reset();
  find_forces(state, before);
  find_masses(state);
  for (;;) {
    const double share = std::min(1., path.done + path.step);
    const double at = share < 1 ? before.time + share * (time - before.time) : time;
    Verdict verdict = Verdict::failed;
    try {
      verdict = find_share(state, before, at, path, stop, result);
      if (verdict == Verdict::found) check_shapes(state);
    } catch (const Unstable&) {
      verdict = Verdict::failed;
    }
    if (verdict == Verdict::stopped) {
      path.x = state.x;
      newton_pause_ = std::move(path);
      return Verdict::stopped;
    }
    path.iteration = 0;
    if (verdict == Verdict::found) {
      if (share == 1) break;
      path.done = share;
      path.x_done = state.x;
      path.step *= 2;
      continue;
    }
    state.x = path.x_done;
    path.step = (share - path.done) / 2;
    if (path.step < kLeastShare || time == before.time) return Verdict::failed;
  }
  result.iterations = path.all;
  refuse_unstable(state);
  return Verdict::found;
}

void Equilibrium::refuse_unstable(const State& state) {
  if (!find_tangent(state) || !solver_.factorise(tangent_, free_, shift_)) return;
  const int negative = solver_.negative_pivots(kPivotNoise);
  if (negative <= 0) return;
  throw Unstable(fmt::format(
      "the equilibrium at t = {:.9g} s (load step {}) is unstable: its tangent stiffness has {} "
      "negative pivot{}, as many as there are ways to fall from it; reduce the load, or give the "
      "body a small imperfection, with which it buckles",
      state.time, state.step, negative, negative == 1 ? "" : "s"));
}

}  // namespace apothem
