#include "apps/reproduce/reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/reproduce/sources.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// Most fields of a panel; with more, the frames would be too small to see.
constexpr size_t kMostFields = 100;
constexpr double kFarthest = 1e60;  // limit of coordinates, m; the same as for polygons

}  // namespace

void FigureReader::field_panel(const JsonValue& value) {
  JsonObject object(in_, value);
  FieldPanel& panel = figure_.shown_fields.panels.emplace_back();
  figure_.field_sources.emplace_back();
  const JsonValue& quantity = object.required("field", "a quantity");
  panel.quantity = &field_quantities()[in_.choice(quantity, names_of(field_quantities()))];
  panel.unit = panel.quantity->unit;
  object.read("title", panel.title, &JsonReader::string);
  const JsonValue* scale = object.optional("scale");
  const JsonValue* unit = object.optional("unit");
  if (scale) panel.scale = in_.positive(*scale, "");
  if (unit) panel.unit = in_.string(*unit);
  if (!scale != !unit) in_.fail(scale ? *scale : *unit, "goes with a \"unit\" and a \"scale\"");
  if (const JsonValue* v = object.optional("window")) panel.window = window(*v);
  if (const JsonValue* v = object.optional("range")) panel.range = range(*v);
  const JsonValue& fields = object.required("fields", "array of fields");
  for (const JsonValue& item : in_.array(fields)) field(item, panel);
  object.finish();
  if (panel.fields.empty()) in_.fail(fields, "must hold at least one field");
  if (panel.fields.size() > kMostFields) {
    in_.fail(fields, fmt::format("must hold at most {} fields", kMostFields));
  }
  const std::vector<FieldSource>& sources = figure_.field_sources.back();
  for (size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].compared && !first_reference(sources)) {
      in_.fail(fields.items()[i], "is compared with a \"reference\" of the same panel; add one");
    }
  }
}

Box FigureReader::window(const JsonValue& value) {
  const std::vector<JsonValue>& corners = in_.array(value);
  if (corners.size() != 2) in_.fail(value, "must be [[x0, y0], [x1, y1]] in m");
  const Vec2 low = in_.vec2(corners[0], "m"), high = in_.vec2(corners[1], "m");
  if (!(low.x() < high.x() && low.y() < high.y())) {
    in_.fail(value, "must be [[x0, y0], [x1, y1]] with x0 below x1 and y0 below y1");
  }
  if (std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()) > kFarthest) {
    in_.fail(value, fmt::format("must lie within {:g} m of the origin", kFarthest));
  }
  return {low.x(), low.y(), high.x(), high.y()};
}

void FigureReader::field(const JsonValue& value, FieldPanel& panel) {
  JsonObject object(in_, value);
  ShownField& shown = panel.fields.emplace_back();
  FieldSource& source = figure_.field_sources.back().emplace_back();
  object.read("label", shown.label, &JsonReader::string);
  const JsonValue* scene = object.optional("scene");
  const JsonValue* reference = object.optional("reference");
  const JsonValue* study = object.optional("study");
  if (!scene + !reference + !study != 2) {
    in_.fail(value, "must give either \"scene\" or \"reference\" (or \"study\")");
  }
  if (study) {
    source.study = in_.string(*study);
    source.frame.from = in_.number(object.required("time", "s"), "s");
  } else if (scene) {
    frame(object, source, *scene, *panel.quantity);
  } else {
    const JsonValue& column = object.required("column", "a column");
    const JsonValue& size = object.required("cell", "[width, height] of the cells in m");
    const Vec2 cell = in_.vec2(size, "m");
    if (!(cell.x() > 0 && cell.y() > 0)) in_.fail(size, "must hold two positive lengths in m");
    cells(source, *reference, column, cell);
  }
  object.finish();
}

void FigureReader::frame(JsonObject& object, FieldSource& source, const JsonValue& name,
                         const FieldQuantity& quantity) {
  const JsonValue& time = object.required("time", "s");
  if (const JsonValue* v = object.optional("compare")) {
    JsonObject compare(in_, *v);
    const auto part = [&](const char* key) {
      return in_.positive(compare.required(key, "a part of the reference's largest value"), "");
    };
    const double rms = part("rms");
    source.compared = {rms, part("max")};
    compare.finish();
  }
  const Scene scene = scene_of(name);
  source.scene = name.string();
  const bool of_stress =
      quantity.kind == FieldKind::stress || quantity.kind == FieldKind::stress_of_elements;
  if (scene.model.deformables.empty() && (of_stress || source.compared)) {
    in_.fail(name, source.compared ? "has no body with a mesh to compare"
                                   : "has no body with a mesh, and rigid bodies have no stress");
  }
  source.statics = scene.time.statics;
  source.frame = frame_time(time, scene);
  figure_.numbers[source.scene];  // no quantities: the report states all of them
}

void FigureReader::cells(FieldSource& source, const JsonValue& reference, const JsonValue& column,
                         const Vec2& cell) {
  const std::vector<std::vector<std::string>> tables = columns_of_table(reference);
  for (const char* name : {"x", "y"}) {
    if (index_of(tables[0], name) == tables[0].size()) {
      in_.fail(reference, fmt::format("has no column \"{}\" of its cells' centres", name));
    }
  }
  holding(tables, column);
  source.reference = reference.string();
  source.column = column.string();
  source.cell = cell;
  bool none = false;
  try {
    none = cells_of(data_, source).centres.empty();
  } catch (const std::runtime_error& error) {
    in_.fail(reference, error.what());
  }
  if (none) in_.fail(reference, "has no rows");
}

}  // namespace apothem
