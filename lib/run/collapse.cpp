#include "lib/run/collapse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/polygon/point.hpp"

namespace apothem {
namespace {

constexpr double kMoves = 0.01;      // of the longest way
constexpr double kMechanism = 0.01;  // of an inradius
constexpr double kShown = 0.05;      // of the size of all free bodies

// The mean motion of the nodes of a deformable body, and the longest way of one.
MovingBody motion_of_nodes(const Model& model, const State& state, DeformableIndex d,
                           const std::vector<double>& motion) {
  const DeformableBody& body = model.deformables[static_cast<size_t>(d)];
  MovingBody result{static_cast<BodyIndex>(model.bodies.size()) + d, 0, 0, 0, 0};
  const auto n = static_cast<NodeIndex>(body.mesh.nodes.size());
  for (NodeIndex i = 0; i < n; ++i) {
    const Vec2 way(&motion[state.layout.node(body.first_node + i)]);
    result.x += way.x() / n, result.y += way.y() / n;
    result.most = std::max(result.most, way.norm());
  }
  return result;
}

std::vector<MovingBody> all_bodies(const Model& model, const State& state,
                                   const std::vector<double>& motion) {
  std::vector<MovingBody> all;
  for (RigidIndex i = 0; i < state.layout.rigid_bodies; ++i) {
    const double* const way = &motion[state.layout.rigid(i)];
    double radius = 0;
    for (const Vec2& v : model.bodies[static_cast<size_t>(i)].potential.vertices) {
      radius = std::max(radius, v.norm());
    }
    all.push_back(
        {i, way[0], way[1], way[2], Vec2(way[0], way[1]).norm() + radius * std::abs(way[2])});
  }
  for (DeformableIndex d = 0; d < static_cast<DeformableIndex>(model.deformables.size()); ++d) {
    all.push_back(motion_of_nodes(model, state, d, motion));
  }
  return all;
}

double longest(const std::vector<MovingBody>& bodies) {
  double most = 0;
  for (const MovingBody& body : bodies) most = std::max(most, body.most);
  return most;
}

}  // namespace

std::vector<MovingBody> moving_bodies(const Model& model, const State& state,
                                      const std::vector<double>& motion) {
  std::vector<MovingBody> bodies = all_bodies(model, state, motion);
  const double most = longest(bodies);
  std::erase_if(bodies, [&](const MovingBody& b) { return !(b.most > kMoves * most); });
  return bodies;
}

bool is_mechanism(const Model& model, const State& state, const std::vector<double>& motion) {
  return std::ranges::any_of(all_bodies(model, state, motion), [&](const MovingBody& b) {
    const auto rigid = static_cast<BodyIndex>(model.bodies.size());
    if (b.body < rigid) {
      return b.most > kMechanism * model.bodies[static_cast<size_t>(b.body)].inradius;
    }
    const DeformableBody& body = model.deformables[static_cast<size_t>(b.body - rigid)];
    return b.most > kMechanism * box_of(body.mesh.nodes).extent();
  });
}

double shown_scale(const Model& model, const State& state, const std::vector<double>& motion) {
  Box box;
  for (const RigidBody& body : model.bodies) {
    if (body.motion != Motion::free) continue;
    for (const Vec2& v : body.potential.vertices) box.include(body.position + v);
  }
  for (const DeformableBody& body : model.deformables) {
    for (const Vec2& node : body.mesh.nodes) box.include(node);
  }
  const double most = longest(all_bodies(model, state, motion));
  return most > 0 ? kShown * box.extent() / most : 1;
}

std::string describe(const Model& model, const State& state, const Collapse& collapse) {
  const std::vector<MovingBody> moving = moving_bodies(model, state, collapse.motion);
  std::string text =
      fmt::format("collapses at load factor {:.6g} (between {:.6g} and {:.6g})", collapse.factor(),
                  collapse.factor() - collapse.error(), collapse.factor() + collapse.error());
  if (!std::isfinite(collapse.error())) {
    text = fmt::format(
        "collapses at load factor {:.6g} with the stiffest contacts that have found "
        "equilibria; too few others tell what rigid bodies do",
        collapse.factor());
  }
  if (moving.empty()) return text;
  const auto most = std::ranges::max_element(moving, {}, &MovingBody::most);
  return text + fmt::format(": {} of {} bodies move, \"{}\" most; the last frame shows how",
                            moving.size(), model.bodies.size() + model.deformables.size(),
                            model.name_of(most->body));
}

}  // namespace apothem
