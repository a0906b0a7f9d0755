#include "apothem/model/columns.hpp"

#include "apothem/model/state.hpp"

namespace apothem {

std::vector<HistoryColumn> history_columns(const Model& model, const OutputSettings& settings) {
  std::vector<HistoryColumn> result;
  const auto add = [&](const std::string& name, const auto& kinds) {
    for (const Column& c : kinds) result.push_back({name + "." + c.name, c.unit});
  };
  for (const int i : settings.track) add(model.bodies[i].name, kBodyColumns);
  for (const int i : settings.track_deformables) add(model.deformables[i].name, kBodyColumns);
  for (const int i : settings.track_surfaces) add(model.deformables[i].name, kSurfaceColumns);
  for (const TrackedPoint& point : settings.points) add(point.name, kPointColumns);
  return result;
}

}  // namespace apothem
