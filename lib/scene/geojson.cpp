#include "lib/scene/geojson.hpp"

#include <fmt/format.h>

#include <vector>

namespace apothem {
namespace {

const JsonValue& member(const JsonReader& in, const JsonValue& object, const char* key) {
  const JsonValue* value = object.find(key);
  if (!value) in.fail(object, fmt::format("GeoJSON without \"{}\"", key));
  return *value;
}

const JsonValue& only_item(const JsonReader& in, const JsonValue& list, const char* what) {
  const std::vector<JsonValue>& items = in.array(list);
  if (items.size() == 1) return items[0];
  in.fail(list, fmt::format("holds {} {}; {}", items.size(), what, kOnePolygon));
}

// A position may have a height as its third number, which is ignored here as in drawings that are
// imported.
RingText ring_of_positions(const JsonReader& in, const JsonValue& ring) {
  RingText text;
  for (const JsonValue& position : in.array(ring)) {
    const std::vector<JsonValue>& numbers = in.array(position);
    text.ring.push_back(numbers.size() == 3
                            ? Vec2(in.number(numbers[0], "m"), in.number(numbers[1], "m"))
                            : in.vec2(position, "m"));
  }
  leave_out_closing_vertex(text.ring);
  for (size_t i = 0; i < text.ring.size(); ++i) text.lines.push_back(ring.items()[i].line());
  return text;
}

PolygonText text_of_rings(const JsonReader& in, const JsonValue& rings) {
  const std::vector<JsonValue>& items = in.array(rings);
  if (items.empty()) in.fail(rings, "the polygon is empty; give it three vertices or more");
  PolygonText text{ring_of_positions(in, items[0]), {}};
  for (size_t i = 1; i < items.size(); ++i) text.holes.push_back(ring_of_positions(in, items[i]));
  return text;
}

}  // namespace

RingText ring_text(const JsonReader& in, const JsonValue& ring) {
  RingText text;
  text.ring = in.ring(ring);
  for (size_t i = 0; i < text.ring.size(); ++i) text.lines.push_back(ring.items()[i].line());
  return text;
}

PolygonText polygon_text(const JsonReader& in, const JsonValue& outer, const JsonValue* holes) {
  PolygonText text{ring_text(in, outer), {}};
  if (!holes) return text;
  for (const JsonValue& hole : in.array(*holes)) text.holes.push_back(ring_text(in, hole));
  return text;
}

PolygonText polygon_of_geojson(const JsonReader& in, const JsonValue& object) {
  if (object.type() != JsonValue::Type::object) in.fail(object, "must be an object of GeoJSON");
  const std::vector<std::string> types{
      "Polygon", "MultiPolygon", "Feature",    "FeatureCollection", "GeometryCollection",
      "Point",   "MultiPoint",   "LineString", "MultiLineString"};
  const JsonValue& type = member(in, object, "type");
  const int kind = in.choice(type, types);
  switch (kind) {
    case 0:
      return text_of_rings(in, member(in, object, "coordinates"));
    case 1:
      return text_of_rings(in, only_item(in, member(in, object, "coordinates"), "polygons"));
    case 2:
      return polygon_of_geojson(in, member(in, object, "geometry"));
    case 3:
      return polygon_of_geojson(in, only_item(in, member(in, object, "features"), "features"));
    case 4:
      return polygon_of_geojson(in, only_item(in, member(in, object, "geometries"), "geometries"));
    default:
      in.fail(type, fmt::format("is a {}; give a Polygon", types[static_cast<size_t>(kind)]));
  }
}

}  // namespace apothem
