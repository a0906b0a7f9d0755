#include "apothem/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <variant>

#include "apothem/mesh/measure.hpp"
#include "apothem/mesh/reorder.hpp"
#include "apothem/scene/contact_reader.hpp"
#include "apothem/scene/deformable_reader.hpp"
#include "apothem/scene/mesh_reader.hpp"
#include "apothem/scene/output_reader.hpp"
#include "apothem/scene/polygon_value.hpp"

namespace apothem {
namespace {

// Reads one scene, top to bottom; every key of the format stands once, here or in the readers of
// its parts.
class SceneReader {
 public:
  explicit SceneReader(Scene& scene) : scene_(scene), model_(scene.model), in_(scene.file) {}

  void read() {
    JsonObject top(in_, scene_.document);
    model_.name = std::filesystem::path(scene_.file).stem().string();
    if (const JsonValue* v = top.optional("name")) model_.name = scene_name(*v);
    if (const JsonValue* v = top.optional("description")) in_.string(*v);
    if (const JsonValue* v = top.optional("gravity")) model_.gravity = in_.vec2(*v, "m/s^2");
    if (const JsonValue* v = top.optional("thickness")) model_.thickness = in_.positive(*v, "m");
    materials(top.required("materials", "{\"NAME\": {\"density\": ...}, ...}"));
    const JsonValue& list = top.required("bodies", "[{\"name\": ..., \"polygon\": ...}, ...]");
    if (in_.array(list).empty()) in_.fail(list, "must hold at least one body");
    if (const JsonValue* v = top.optional("contact")) {
      contact_.read(*v);
    } else if (list.items.size() > 1) {
      top.required("contact", "{\"normal_stiffness\": ...} for scenes of more than one body");
    }
    bodies(list);
    contact_.pairs();
    time(top.required("time", "{\"end\": ...} in s"));
    if (scene_.time.statics) statics();
    contact_.refuse_with_meshes();
    const JsonValue* output_value = top.optional("output");
    const JsonValue* expect_value = top.optional("expect");
    top.finish();
    OutputReader output(in_, model_, scene_.time.end, scene_.output);
    output.track_by_default();
    if (output_value) output.read(*output_value);
    scene_.time.longest_step = scene_.output.history_interval.value_or(scene_.time.end / 1000);
    if (expect_value) scene_.expectations = output.expectations(*expect_value);
  }

 private:
  const std::string& scene_name(const JsonValue& value) {
    const std::string& name = in_.string(value);
    if (name.empty() || has_control_character(name) ||
        name.find_first_of("/\\\n") != std::string::npos || name[0] == '.') {
      in_.fail(value,
               "must be usable as the name of a folder: not empty, without / or \\, not "
               "starting with a dot");
    }
    return name;
  }

  void materials(const JsonValue& value) {
    JsonObject object(in_, value);
    for (size_t i = 0; i < value.keys.size(); ++i) {
      object.optional(value.keys[i]);
      material(value.keys[i], value.items[i]);
    }
    if (model_.materials.empty()) in_.fail(value, "must hold at least one material");
  }

  void material(const std::string& name, const JsonValue& value) {
    JsonObject object(in_, value);
    Material material{name, in_.positive(object.required("density", "in kg/m^3"), "kg/m^3")};
    // Elastic constants belong to deformable bodies; rigid ones only have them checked.
    Elastic& elastic = material.elastic;
    if (const JsonValue* v = object.optional("young")) elastic.young = in_.positive(*v, "Pa");
    if (const JsonValue* v = object.optional("poisson")) {
      elastic.poisson = in_.number(*v, "");
      if (!(elastic.poisson > -1 && elastic.poisson < 0.5)) {
        in_.fail(*v, fmt::format("must lie between -1 and 0.5, not {}", elastic.poisson));
      }
      has_poisson_.push_back(static_cast<int>(model_.materials.size()));
    }
    if (const JsonValue* v = object.optional("plane")) {
      elastic.plane = static_cast<Plane>(in_.choice(*v, {kPlanes.begin(), kPlanes.end()}));
    }
    if (const JsonValue* v = object.optional("law")) {
      elastic.law =
          static_cast<ElasticLaw>(in_.choice(*v, {kElasticLaws.begin(), kElasticLaws.end()}));
    }
    if (const JsonValue* v = object.optional("damping")) bulk_damping(*v, material);
    object.finish();
    model_.materials.push_back(std::move(material));
  }

