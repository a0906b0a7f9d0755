#include "apothem/model/columns.hpp"

#include "apothem/model/body_quantities.hpp"

namespace apothem {

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
