#include "apothem/scene/polygon_value.hpp"

#include <filesystem>

#include "apothem/scene/polygon_file.hpp"

namespace apothem {

std::string file_beside(const JsonReader& scene, const std::string& name) {
  return (std::filesystem::path(scene.file()).parent_path() / name).string();
}

Polygon read_polygon(const JsonReader& in, const JsonValue& outline) {
  std::string where;
  std::vector<Vec2> ring;
  if (outline.type == JsonValue::Type::string) {
    const std::string file = file_beside(in, outline.string);
    try {
      ring = read_polygon_file(file);
    } catch (const SceneError& error) {
      in.fail(outline, error.what());
    }
    where = file + ": ";
  } else {
    ring = in.ring(outline);
  }
  try {
    return Polygon(std::move(ring));
  } catch (const InvalidPolygon& error) {
    refuse_polygon(in, outline, error, where);
  }
}

void refuse_polygon(const JsonReader& in, const JsonValue& outline, const InvalidPolygon& error,
                    const std::string& where) {
  const bool inside = outline.type == JsonValue::Type::array && error.vertex() >= 0 &&
                      error.vertex() < static_cast<int>(outline.items.size());
  in.fail(inside ? outline.items[error.vertex()] : outline,
          where + "not a usable polygon: " + error.what());
}

}  // namespace apothem