  void bulk_damping(const JsonValue& value, Material& material) {
    JsonObject object(in_, value);
    in_.choice(object.required("model", "\"rayleigh\""), {"rayleigh"});
    if (const JsonValue* v = object.optional("mass")) {
      material.mass_damping = in_.positive(*v, "1/s");
    }
    if (const JsonValue* v = object.optional("stiffness")) {
      material.stiffness_damping = in_.positive(*v, "s");
    }
    object.finish();
    if (material.mass_damping == 0 && material.stiffness_damping == 0) {
      in_.fail(value, "must give \"mass\" (alpha in 1/s), \"stiffness\" (beta in s) or both");
    }
  }

  void bodies(const JsonValue& list) {
    // All shapes first: the origin of the model's coordinates depends on where the scene is.
    std::vector<std::variant<Polygon, MeshSpec>> shapes;
    Box box;
    for (const JsonValue& value : list.items) {
      shapes.push_back(shape(value));
      Box own;
      if (const auto* polygon = std::get_if<Polygon>(&shapes.back())) {
        own = bounding_box(*polygon);
      } else {
        for (const Vec2& x : std::get<MeshSpec>(shapes.back()).mesh.nodes) {
          own.include(x.x(), x.y());
        }
      }
      if (const JsonValue* v = value.find("position")) {
        const Vec2 p = in_.vec2(*v, "m");
        own = Box{p.x(), p.y(), p.x(), p.y()}.grown(own.extent());
      }
      box.include(own.x0, own.y0);
      box.include(own.x1, own.y1);
    }
    model_.origin = local_origin(box);
    for (size_t i = 0; i < shapes.size(); ++i) {
      if (const auto* polygon = std::get_if<Polygon>(&shapes[i])) {
        scene_.rigid_places.push_back(static_cast<int>(i));
        body(list.items[i], *polygon);
      } else {
        deformable(list.items[i], std::move(std::get<MeshSpec>(shapes[i])));
      }
    }
  }

  std::variant<Polygon, MeshSpec> shape(const JsonValue& value) {
    JsonObject object(in_, value);
    if (const JsonValue* mesh = object.optional("mesh")) {
      if (const JsonValue* v = object.optional("polygon")) {
        in_.fail(*v,
                 "a body is rigid with a \"polygon\" or deformable with a \"mesh\": leave one out");
      }
      return read_mesh(in_, *mesh);
    }
    return read_polygon(in_, object.required("polygon",
                                             "[[x,y],...] in m, or the name of a file; "
                                             "or a \"mesh\""));
  }

  void deformable(const JsonValue& value, MeshSpec spec) {
    JsonObject object(in_, value);
    DeformableBody body;
    body.name = body_name(object.required("name", "a string, unique among the bodies"));
    const JsonValue& material = object.required("material", "the name of a material");
    body.material = index_of(material, model_.materials, "material");
    const Material& m = model_.materials[body.material];
    if (!(m.elastic.young > 0) ||
        std::find(has_poisson_.begin(), has_poisson_.end(), body.material) == has_poisson_.end()) {
      in_.fail(material, fmt::format("a body with a mesh needs \"young\" (Pa) and \"poisson\" of "
                                     "material \"{}\"",
                                     m.name));
    }
    object.required("mesh", "");
    body.element = spec.element;
    body.mesh = std::move(spec.mesh);
    place_mesh(object, body.mesh);
    reorder_along_curve(body.mesh);
    body.first_node = model_.node_count();
    DeformableReader reader(in_, model_, body);
    if (const JsonValue* v = object.optional("supports")) reader.supports(*v);
    if (const JsonValue* v = object.optional("loads")) reader.loads(*v);
    if (const JsonValue* v = object.optional("velocity")) body.velocity = in_.vec2(*v, "m/s");
    if (const JsonValue* v = object.optional("spin")) body.spin = in_.number(*v, "rad/s");
    if (const JsonValue* v = object.optional("motion")) {
      if (v->type != JsonValue::Type::string || v->string != "free") {
        in_.fail(*v, "a body with a mesh is \"free\"; hold or move parts of it by \"supports\"");
      }
    }
    object.finish();
    model_.deformables.push_back(std::move(body));
  }

