#include "lib/scene/scene.hpp"

#include <algorithm>
#include <filesystem>

#include "lib/model/forecast.hpp"
#include "lib/scene/body_reader.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/contact_reader.hpp"
#include "lib/scene/deformable_reader.hpp"
#include "lib/scene/fill_reader.hpp"
#include "lib/scene/import_reader.hpp"
#include "lib/scene/material_reader.hpp"
#include "lib/scene/output_reader.hpp"
#include "lib/scene/population_reader.hpp"
#include "lib/scene/time_reader.hpp"
#include "lib/scene/value_maker.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// Reads one scene from top to bottom. Each key of the format stands once, here or in the reader of
// its part. What the parts must not combine is refused at the end, by the table in
// compatibility.hpp.
class SceneReader {
 public:
  explicit SceneReader(Scene& scene) : scene_(scene), model_(scene.model), in_(scene.file) {}

  void read() {
    add_bodies();
    JsonObject top(in_, scene_.document);
    settings(top);
    const JsonValue& materials = top.required("materials", "{\"NAME\": {\"density\": ...}, ...}");
    model_.materials = read_materials(in_, materials, features_);
    const JsonValue* fills = top.optional("fill");
    const JsonValue* list = top.optional("bodies");
    if (!list && !fills) top.required("bodies", "[{\"name\": ..., \"polygon\": ...}, ...]");
    if (list && in_.array(*list).empty() && !fills) in_.fail(*list, "must hold at least one body");
    top.optional("import");
    const JsonValue* contact = top.optional("contact");
    if (contact) {
      read_contact(in_, *contact, model_, features_);
    } else if (fills || (list && list->items().size() > 1)) {
      top.required("contact",
                   "{\"penetration\": 0.01} or {\"normal_stiffness\": ...} for scenes of more than "
                   "one body");
    }
    BodyReader bodies(in_, materials, model_, features_);
    if (list) bodies.add(list->items());
    std::vector<Filled> filled;
    if (fills) filled = read_fills(in_, *fills, bodies.outlines());
    for (Filled& fill : filled) {
      fill.polygons.empty() ? bodies.add(fill.bodies)
                            : bodies.add(fill.alike, std::move(fill.polygons));
    }
    bodies.read();
    scene_.rigid_pointers = bodies.rigid_pointers();
    scene_.warnings = bodies.warnings();
    add_inflows(bodies, list ? list->items().size() : 0, filled);
    if (contact) read_contact_rules(in_, *contact, model_, features_);
    population(top);
    scene_.time = read_time(in_, top.required("time", "{\"end\": ...} in s"), features_);
    const JsonValue* output = top.optional("output");
    const JsonValue* expect = top.optional("expect");
    const JsonValue* measure = top.optional("measure");
    top.finish();
    results(bodies.names(), output, expect, measure);
    if (contact && model_.contact.penetration) choose_stiffness(*contact->find("penetration"));
  }

 private:
  // Puts the bodies that come from elsewhere behind those of the scene's own list.
  void add_bodies() {
    JsonValue& top = scene_.document;
    const JsonValue* imports = top.find("import");
    if (imports == nullptr) return;
    std::vector<JsonValue> bodies;
    scene_.imports = append_imports(in_, *imports, bodies);
    if (top.find("bodies") == nullptr) {
      ValueMaker::add(top, "bodies", ValueMaker(*imports).make(JsonValue::Type::array));
    }
    JsonValue& list = *top.find("bodies");
    in_.array(list);
    for (JsonValue& body : bodies) list.add_from_elsewhere(std::move(body));
  }

  void settings(JsonObject& top) {
    model_.name = std::filesystem::path(scene_.file).stem().string();
    if (const JsonValue* v = top.optional("$schema")) in_.string(*v);
    if (const JsonValue* v = top.optional("name")) model_.name = scene_name(*v);
    if (const JsonValue* v = top.optional("description")) in_.string(*v);
    if (const JsonValue* v = top.optional("gravity")) gravity(*v);
    top.read("thickness", model_.thickness, &JsonReader::positive, "m");
  }

