#include "lib/model/columns.hpp"

#include <cmath>
#include <numbers>

#include "lib/mesh/measure.hpp"

namespace apothem {
namespace {

MeanMotion mean_motion_of(const Model& model, const State& state, DeformableIndex body,
                          const std::vector<double>& node_mass) {
  const DeformableBody& of = model.deformables[body];
  const auto first = static_cast<size_t>(of.first_node);
  MeanMotion mean = mean_motion(of.mesh, state.layout.of_nodes(state.x).subspan(2 * first),
                                state.layout.of_nodes(state.v).subspan(2 * first),
                                std::span(node_mass).subspan(first));
  if (state.turns.empty()) return mean;
  const MeanTurn& last = state.turns[static_cast<size_t>(body)];
  const double about = last.angle + (last.spin + mean.spin) / 2 * (state.time - last.time);
  constexpr double kTurn = 2 * std::numbers::pi;
  mean.angle += kTurn * std::round((about - mean.angle) / kTurn);
  return mean;
}

}  // namespace

void note_turns(const Model& model, const std::vector<double>& node_mass, State& state) {
  std::vector<MeanTurn> turns;
  for (DeformableIndex i = 0; i < static_cast<DeformableIndex>(model.deformables.size()); ++i) {
    const MeanMotion mean = mean_motion_of(model, state, i, node_mass);
    turns.push_back({mean.angle, mean.spin, state.time});
  }
  state.turns = std::move(turns);
}

BodyMotion motion_of(const Model& model, const State& state, BodyIndex body,
                     const BodyForce& contact, const std::vector<double>& node_mass) {
  BodyMotion motion;
  motion.contact = contact;
  if (body < state.layout.rigid_bodies) {
    const auto x = state.pose(body), v = state.pose_rate(body), f = state.force(body);
    motion.place = x.head<2>();
    motion.angle = x[2];
    motion.rotation = x[2] - model.bodies[body].angle;
    motion.velocity = v.head<2>();
    motion.spin = v[2];
    motion.contact.fx = f[0], motion.contact.fy = f[1];
  } else {
    const MeanMotion mean =
        mean_motion_of(model, state, body - state.layout.rigid_bodies, node_mass);
    motion = {mean.place, mean.angle, mean.angle, mean.velocity, mean.spin, contact};
  }
  motion.place += model.origin;
  return motion;
}

std::vector<HistoryColumn> history_columns(const Model& model, const OutputSettings& settings) {
  std::vector<HistoryColumn> result;
  const auto add = [&](const std::string& name, const auto& kinds) {
    for (const auto& c : kinds) result.push_back({name + "." + c.name, c.unit});
  };
  const auto add_body = [&](const std::string& name) {
    for (const BodyQuantity& q : kBodyQuantities) {
      if (q.in_histories()) {
        result.push_back({name + "." + q.name, q.unit, q.kind == BodyQuantity::Kind::count});
      }
    }
  };
  for (const RigidIndex i : settings.track) add_body(model.bodies[i].name);
  for (const DeformableIndex i : settings.track_deformables) add_body(model.deformables[i].name);
  for (const DeformableIndex i : settings.track_surfaces)
    add(model.deformables[i].name, kSurfaceColumns);
  for (const TrackedPoint& point : settings.points) add(point.name, kPointColumns);
  for (const Region& region : model.regions) {
    for (const RegionQuantity& c : kRegionQuantities) {
      result.push_back({region.name + "." + c.name, c.unit, c.jumps});
    }
  }
  return result;
}

}  // namespace apothem
