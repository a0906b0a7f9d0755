#include "apps/polygon/input.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lib/contact/law/law.hpp"
#include "lib/text/decimal.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;

Json ring_json(const std::vector<Vec2>& ring) {
  Json list = Json::array();
  for (const Vec2& p : ring) list.push_back({p.x(), p.y()});
  return list;
}

Json list_of(const std::vector<std::vector<Vec2>>& rings) {
  Json list = Json::array();
  for (const std::vector<Vec2>& ring : rings) list.push_back(ring_json(ring));
  return list;
}

}  // namespace

std::string holes_json(const std::vector<std::vector<Vec2>>& holes) {
  return list_of(holes).dump();
}

std::string polygons_json(const std::vector<PolygonWithHoles>& polygons) {
  Json list = Json::array();
  for (const PolygonWithHoles& polygon : polygons) {
    list.push_back({{"polygon", ring_json(polygon.outer)}, {"holes", list_of(polygon.holes)}});
  }
  return list.dump();
}

void set_reference(PotentialChoice& choice, const std::string& text) {
  for (const NamedReference& r : kReferences) {
    if (text == r.name) {
      choice.reference = r.reference;
      return;
    }
  }
  choice.reference = PotentialChoice::Reference::length;
  try {
    choice.length = parse_decimal(text);
  } catch (const BadNumber&) {
    choice.length = 0;
  }
  if (!(choice.length > 0)) {
    throw UsageError(
        "--reference",
        fmt::format("must be roof, inscribed_circle or a positive length in m, not \"{}\"", text));
  }
}

ShapeFormat shape_format_of(const std::string& file) {
  if (const auto format = shape_format(file)) return *format;
  throw UsageError("-o", fmt::format("must end in {}, not \"{}\"", kShapeFormats, file));
}

std::vector<Shape> shapes_of(const std::vector<PolygonWithHoles>& polygons) {
  std::vector<Shape> shapes;
  for (const PolygonWithHoles& polygon : polygons) shapes.push_back(polygon_shape(polygon));
  return shapes;
}

}  // namespace apothem
