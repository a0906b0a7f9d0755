// Reads the part of a scene that says how time runs: dynamic or static, end, step and start.
#pragma once

#include "lib/model/settings.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// The time settings of a scene. Adds the features that they use to `features`. Throws SceneError.
TimeSettings read_time(const JsonReader& in, const JsonValue& value, UsedFeatures& features);

}  // namespace apothem
