#include "apothem/dynamics/time_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "apothem/contact/stiffness.hpp"
#include "apothem/dynamics/unstable.hpp"
#include "apothem/execution/elementary.hpp"
#include "apothem/model/pairs.hpp"

namespace apothem {

namespace {

// Parts of the limit of stability, at most: of finite elements, and of rigid bodies.
constexpr double kSmooth = .5;
constexpr double kCoarsest = .6;

// An edge that lies flat on another body.
struct FlatEdge {
  double length;    // m
  double mobility;  // of the body against a force spread over the edge, 1/kg
};

struct FlatEdges {
  std::vector<FlatEdge> edges;
  double longest = 0;   // m
  double mobility = 0;  // the highest, 1/kg
  double slope = 0;     // of the potential, 1/m
};

FlatEdges flat_edges(const RigidBody& body) {
  FlatEdges result;
  const std::array<double, 3> inverse_mass = body.inverse_mass();
  const std::vector<Vec2>& v = body.potential.vertices;
  for (size_t i = 0; i < v.size(); ++i) {
    const Vec2& p = v[i];
    const Vec2& q = v[i + 1 == v.size() ? 0 : i + 1];
    const double length = (q - p).norm();
    const double arm = std::abs((p + q).dot(q - p)) / (2 * length);
    result.edges.push_back({length, strip_mobility(inverse_mass, arm, length)});
    result.longest = std::max(result.longest, length);
    result.mobility = std::max(result.mobility, result.edges.back().mobility);
  }
  result.slope = body.potential.steepest;
  return result;
}

// lambda / k_n of two bodies, flat on each other along the worst two edges.
double flat_contact(const FlatEdges& a, const FlatEdges& b) {
  double worst = 0;
  for (const FlatEdge& p : a.edges) {
    for (const FlatEdge& q : b.edges) {
      worst = std::max(worst, std::min(p.length, q.length) * (p.mobility + q.mobility));
    }
  }
  return worst * (a.slope + b.slope);
}

std::string quoted(const std::string& name) { return '"' + name + '"'; }

}  // namespace

double flat_mobility(const RigidBody& body) {
  double worst = 0;
  for (const FlatEdge& edge : flat_edges(body).edges) {
    worst = std::max(worst, edge.length * edge.mobility);
  }
  return worst;
}

namespace {

// A bound of lambda / k_n of two bodies, or of a body with each of a group.
template <class Flat>
double flat_bound(const FlatEdges& a, const Flat& b) {
  return std::min(a.longest, b.longest) * (a.mobility + b.mobility) * (a.slope + b.slope);
}

// Bounds of some bodies.
struct FlatGroup {
  std::vector<int> members;
  double longest = 0, mobility = 0, slope = 0;

  void add(int member, const FlatEdges& f) {
    members.push_back(member);
    longest = std::max(longest, f.longest);
    mobility = std::max(mobility, f.mobility);
    slope = std::max(slope, f.slope);
  }
};

// Bodies of about the same size go together, so that the bounds of a group are sharp.
std::vector<FlatGroup> groups_by_length(const std::vector<FlatEdges>& all) {
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater(), [&](int i) { return all[i].longest; });
  const auto size = static_cast<size_t>(std::sqrt(static_cast<double>(all.size()))) + 1;
  std::vector<FlatGroup> groups;
  for (const int i : order) {
    if (groups.empty() || groups.back().members.size() == size) groups.emplace_back();
    groups.back().add(i, all[i]);
  }
  return groups;
}

}  // namespace

StepLimit contact_step_limit(const Model& model) {
  std::vector<FlatEdges> all;
  for (const RigidBody& body : model.bodies) all.push_back(flat_edges(body));
  const PairTable table = pair_table(model);
  const std::vector<FlatGroup> groups = groups_by_length(all);
  const auto bound = [&](int i) {
    double most = 0;
    for (const FlatGroup& group : groups) most = std::max(most, flat_bound(all[i], group));
    return most * table.stiffest();
  };
  // Bodies in the order of what they could reach at worst, so that the search may stop early.
  std::vector<std::pair<double, int>> order;
  for (int i = 0; i < static_cast<int>(all.size()); ++i) order.emplace_back(-bound(i), i);
  std::ranges::sort(order);
  double worst = 0;
  std::array<int, 2> pair{-1, -1};
  for (const auto& [minus_bound, i] : order) {
    if (!(-minus_bound > worst)) break;
    for (const FlatGroup& group : groups) {
      if (!(flat_bound(all[i], group) * table.stiffest() > worst)) continue;
      for (const int j : group.members) {
        if (!(flat_bound(all[i], all[j]) * table.stiffest() > worst)) continue;
        if (i == j || (!model.bodies[i].can_move() && !model.bodies[j].can_move())) continue;
        const double lambda = flat_contact(all[i], all[j]) * table.between(i, j).normal_stiffness;
        if (lambda > worst) {
          worst = lambda;
          pair = {std::min(i, j), std::max(i, j)};
        }
      }
    }
  }
  if (worst <= 0) return {std::numeric_limits<double>::infinity(), "no contact can occur"};
  return {2 / std::sqrt(model.thickness * worst),
          "contact of " + quoted(model.bodies[pair[0]].name) + " with " +
              quoted(model.bodies[pair[1]].name)};
}

StepLimit motion_step_limit(const Model& model) {
  double inradius = std::numeric_limits<double>::infinity();
  Box scene;
  for (const RigidBody& body : model.bodies) {
    inradius = std::min(inradius, body.inradius);
    for (const Vec2& v : body.potential.vertices) {
      scene.include(body.position.x() + v.x(), body.position.y() + v.y());
    }
  }
  double fastest = 0;
  std::string name;
  for (const RigidBody& body : model.bodies) {
    double speed = body.velocity.norm();
    double spin = std::abs(body.spin);
    if (body.servo) speed = body.servo->speed;
    for (const auto& point : body.history.velocity) speed = std::max(speed, point.velocity.norm());
    for (const auto& point : body.history.spin) spin = std::max(spin, std::abs(point.spin));
    if (body.motion == Motion::free) {
      speed = std::sqrt(speed * speed + 2 * model.strongest_gravity() * scene.extent());
    }
    speed += spin * body.reach();
    if (speed > fastest) {
      fastest = speed;
      name = body.name;
    }
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

double element_safety(double accuracy) {
  return std::min(.2 * power(accuracy / 1e-4, 1. / 4), kSmooth);
}

StepChoice choose_step(const Model& model, const TimeSettings& time, const StepBounds& bounds,
                       int frames, bool node_contact) {
  StepChoice choice;
  choice.safety = time.safety.value_or(contact_safety(time.accuracy));
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
    if (choice.step > choice.limit.step) {
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
