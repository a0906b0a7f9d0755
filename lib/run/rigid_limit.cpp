#include "lib/run/rigid_limit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/dynamics/simulation.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/run/collapse.hpp"
#include "lib/run/load_path.hpp"

namespace apothem {
namespace {

constexpr double kStiffer = 10;
constexpr double kShorter = 0.46415888336127786;              // one over its cube root
constexpr size_t kFewest = 4;                                 // passes
constexpr double kRounded = 5e-7;                             // of the weight
constexpr double kLeastRatio = 1.585, kMostRatio = kStiffer;  // of exponents .2 and 1: believed
constexpr double kSoftest = 1e-3;  // of the stiffest pass: kFewest of them

using Three = std::span<const double, 3>;

// The weights of the values at x = k^(-1/3) in the parabola through them at x = 0.
Estimate by_thirds(Three f, double noise) {
  const double s = kShorter;
  const std::array<double, 3> x{1, s, s * s};
  Estimate result;
  for (size_t i = 0; i < 3; ++i) {
    double weight = 1;
    for (size_t j = 0; j < 3; ++j) {
      if (j != i) weight *= x[j] / (x[j] - x[i]);
    }
    result.value += weight * f[i];
    result.error += std::abs(weight) * noise;
  }
  return result;
}

// A geometric series with the ratio of the last two differences, within the exponents that are
// believed.
Estimate by_ratio(Three f, double noise) {
  const double before = f[1] - f[0], last = f[2] - f[1];
  const double ratio = last != 0 ? before / last : HUGE_VAL;
  const double r = std::clamp(ratio > 0 ? ratio : HUGE_VAL, kLeastRatio, kMostRatio);
  return {f[2] + last / (r - 1), noise * (1 + 4 / (r - 1))};
}

}  // namespace

Estimate extrapolate(std::span<const double> values, double noise) {
  const Three now = values.last<3>();
  const Estimate thirds = by_thirds(now, noise), ratio = by_ratio(now, noise);
  if (values.size() == 3) {
    return {thirds.value,
            std::max(thirds.error, ratio.error) + std::abs(thirds.value - ratio.value)};
  }
  const Three before = values.first(values.size() - 1).last<3>();
  const double thirds_error =
      thirds.error + std::abs(thirds.value - by_thirds(before, noise).value);
  const double ratio_error = ratio.error + std::abs(ratio.value - by_ratio(before, noise).value);
  return thirds_error <= ratio_error ? Estimate{thirds.value, thirds_error}
                                     : Estimate{ratio.value, ratio_error};
}

std::optional<Estimate> RigidLimit::factor() const {
  std::vector<double> values;
  double noise = 0;
  for (const RigidPass& pass : passes) {
    // A soft structure that does not stand at all says nothing about the limit.
    if (!pass.collapsed || pass.lower == 0) {
      values.clear(), noise = 0;
      continue;
    }
    values.push_back(pass.factor());
    noise = std::max(noise, (pass.upper - pass.lower) / 2);
  }
  if (values.size() < kFewest - 1) return {};
  return extrapolate(values, noise);
}

Model stiffened(Model model, double scale) {
  const auto stiffen = [&](Friction& friction) { friction.tangential_stiffness *= scale; };
  ContactLaw& law = model.contact;
  law.normal_stiffness *= scale;
  stiffen(law.friction);
  for (ContactRule& rule : law.rules) {
    if (rule.normal_stiffness) *rule.normal_stiffness *= scale;
    if (rule.friction) stiffen(*rule.friction);
  }
  return model;
}

namespace {

// What a contact of a body makes of the rounding of its places, N per Pa of k_n: another body lies
// flat on its longest side.
double rounded(const Model& model, double place, double slope, double longest) {
  return std::numeric_limits<double>::epsilon() * place * 2 * model.thickness * slope * longest;
}
double rounded(const Model& model, const RigidBody& body) {
  double longest = 0, radius = 0;
  for (int i = 0; i < body.potential.size(); ++i) {
    const Vec2& vertex = body.potential.vertices[i];
    radius = std::max(radius, vertex.norm());
    longest = std::max(longest, (body.potential.vertices[body.potential.next(i)] - vertex).norm());
  }
  const double place = std::abs(body.position.x()) + std::abs(body.position.y()) + radius;
  return rounded(model, place, body.potential.steepest, longest);
}
double rounded(const Model& model, const DeformableBody& body) {
  const Box box = box_of(body.mesh.nodes);
  const double place =
      std::max(std::abs(box.x0), std::abs(box.x1)) + std::max(std::abs(box.y0), std::abs(box.y1));
  return rounded(model, place, 1 / boundary_inradius(body.mesh, boundary(body.mesh)), box.extent());
}

}  // namespace

double stiffest(const Model& model, std::span<const double> forces) {
  const double g = model.strongest_gravity();
  double most = HUGE_VAL;
  const auto bound = [&](double force, double noise) {
    if (force > 0) most = std::min(most, kRounded * force / noise);
  };
  const size_t rigid = model.bodies.size();
  for (size_t i = 0; i < rigid; ++i) {
    const RigidBody& body = model.bodies[i];
    if (body.motion != Motion::free) continue;
    bound(g > 0 ? body.mass * g : forces.empty() ? 0 : forces[i], rounded(model, body));
  }
  if (forces.empty()) return most;
  for (size_t d = 0; d < model.deformables.size(); ++d) {
    bound(forces[rigid + d], rounded(model, model.deformables[d]));
  }
  return most;
}

namespace {

// The end of one pass.
struct End {
  State state;
  std::vector<double> forces;  // that press on each body in its last equilibrium, N
};

std::vector<double> forces_on_bodies(const Model& model, const Simulation& simulation) {
  std::vector<double> forces(model.bodies.size() + model.deformables.size(), 0);
  for (const ContactRecord& contact : simulation.contacts()) {
    for (const BodyIndex body : {contact.a, contact.b}) {
      forces[static_cast<size_t>(body)] += contact.normal.norm();
    }
  }
  return forces;
}

// One pass: the load path to its end or to the limit. Returns nothing if an equilibrium has not
// been found.
std::optional<End> walk(const Model& model, const TimeSettings& time, int threads,
                        const std::function<bool()>& stop, RigidPass& pass) {
  Simulation simulation(model, time, 1, threads, stop);
  std::vector<double> forces(model.bodies.size() + model.deformables.size(), 0);
  LoadPath path(time.end);
  std::vector<double> motion;
  while (simulation.state().time < time.end * (1 - 1e-12)) {
    const double before = simulation.state().time, next = path.next(before);
    const LoadStep found = simulation.balance_near(next, stop, motion);
    if (!found.complete) throw Stopped();
    if (found.found) {
      path.found(next);
      forces = forces_on_bodies(model, simulation);
    } else if (path.missed(before, next)) {
      // Without a mechanism it is the search that has failed.
      if (!is_mechanism(model, simulation.state(), motion)) return {};
      pass.collapsed = true;
      pass.lower = before, pass.upper = next;
      return End{simulation.state(), forces};
    }
  }
  pass.lower = pass.upper = time.end;
  return End{simulation.state(), forces};
}

// The longest way between two states of a point of a free body: of a rigid one over its inradius,
// of nodes over the longest way that one of the body has gone.
double change_of_places(const Model& model, const State& a, const State& b) {
  double most = 0;
  for (RigidIndex i = 0; i < a.layout.rigid_bodies; ++i) {
    const RigidBody& body = model.bodies[static_cast<size_t>(i)];
    if (body.motion != Motion::free) continue;
    const Eigen::Vector3d way = a.pose(i) - b.pose(i);
    double radius = 0;
    for (const Vec2& v : body.potential.vertices) radius = std::max(radius, v.norm());
    most = std::max(most, (way.head<2>().norm() + radius * std::abs(way[2])) / body.inradius);
  }
  for (const DeformableBody& body : model.deformables) {
    double longest = 0, change = 0;
    for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
      const size_t c = a.layout.node(body.first_node + static_cast<NodeIndex>(i));
      const Vec2 displacement(&b.x[c]);
      longest = std::max(longest, displacement.norm());
      change = std::max(change, (displacement - Vec2(&a.x[c])).norm());
    }
    if (longest > 0) most = std::max(most, change / longest);
  }
  return most;
}

// Whether another pass would tell nothing new.
bool stands_still(const RigidLimit& limit) {
  if (limit.passes.size() < 2) return false;
  if (!limit.collapses()) {
    return !limit.passes[limit.passes.size() - 2].collapsed &&
           limit.change <= RigidLimit::kTolerance;
  }
  if (limit.passes.size() < kFewest) return false;
  const std::optional<Estimate> factor = limit.factor();
  return factor && factor->error <= RigidLimit::kTolerance * std::abs(factor->value);
}

}  // namespace

