#include "apothem/scene/polygon_value.hpp"

#include <filesystem>

#include "apothem/scene/polygon_file.hpp"

namespace apothem {

std::string file_beside(const JsonReader& scene, const std::string& name) {
  return (std::filesystem::path(scene.file()).parent_path() / name).string();
}

Polygon read_polygon(const JsonReader& in, const JsonValue& outline) {
  if (outline.type() == JsonValue::Type::string) {
    try {
      return polygon_of_file(file_beside(in, outline.string()));
    } catch (const SceneError& error) {
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
