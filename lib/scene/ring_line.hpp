// Files with one polygon, or one pair of polygons, per line: a name, and each polygon as the number
// of vertices and their coordinates, or as well-known text, which has holes.
#pragma once

#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"

namespace apothem {

struct BatchLine {
  std::string name;  ///< the first word
  std::string text;  ///< the whole line
  int number;        ///< in the file, counted from 1
  /// Whether a number of vertices or the word POLYGON follows the name. Otherwise the line may be
  /// that of any file, and no message quotes it.
  bool has_polygon = false;
};

/// What a line with a polygon must hold.
inline constexpr const char* kPolygonForm =
    "name n x y ..., or name POLYGON ((x y, ...), ...) with holes";

/// Calls evaluate() for each line but those that are blank or begin with the word #, which are
/// comments. Throws SceneError if the file cannot be read, or if there is no such line: `form` says
/// what to write.
void for_each_line(const std::string& file, const char* form,
                   const std::function<void(const BatchLine&)>& evaluate);
/// The same for the text of a file.
void for_each_line(std::istream& text, const std::string& file, const char* form,
                   const std::function<void(const BatchLine&)>& evaluate);

/// Reads a ring given by the words n x y ..., where n is the number of vertices. A closing vertex
/// counts in n and is left out. Throws InvalidPolygon.
std::vector<Vec2> read_ring(std::istream& line);

/// Reads a polygon given as read_ring() reads it, or as WKT, see parse_wkt(). Its rings are as they
/// stand in the line, in either sense; whether they are a polygon is not checked. Throws
/// InvalidPolygon.
PolygonWithHoles read_line_polygon(std::istringstream& line);

/// Throws InvalidPolygon if anything but white space is left of the line.
void require_end(std::istream& line);

}  // namespace apothem
