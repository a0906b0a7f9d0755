#include "lib/dynamics/gravity_history.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace apothem {

bool GravityHistory::needed(const Model& model) {
  return !model.gravity_parts.empty() ||
         (!model.gravity_history.points.empty() && model.gravity != Vec2::Zero());
}

std::string GravityHistory::describe() const {
  if (!model_.gravity_parts.empty()) {
    return fmt::format("gravity that turns or is the sum of histories, up to {:g} m/s^2",
                       model_.strongest_gravity());
  }
  const std::vector<LoadHistory::Point>& points = model_.gravity_history.points;
  const auto [least, most] =
      std::minmax_element(points.begin(), points.end(),
                          [](const auto& p, const auto& q) { return p.factor < q.factor; });
  return fmt::format("gravity that follows a history, {:g} to {:g} times its value", least->factor,
                     most->factor);
}

void GravityHistory::set(double time) {
  if (model_.gravity_parts.empty()) {
    dofs_.scale_gravity(model_.gravity_history.at(time));
  } else {
    dofs_.set_gravity(model_.gravity_at(time));
  }
}

void GravityHistory::add_forces(const Evaluation& now) {
  set(now.state.time);
  if (now.trial) return;
  // Velocity Verlet and the static solver both sum the work of weights by the trapezoid rule: with
  // the mean of both places here nothing is left over.
  if (model_.gravity_parts.empty()) {
    const double factor = model_.gravity_history.at(now.state.time);
    const double energy = dofs_.full_gravity_energy(now.state);
    work_ += (factor - factor_) * (energy_ + energy) / 2;
    factor_ = factor;
    energy_ = energy;
    return;
  }
  const Vec2 value = model_.gravity_at(now.state.time), moved = dofs_.mass_moved(now.state);
  work_ -= (value - value_).dot(moved_ + moved) / 2;
  value_ = value;
  moved_ = moved;
}

void GravityHistory::refresh(const State& state) {
  set(state.time);
  if (model_.gravity_parts.empty()) {
    factor_ = model_.gravity_history.at(state.time);
    energy_ = dofs_.full_gravity_energy(state);
  } else {
    value_ = model_.gravity_at(state.time);
    moved_ = dofs_.mass_moved(state);
  }
}

}  // namespace apothem
