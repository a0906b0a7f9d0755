#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>

#include "apothem/model/columns.hpp"
#include "apothem/output/history.hpp"
#include "figure.hpp"
#include "figure_comparison.hpp"
#include "figure_sources.hpp"
#include "figure_text.hpp"

namespace apothem {
namespace {

// Most fields of a panel; with more, the frames would be too small to see.
constexpr size_t kMostFields = 100;
constexpr double kFarthest = 1e60;  // limit of coordinates, m; the same as for polygons

std::string scene_file(const std::string& data, const std::string& scene) {
  return data + "/scenes/" + scene + ".json";
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  }
  return names;
}

// The columns that a scene records in history.csv, energy.csv and momentum.csv.
std::vector<std::vector<std::string>> recorded_columns(const Scene& scene) {
  std::vector<std::vector<std::string>> files{names_of(history_columns(scene.model, scene.output)),
                                              names_of(kEnergyColumns), names_of(kMomentumColumns)};
  for (std::vector<std::string>& columns : files) columns.emplace_back("time");
  return files;
}

class FigureReader {
 public:
  FigureReader(const std::string& data, Figure& figure, const std::string& file)
      : data_(data), figure_(figure), in_(file) {}

  void read(const JsonValue& document) {
    JsonObject top(in_, document);
    figure_.shown.title = in_.string(top.required("title", "string"));
    figure_.shown_fields.title = figure_.shown.title;
    figure_.text = read_figure_text(in_, top);
    if (const JsonValue* v = top.optional("panels")) {
      for (const JsonValue& item : in_.array(*v)) {
        if (item.find("shapes")) {
          figure_.potentials.push_back(read_potential_panel(in_, item));
        } else if (item.find("field")) {
          field_panel(item);
        } else {
          panel(item);
        }
      }
    }
    if (const JsonValue* v = top.optional("numbers")) {
      for (const JsonValue& item : in_.array(*v)) {
        scene_of(item);
        figure_.numbers[in_.string(item)].clear();
      }
    }
    if (const JsonValue* v = top.optional("studies")) {
      for (const JsonValue& item : in_.array(*v)) figure_.studies.push_back(read_study(in_, item));
    }
    if (const JsonValue* v = top.optional("compare")) {
      for (const JsonValue& item : in_.array(*v)) {
        figure_.comparisons.push_back(read_comparison(in_, item, data_));
      }
    }
    if (const JsonValue* v = top.optional("players")) {
      for (const JsonValue& item : in_.array(*v)) {
        if (item.type() == JsonValue::Type::object) {
          JsonObject object(in_, item);
          figure_.study_players.push_back(in_.string(object.required("study", "folder of a run")));
          object.finish();
        } else {
          figure_.players.push_back(figure_.scenes[in_.choice(item, figure_.scenes)]);
        }
      }
    }
    top.finish();
    if (figure_.scenes.empty() && figure_.shown.panels.empty() && figure_.field_sources.empty() &&
        figure_.potentials.empty()) {
      in_.fail(document, "has neither panels nor numbers");
    }
  }

 private:
  // The label of an axis, which also becomes the header of a CSV file.
  std::string axis_label(const JsonValue& value) {
    const std::string& label = in_.string(value);
    if (label.find_first_of(",\"\n\r") != std::string::npos || !label.ends_with(']') ||
        label.find(" [") == std::string::npos) {
      in_.fail(value, "must be a name with a unit, like \"time [s]\", without comma or quote");
    }
    return label;
  }

  Vec2 range(const JsonValue& value) {
    Vec2 limits = in_.vec2(value, "the axis's unit");
    if (!(limits.x() < limits.y())) in_.fail(value, "must be [from, to] with from below to");
    return limits;
  }

