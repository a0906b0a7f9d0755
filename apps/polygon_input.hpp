// What `contact` and `polygon` read alike from the command line and from files of polygons.
#pragma once

#include <functional>
#include <string>

#include "geometry/potential.hpp"

namespace apothem {

/// --reference: roof, inscribed_circle or a length in m. Throws SceneError.
void set_reference(PotentialChoice& choice, const std::string& text);

/// A ring as n x y ... Throws InvalidPolygon; coordinates that are no finite numbers are left to
/// Polygon.
std::vector<Vec2> read_ring(std::istream& line);

/// Calls evaluate(name, rest of the line) for every line of a file that is not empty. Throws
/// SceneError if the file cannot be read.
void for_each_line(const std::string& file,
                   const std::function<void(const std::string&, std::istream&)>& evaluate);

/// Throws InvalidPolygon if anything is left.
void require_end(std::istream& line);

}  // namespace apothem
