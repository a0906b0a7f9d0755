#include "apothem/model/columns.hpp"

#include "apothem/mesh/measure.hpp"
#include "apothem/model/statistics.hpp"

namespace apothem {

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
    const DeformableBody& of = model.deformables[body - state.layout.rigid_bodies];
    const auto first = static_cast<size_t>(of.first_node);
    const MeanMotion mean = mean_motion(of.mesh, state.layout.of_nodes(state.x).subspan(2 * first),
                                        state.layout.of_nodes(state.v).subspan(2 * first),
                                        std::span(node_mass).subspan(first));
    motion = {mean.place, mean.angle, mean.velocity, mean.spin, contact};
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
  for (const Region& region : model.regions) add(region.name, kRegionQuantities);
  return result;
}

}  // namespace apothem
