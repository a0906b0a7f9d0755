#include "apothem/model/columns.hpp"

#include <cmath>

namespace apothem {
namespace {

// The rotation that fits best, and angular momentum over the present moment of inertia.
BodyMotion mean_motion(const DeformableBody& body, const State& state,
                       const std::vector<double>& mass) {
  BodyMotion mean;
  Vec2 reference = Vec2::Zero();
  double whole = 0;
  const auto n = static_cast<int>(body.mesh.nodes.size());
  for (int i = 0; i < n; ++i) {
    const NodeIndex node = body.first_node + i;
    const double m = mass[node];
    whole += m;
    reference += m * body.mesh.nodes[i];
    mean.place += m * state.node(node);
    mean.velocity += m * state.node_velocity(node);
  }
  reference /= whole;
  mean.place = mean.place / whole + reference;
  mean.velocity /= whole;
  double turned = 0, straight = 0, angular = 0, inertia = 0;
  for (int i = 0; i < n; ++i) {
    const NodeIndex node = body.first_node + i;
    const double m = mass[node];
    const Vec2 before = body.mesh.nodes[i] - reference;
    const Vec2 now = body.mesh.nodes[i] + state.node(node) - mean.place;
    turned += m * cross(before, now);
    straight += m * before.dot(now);
    angular += m * cross(now, Vec2(state.node_velocity(node) - mean.velocity));
    inertia += m * now.squaredNorm();
  }
  mean.angle = std::atan2(turned, straight);
  mean.spin = angular / inertia;
  return mean;
}

}  // namespace

BodyMotion motion_of(const Model& model, const State& state, BodyIndex body,
                     const BodyForce& contact, const std::vector<double>& node_mass) {
  BodyMotion motion;
  motion.contact = contact;
  if (body < state.layout.rigid_bodies) {
    const auto x = state.pose(body), v = state.pose_rate(body), f = state.force(body);
    motion.place = x.head<2>();
    motion.angle = x[2];
    motion.velocity = v.head<2>();
    motion.spin = v[2];
    motion.contact.fx = f[0], motion.contact.fy = f[1];
  } else {
    motion = mean_motion(model.deformables[body - state.layout.rigid_bodies], state, node_mass);
    motion.contact = contact;
  }
  motion.place += model.origin;
  return motion;
}

std::vector<HistoryColumn> history_columns(const Model& model, const OutputSettings& settings) {
  std::vector<HistoryColumn> result;
  const auto add = [&](const std::string& name, const auto& kinds) {
    for (const auto& c : kinds) result.push_back({name + "." + c.name, c.unit});
  };
  for (const RigidIndex i : settings.track) add(model.bodies[i].name, kBodyQuantities);
  for (const DeformableIndex i : settings.track_deformables) {
    add(model.deformables[i].name, kBodyQuantities);
  }
  for (const DeformableIndex i : settings.track_surfaces)
    add(model.deformables[i].name, kSurfaceColumns);
  for (const TrackedPoint& point : settings.points) add(point.name, kPointColumns);
  return result;
}

}  // namespace apothem
