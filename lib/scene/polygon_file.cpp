#include "lib/scene/polygon_file.hpp"

#include <utility>

#include "lib/scene/geojson.hpp"
#include "lib/scene/json.hpp"
#include "lib/scene/wkt.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

PolygonText parse_polygon(const std::string& text, const std::string& file) {
  const size_t start = text.find_first_not_of(" \t\r\n\f\v");
  if (start == std::string::npos) throw SceneError(file, "is empty; give a polygon");
  // Of the notations, only JSON begins with a bracket, or with a comment.
  if (std::string("[{/").find(text[start]) == std::string::npos) return parse_wkt(text, file);
  const JsonReader reader(file);
  const JsonValue document = parse_json(text, file);
  if (document.type() == JsonValue::Type::array) return polygon_text(reader, document, nullptr);
  if (document.find("type")) return polygon_of_geojson(reader, document);
  JsonObject object(reader, document);
  const JsonValue& ring = object.required("polygon", "[[x,y],...] in m");
  const JsonValue* holes = object.optional("holes");
  object.finish();
  return polygon_text(reader, ring, holes);
}

}  // namespace

PolygonText read_polygon_file(const std::string& file) {
  return parse_polygon(read_text(file, kLargestJson), file);
}

Polygon polygon_of_file(const std::string& file) {
  const PolygonText text = read_polygon_file(file);
  Rings holes;
  for (const RingText& hole : text.holes) holes.push_back(hole.ring);
  try {
    return Polygon(text.outer.ring, holes);
  } catch (const InvalidPolygon& error) {
    const RingText& ring =
        error.hole() ? text.holes[static_cast<size_t>(*error.hole())] : text.outer;
    const auto vertex = static_cast<size_t>(error.vertex());
    const int line = vertex < ring.lines.size() ? ring.lines[vertex] : 0;
    throw PolygonError(file, line, std::string("the polygon is not usable: ") + error.what(),
                       error.vertex(), error.hole());
  }
}

}  // namespace apothem
