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

}  // namespace

std::string file_beside(const JsonReader& scene, const std::string& name) {
  return (std::filesystem::path(scene.file()).parent_path() / name).string();
}

Polygon read_polygon(const JsonReader& in, const JsonValue& outline) {
  if (outline.type() == JsonValue::Type::string) {
    try {
      const std::string file = file_beside(in, outline.string());
      Polygon polygon = polygon_of_file(file);
      require_metres(file, polygon);
      return polygon;
    } catch (const std::runtime_error& error) {
      in.fail(outline, error.what());
    }
  }
  try {
    return Polygon(in.ring(outline));
  } catch (const InvalidPolygon& error) {
    refuse_polygon(in, outline, error);
  }
}

void refuse_polygon(const JsonReader& in, const JsonValue& outline, const InvalidPolygon& error) {
  const bool inside = outline.type() == JsonValue::Type::array && error.vertex() >= 0 &&
                      error.vertex() < static_cast<int>(outline.items().size());
  in.fail(inside ? outline.items()[error.vertex()] : outline,
          std::string("not a usable polygon: ") + error.what());
}

}  // namespace apothem