  // "position": where the centroid goes; "angle": turned about it.
  void place_mesh(JsonObject& object, Mesh& mesh) {
    const JsonValue* position = object.optional("position");
    const JsonValue* angle = object.optional("angle");
    for (Vec2& x : mesh.nodes) x -= model_.origin;
    if (!position && !angle) return;
    const Vec2 centre = mesh_centroid(mesh);
    const Vec2 goal = position ? Vec2(in_.vec2(*position, "m") - model_.origin) : centre;
    const double a = angle ? in_.number(*angle, "rad") : 0;
    for (Vec2& x : mesh.nodes) {
      const Vec2 arm = x - centre;
      x = goal + Vec2(std::cos(a) * arm.x() - std::sin(a) * arm.y(),
                      std::sin(a) * arm.x() + std::cos(a) * arm.y());
    }
  }

  void body(const JsonValue& value, const Polygon& polygon) {
    JsonObject object(in_, value);
    RigidBody body;
    const JsonValue& name = object.required("name", "a string, unique among the bodies");
    body.name = body_name(name);
    body.material = index_of(object.required("material", "the name of a material"),
                             model_.materials, "material");
    const JsonValue& outline = object.required("polygon", "");
    try {
      set_shape(body, polygon, model_);
    } catch (const InvalidPolygon& error) {
      refuse_polygon(in_, outline, error);
    }
    if (!(body.mass > 0 && body.inertia > 0 && std::isfinite(1 / body.mass) &&
          std::isfinite(1 / body.inertia) && std::isfinite(body.potential.steepest))) {
      in_.fail(value,
               fmt::format("has a mass of {:g} kg and an inertia of {:g} kg m^2, out of the range "
                           "of double precision; check density, thickness and size",
                           body.mass, body.inertia));
    }
    if (const JsonValue* v = object.optional("position")) {
      body.position = in_.vec2(*v, "m") - model_.origin;
    }
    if (const JsonValue* v = object.optional("angle")) body.angle = in_.number(*v, "rad");
    if (const JsonValue* v = object.optional("motion")) motion(*v, body);
    if (const JsonValue* v = object.optional("fix")) fix(*v, body);
    if (const JsonValue* v = object.optional("velocity")) {
      require_free(*v, body);
      body.velocity = in_.vec2(*v, "m/s");
      for (int k = 0; k < 2; ++k) {
        if (body.held[k] && body.velocity[k] != 0) in_.fail(v->items[k], kHeldRate);
      }
    }
    if (const JsonValue* v = object.optional("spin")) {
      require_free(*v, body);
      body.spin = in_.number(*v, "rad/s");
      if (body.held[2] && body.spin != 0) in_.fail(*v, kHeldRate);
    }
    object.finish();
    model_.bodies.push_back(std::move(body));
  }

  const std::string& body_name(const JsonValue& value) {
    const std::string& name = in_.string(value);
    refuse_as_column(in_, value);
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) {
      in_.fail(
          value,
          fmt::format("\"{}\" is already the name of another body; give each body its own", name));
    }
    names_.push_back(name);
    return name;
  }

