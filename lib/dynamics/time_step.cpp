#include "lib/dynamics/time_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "lib/contact/law/stiffness.hpp"
#include "lib/dynamics/landing.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/model/pairs.hpp"

namespace apothem {

namespace {

// Parts of the limit of stability, at most: of finite elements, and of rigid bodies.
constexpr double kSmooth = .5;
constexpr double kCoarsest = .6;

// Bounds of all landings of one body or of several.
struct LandingBounds {
  double longest = 0;   // m
  double mobility = 0;  // the highest, with friction springs in proportion, 1/kg
  double slope = 0;     // of the potential, 1/m
  double slide = 0;     // the same along the strips, 1/kg
  int pieces = 1;       // the most

  void include(const LandingBounds& other) {
    longest = std::max(longest, other.longest);
    mobility = std::max(mobility, other.mobility);
    slope = std::max(slope, other.slope);
    slide = std::max(slide, other.slide);
    pieces = std::max(pieces, other.pieces);
  }
};

// A body in the search for the stiffest pair.
struct Lander {
  std::vector<Landing> landings;
  LandingBounds bounds;
};

// lambda over the normal stiffness of a body on a landing of this breadth (m), 1/kg. Friction
// springs have `ratio` times this stiffness.
double mobility_of(const RigidBody& body, const Landing& landing, double breadth, double ratio) {
  BodyStiffness stiffness;
  stiffness.add(1, 0, 1, landing.arm);
  stiffness.tt += breadth * breadth / 12;
  stiffness.add(ratio, 1, 0, landing.height);
  return rate_of(stiffness, body.inverse_mass());
}

// lambda over the thickness of two bodies that lie on each other with these landings: that of the
// normal force, and with the springs of friction beside it.
double lambda_of(const RigidBody& body_a, const RigidBody& body_b, const Landing& a,
                 const Landing& b, const PairLaw& law) {
  const double slopes = body_a.potential.steepest + body_b.potential.steepest;
  const double normal = law.normal_stiffness * std::min(a.length, b.length) * slopes;
  if (!law.rough()) return normal * (a.mobility + b.mobility);
  const double breadth = std::min(a.breadth, b.breadth);
  const int springs = std::max(a.pieces, b.pieces);
  const double ratio =
      law.friction.stiffness_ratio + springs * law.friction.tangential_stiffness / normal;
  return normal * (mobility_of(body_a, a, breadth, ratio) + mobility_of(body_b, b, breadth, ratio));
}

// The landings of all bodies at the deepest impact that they may have with one that is flat.
std::vector<Lander> landers(const Model& model, double softest, double ratio) {
  const std::vector<double> speeds = fastest_speeds(model);
  // Of each body the fastest and the flattest other one.
  const auto other = [&](auto&& value, auto&& better, double none) {
    double first = none, second = none;
    for (size_t i = 0; i < model.bodies.size(); ++i) {
      const double x = value(i);
      if (better(x, first)) {
        second = first, first = x;
      } else if (better(x, second)) {
        second = x;
      }
    }
    return [=](double own) { return own == first ? second : first; };
  };
  const auto slope = [&](size_t i) { return model.bodies[i].potential.steepest; };
  const auto fastest = other([&](size_t i) { return speeds[i]; }, std::greater(), 0.);
  const auto flattest = other(slope, std::less(), HUGE_VAL);
  std::vector<double> energies;  // J, with the mass of the body that moves
  for (size_t i = 0; i < model.bodies.size(); ++i) {
    const double speed = speeds[i] + fastest(speeds[i]);
    const bool free = model.bodies[i].motion == Motion::free;
    energies.push_back(free ? model.bodies[i].mass * speed * speed / 2 : 0);
  }
  const double largest = energies.empty() ? 0 : *std::ranges::max_element(energies);
  std::vector<Lander> all;
  for (size_t i = 0; i < model.bodies.size(); ++i) {
    const RigidBody& body = model.bodies[i];
    const double energy = body.motion == Motion::free ? energies[i] : largest;
    const double slopes = slope(i) + flattest(slope(i));
    Lander lander;
    lander.landings = landings(body, energy / (softest * model.thickness * slopes));
    for (const Landing& landing : lander.landings) {
      const double mobility =
          ratio > 0 ? mobility_of(body, landing, landing.breadth, ratio) : landing.mobility;
      lander.bounds.include({landing.length, mobility, slope(i), landing.slide, landing.pieces});
    }
    all.push_back(std::move(lander));
  }
  return all;
}

std::string quoted(const std::string& name) { return '"' + name + '"'; }

}  // namespace

double flat_mobility(const RigidBody& body) {
  double worst = 0;
  for (const Landing& landing : landings(body, 0)) {
    worst = std::max(worst, landing.length * landing.mobility);
  }
  return worst;
}

namespace {

// A bound of lambda over the thickness of two bodies, or of a body with each of a group.
double flat_bound(const LandingBounds& a, const LandingBounds& b, const PairLaw& worst) {
  const double normal =
      std::min(a.longest, b.longest) * (a.mobility + b.mobility) * (a.slope + b.slope);
  return worst.normal_stiffness * normal +
         std::max(a.pieces, b.pieces) * worst.friction.tangential_stiffness * (a.slide + b.slide);
}

// A number rounded to 32 bits: exponent and digits.
std::pair<int, long long> rounded(double value) {
  int exponent = 0;
  const double digits = std::frexp(value, &exponent);
  return {exponent, std::llround(std::ldexp(digits, 32))};
}

// What the stiffness of a body's contacts follows from, rounded.
using LanderKind = std::vector<std::pair<int, long long>>;

LanderKind kind_of(const RigidBody& body, int law, const Lander& lander) {
  std::vector<LanderKind> landings;
  for (const Landing& l : lander.landings) {
    landings.push_back({rounded(l.length),
                        rounded(l.breadth),
                        rounded(std::abs(l.arm)),
                        rounded(std::abs(l.height)),
                        rounded(l.mobility),
                        rounded(l.slide),
                        {l.pieces, 0}});
  }
  std::ranges::sort(landings);
  LanderKind kind{{law, body.can_move()}, rounded(body.potential.steepest)};
  for (const double inverse : body.inverse_mass()) kind.push_back(rounded(inverse));
  for (const LanderKind& landing : landings)
    kind.insert(kind.end(), landing.begin(), landing.end());
  return kind;
}

// Bodies that stand for all: two of each kind. A thousand equal boxes at other places differ by
// round-off, and the stiffest of their pairs would be sought among all.
std::vector<int> representatives(const Model& model, const PairTable& table,
                                 const std::vector<Lander>& all) {
  std::map<LanderKind, int> members;
  std::vector<int> chosen;
  for (int i = 0; i < static_cast<int>(all.size()); ++i) {
    if (++members[kind_of(model.bodies[i], table.kind(i), all[i])] <= 2) chosen.push_back(i);
  }
  return chosen;
}

struct FlatGroup {
  std::vector<int> members;
  LandingBounds bounds;
};

// Bodies of about the same size go together, so that the bounds of a group are sharp.
std::vector<FlatGroup> groups_by_length(const std::vector<Lander>& all, std::vector<int> order) {
  std::ranges::stable_sort(order, std::greater(), [&](int i) { return all[i].bounds.longest; });
  const auto size = static_cast<size_t>(std::sqrt(static_cast<double>(order.size()))) + 1;
  std::vector<FlatGroup> groups;
  for (const int i : order) {
    if (groups.empty() || groups.back().members.size() == size) groups.emplace_back();
    groups.back().members.push_back(i);
    groups.back().bounds.include(all[i].bounds);
  }
  return groups;
}

}  // namespace

StepLimit contact_step_limit(const Model& model) {
  const PairTable table = pair_table(model);
  const std::vector<Lander> all =
      landers(model, table.softest(), table.stiffest_friction().stiffness_ratio);
  const std::vector<int> chosen = representatives(model, table, all);
  const std::vector<FlatGroup> groups = groups_by_length(all, chosen);
  const PairLaw stiffest{.normal_stiffness = table.stiffest(),
                         .friction = table.stiffest_friction()};
  const auto bound = [&](int i) {
    double most = 0;
    for (const FlatGroup& group : groups) {
      most = std::max(most, flat_bound(all[i].bounds, group.bounds, stiffest));
    }
    return most;
  };
  // Bodies in the order of what they could reach at worst, so that the search may stop early.
  std::vector<std::pair<double, int>> order;
  order.reserve(chosen.size());
  for (const int i : chosen) order.emplace_back(-bound(i), i);
  std::ranges::sort(order);
  double worst = 0;
  std::array<int, 2> pair{-1, -1};
  const auto look_at = [&](int i, int j) {
    const RigidBody &a = model.bodies[i], &b = model.bodies[j];
    const PairLaw& law = table.between(i, j);
    for (const Landing& p : all[i].landings) {
      for (const Landing& q : all[j].landings) {
        const double lambda = lambda_of(a, b, p, q, law);
        if (lambda > worst) worst = lambda, pair = {std::min(i, j), std::max(i, j)};
      }
    }
  };
  for (const auto& [minus_bound, i] : order) {
    if (!(-minus_bound > worst)) break;
    for (const FlatGroup& group : groups) {
      if (!(flat_bound(all[i].bounds, group.bounds, stiffest) > worst)) continue;
      for (const int j : group.members) {
        if (i == j || (!model.bodies[i].can_move() && !model.bodies[j].can_move())) continue;
        if (flat_bound(all[i].bounds, all[j].bounds, stiffest) > worst) look_at(i, j);
      }
    }
  }
  if (worst <= 0) return {std::numeric_limits<double>::infinity(), "no contact can occur"};
  return {2 / std::sqrt(model.thickness * worst),
          "contact of " + quoted(model.bodies[pair[0]].name) + " with " +
              quoted(model.bodies[pair[1]].name)};
}

StepLimit motion_step_limit(const Model& model) {
  double inradius = std::numeric_limits<double>::infinity(), fastest = 0;
  std::string name;
  const std::vector<double> speeds = fastest_speeds(model);
  for (size_t i = 0; i < model.bodies.size(); ++i) {
    inradius = std::min(inradius, model.bodies[i].inradius);
    if (speeds[i] > fastest) fastest = speeds[i], name = model.bodies[i].name;
  }
  if (model.bodies.size() < 2 || fastest == 0) {
    return {std::numeric_limits<double>::infinity(), "nothing to run into"};
  }
  return {kLargestStride * inradius / fastest, "speed of " + quoted(name)};
}

namespace {

void require_progress(const StepChoice& choice, double end) {
  if (choice.step > 0 && std::isfinite(choice.step) && end + choice.step > end) return;
  throw Unrunnable(
      fmt::format("a step of {:.3g} s ({}) makes no progress towards the end at {:.3g} s; "
                  "check the magnitudes of time, stiffness, masses and speeds",
                  choice.step, choice.limit.reason, end),
      "time", -1);
}

}  // namespace

double contact_safety(double accuracy) {
  return std::min(.16 * power(accuracy / 1e-4, 1. / 5), kCoarsest);
}

double damped_safety(double accuracy) {
  return std::min(.05 * std::sqrt(accuracy / 1e-4), contact_safety(accuracy));
}

double element_safety(double accuracy) {
  return std::min(.11 * std::sqrt(accuracy / 1e-4), kSmooth);
}

StepChoice choose_step(const Model& model, const TimeSettings& time, const StepBounds& bounds,
                       int frames, bool node_contact) {
  StepChoice choice;
  choice.damped = !model.bodies.empty() && pair_table(model).damped();
  choice.safety = time.safety.value_or(choice.damped ? damped_safety(time.accuracy)
                                                     : contact_safety(time.accuracy));
  choice.element_safety =
      time.element_safety.value_or(node_contact ? element_safety(time.accuracy) : kSmooth);
  choice.limit = bounds.nodes.step < bounds.bodies.step ? bounds.nodes : bounds.bodies;
  choice.stability = choice.limit.step;
  if (time.statics) {
    choice.step = time.end / time.load_steps;
    choice.limit = {choice.step, "load steps"};
    return choice;
  }
  if (time.fixed_step) {
    choice.step = *time.fixed_step;
    if (time.scheme != TimeScheme::implicit && choice.step > choice.limit.step) {
      throw Unrunnable(
          fmt::format("{} s is above the stability limit of {:.6g} s ({}); give a smaller "
                      "step or \"auto\"",
                      choice.step, choice.limit.step, choice.limit.reason),
          "time/step", -1);
    }
    require_progress(choice, time.end);
    return choice;
  }
  double target = choice.safety * bounds.bodies.step;
  if (choice.element_safety * bounds.nodes.step < target) {
    target = choice.element_safety * bounds.nodes.step;
    choice.limit = bounds.nodes;
  }
  const StepLimit motion = motion_step_limit(model);
  if (motion.step < target) {
    choice.limit = motion;
    target = motion.step;
  }
  const double interval = time.end / std::max(frames, 1);
  if (std::min(interval, time.longest_step) <= target) {
    target = std::min(interval, time.longest_step);
    choice.limit = {target, "interval of the output"};
  }
  choice.step = interval / std::max(std::ceil(interval / target * (1 - 1e-12)), 1.0);
  require_progress(choice, time.end);
  return choice;
}

}  // namespace apothem
