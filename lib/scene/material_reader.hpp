// Reads the materials of a scene: density, elasticity and damping.
#pragma once

#include <vector>

#include "lib/model/model.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// The materials of a scene, in the order in which they stand there. Adds the features that they
/// use to `features`. Throws SceneError.
std::vector<Material> read_materials(const JsonReader& in, const JsonValue& value,
                                     UsedFeatures& features);

}  // namespace apothem