  void gravity(const JsonValue& value) {
    // A list of vectors or objects is a sum; a list of two numbers is a vector.
    const bool list = value.type() == JsonValue::Type::array && !in_.array(value).empty() &&
                      in_.array(value)[0].type() != JsonValue::Type::number;
    if (!list) {
      const GravityPart part = gravity_part(value);
      if (part.tilt.points.empty()) {
        model_.gravity = part.value;
        model_.gravity_history = part.history;
        return;
      }
      model_.gravity_parts = {part};
    } else {
      for (const JsonValue& part : in_.array(value)) {
        model_.gravity_parts.push_back(gravity_part(part));
      }
    }
    model_.gravity = model_.gravity_at(0);
  }

  GravityPart gravity_part(const JsonValue& value) {
    GravityPart part;
    if (value.type() != JsonValue::Type::object) {
      part.value = in_.vec2(value, "m/s^2");
      return part;
    }
    JsonObject object(in_, value);
    part.value = in_.vec2(object.required("value", "[x, y] in m/s^2"), "m/s^2");
    if (const JsonValue* v = object.optional("history")) {
      part.history = read_load_history(in_, *v);
    }
    if (const JsonValue* v = object.optional("direction_history")) {
      part.tilt = read_tilt_history(in_, *v);
    }
    object.finish();
    return part;
  }

  // Bodies of the batches after the first one of a fill.
  void add_inflows(const BodyReader& bodies, size_t place, const std::vector<Filled>& filled) {
    for (const Filled& fill : filled) {
      const size_t first = place;
      place += static_cast<size_t>(fill.count);
      if (fill.batches == 1) continue;
      Inflow inflow{fill.every, {}};
      for (int batch = 1; batch < fill.batches; ++batch) {
        std::vector<BodyIndex>& members = inflow.batches.emplace_back();
        for (int i = 0; i < fill.batch; ++i) {
          members.push_back(bodies.body_at(first + static_cast<size_t>(batch * fill.batch + i)));
        }
      }
      model_.inflows.push_back(std::move(inflow));
      features_.add(Feature::inflow, scene_.document.find("fill"));
    }
  }

  void population(JsonObject& top) {
    if (const JsonValue* v = top.optional("world")) read_world(in_, *v, model_, features_);
    if (const JsonValue* v = top.optional("regions")) read_regions(in_, *v, model_);
    if (const JsonValue* v = top.optional("stop")) {
      scene_.stops = read_stops(in_, *v, model_, features_);
    }
  }

  const std::string& scene_name(const JsonValue& value) {
    const std::string& name = in_.string(value);
    if (name.empty() || has_control_character(name) ||
        name.find_first_of("/\\\n") != std::string::npos || name[0] == '.') {
      in_.fail(value,
               "must be usable as the name of a folder: not empty, without / or \\ or line breaks, "
               "not starting with a dot");
    }
    return name;
  }

  // Expectations are read last, because only a scene whose features go together has the columns
  // that they name.
  void results(const std::vector<std::string>& bodies, const JsonValue* output,
               const JsonValue* expect, const JsonValue* measure) {
    if (scene_.time.statics) {
      scene_.output.frames = scene_.time.load_steps;
      scene_.output.history_interval = scene_.time.end / scene_.time.load_steps;
    }
    OutputReader reader(in_, model_, bodies, scene_.output, features_);
    reader.track_by_default();
    if (output) reader.read(*output);
    scene_.frame_format = reader.frame_format();
    if (!scene_.time.statics && !features_.uses(Feature::frames)) {
      scene_.output.frames = default_frames(model_);
    }
    if (!scene_.time.statics && !features_.uses(Feature::history_interval)) {
      scene_.output.history_interval = scene_.time.end / default_rows(model_, scene_.output);
    }
    scene_.time.longest_step = scene_.output.history_interval;
    add_features_of_all_bodies();
    refuse_incompatible(in_, features_);
    scene_.automatic_scheme = !scene_.time.statics &&
                              goes_with(features_, Feature::automatic_scheme) &&
                              goes_with(features_, Feature::implicit_steps);
    scene_.rigid = features_.uses(Feature::rigid_limit);
    if (scene_.rigid) scene_.time.automatic_load_steps = true;
    if (scene_.time.automatic_load_steps) reader.know({kCollapseFactor, "1"});
    if (expect) scene_.expectations = reader.expectations(*expect, scene_.time.end);
    if (measure) scene_.measures = reader.measures(*measure, scene_.time.end, stop_names());
  }

