// Reads polygons that stand in files of their own, as [[x,y],...], {"polygon": [[x,y],...],
// "holes": [[[x,y],...],...]}, GeoJSON or WKT.
#pragma once

#include <string>

#include "geometry/polygon/polygon.hpp"
#include "lib/scene/ring_text.hpp"

namespace apothem {

/// The rings as they stand in the file. Whether they are a polygon is not checked yet. Throws
/// SceneError, and PolygonError where a vertex is wrong.
PolygonText read_polygon_file(const std::string& file);

/// The polygon of a file. Throws as read_polygon_file(), and PolygonError, at the line of the
/// vertex, if the rings are not a polygon.
Polygon polygon_of_file(const std::string& file);

}  // namespace apothem
