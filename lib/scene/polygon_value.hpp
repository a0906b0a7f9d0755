// Polygons in scenes: rings, or names of files that hold one.
#pragma once

#include <string>

#include "apothem/geometry/polygon/polygon.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

/// The file that a scene names: relative to the scene's folder.
std::string file_beside(const JsonReader& scene, const std::string& name);

/// The polygon of [[x,y],...] in m or of the file of that name (see read_polygon_file). Throws
/// SceneError, at the vertex if the ring stands in the scene.
Polygon read_polygon(const JsonReader& in, const JsonValue& outline);

/// Throws the SceneError for an outline that turned out to be unusable; `where` precedes the
/// reason.
[[noreturn]] void refuse_polygon(const JsonReader& in, const JsonValue& outline,
                                 const InvalidPolygon& error, const std::string& where = "");

}  // namespace apothem
