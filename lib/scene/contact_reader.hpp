// Reads the contact law of a scene.
#pragma once

#include "lib/model/model.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// Reads all of "contact" but the rules for pairs. Throws SceneError.
void read_contact(const JsonReader& in, const JsonValue& value, Model& model,
                  UsedFeatures& features);

/// Reads the rules for pairs of materials or bodies in "contact", when the model has its bodies,
/// because the rules name them. Throws SceneError.
void read_contact_rules(const JsonReader& in, const JsonValue& value, Model& model,
                        UsedFeatures& features);

}  // namespace apothem