  void panel(const JsonValue& value) {
    JsonObject object(in_, value);
    CurvePanel& panel = figure_.shown.panels.emplace_back();
    figure_.sources.emplace_back();
    if (const JsonValue* v = object.optional("title")) panel.title = in_.string(*v);
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

  void curve(const JsonValue& value, CurvePanel& panel) {
    JsonObject object(in_, value);
    Curve& curve = panel.curves.emplace_back();
    CurveSource& source = figure_.sources.back().emplace_back();
    if (const JsonValue* v = object.optional("label")) curve.label = in_.string(*v);
    curve.colour = static_cast<int>(panel.curves.size()) - 1;
    if (const JsonValue* v = object.optional("colour")) curve.colour = in_.count(*v);
    if (const JsonValue* v = object.optional("style")) {
      curve.style =
          static_cast<CurveStyle>(in_.choice(*v, {"line", "dashed", "marks", "error_bars"}));
    }
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

  void table(JsonObject& object, CurveSource& source, bool is_scene, const JsonValue& name) {
    const JsonValue* x = object.optional("x");
    const JsonValue& y = object.required("y", "a column");
    for (auto& [axis, key] : {std::pair(&source.x, std::string("x")), {&source.y, "y"}}) {
      if (const JsonValue* v = object.optional(key + "_offset")) axis->offset = in_.number(*v, "");
      if (const JsonValue* v = object.optional(key + "_scale")) axis->scale = in_.number(*v, "");
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

  CurveSource::Tolerance compared(const JsonValue& value) {
    JsonObject object(in_, value);
    const auto part = [&](const char* key) {
      return in_.positive(object.required(key, "a part of the reference's largest value"), "");
    };
    const double rms = part("rms"), largest = part("max");
    const JsonValue& basis = object.required("basis", "what the reference rests on");
    const auto kind = static_cast<Basis>(in_.choice(basis, {kBases.begin(), kBases.end()}));
    object.finish();
    return {rms, largest, kind};
  }

  void surface(JsonObject& object, CurveSource& source, const JsonValue& name,
               const JsonValue& body, const JsonValue* x, const JsonValue& y) {
    const Scene scene = scene_of(name);
    source.frame = frame_time(object.required("time", "s"), scene);
    const std::vector<DeformableBody>& bodies = scene.model.deformables;
    std::vector<std::string> names;
    names.reserve(bodies.size());
    for (const DeformableBody& b : bodies) names.push_back(b.name);
    source.surface = static_cast<int>(scene.model.bodies.size()) + in_.choice(body, names);
    source.x.column = x ? std::vector<std::string>{"x", "y"}[in_.choice(*x, {"x", "y"})] : "x";
    source.y.column =
        std::vector<std::string>{"pressure", "traction"}[in_.choice(y, {"pressure", "traction"})];
    figure_.numbers[source.scene];  // no quantities: the report states all of them
  }

  static size_t index_of(const std::vector<std::string>& list, const std::string& name) {
    return static_cast<size_t>(std::find(list.begin(), list.end(), name) - list.begin());
  }

  const std::vector<std::string>& holding(const std::vector<std::vector<std::string>>& tables,
                                          const JsonValue& column) {
    std::vector<std::string> all;
    for (const std::vector<std::string>& columns : tables) {
      if (index_of(columns, in_.string(column)) < columns.size()) return columns;
      all.insert(all.end(), columns.begin(), columns.end());
    }
    in_.fail(column, "there is no column " + suggest(column.string(), all));
  }

  void field_panel(const JsonValue& value) {
    JsonObject object(in_, value);
    FieldPanel& panel = figure_.shown_fields.panels.emplace_back();
    figure_.field_sources.emplace_back();
    std::vector<std::string> names;
    names.reserve(std::size(kFieldQuantities));
    for (const FieldQuantity& q : kFieldQuantities) names.emplace_back(q.name);
    const JsonValue& quantity = object.required("field", "a quantity");
    panel.quantity = &kFieldQuantities[in_.choice(quantity, names)];
    panel.unit = panel.quantity->unit;
    if (const JsonValue* v = object.optional("title")) panel.title = in_.string(*v);
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

  Box window(const JsonValue& value) {
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

  void field(const JsonValue& value, FieldPanel& panel) {
    JsonObject object(in_, value);
    ShownField& shown = panel.fields.emplace_back();
    FieldSource& source = figure_.field_sources.back().emplace_back();
    if (const JsonValue* v = object.optional("label")) shown.label = in_.string(*v);
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

  void frame(JsonObject& object, FieldSource& source, const JsonValue& name,
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

  FrameTime frame_time(const JsonValue& value, const Scene& scene) {
    const double time = in_.number(value, "s");
    const int frames = scene.time.statics ? scene.time.load_steps : scene.output.frames;
    const double interval = scene.time.end / std::max(frames, 1);
    const double count = std::round(time / interval);
    if (count < 0 || count > std::max(frames, 1) ||
        std::abs(time - count * interval) > 1e-6 * interval) {
      in_.fail(value, fmt::format("is not the time of a frame: those of {} are {} s apart, to {} s",
                                  scene.model.name, interval, scene.time.end));
    }
    return {time, time + interval / 2};
  }

  void cells(FieldSource& source, const JsonValue& reference, const JsonValue& column,
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

  Scene scene_of(const JsonValue& scene) {
    const std::string& name = in_.string(scene);
    const std::vector<std::string> known = names_in(data_ + "/scenes");
    if (index_of(known, name) == known.size()) {
      in_.fail(scene, "there is no scene " + suggest(name, known));
    }
    if (index_of(figure_.scenes, name) == figure_.scenes.size()) figure_.scenes.push_back(name);
    return read_scene(scene_file(data_, name));
  }

  std::vector<std::vector<std::string>> columns_of_table(const JsonValue& reference) {
    try {
      return {read_history(data_ + "/reference/" + in_.string(reference)).names};
    } catch (const std::runtime_error& error) {
      in_.fail(reference, error.what());
    }
  }

  const std::string& data_;
  Figure& figure_;
  JsonReader in_;
};

}  // namespace

std::vector<std::string> figure_names(const std::string& data) {
  std::vector<std::string> names = names_in(data + "/figures");
  if (names.empty()) {
    throw SceneError(data, 0, "", "holds no figures; name the folder that does with --data");
  }
  const auto key = [](const std::string& name) {
    constexpr const char* kDigits = "0123456789";
    const size_t from = std::min(name.find_first_of(kDigits), name.size());
    const size_t to = std::min(name.find_first_not_of(kDigits, from), name.size());
    const bool of_paper = name.starts_with("fig-");
    return std::tuple(!of_paper, name.substr(0, from), to - from, name.substr(from));
  };
  std::sort(names.begin(), names.end(),
            [&](const std::string& a, const std::string& b) { return key(a) < key(b); });
  return names;
}

Figure read_figure(const std::string& data, const std::string& name) {
  Figure figure;
  figure.name = name;
  const std::string file = data + "/figures/" + name + ".json";
  FigureReader(data, figure, file).read(parse_json(read_text(file), file));
  return figure;
}

}  // namespace apothem
