#include "lib/run/collapse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/polygon/point.hpp"
#include "lib/dynamics/departure.hpp"

namespace apothem {
namespace {

constexpr double kMoves = 0.01;      // of the longest way
constexpr double kMechanism = 0.01;  // of an inradius
constexpr double kShown = 0.05;      // of the size of all free bodies

std::vector<MovingBody> all_bodies(const Model& model, const State& state,
                                   const std::vector<double>& motion) {
  State from(state.layout), to(state.layout);
  to.x = motion;
  std::vector<MovingBody> all;
  const size_t count = model.bodies.size() + model.deformables.size();
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(count); ++b) {
    const BodyShift way = motion_of(model, to, from, b);
    double most = way.most();
    if (b >= state.layout.rigid_bodies) {
      const DeformableBody& body =
          model.deformables[static_cast<size_t>(b - state.layout.rigid_bodies)];
      most = 0;
      for (NodeIndex i = 0; i < static_cast<NodeIndex>(body.mesh.nodes.size()); ++i) {
        most = std::max(most, to.node(body.first_node + i).norm());
      }
    }
    all.push_back({b, way.shift.x(), way.shift.y(), way.turn, most});
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