RigidLimit find_rigid_limit(const Model& model, const TimeSettings& time, int threads,
                            const std::function<bool()>& stop) {
  const double own = model.contact.normal_stiffness;
  double most = stiffest(model, {}), stiffness = std::min(own, kSoftest * most);
  RigidLimit limit;
  std::optional<End> before;
  while (stiffness <= most * (1 + 1e-9)) {
    RigidPass pass{.stiffness = stiffness};
    const Model stiff = stiffened(model, stiffness / own);
    std::optional<End> after = walk(stiff, time, threads, stop, pass);
    if (!after) break;
    most = std::min(most, stiffest(model, after->forces));
    if (limit.passes.empty() && stiffness > 2 * kSoftest * most) {
      stiffness = kSoftest * most;  // what presses on the bodies is known only now
      continue;
    }
    limit.passes.push_back(pass);
    if (before) limit.change = change_of_places(model, before->state, after->state);
    before = std::move(after);
    if (stands_still(limit)) break;
    stiffness *= kStiffer;
  }
  if (limit.passes.empty()) {
    throw Unrunnable(
        "Newton's method finds no equilibrium under the first loads, although no body "
        "moves away; another contact.normal_stiffness may help",
        "contact/normal_stiffness", -1);
  }
  return limit;
}

}  // namespace apothem
