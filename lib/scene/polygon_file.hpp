// Polygons in files of their own: [[x,y],...], {"polygon": [[x,y],...]} or WKT.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// The ring as it stands in the file, in world coordinates (a closing WKT vertex is dropped); not
/// yet checked for being simple. Throws SceneError.
std::vector<Vec2> read_polygon_file(const std::string& file);

/// A ring as the words n x y ... Throws InvalidPolygon; coordinates that are no finite numbers are
/// left to Polygon.
std::vector<Vec2> read_ring(std::istream& line);

/// Throws InvalidPolygon if anything is left.
void require_end(std::istream& line);

}  // namespace apothem
