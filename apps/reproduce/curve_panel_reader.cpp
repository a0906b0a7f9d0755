#include "apps/reproduce/reader.hpp"

#include "apps/reproduce/comparison.hpp"
#include "lib/model/columns.hpp"
#include "lib/output/history.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// The columns that a scene records in history.csv, energy.csv and momentum.csv.
std::vector<std::vector<std::string>> recorded_columns(const Scene& scene) {
  std::vector<std::vector<std::string>> files{names_of(history_columns(scene.model, scene.output)),
                                              names_of(kEnergyColumns), names_of(kMomentumColumns)};
  for (std::vector<std::string>& columns : files) columns.emplace_back("time");
  return files;
}

}  // namespace

void FigureReader::panel(const JsonValue& value) {
  JsonObject object(in_, value);
  CurvePanel& panel = figure_.shown.panels.emplace_back();
  figure_.sources.emplace_back();
  object.read("title", panel.title, &JsonReader::string);
  panel.x_label = axis_label(object.required("x", "name [unit]"));
  panel.y_label = axis_label(object.required("y", "name [unit]"));
  if (const JsonValue* v = object.optional("x_logarithmic")) panel.x_logarithmic = v->boolean();
  if (const JsonValue* v = object.optional("y_logarithmic")) panel.y_logarithmic = v->boolean();
  if (const JsonValue* v = object.optional("x_range")) panel.x_range = range(*v);
  if (const JsonValue* v = object.optional("y_range")) panel.y_range = range(*v);
  const JsonValue& curves = object.required("curves", "array of curves");
  for (const JsonValue& item : in_.array(curves)) curve(item, panel);
  if (panel.curves.empty()) in_.fail(curves, "must hold at least one curve");
  const std::vector<CurveSource>& sources = figure_.sources.back();
  for (size_t c = 0; c < sources.size(); ++c) {
    if (sources[c].compared && !reference_of(panel, sources, c)) {
      in_.fail(curves.items()[c], "is compared with a \"reference\" of the same panel; add one");
    }
  }
  object.finish();
}

void FigureReader::curve(const JsonValue& value, CurvePanel& panel) {
  JsonObject object(in_, value);
  Curve& curve = panel.curves.emplace_back();
  CurveSource& source = figure_.sources.back().emplace_back();
  object.read("label", curve.label, &JsonReader::string);
  curve.colour = static_cast<int>(panel.curves.size()) - 1;
  object.read("colour", curve.colour, &JsonReader::count);
  object.choose("style", curve.style, {"line", "dashed", "marks", "error_bars"});
  if (is_table_source(value)) {
    source.rows = read_table_source(in_, object, data_);
    return object.finish();
  }
  if (curve.style == CurveStyle::error_bars) {
    in_.fail(value, "has no intervals: only curves of a \"study\" or a \"table\" do");
  }
  const JsonValue* scene = object.optional("scene");
  const JsonValue* reference = object.optional("reference");
  const JsonValue* points = object.optional("points");
  if (!scene + !reference + !points != 2) {
    in_.fail(value, "must give one of \"scene\", \"reference\" and \"points\"");
  }
  if (points) {
    for (const JsonValue& item : in_.array(*points)) {
      source.points.push_back(in_.vec2(item, "what is shown"));
    }
    if (source.points.empty()) in_.fail(*points, "must hold at least one point");
  } else {
    table(object, source, scene, scene ? *scene : *reference);
  }
  object.finish();
}

void FigureReader::table(JsonObject& object, CurveSource& source, bool is_scene,
                         const JsonValue& name) {
  const JsonValue* x = object.optional("x");
  const JsonValue& y = object.required("y", "a column");
  for (auto& [axis, key] : {std::pair(&source.x, std::string("x")), {&source.y, "y"}}) {
    object.read(key + "_offset", axis->offset, &JsonReader::number, "");
    object.read(key + "_scale", axis->scale, &JsonReader::number, "");
  }
  (is_scene ? source.scene : source.reference) = in_.string(name);
  if (is_scene) {
    if (const JsonValue* v = object.optional("compare")) source.compared = compared(*v);
    if (const JsonValue* body = object.optional("surface")) {
      return surface(object, source, name, *body, x, y);
    }
  }
  const std::vector<std::vector<std::string>> tables =
      is_scene ? recorded_columns(scene_of(name)) : columns_of_table(name);
  const std::vector<std::string>& columns = holding(tables, y);
  source.y.column = y.string();
  if (x) source.x.column = holding({columns}, *x).at(index_of(columns, x->string()));
  if (index_of(columns, source.x.column) == columns.size()) {
    in_.fail(name, "has no column \"" + source.x.column + "\": give \"x\"");
  }
  if (!is_scene) return;
  std::vector<std::string>& stated = figure_.numbers[source.scene];
  if (index_of(stated, y.string()) == stated.size()) stated.push_back(y.string());
}

CurveSource::Tolerance FigureReader::compared(const JsonValue& value) {
  JsonObject object(in_, value);
  const auto part = [&](const char* key) {
    return in_.positive(object.required(key, "a part of the reference's largest value"), "");
  };
  const double rms = part("rms"), largest = part("max");
  const JsonValue& basis = object.required("basis", "what the reference rests on");
  const auto kind = in_.choice<Basis>(basis, kBases);
  object.finish();
  return {rms, largest, kind};
}

void FigureReader::surface(JsonObject& object, CurveSource& source, const JsonValue& name,
                           const JsonValue& body, const JsonValue* x, const JsonValue& y) {
  const Scene scene = scene_of(name);
  source.frame = frame_time(object.required("time", "s"), scene);
  source.surface = static_cast<int>(scene.model.bodies.size()) +
                   in_.choice(body, names_of(scene.model.deformables));
  source.x.column = x ? std::vector<std::string>{"x", "y"}[in_.choice(*x, {"x", "y"})] : "x";
  source.y.column =
      std::vector<std::string>{"pressure", "traction"}[in_.choice(y, {"pressure", "traction"})];
  figure_.numbers[source.scene];  // no quantities: the report states all of them
}

// The label of an axis, which also becomes the header of a CSV file.
std::string FigureReader::axis_label(const JsonValue& value) {
  const std::string& label = in_.string(value);
  if (label.find_first_of(",\"\n\r") != std::string::npos || !label.ends_with(']') ||
      label.find(" [") == std::string::npos) {
    in_.fail(value, "must be a name with a unit, like \"time [s]\", without comma or quote");
  }
  return label;
}

}  // namespace apothem
