#include "lib/dynamics/step_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/dynamics/unstable.hpp"

namespace apothem {
namespace {

// The step is chosen for two bodies. The frequency of one that is squeezed between others may be
// higher by this factor, before a change of the step costs less than it is worth.
constexpr double kOvershoot = 2;
constexpr double kStable = .9;  // part of the limit of stability that a step may take
// The bound counts flanks that hardly press: a step may exceed it by a little.
constexpr double kOfBound = 1.05;
constexpr std::int64_t kPatience = 512;
constexpr std::int64_t kSoon = 8;  // times the patience
constexpr size_t kMostChanges = 1000;

}  // namespace

StepControl::StepControl(const Model& model, const TimeSettings& time, const StepBounds& bounds,
                         int frames, bool node_contact)
    : model_(model),
      automatic_(!time.fixed_step),
      choice_(choose_step(model, time, bounds, frames, node_contact)),
      patience_(kPatience) {
  safety_ = choice_.safety;
  changes_.shortest = choice_.step;
}

void StepControl::advance(State& state, std::int64_t steps) {
  state.time = time_after(state, steps);
  state.step += steps;
  part_ += steps;
}

void StepControl::follow(const State& state, std::span<const double> lambda) {
  const auto worst = std::ranges::max_element(lambda);
  if (worst == lambda.end()) return;
  if (*worst > largest_lambda()) {
    shorten(state, 2 / std::sqrt(*worst), static_cast<RigidIndex>(worst - lambda.begin()));
  } else if (halvings_ > 0) {
    soft_ = *worst <= soft_lambda() ? soft_ + 1 : 0;
    if (soft_ >= patience_ && part_ % 2 == 0) lengthen(state);
  }
}

double StepControl::largest_lambda() const {
  const double part =
      automatic_ ? std::min(kOvershoot * safety_, std::max(kStable, safety_ * kOfBound)) : kOfBound;
  const double frequency = 2 * part / choice_.step;
  return frequency * frequency;
}

double StepControl::soft_lambda() const {
  const double frequency = safety_ / choice_.step;
  return frequency * frequency;
}

void StepControl::shorten(const State& state, double limit, RigidIndex body) {
  const std::string& name = model_.bodies[static_cast<size_t>(body)].name;
  if (!automatic_) {
    throw Unstable(
        fmt::format("the step of {} s is above the stability limit of {:.6g} s of the "
                    "contacts of body \"{}\" {}; give a smaller time.step or \"auto\"",
                    choice_.step, limit, name, at_time(state)));
  }
  if (state.step - lengthened_ < kSoon * patience_) patience_ *= 2;
  double size = choice_.step;
  while (size > kOfBound * safety_ * limit) {
    size /= 2;
    ++halvings_;
    part_ *= 2;
  }
  ++changes_.shortened;
  change(state, size, body);
  choice_.stability = limit;
  choice_.limit = {limit, fmt::format("contacts of \"{}\" {}", name, at_time(state))};
}

void StepControl::lengthen(const State& state) {
  --halvings_, part_ /= 2;
  lengthened_ = state.step;
  ++changes_.lengthened;
  change(state, 2 * choice_.step, -1);
}

void StepControl::change(const State& state, double size, RigidIndex body) {
  choice_.step = size;
  base_time_ = state.time;
  base_step_ = state.step;
  soft_ = 0;
  changes_.shortest = std::min(changes_.shortest, size);
  if (changes_.first.size() < kMostChanges) {
    changes_.first.push_back({state.time, state.step, size, body});
  }
}

void StepControl::fields(Archive& archive) {
  archive("size", choice_.step)("limit", choice_.limit.step)("limited_by", choice_.limit.reason)(
      "stability_limit", choice_.stability);
  archive("base_time", base_time_)("base_step", base_step_)("halvings", halvings_)("part", part_);
  archive("soft", soft_)("patience", patience_)("lengthened", lengthened_)("changes", changes_);
}

}  // namespace apothem
