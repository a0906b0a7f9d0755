// Reads what a scene says of many bodies: the world, the regions, and when to stop.
#pragma once

#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// They read the keys "world", "regions" and, after the regions, "stop". The model has its origin,
/// and receives world and regions. All throw SceneError.
void read_world(const JsonReader& in, const JsonValue& value, Model& model, UsedFeatures& features);
void read_regions(const JsonReader& in, const JsonValue& value, Model& model);
std::vector<StopRule> read_stops(const JsonReader& in, const JsonValue& value, const Model& model,
                                 UsedFeatures& features);

}  // namespace apothem
