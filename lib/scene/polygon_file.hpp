// Reads polygons that stand in files of their own, as [[x,y],...], {"polygon": [[x,y],...]} or WKT.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// The ring as it stands in the file, in world coordinates and without the closing vertex of WKT.
/// Whether it is a simple polygon is not checked yet. Throws SceneError.
std::vector<Vec2> read_polygon_file(const std::string& file);

/// Reads a ring given by the words n x y ..., where n is the number of vertices. Throws
/// InvalidPolygon, but accepts infinite coordinates and NaN, which the class Polygon refuses.
std::vector<Vec2> read_ring(std::istream& line);

/// Throws InvalidPolygon if anything but white space is left of the line.
void require_end(std::istream& line);

}  // namespace apothem
