#include "apothem/dynamics/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace apothem {

double strip_mobility(const std::array<double, 3>& inverse_mass, double arm, double breadth) {
  const double translation = std::max(inverse_mass[0], inverse_mass[1]);
  const double spread = breadth * breadth / 12 * inverse_mass[2];
  const double mean = (translation + arm * arm * inverse_mass[2] + spread) / 2;
  return mean + std::sqrt(std::max(mean * mean - translation * spread, 0.0));
}

namespace {

// An edge lying flat on something.
struct Foot {
  double length;
  double mobility;
};

struct Footing {
  std::vector<Foot> feet;
  double longest = 0;
  double highest = 0;  // mobility
  double slope = 0;    // 1/r, 1/m
};

Footing footing(const RigidBody& body) {
  Footing result;
  const std::array<double, 3> inverse_mass = body.inverse_mass();
  const std::vector<Vec2>& v = body.potential.vertices;
  for (size_t i = 0; i < v.size(); ++i) {
    const Vec2& p = v[i];
    const Vec2& q = v[i + 1 == v.size() ? 0 : i + 1];
    const double length = (q - p).norm();
    const double arm = std::abs((p + q).dot(q - p)) / (2 * length);
    result.feet.push_back({length, strip_mobility(inverse_mass, arm, length)});
    result.longest = std::max(result.longest, length);
    result.highest = std::max(result.highest, result.feet.back().mobility);
  }
  result.slope = body.potential.steepest;
  return result;
}

// lambda / k_n of two bodies, flat on each other along the worst two edges.
double flat_contact(const Footing& a, const Footing& b) {
  double worst = 0;
  for (const Foot& p : a.feet) {
    for (const Foot& q : b.feet) {
      worst = std::max(worst, std::min(p.length, q.length) * (p.mobility + q.mobility));
    }
  }
  return worst * (a.slope + b.slope);
}

std::string quoted(const std::string& name) { return '"' + name + '"'; }

}  // namespace

double flat_mobility(const RigidBody& body) {
  double worst = 0;
  for (const Foot& foot : footing(body).feet) worst = std::max(worst, foot.length * foot.mobility);
  return worst;
}

StepLimit contact_step_limit(const Model& model) {
  std::vector<Footing> footings;
  Footing any;  // bounds every other body
  for (const RigidBody& body : model.bodies) {
    footings.push_back(footing(body));
    any.highest = std::max(any.highest, footings.back().highest);
    any.slope = std::max(any.slope, footings.back().slope);
  }
  // Bodies in the order of what they could reach at worst, so that the search may stop early.
  const auto bound = [&](int i) {
    const Footing& f = footings[i];
    return f.longest * (f.highest + any.highest) * (f.slope + any.slope);
  };
  std::vector<int> order(footings.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return std::pair(-bound(i), i) < std::pair(-bound(j), j); });
  double worst = 0;
  std::array<int, 2> pair{-1, -1};
  for (size_t k = 0; k < order.size() && bound(order[k]) > worst; ++k) {
    const int i = order[k];
    for (size_t l = k + 1; l < order.size(); ++l) {
      const int j = order[l];
      if (!model.bodies[i].can_move() && !model.bodies[j].can_move()) continue;
      const double lambda = flat_contact(footings[i], footings[j]);
      if (lambda > worst) {
        worst = lambda;
        pair = {std::min(i, j), std::max(i, j)};
      }
    }
  }
  if (worst <= 0) return {std::numeric_limits<double>::infinity(), "no contact can occur"};
  return {2 / std::sqrt(model.stiffness() * worst),
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
    double radius = 0;
    for (const Vec2& v : body.potential.vertices) radius = std::max(radius, v.norm());
    for (const auto& point : body.history.velocity) speed = std::max(speed, point.velocity.norm());
    for (const auto& point : body.history.spin) spin = std::max(spin, std::abs(point.spin));
    if (body.motion == Motion::free) {
      speed = std::sqrt(speed * speed + 2 * model.gravity.norm() * scene.extent());
    }
    speed += spin * radius;
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

}  // namespace apothem
