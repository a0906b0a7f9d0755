// Reads polygons in scenes, which are rings or names of files that hold one.
#pragma once

#include <string>

#include "geometry/polygon/polygon.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// The path of a file that a scene names relative to its own folder.
std::string file_beside(const JsonReader& scene, const std::string& name);

/// The polygon given by [[x,y],...] in m, or by the name of a file, see polygon_of_file(), without
/// the holes that are listed as such rings or files in `holes`, which may be null. A file may have
/// further holes. Throws SceneError, at the vertex if the ring stands in the scene.
Polygon read_polygon(const JsonReader& in, const JsonValue& outline,
                     const JsonValue* holes = nullptr);

/// A polygon where no holes can be: `what` says so, and what to do.
Polygon read_polygon_without_holes(const JsonReader& in, const JsonValue& outline,
                                   const char* what);

/// Throws SceneError for a polygon that is not usable.
[[noreturn]] void refuse_polygon(const JsonReader& in, const JsonValue& outline,
                                 const InvalidPolygon& error, const JsonValue* holes = nullptr);

}  // namespace apothem
