#include "lib/scene/ring_line.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "geometry/polygon/polygon.hpp"
#include "lib/scene/json.hpp"
#include "lib/scene/ring_text.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/file.hpp"

namespace apothem {

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
    std::string count;
    line.has_count = words >> count && find_count(count);
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
                                   : "the number of vertices is not a whole number",
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

void require_end(std::istream& line) {
  if (std::string rest; line >> rest) {
    throw InvalidPolygon(fmt::format("text behind the last vertex: \"{}\"", rest.substr(0, 40)), 0);
  }
}

}  // namespace apothem
