#include "lib/scene/ring_line.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "geometry/polygon/polygon.hpp"
#include "lib/scene/json.hpp"
#include "lib/scene/ring_text.hpp"
#include "lib/scene/wkt.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// Whether a word begins WKT of a polygon, right or wrong.
bool begins_wkt(std::string_view word) {
  const std::string capitals = upper_case(word);
  return capitals.starts_with("POLYGON") || capitals.starts_with("MULTIPOLYGON") ||
         capitals.starts_with("SRID=");
}

}  // namespace

void for_each_line(const std::string& file, const char* form,
                   const std::function<void(const BatchLine&)>& evaluate) {
  std::ifstream stream = open_text(file);
  for_each_line(stream, file, form, evaluate);
  if (stream.bad()) throw SceneError(file, "cannot be read");
}

void for_each_line(std::istream& text, const std::string& file, const char* form,
                   const std::function<void(const BatchLine&)>& evaluate) {
  BatchLine line;
  bool any = false;
  for (line.number = 1; std::getline(text, line.text); ++line.number) {
    if (line.number == 1) strip_byte_order_mark(line.text, file);
    std::istringstream words(line.text);
    if (!(words >> line.name) || line.name == "#") continue;
    any = true;
    std::string shape;
    line.has_polygon = words >> shape && (find_count(shape) || begins_wkt(shape));
    evaluate(line);
  }
  if (!any) throw SceneError(file, std::string("is empty; write on each line ") + form);
}

std::vector<Vec2> read_ring(std::istream& line) {
  std::string word;
  if (!(line >> word)) throw InvalidPolygon("the number of vertices is missing", 0);
  int n = 0;
  try {
    n = parse_count(word);
  } catch (const BadNumber& error) {
    // Nothing but a number is quoted: the file may be any other one.
    const bool is_number = word.find_first_not_of("0123456789.eE+-") == std::string::npos;
    throw InvalidPolygon(is_number ? fmt::format("the number of vertices: {}", error.what())
                                   : "neither a whole number of vertices nor POLYGON ((x y, ...))",
                         0);
  }
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    Vec2 vertex;
    for (int axis = 0; axis < 2; ++axis) {
      if (!(line >> word)) {
        throw InvalidPolygon(fmt::format("the line ends before vertex {} of {} {}", i, n,
                                         axis == 0 ? "begins" : "has its y"),
                             i);
      }
      try {
        vertex[axis] = parse_decimal(word);
      } catch (const BadNumber& error) {
        throw InvalidPolygon(fmt::format("vertex {}: {}", i, error.what()), i);
      }
    }
    ring.push_back(vertex);
  }
  leave_out_closing_vertex(ring);
  return ring;
}

PolygonWithHoles read_line_polygon(std::istringstream& line) {
  const std::istringstream::pos_type start = line.tellg();
  std::string word;
  const bool is_wkt = line >> word && begins_wkt(word);
  line.clear();
  line.seekg(start);
  if (!is_wkt) return {read_ring(line), {}};
  const std::string text = line.str();
  std::string_view rest = std::string_view(text).substr(static_cast<size_t>(start));
  try {
    const PolygonText read = take_wkt(rest, "");
    line.seekg(static_cast<std::istringstream::off_type>(text.size() - rest.size()));
    PolygonWithHoles polygon{read.outer.ring, {}};
    for (const RingText& hole : read.holes) polygon.holes.push_back(hole.ring);
    return polygon;
  } catch (const PolygonError& error) {
    throw InvalidPolygon(error.reason(), std::max(error.vertex(), 0), error.hole());
  }
}

void require_end(std::istream& line) {
  if (std::string rest; line >> rest) {
    throw InvalidPolygon(fmt::format("text behind the last vertex: \"{}\"", rest.substr(0, 40)), 0);
  }
}

}  // namespace apothem