  // Index of the one of that name in a list of materials or bodies.
  template <class Named>
  int index_of(const JsonValue& value, const std::vector<Named>& list, const char* kind) {
    const std::string& name = in_.string(value);
    std::vector<std::string> names;
    for (size_t i = 0; i < list.size(); ++i) {
      if (list[i].name == name) return static_cast<int>(i);
      names.push_back(list[i].name);
    }
    in_.fail(value, fmt::format("unknown {} {}", kind, suggest(name, names)));
  }

  static constexpr const char* kHeldRate =
      "must be 0 in a direction that \"fix\" holds; leave it out or take the direction from "
      "\"fix\"";

  void require_free(const JsonValue& value, const RigidBody& body) {
    if (body.motion == Motion::free) return;
    in_.fail(value,
             body.motion == Motion::fixed
                 ? "a fixed body has no initial velocity or spin; leave it out or make the "
                   "motion \"free\""
                 : "a body with prescribed motion takes its velocity from \"motion\"; leave it "
                   "out");
  }

  void motion(const JsonValue& value, RigidBody& body) {
    if (value.type == JsonValue::Type::string) {
      body.motion = in_.choice(value, {"free", "fixed"}) == 0 ? Motion::free : Motion::fixed;
      return;
    }
    body.motion = Motion::prescribed;
    if (value.type != JsonValue::Type::object) {
      in_.fail(value,
               "must be \"free\", \"fixed\" or {\"velocity\": [[t,vx,vy],...], \"spin\": "
               "[[t,w],...]}");
    }
    JsonObject object(in_, value);
    if (const JsonValue* v = object.optional("velocity")) {
      body.history.velocity = read_velocities(in_, *v);
    }
    if (const JsonValue* v = object.optional("spin")) {
      body.history.spin = read_spins(in_, *v);
    }
    object.finish();
    if (body.history.velocity.empty() && body.history.spin.empty()) {
      in_.fail(value,
               "must give a velocity or a spin history with at least one row; for a body at "
               "rest use \"fixed\"");
    }
  }

  void fix(const JsonValue& value, RigidBody& body) {
    if (body.motion != Motion::free)
      in_.fail(value, "only a body of \"free\" motion takes \"fix\"");
    for (const JsonValue& direction : in_.array(value)) {
      body.held[in_.choice(direction, {"x", "y", "angle"})] = true;
    }
  }

  void time(const JsonValue& value) {
    JsonObject object(in_, value);
    TimeSettings& time = scene_.time;
    time.end = in_.positive(object.required("end", "in s"), "s");
    if (const JsonValue* v = object.optional("mode")) {
      time.statics = in_.choice(*v, {"dynamic", "static"}) == 1;
    }
    for (const char* key : {"step", "start", "safety"}) {
      const JsonValue* v = value.find(key);
      if (v && time.statics) in_.fail(*v, kStatic);
    }
    for (const char* key : {"load_steps", "tolerance"}) {
      const JsonValue* v = value.find(key);
      if (v && !time.statics) in_.fail(*v, "goes with \"mode\": \"static\"; leave it out");
    }
    if (const JsonValue* v = object.optional("load_steps")) {
      time.load_steps = in_.count(*v);
      if (time.load_steps < 1) in_.fail(*v, "must be at least 1");
    }
    if (const JsonValue* v = object.optional("tolerance")) {
      time.tolerance = in_.positive(*v, "parts of the loads");
      if (!(time.tolerance >= 1e-12 && time.tolerance <= 1e-2)) {
        in_.fail(*v, fmt::format("must lie between 1e-12 and 1e-2, not {}", time.tolerance));
      }
    }
    if (const JsonValue* v = object.optional("step")) {
      if (v->type == JsonValue::Type::string) {
        in_.choice(*v, {"auto"});
      } else {
        time.fixed_step = in_.positive(*v, "s");
        if (*time.fixed_step > time.end) in_.fail(*v, "is longer than the whole run");
      }
    }
    if (const JsonValue* v = object.optional("start")) {
      time.settled = in_.choice(*v, {"as_given", "settled"}) == 1;
      if (time.settled && !model_.deformables.empty()) {
        in_.fail(*v,
                 "\"settled\" is for rigid bodies only; where a body has a mesh leave it out, and "
                 "find equilibria with \"mode\": \"static\"");
      }
    }
    if (const JsonValue* v = object.optional("safety")) {
      time.safety = in_.positive(*v, "parts of the stability limit");
      time.element_safety = time.safety;
      if (time.safety > 0.8) {
        in_.fail(*v, fmt::format("must not exceed 0.8 of the stability limit, is {}", time.safety));
      }
      if (time.fixed_step) in_.fail(*v, "goes with an automatic step only; leave it out");
    }
    object.finish();
  }

