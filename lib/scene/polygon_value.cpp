#include "lib/scene/polygon_value.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "lib/scene/drawing_unit.hpp"
#include "lib/scene/polygon_file.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

// A body has no scale, so that its file must be in metres if it states a unit.
void require_metres(const std::string& file, const Polygon& polygon) {
  const DrawingUnit unit = unit_of_polygon(read_text(file), file, bounding_box(polygon));
  if (!unit.problem.empty()) throw SceneError(file, unit.problem);
  if (unit.metres == 1) return;
  throw SceneError(
      file, fmt::format("is in units of {:.10g} m ({}); read it by \"import\", which converts "
                        "it to metres, or write it in metres",
                        unit.metres, unit.source));
}

Polygon polygon_beside(const JsonReader& in, const JsonValue& name) {
  try {
    const std::string file = file_beside(in, name.string());
    Polygon polygon = polygon_of_file(file);
    require_metres(file, polygon);
    return polygon;
  } catch (const std::runtime_error& error) {
    in.fail(name, error.what());
  }
}

// The rings of a list of holes.
Rings rings_of(const JsonReader& in, const JsonValue& holes) {
  constexpr const char* kNoHole = "a hole is one ring, and what lies in it is another body";
  Rings rings;
  for (const JsonValue& hole : in.array(holes)) {
    rings.push_back(hole.type() == JsonValue::Type::string
                        ? read_polygon_without_holes(in, hole, kNoHole).vertices()
                        : in.ring(hole));
  }
  return rings;
}

// The polygon of a file with further holes, which stand in the scene.
Polygon with_holes(const JsonReader& in, const Polygon& polygon, const JsonValue& outline,
                   const JsonValue& holes) {
  Rings all = rings_of(polygon);
  const std::vector<Vec2> outer = std::move(all.front());
  all.erase(all.begin());
  const int of_file = static_cast<int>(all.size());
  for (std::vector<Vec2>& ring : rings_of(in, holes)) all.push_back(std::move(ring));
  try {
    return {outer, all};
  } catch (const InvalidPolygon& error) {
    const int hole = error.hole().value_or(of_file) - of_file;
    const InvalidPolygon here(error.what(), error.vertex(), hole);
    refuse_polygon(in, outline, hole < 0 ? InvalidPolygon(error.what(), -1) : here, &holes);
  }
}

}  // namespace

std::string file_beside(const JsonReader& scene, const std::string& name) {
  return (std::filesystem::path(scene.file()).parent_path() / name).string();
}

Polygon read_polygon(const JsonReader& in, const JsonValue& outline, const JsonValue* holes) {
  if (outline.type() == JsonValue::Type::string) {
    Polygon polygon = polygon_beside(in, outline);
    return holes ? with_holes(in, polygon, outline, *holes) : polygon;
  }
  try {
    std::vector<Vec2> ring = in.ring(outline);
    return holes ? Polygon(ring, rings_of(in, *holes)) : Polygon(std::move(ring));
  } catch (const InvalidPolygon& error) {
    refuse_polygon(in, outline, error, holes);
  }
}

Polygon read_polygon_without_holes(const JsonReader& in, const JsonValue& outline,
                                   const char* what) {
  Polygon polygon = read_polygon(in, outline);
  if (polygon.has_holes()) in.fail(outline, fmt::format("the polygon has holes; {}", what));
  return polygon;
}

void refuse_polygon(const JsonReader& in, const JsonValue& outline, const InvalidPolygon& error,
                    const JsonValue* holes) {
  const bool is_hole =
      holes && error.hole() && *error.hole() < static_cast<int>(holes->items().size());
  const JsonValue& ring = is_hole ? holes->items()[*error.hole()] : outline;
  const bool inside = ring.type() == JsonValue::Type::array && error.vertex() >= 0 &&
                      error.vertex() < static_cast<int>(ring.items().size());
  in.fail(inside ? ring.items()[error.vertex()] : ring,
          std::string("not a usable polygon: ") + error.what());
}

}  // namespace apothem
