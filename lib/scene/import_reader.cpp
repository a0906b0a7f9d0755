#include "lib/scene/import_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "lib/scene/outlines.hpp"
#include "lib/scene/polygon_value.hpp"
#include "lib/scene/value_maker.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// Keys of a body that an import or one of its layers gives to all of its bodies. "mesh" is another
// one, without the polygon.
constexpr std::array kOfBody{"material", "motion", "fix", "velocity", "spin", "supports", "loads"};

class Import {
 public:
  Import(const JsonReader& in, const JsonValue& value) : in_(in), value_(value), make_(value) {}

  ImportReport append(std::vector<JsonValue>& bodies) {
    JsonObject object(in_, value_);
    read_keys(object);
    object.finish();
    const std::vector<Outline> outlines = read_outlines_of_file();
    const std::vector<std::string> names = names_of(outlines);
    for (size_t i = 0; i < outlines.size(); ++i) {
      bodies.push_back(body(outlines[i], names[i]));
    }
    report_.file = in_.string(*file_);
    report_.bodies = static_cast<int>(outlines.size());
    report_.scale = rules_.scale;
    return std::move(report_);
  }

 private:
  void read_keys(JsonObject& object) {
    file_ = &object.required("file", "the name of a drawing: .dxf, .wkt, .geojson or .csv");
    name_ = std::filesystem::path(in_.string(*file_)).stem().string();
    scale_ = object.optional("scale");
    if (scale_ != nullptr) rules_.scale = in_.positive(*scale_, "m");
    if (const JsonValue* v = object.optional("offset")) rules_.offset = in_.vec2(*v, "m");
    if (const JsonValue* v = object.optional("name")) name_ = in_.string(*v);
    if (const JsonValue* v = object.optional("lines")) {
      rules_.polygonize = in_.choice(*v, {"outlines", "polygonize"}) == 1;
    }
    if (const JsonValue* v = object.optional("tolerance")) rules_.tolerance = in_.positive(*v, "m");
    object.read("repair", rules_.repair, &JsonReader::boolean);
    if (const JsonValue* v = object.optional("faults")) {
      rules_.skip_faults = in_.choice(*v, {"refuse", "skip"}) == 1;
    }
    if (const JsonValue* v = object.optional("holes")) {
      rules_.nested_holes = in_.choice(*v, {"separate", "nested"}) == 1;
    }
    layers_ = object.optional("layers");
    read_body_keys(object);
    if (layers_ == nullptr) return;
    if (layers_->type() != JsonValue::Type::object) {
      in_.fail(*layers_, "must be {\"LAYER\": { keys of a body } or false, ...}");
    }
    for (size_t i = 0; i < layers_->items().size(); ++i) read_layer(i);
  }

  void read_layer(size_t i) {
    const JsonValue& layer = layers_->items()[i];
    if (layer.type() == JsonValue::Type::boolean && !layer.boolean()) {
      rules_.ignored.insert(layers_->keys()[i]);
      return;
    }
    if (layer.type() != JsonValue::Type::object) {
      in_.fail(layer, "must be an object with keys of a body, or false to leave the layer out");
    }
    JsonObject object(in_, layer);
    read_body_keys(object);
    object.finish();
  }

  void read_body_keys(JsonObject& object) {
    for (const char* key : kOfBody) object.optional(key);
    const JsonValue* mesh = object.optional("mesh");
    if (mesh == nullptr || (mesh->type() == JsonValue::Type::boolean && !mesh->boolean())) return;
    if (mesh->type() != JsonValue::Type::object) {
      in_.fail(*mesh, "must be {\"size\": in m, \"element\": ...}, or false for rigid bodies");
    }
    JsonObject keys(in_, *mesh);
    keys.required("size", "of the elements, in m");
    keys.optional("element");
    keys.finish();
  }

  // What a layer says goes before what the import says.
  const JsonValue* find(const std::string& layer, const char* key) const {
    const JsonValue* of_layer = layers_ != nullptr ? layers_->find(layer) : nullptr;
    const JsonValue* found = of_layer != nullptr ? of_layer->find(key) : nullptr;
    return found != nullptr ? found : value_.find(key);
  }
  const JsonValue* mesh_of(const std::string& layer) const {
    const JsonValue* mesh = find(layer, "mesh");
    return mesh != nullptr && mesh->type() == JsonValue::Type::object ? mesh : nullptr;
  }

  std::vector<Outline> read_outlines_of_file() {
    try {
      const Drawing drawing = read_drawing(file_beside(in_, file_->string()));
      check_layers(drawing);
      take_unit(drawing.unit);
      return outlines_of(drawing.shapes, rules_, report_);
    } catch (const BadOutline& error) {
      in_.fail(*file_, fmt::format("{}: {}", file_->string(), error.what()));
    } catch (const SceneError& error) {
      if (error.file() == in_.file()) throw;
      in_.fail(*file_, error.what());
    }
  }