  // What a sequence of equilibria cannot take.
  void statics() {
    const JsonValue& document = scene_.document;
    const std::vector<JsonValue>& list = document.find("bodies")->items;
    if (model_.deformables.empty()) {
      in_.fail(*document.find("time")->find("mode"), "a static run needs a body with a mesh");
    }
    for (size_t i = 0; i < model_.bodies.size(); ++i) {
      if (model_.bodies[i].motion == Motion::free) {
        in_.fail(list[scene_.rigid_places[i]],
                 "a rigid body of a static run must be \"fixed\" or move as prescribed; say so by "
                 "\"motion\", or give it a mesh");
      }
    }
    for (const JsonValue& body : list) {
      for (const char* key : {"velocity", "spin"}) {
        if (const JsonValue* v = body.find(key)) in_.fail(*v, kStatic);
      }
    }
    for (const JsonValue& material : document.find("materials")->items) {
      if (const JsonValue* v = material.find("damping")) in_.fail(*v, kStatic);
    }
    if (const JsonValue* contact = document.find("contact")) {
      for (const char* key : {"friction", "damping", "pairs"}) {
        if (const JsonValue* v = contact->find(key)) in_.fail(*v, kStatic);
      }
    }
    if (contact_.element_surface()) {
      in_.fail(*contact_.element_surface(),
               "a static run needs \"body\": element potentials have no equilibrium "
               "of least energy");
    }
    if (const JsonValue* output = document.find("output")) {
      const JsonValue* history = output->find("history");
      for (const JsonValue* v : {output->find("frames"), output->find("checkpoint"),
                                 history ? history->find("interval") : nullptr}) {
        if (v) in_.fail(*v, "a static run writes a row and a frame per load step; leave it out");
      }
    }
    scene_.output.frames = scene_.time.load_steps;
    scene_.output.history_interval = scene_.time.end / scene_.time.load_steps;
  }

  static constexpr const char* kStatic = "has no meaning in a static run; leave it out";

  Scene& scene_;
  Model& model_;
  JsonReader in_;
  ContactReader contact_{in_, model_};
  std::vector<std::string> names_;  // of all bodies
  std::vector<int> has_poisson_;    // materials that say their Poisson's ratio
};

}  // namespace

SceneError Scene::error_at(const std::string& pointer, const std::string& what) const {
  const JsonValue* at = &document;
  size_t start = 1;
  while (start < pointer.size()) {
    const size_t slash = std::min(pointer.find('/', start), pointer.size());
    const std::string part = pointer.substr(start, slash - start);
    const JsonValue* next = at->find(part);
    if (at->type == JsonValue::Type::array) next = &at->items.at(std::stoul(part));
    if (!next) break;
    at = next;
    start = slash + 1;
  }
  return {file, at->line, at->pointer, what};
}

Scene read_scene(const std::string& file) {
  Scene scene;
  scene.file = file;
  scene.text = read_text(file);
  scene.document = parse_json(scene.text, file);
  SceneReader(scene).read();
  return scene;
}

}  // namespace apothem
