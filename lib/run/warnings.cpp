#include "lib/run/warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/model/inradius.hpp"

namespace apothem {
namespace {

// Contact is a penalty: what it lets bodies into each other should not matter for their motion.
void warn_of_penetration(const Model& model, const Peak& deepest,
                         std::vector<std::string>& warnings) {
  const double limit = model.contact.penetration_warning;
  if (!(deepest.value > limit)) return;
  double inradius = inradius_of(model, deepest.a);
  BodyIndex smaller = deepest.a;
  if (const double other = inradius_of(model, deepest.b); other < inradius) {
    inradius = other;
    smaller = deepest.b;
  }
  warnings.push_back(fmt::format(
      "\"{}\" and \"{}\" were {:.3g} m deep in each other at t = {:.6g} s, {:.3g} % of the "
      "inradius of \"{}\" ({:.3g} m) and more than contact.{} ({:.3g} %): {}",
      model.name_of(deepest.a), model.name_of(deepest.b), deepest.value * inradius, deepest.time,
      100 * deepest.value, model.name_of(smaller), inradius,
      limit == model.contact.penetration ? "penetration" : "penetration_warning", 100 * limit,
      stiffening(model.contact)));
}

// What lasted has ended the run. What a contact has made and taken back is no energy of the run,
// but its motion meanwhile is coarse.
void warn_of_energy(const Extremes& extremes, std::vector<std::string>& warnings) {
  if (!(extremes.energy_error > extremes.energy_allowed)) return;
  warnings.push_back(fmt::format(
      "for a few steps {:.3g} J were unaccounted for, more than a tenth of the {:.3g} J in play: "
      "contacts are integrated coarsely; reduce the time step",
      extremes.energy_error, extremes.energy_in_play));
}

// An equilibrium may be found that no body would stay in.
void warn_of_instability(std::span<const LoadStep> steps, std::vector<std::string>& warnings) {
  const auto unstable = [](const LoadStep& step) { return step.negative_pivots > 0; };
  const auto first = std::ranges::find_if(steps, unstable);
  if (first == steps.end()) return;
  const auto more = std::count_if(first + 1, steps.end(), unstable);
  warnings.push_back(fmt::format(
      "the equilibrium at t = {:.6g} s{} is unstable: its tangent stiffness has {} negative "
      "pivot{}, one for each way to fall from it; support the body, reduce the load, or give it an "
      "imperfection with which it buckles",
      first->time, more > 0 ? fmt::format(", like those of {} later load steps,", more) : "",
      first->negative_pivots, first->negative_pivots == 1 ? "" : "s"));
}

// Statics does not know the motion between equilibria.
void warn_of_moves(const Model& model, std::span<const LoadStep> steps,
                   std::vector<std::string>& warnings) {
  const auto first = std::ranges::find_if(steps, [](const LoadStep& s) { return s.moved >= 0; });
  if (first == steps.end()) return;
  warnings.push_back(
      fmt::format("\"{}\" has moved by {:.3g} m, {:.3g} times its inradius, in the load step to t "
                  "= {:.6g} s: it "
                  "has tipped over or slid to another place, and statics does not know whether it "
                  "would come to "
                  "rest there; \"load_steps\": \"auto\" finds the load at which it lets go",
                  model.name_of(first->moved), first->way,
                  first->way / inradius_of(model, first->moved), first->time));
}

// Free bodies that are below all others along gravity, by more than the size of any: nothing can
// catch them.
std::vector<RigidIndex> falling_for_ever(const Model& model, const State& state) {
  const Vec2 down = model.gravity.normalized();
  double floor = -HUGE_VAL;
  const auto bodies = static_cast<RigidIndex>(model.bodies.size());
  for (RigidIndex i = 0; i < bodies; ++i) {
    const RigidBody& body = model.bodies[i];
    if (body.motion == Motion::free || state.is_absent(i)) continue;
    const double reach = box_of(body.potential.vertices).extent();
    floor = std::max(floor, down.dot(state.pose(i).head<2>()) + reach);
  }
  std::vector<RigidIndex> found;
  for (RigidIndex i = 0; i < bodies; ++i) {
    const RigidBody& body = model.bodies[i];
    if (body.motion != Motion::free || state.is_absent(i)) continue;
    const double reach = box_of(body.potential.vertices).extent();
    if (down.dot(state.pose(i).head<2>()) - reach > floor) found.push_back(i);
  }
  return found;
}

}  // namespace

std::string rules_in_vain(const Model& model, const std::vector<StopRule>& rules,
                          const State& state) {
  const auto waits = [](const StopRule& rule) { return rule.kinetic_per_body && rule.region < 0; };
  const auto rule = std::ranges::find_if(rules, waits);
  if (rule == rules.end() || !model.has_gravity() || !model.deformables.empty()) return {};
  const std::vector<RigidIndex> falling = falling_for_ever(model, state);
  if (falling.empty()) return {};
  const std::string more =
      falling.size() > 1 ? fmt::format(" and {} more bodies fall", falling.size() - 1) : " falls";
  return fmt::format(
      "\"{}\"{} and nothing is below, so that the rule \"{}\" waits for rest in vain: bound the "
      "\"world\", with \"outside\": \"remove\"",
      model.bodies[falling.front()].name, more, rule->name);
}

std::vector<std::string> warnings_of(const Model& model, const Extremes& extremes,
                                     std::span<const LoadStep> steps) {
  std::vector<std::string> warnings;
  warn_of_instability(steps, warnings);
  warn_of_moves(model, steps, warnings);
  warn_of_energy(extremes, warnings);
  warn_of_penetration(model, extremes.relative_penetration, warnings);
  return warnings;
}

std::string with_key_of_step(std::string sentence, const TimeSettings& time) {
  constexpr std::string_view kWords = "the time step";
  const size_t reduce = sentence.rfind("reduce ");
  const size_t at = reduce == std::string::npos ? reduce : sentence.find(kWords, reduce);
  if (at == std::string::npos) return sentence;
  const char* const key = time.fixed_step ? "time.step"
                          : time.safety   ? "time.safety"
                                          : "time.accuracy";
  return sentence.replace(at, kWords.size(), key);
}

}  // namespace apothem