  // k_n from the penetration that the scene allows.
  void choose_stiffness(const JsonValue& penetration) {
    const NeededStiffness needed = stiffness_for(model_, *model_.contact.penetration);
    model_.contact.normal_stiffness = std::max(needed.flat, needed.corner);
    if (model_.contact.normal_stiffness > 0) return;
    in_.fail(
        penetration,
        "gives no stiffness, because at the start no free body has a weight, a speed or a fast "
        "partner; give \"normal_stiffness\" in Pa");
  }

  // What can end a run before its time.
  [[nodiscard]] std::vector<std::string> stop_names() const {
    std::vector<std::string> names = names_of(scene_.stops);
    if (model_.world.outside == World::Outside::stop) names.emplace_back(kStoppedOutside);
    if (scene_.time.automatic_load_steps) names.emplace_back(kStoppedCollapse);
    return names;
  }

  void add_features_of_all_bodies() {
    if (model_.deformables.empty()) return;
    if (scene_.time.settled) features_.add(Feature::settled_mesh);
    if (model_.bodies.size() < 2) {
      features_.add(Feature::mesh_in_every_contact);
      if (model_.contact.surface == ContactSurface::body) {
        features_.add(Feature::outline_in_every_contact);
      }
    }
  }

  Scene& scene_;
  Model& model_;
  JsonReader in_;
  UsedFeatures features_;
};

}  // namespace

SceneError Scene::error_at(const std::string& pointer, const std::string& what) const {
  const JsonValue* at = &document;
  size_t start = 1;
  while (start < pointer.size()) {
    const size_t slash = std::min(pointer.find('/', start), pointer.size());
    const std::string part = pointer.substr(start, slash - start);
    const JsonValue* next = at->find(part);
    if (at->type() == JsonValue::Type::array) next = &at->items().at(std::stoul(part));
    if (!next) break;
    at = next;
    start = slash + 1;
  }
  return {file, at->line(), at->pointer(), what};
}

void Scene::drop_rings() {
  JsonValue* bodies = document.find("bodies");
  for (size_t i = 0; bodies != nullptr && i < bodies->items().size(); ++i) {
    JsonValue* polygon = bodies->item(i).find("polygon");
    if (polygon != nullptr && polygon->type() == JsonValue::Type::array) polygon->drop_items();
  }
}

Scene read_scene(const std::string& file, const std::vector<Setting>& settings) {
  return read_scene_text(read_text(file, kLargestJson), file, settings);
}

Scene read_scene_text(std::string text, const std::string& file,
                      const std::vector<Setting>& settings) {
  Scene scene;
  scene.file = file;
  scene.text = std::move(text);
  scene.text.shrink_to_fit();
  scene.settings = settings;
  scene.document = parse_json(scene.text, file);
  std::vector<std::string> places;
  places.reserve(settings.size());
  for (const Setting& s : settings) places.push_back(apply_setting(scene.document, s, file));
  try {
    SceneReader(scene).read();
  } catch (const SceneError& error) {
    for (size_t i = 0; i < places.size(); ++i) {
      if (error.pointer() != places[i] && !error.pointer().starts_with(places[i] + "/")) continue;
      throw SceneError(file, error.line(), error.pointer(),
                       error.reason() + ", set by " + settings[i].as_given());
    }
    throw;
  }
  return scene;
}

}  // namespace apothem
