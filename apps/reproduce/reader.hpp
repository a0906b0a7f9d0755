// Private header: the reader of figures.
#pragma once

#include <string>
#include <vector>

#include "apps/reproduce/figure.hpp"
#include "lib/scene/json.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {

/// Reads one figure. What belongs to curves stands in curve_panel_reader.cpp, what belongs to
/// fields in field_panel_reader.cpp, the rest in reader.cpp.
class FigureReader {
 public:
  FigureReader(const std::string& data, Figure& figure, const std::string& file)
      : data_(data), figure_(figure), in_(file) {}

  /// Throws SceneError.
  void read(const JsonValue& document);

 private:
  // Panels of curves.
  void panel(const JsonValue& value);
  void curve(const JsonValue& value, CurvePanel& panel);
  void table(JsonObject& object, CurveSource& source, bool is_scene, const JsonValue& name);
  CurveSource::Tolerance compared(const JsonValue& value);
  void surface(JsonObject& object, CurveSource& source, const JsonValue& name,
               const JsonValue& body, const JsonValue* x, const JsonValue& y);
  // The label of an axis, which also becomes the header of a CSV file.
  std::string axis_label(const JsonValue& value);

  // Panels of fields.
  void field_panel(const JsonValue& value);
  Box window(const JsonValue& value);
  void field(const JsonValue& value, FieldPanel& panel);
  void frame(JsonObject& object, FieldSource& source, const JsonValue& name,
             const FieldQuantity& quantity);
  void cells(FieldSource& source, const JsonValue& reference, const JsonValue& column,
             const Vec2& cell);

  // What both need.
  Vec2 range(const JsonValue& value);
  static size_t index_of(const std::vector<std::string>& list, const std::string& name);
  const std::vector<std::string>& holding(const std::vector<std::vector<std::string>>& tables,
                                          const JsonValue& column);
  FrameTime frame_time(const JsonValue& value, const Scene& scene);
  Scene scene_of(const JsonValue& scene);
  std::vector<std::vector<std::string>> columns_of_table(const JsonValue& reference);
  void player(const JsonValue& item);

  const std::string& data_;
  Figure& figure_;
  JsonReader in_;
};

}  // namespace apothem
