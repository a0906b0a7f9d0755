#include "lib/dynamics/gravity_history.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace apothem {

std::string GravityHistory::describe() const {
  const std::vector<LoadHistory::Point>& points = model_.gravity_history.points;
  const auto [least, most] =
      std::minmax_element(points.begin(), points.end(),
                          [](const auto& p, const auto& q) { return p.factor < q.factor; });
  return fmt::format("gravity that follows a history, {:g} to {:g} times its value", least->factor,
                     most->factor);
}

void GravityHistory::add_forces(const Evaluation& now) {
  const double factor = model_.gravity_history.at(now.state.time);
  dofs_.scale_gravity(factor);
  if (now.trial) return;
  // Velocity Verlet and the static solver both sum the work of weights by the trapezoid rule: with
  // the mean of both places here nothing is left over.
  const double energy = dofs_.full_gravity_energy(now.state);
  work_ += (factor - factor_) * (energy_ + energy) / 2;
  factor_ = factor;
  energy_ = energy;
}

void GravityHistory::refresh(const State& state) {
  factor_ = model_.gravity_history.at(state.time);
  dofs_.scale_gravity(factor_);
  energy_ = dofs_.full_gravity_energy(state);
}

}  // namespace apothem
