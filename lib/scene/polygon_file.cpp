#include "apothem/scene/polygon_file.hpp"

#include <boost/geometry.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <cstdlib>
#include <istream>

#include "apothem/geometry/polygon/polygon.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {
namespace {

std::vector<Vec2> parse_wkt(const std::string& text, const std::string& file) {
  using Point = boost::geometry::model::d2::point_xy<double>;
  boost::geometry::model::polygon<Point> polygon;
  try {
    boost::geometry::read_wkt(text, polygon);
  } catch (const std::exception& error) {  // Boost throws read_wkt_exception or bad_lexical_cast
    throw SceneError(file, 0, "", std::string("not a WKT polygon: ") + error.what());
  }
  if (!polygon.inners().empty()) {
    throw SceneError(file, 0, "", "the polygon has a hole; give a simple polygon");
  }
  std::vector<Vec2> ring;
  for (const Point& p : polygon.outer()) ring.emplace_back(p.x(), p.y());
  if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();  // rings of WKT repeat it
  return ring;
}

}  // namespace

std::vector<Vec2> read_polygon_file(const std::string& file) {
  const std::string text = read_text(file);
  const size_t start = text.find_first_not_of(" \t\r\n");
  if (start == std::string::npos) throw SceneError(file, 0, "", "is empty; give a polygon");
  if (std::isalpha(static_cast<unsigned char>(text[start]))) {
    return parse_wkt(text.substr(start, text.find_last_not_of(" \t\r\n") + 1 - start), file);
  }
  const JsonReader reader(file);
  const JsonValue document = parse_json(text, file);
  if (document.type == JsonValue::Type::array) return reader.ring(document);
  JsonObject object(reader, document);
  std::vector<Vec2> ring = reader.ring(object.required("polygon", "[[x,y],...] in m"));
  object.finish();
  return ring;
}

std::vector<Vec2> read_ring(std::istream& line) {
  int n = 0;
  if (!(line >> n) || n < 0) throw InvalidPolygon("the number of vertices is missing", 0);
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    std::string x, y;  // read as words, because streams do not read nan or inf
    if (!(line >> x >> y)) throw InvalidPolygon("the line ends before the vertex", i);
    char* end_x = nullptr;
    char* end_y = nullptr;
    ring.emplace_back(std::strtod(x.c_str(), &end_x), std::strtod(y.c_str(), &end_y));
    if (*end_x != '\0' || *end_y != '\0') throw InvalidPolygon("is not a number", i);
  }
  return ring;
}

void require_end(std::istream& line) {
  if (std::string rest; line >> rest) throw InvalidPolygon("text behind the last vertex", 0);
}

}  // namespace apothem
