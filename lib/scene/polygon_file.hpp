// Reads polygons that stand in files of their own, as [[x,y],...], {"polygon": [[x,y],...]},
// GeoJSON or WKT.
#pragma once

#include <string>

#include "geometry/polygon/polygon.hpp"
#include "lib/scene/ring_text.hpp"

namespace apothem {

/// The ring as it stands in the file. Whether it is a simple polygon is not checked yet. Throws
/// SceneError, and PolygonError where a vertex is wrong.
RingText read_polygon_file(const std::string& file);

/// The polygon of a file. Throws as read_polygon_file(), and PolygonError, at the line of the
/// vertex, if the ring is not a simple polygon.
Polygon polygon_of_file(const std::string& file);

}  // namespace apothem
