// Reads the key "import" of a scene: drawings whose outlines become bodies.
#pragma once

#include <vector>

#include "lib/scene/import_report.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// Appends the bodies of a list of imports to the bodies of the scene, as if the scene gave each of
/// them its polygon or mesh. An import is
///   { "file": NAME, "scale": m, "offset": [x, y], "name": NAME, "lines": "outlines" or
///     "polygonize", "holes": "separate" or "nested", "tolerance": m, "layers": { "LAYER": { ... }
///     or false }, ... }
/// with further keys of a body, which a layer may replace. The bodies stand at the import's place
/// in the scene. Throws SceneError, for drawings with what they are, where, and what to do.
/// Returns what it has read of each drawing.
std::vector<ImportReport> append_imports(const JsonReader& in, const JsonValue& list,
                                         std::vector<JsonValue>& bodies);

}  // namespace apothem