  // What the scene says goes before what the drawing says.
  void take_unit(const DrawingUnit& unit) {
    if (scale_ != nullptr) {
      report_.unit_source = "by the scene";
      return;
    }
    if (!unit.problem.empty()) {
      in_.fail(*file_, fmt::format("{}: {}", file_->string(), unit.problem));
    }
    rules_.scale = unit.metres;
    report_.unit_source = unit.source.empty() ? "the drawing states no unit" : unit.source;
  }

  void check_layers(const Drawing& drawing) const {
    if (layers_ == nullptr) return;
    std::vector<std::string> known = drawing.layers;
    std::map<std::string, bool> shown;  // layers with shapes: whether one of them can be seen
    for (const DrawnShape& shape : drawing.shapes) {
      const bool is_new = std::find(known.begin(), known.end(), shape.layer) == known.end();
      if (!shape.layer.empty() && is_new) known.push_back(shape.layer);
      shown[shape.layer] |= !shape.hidden;
    }
    for (size_t i = 0; i < layers_->keys().size(); ++i) {
      const std::string& layer = layers_->keys()[i];
      const auto seen = shown.find(layer);
      if (seen != shown.end() && !seen->second && !rules_.ignored.count(layer)) {
        in_.fail(
            layers_->items()[i],
            fmt::format("the layer \"{}\" is off or frozen in the drawing, so nothing on it is "
                        "read; switch it on there, or say false",
                        layer));
      }
      if (std::find(known.begin(), known.end(), layer) != known.end()) continue;
      in_.fail(layers_->items()[i],
               known.empty() ? "the drawing has no layers; leave \"layers\" out"
                             : fmt::format("the drawing has no layer {} (it has: {})",
                                           suggest(layer, known), fmt::join(known, ", ")));
    }
  }

  // By the drawing where it names one outline only, and otherwise by numbers.
  std::vector<std::string> names_of(const std::vector<Outline>& outlines) {
    std::map<std::string, int> uses;
    for (const Outline& outline : outlines) ++uses[usable_name(outline.name)];
    std::vector<std::string> names;
    for (size_t i = 0; i < outlines.size(); ++i) {
      const std::string own = usable_name(outlines[i].name);
      if (own != outlines[i].name) {
        report_.renamed.push_back(fmt::format("{}: the name \"{}\" to \"{}\"", outlines[i].place,
                                              printable(outlines[i].name), own));
      }
      names.push_back(name_ + "-" + (own.empty() || uses[own] > 1 ? std::to_string(i) : own));
    }
    return names;
  }

  // Names head columns of tables, which commas, quotes, brackets and line breaks would divide.
  static std::string usable_name(std::string name) {
    for (char& c : name) {
      const auto code = static_cast<unsigned char>(c);
      if (code < 32 || code == 127 || std::string(",\"[]").find(c) != std::string::npos) c = '_';
    }
    return name;
  }
  static std::string printable(std::string name) {
    for (char& c : name) {
      if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
    }
    return name;
  }

  JsonValue body(const Outline& outline, const std::string& name) const {
    JsonValue body = make_.make(JsonValue::Type::object);
    ValueMaker::add(body, "name", make_.string(name));
    for (const char* key : kOfBody) {
      if (const JsonValue* v = find(outline.layer, key)) ValueMaker::add(body, key, *v);
    }
    const JsonValue* mesh = mesh_of(outline.layer);
    if (mesh == nullptr) {
      ValueMaker::add(body, "polygon", make_.ring(outline.rings[0]));
      if (outline.rings.size() > 1) ValueMaker::add(body, "holes", make_.rings(holes_of(outline)));
    } else {
      ValueMaker::add(body, "mesh", filled(outline, *mesh));
    }
    return body;
  }

  static Rings holes_of(const Outline& outline) { return polygon_of_rings(outline.rings).holes; }

  static JsonValue filled(const Outline& outline, const JsonValue& mesh) {
    const ValueMaker make(mesh);
    JsonValue fill = make.make(JsonValue::Type::object);
    ValueMaker::add(fill, "polygon", make.ring(outline.rings[0]));
    ValueMaker::add(fill, "holes", make.rings(holes_of(outline)));
    ValueMaker::add(fill, "size", *mesh.find("size"));
    JsonValue value = make.make(JsonValue::Type::object);
    ValueMaker::add(value, "fill", std::move(fill));
    if (const JsonValue* v = mesh.find("element")) ValueMaker::add(value, "element", *v);
    return value;
  }

  const JsonReader& in_;
  const JsonValue& value_;
  ValueMaker make_;
  const JsonValue* file_ = nullptr;
  const JsonValue* scale_ = nullptr;
  const JsonValue* layers_ = nullptr;
  std::string name_;
  OutlineRules rules_;
  ImportReport report_;
};

}  // namespace

std::vector<ImportReport> append_imports(const JsonReader& in, const JsonValue& list,
                                         std::vector<JsonValue>& bodies) {
  std::vector<ImportReport> reports;
  for (const JsonValue& value : in.array(list)) {
    reports.push_back(Import(in, value).append(bodies));
  }
  return reports;
}

}  // namespace apothem
