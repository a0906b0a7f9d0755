// Reads polygons in scenes, which are rings or names of files that hold one.
#pragma once

#include <string>

#include "geometry/polygon/polygon.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// The path of a file that a scene names relative to its own folder.
std::string file_beside(const JsonReader& scene, const std::string& name);

/// The polygon given by [[x,y],...] in m, or by the name of a file, see polygon_of_file(). Throws
/// SceneError, at the vertex if the ring stands in the scene.
Polygon read_polygon(const JsonReader& in, const JsonValue& outline);

/// Throws SceneError for an outline that is not a usable polygon.
[[noreturn]] void refuse_polygon(const JsonReader& in, const JsonValue& outline,
                                 const InvalidPolygon& error);

}  // namespace apothem
