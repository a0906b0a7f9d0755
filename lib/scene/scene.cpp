#include "scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <variant>

#include "mesh/locate.hpp"
#include "mesh/measure.hpp"
#include "mesh/reorder.hpp"
#include "model/columns.hpp"
#include "model/state.hpp"
#include "scene/deformable_reader.hpp"
#include "scene/mesh_reader.hpp"
#include "scene/polygon_value.hpp"

namespace apothem {
namespace {

// Reads one scene, top to bottom; every key of the format stands here once.
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
      contact(*v);
    } else if (list.items.size() > 1) {
      top.required("contact", "{\"normal_stiffness\": ...} for scenes of more than one body");
    }
    bodies(list);
    contact_rules();
    time(top.required("time", "{\"end\": ...} in s"));
    if (scene_.time.statics) statics();
    meshed_contact();
    const JsonValue* output_value = top.optional("output");
    const JsonValue* expect_value = top.optional("expect");
    top.finish();
    track_by_default();
    if (output_value) output(*output_value);
    scene_.time.longest_step = scene_.output.history_interval.value_or(scene_.time.end / 1000);
    if (expect_value) expect(*expect_value);
  }

 private:
  static bool has_control_character(const std::string& name) {
    return std::any_of(name.begin(), name.end(),
                       [](unsigned char c) { return c < 32 || c == 127; });
  }

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

  void contact(const JsonValue& value) {
    JsonObject object(in_, value);
    ContactLaw& law = model_.contact;
    if (const JsonValue* v = object.optional("potential")) {
      std::vector<std::string> names;
      for (const NamedPotential& p : kPotentials) names.emplace_back(p.name);
      law.potential.kind = kPotentials[in_.choice(*v, names)].kind;
      potential_ = v;
    }
    law.normal_stiffness =
        in_.positive(object.required("normal_stiffness", "k_n in Pa (there is no default)"), "Pa");
    if (const JsonValue* v = object.optional("field")) field(*v);
    if (const JsonValue* v = object.optional("reference")) reference(*v);
    if (const JsonValue* v = object.optional("friction")) law.friction = friction(*v, true);
    contact_damping_ = object.optional("damping");
    if (contact_damping_) damping(*contact_damping_);
    contact_pairs_ = object.optional("pairs");
    surface(object);
    object.finish();
  }

  // Of bodies with a mesh, and how its forces reach their nodes.
  void surface(JsonObject& object) {
    ContactLaw& law = model_.contact;
    const JsonValue* surface = object.optional("surface");
    if (surface) {
      std::vector<std::string> names;
      for (const NamedSurface& n : kSurfaces) names.emplace_back(n.name);
      law.surface = kSurfaces[in_.choice(*surface, names)].surface;
    }
    const auto fits = [&](const NamedDistribution& d) { return d.surface == law.surface; };
    const NamedDistribution* known =
        std::find_if(kDistributions.begin(), kDistributions.end(), fits);
    if (const JsonValue* v = object.optional("distribution")) {
      std::vector<std::string> names;
      for (const NamedDistribution& d : kDistributions) names.emplace_back(d.name);
      known = &kDistributions[in_.choice(*v, names)];
      if (!fits(*known)) {
        const bool body = known->surface == ContactSurface::body;
        in_.fail(*v, fmt::format("\"{}\" needs \"surface\": \"{}\"; {}", known->name,
                                 body ? "body" : "element",
                                 body ? "with elements use \"resultant\" or \"integrated\""
                                      : "the body's own surface has \"variational\" only"));
      }
    }
    law.distribution = known->distribution;
    if (law.surface == ContactSurface::element) by_element_ = surface;
  }

  // Of the whole scene, or of a pair, which may leave the stiffness to the scene.
  Friction friction(const JsonValue& value, bool of_scene) {
    ContactLaw& law = model_.contact;
    JsonObject object(in_, value);
    Friction friction = law.friction;
    const JsonValue& mu = object.required("coefficient", "mu, 0 or more");
    friction.coefficient = in_.number(mu, "");
    if (!(friction.coefficient >= 0)) in_.fail(mu, "must be 0 or more");
    if (const JsonValue* v = object.optional("tangential_stiffness")) {
      friction.tangential_stiffness = in_.positive(*v, "Pa");
    } else if (friction.coefficient > 0 && !(friction.tangential_stiffness > 0)) {
      object.required("tangential_stiffness", "k_s in Pa");
    }
    if (of_scene) {
      if (const JsonValue* v = object.optional("law")) {
        std::vector<std::string> names;
        for (const NamedFrictionLaw& l : kFrictionLaws) names.emplace_back(l.name);
        law.friction_law = kFrictionLaws[in_.choice(*v, names)].law;
        friction_law_ = v;
      }
    }
    object.finish();
    return friction;
  }

  void damping(const JsonValue& value) {
    JsonObject object(in_, value);
    std::vector<std::string> names;
    for (const NamedDamping& d : kDampingModels) names.emplace_back(d.name);
    const NamedDamping& model =
        kDampingModels[in_.choice(object.required("model", "normal_viscous or mass"), names)];
    const std::string key(model.key);
    const std::string unit(model.unit);
    model_.contact.*model.value =
        in_.positive(object.required(key, "a positive number " + unit), unit);
    object.finish();
  }

  // After the bodies, whose names it may use.
  void contact_rules() {
    if (contact_pairs_ == nullptr) return;
    for (const JsonValue& value : in_.array(*contact_pairs_)) {
      JsonObject object(in_, value);
      const JsonValue& between = object.required("between", "two names of materials or bodies");
      const std::vector<JsonValue>& names = in_.array(between);
      if (names.size() != 2) in_.fail(between, "must hold two names of materials or bodies");
      const ContactRule::Party a = party(names[0]);
      const ContactRule::Party b = party(names[1]);
      const Friction rule = friction(object.required("friction", "{\"coefficient\": ...}"), false);
      model_.contact.rules.push_back({{a, b}, rule});
      object.finish();
    }
  }

  // What bodies with a mesh cannot take.
  void meshed_contact() {
    if (model_.deformables.empty()) return;
    if (model_.contact.friction_law == FrictionLaw::per_edge) {
      in_.fail(
          *friction_law_,
          "\"per_edge\" is for rigid bodies only; bodies with a mesh have a spring per boundary "
          "edge, or per pair of elements with \"surface\": \"element\": leave it out");
    }
    if (contact_damping_) {
      in_.fail(*contact_damping_,
               "acts between rigid bodies only; where a body has a mesh leave it out, and give the "
               "material \"damping\"");
    }
    const ContactLaw& law = model_.contact;
    if (law.potential.kind == PotentialChoice::Kind::area && law.surface == ContactSurface::body) {
      in_.fail(
          *potential_,
          "\"area\" is for triangles; the surface of a body with a mesh has the depth below it: "
          "use \"distance\", or \"surface\": \"element\" with triangles");
    }
  }

  // A name that is both a body's and a material's means the body.
  ContactRule::Party party(const JsonValue& value) {
    const std::string& name = in_.string(value);
    const int bodies = static_cast<int>(model_.bodies.size() + model_.deformables.size());
    for (int i = 0; i < bodies; ++i) {
      if (model_.name_of(i) == name) return {true, i};
    }
    for (size_t i = 0; i < model_.materials.size(); ++i) {
      if (model_.materials[i].name == name) return {false, static_cast<int>(i)};
    }
    in_.fail(value, fmt::format("\"{}\" is neither a body nor a material", name));
  }

  void field(const JsonValue& value) {
    PotentialChoice& choice = model_.contact.potential;
    if (choice.kind == PotentialChoice::Kind::area) {
      in_.fail(value, "the area potential has one field only; leave it out");
    }
    std::vector<std::string> names;
    for (const NamedField& f : kFields) names.emplace_back(f.name);
    choice.field = kFields[in_.choice(value, names)].field;
  }

  void reference(const JsonValue& value) {
    PotentialChoice& choice = model_.contact.potential;
    if (choice.kind == PotentialChoice::Kind::area) {
      in_.fail(value, "the area potential has no reference length; leave it out");
    }
    if (value.type == JsonValue::Type::number) {
      choice.reference = PotentialChoice::Reference::length;
      choice.length = in_.positive(value, "m");
      if (!std::isfinite(1 / choice.length)) in_.fail(value, "is too small for double precision");
      return;
    }
    std::vector<std::string> names;
    for (const NamedReference& r : kReferences) names.emplace_back(r.name);
    choice.reference = kReferences[in_.choice(value, names)].reference;
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

  void refuse_as_column(const JsonValue& value) {
    const std::string& name = in_.string(value);
    if (name.empty() || has_control_character(name) ||
        name.find_first_of(",\"\n\r[]") != std::string::npos) {
      in_.fail(value, "must not be empty nor hold , \" [ ] or line breaks: it heads CSV columns");
    }
  }

  const std::string& body_name(const JsonValue& value) {
    const std::string& name = in_.string(value);
    refuse_as_column(value);
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
    if (by_element_) {
      in_.fail(*by_element_,
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

  void track_by_default() {
    constexpr size_t kMany = 20;
    std::vector<int>& track = scene_.output.track;
    for (size_t i = 0; i < model_.bodies.size(); ++i) {
      if (model_.bodies[i].can_move()) track.push_back(static_cast<int>(i));
    }
    std::vector<int>& deformables = scene_.output.track_deformables;
    for (size_t i = 0; i < model_.deformables.size(); ++i) {
      deformables.push_back(static_cast<int>(i));
    }
    if (track.size() + deformables.size() > kMany) {
      track.clear();
      deformables.clear();
    }
  }

  void tracked(const JsonValue& item) {
    OutputSettings& output = scene_.output;
    JsonObject object(in_, item);
    const JsonValue& name = object.required("body", "the name of a body");
    const JsonValue* point = object.optional("point");
    const JsonValue* surface = object.optional("surface");
    const JsonValue* label = object.optional("name");
    object.finish();
    const auto place = std::find(names_.begin(), names_.end(), in_.string(name));
    if (place == names_.end()) in_.fail(name, "unknown body " + suggest(name.string, names_));
    const auto index_in = [&](const auto& bodies) {
      const auto body = std::find_if(bodies.begin(), bodies.end(),
                                     [&](const auto& b) { return b.name == name.string; });
      return body == bodies.end() ? -1 : static_cast<int>(body - bodies.begin());
    };
    const int rigid = index_in(model_.bodies);
    const int deformable = index_in(model_.deformables);
    if (surface) return tracked_surface(deformable, *surface, point);
    if (!point) {
      if (label) in_.fail(*label, "goes with a \"point\"; leave it out");
      std::vector<int>& list = rigid >= 0 ? output.track : output.track_deformables;
      const int body = std::max(rigid, deformable);
      if (std::find(list.begin(), list.end(), body) != list.end()) {
        in_.fail(item, "is tracked already; leave it out");
      }
      list.push_back(body);
      return;
    }
    if (rigid >= 0) {
      in_.fail(*point,
               "points are tracked in bodies with a mesh; of a rigid body leave it out: "
               "place and angle say it all");
    }
    tracked_point(deformable, *point, label);
  }

  void tracked_surface(int deformable, const JsonValue& value, const JsonValue* point) {
    std::vector<int>& list = scene_.output.track_surfaces;
    in_.choice(value, {"contact"});
    if (point) in_.fail(value, "and a \"point\" are tracked apart; make two entries");
    if (deformable < 0) in_.fail(value, "is recorded of bodies with a mesh");
    if (model_.contact.surface != ContactSurface::body) {
      in_.fail(value, "is not recorded with \"surface\": \"element\"");
    }
    if (std::find(list.begin(), list.end(), deformable) != list.end()) {
      in_.fail(value, "is tracked already; leave it out");
    }
    list.push_back(deformable);
  }

  void tracked_point(int index, const JsonValue& point, const JsonValue* label) {
    const DeformableBody& body = model_.deformables[index];
    const std::optional<MeshPoint> found =
        find_point(body.mesh, in_.vec2(point, "m") - model_.origin);
    if (!found) in_.fail(point, fmt::format("lies outside \"{}\"", body.name));
    TrackedPoint tracked;
    tracked.body = index;
    tracked.element = found->element;
    for (const int node : body.mesh.element(found->element)) {
      tracked.nodes.push_back(body.first_node + node);
    }
    tracked.weights = found->weights;
    const auto taken = [&](const std::string& candidate) {
      for (const TrackedPoint& p : scene_.output.points) {
        if (p.name == candidate) return true;
      }
      return candidate != body.name &&
             std::find(names_.begin(), names_.end(), candidate) != names_.end();
    };
    tracked.name = label ? in_.string(*label) : body.name;
    if (label) {
      refuse_as_column(*label);
      if (taken(tracked.name)) in_.fail(*label, "is the name of another body or point");
    }
    for (int i = 2; taken(tracked.name); ++i) tracked.name = fmt::format("{}-{}", body.name, i);
    scene_.output.points.push_back(std::move(tracked));
  }

  void output(const JsonValue& value) {
    JsonObject object(in_, value);
    OutputSettings& output = scene_.output;
    if (const JsonValue* v = object.optional("frames")) output.frames = in_.count(*v);
    if (const JsonValue* v = object.optional("history")) {
      JsonObject history(in_, *v);
      if (const JsonValue* i = history.optional("interval")) {
        output.history_interval = in_.positive(*i, "s");
      }
      if (const JsonValue* list = history.optional("track")) {
        output.track.clear();
        output.track_deformables.clear();
        for (const JsonValue& item : in_.array(*list)) tracked(item);
      }
      history.finish();
    }
    if (const JsonValue* v = object.optional("checkpoint")) {
      JsonObject checkpoint(in_, *v);
      output.checkpoint_interval = in_.positive(
          checkpoint.required("wall_clock", "s of real time between checkpoints"), "s");
      checkpoint.finish();
    }
    object.finish();
  }

  void expect(const JsonValue& value) {
    std::vector<std::string> columns;
    for (HistoryColumn& c : history_columns(model_, scene_.output)) {
      columns.push_back(std::move(c.name));
    }
    columns.insert(columns.end(), kEnergyColumns.begin(), kEnergyColumns.end());
    columns.insert(columns.end(), kMomentumColumns.begin(), kMomentumColumns.end());
    for (const JsonValue& item : in_.array(value)) {
      JsonObject object(in_, item);
      Expectation e;
      const JsonValue& quantity = object.required("quantity", "a column of a history");
      e.quantity = in_.string(quantity);
      if (std::find(columns.begin(), columns.end(), e.quantity) == columns.end()) {
        in_.fail(quantity, "no history has a column " + suggest(e.quantity, columns));
      }
      if (const JsonValue* v = object.optional("take")) {
        e.take = static_cast<Expectation::Take>(in_.choice(*v, {kTakes.begin(), kTakes.end()}));
      }
      if (const JsonValue* v = object.optional("between")) {
        const std::vector<double> t = in_.numbers(*v, 2, "[from, until] in s");
        if (!(t[0] <= t[1])) in_.fail(*v, "must not end before it starts");
        if (t[0] > scene_.time.end || t[1] < 0) in_.fail(*v, "lies outside the run");
        e.from = t[0];
        e.until = t[1];
      }
      e.value = in_.number(object.required("value", "the number to expect"), "");
      const JsonValue* absolute = object.optional("tolerance");
      const JsonValue* relative = object.optional("relative");
      if (absolute) e.tolerance = in_.positive(*absolute, "the quantity's unit");
      if (relative) e.tolerance = in_.positive(*relative, "parts of the value") * std::abs(e.value);
      if (!absolute == !relative) {
        in_.fail(item, "must give either \"tolerance\" (absolute) or \"relative\"");
      }
      if (!(e.tolerance > 0))
        in_.fail(*relative, "a relative tolerance needs a value other than 0");
      if (const JsonValue* v = object.optional("label")) e.label = in_.string(*v);
      if (const JsonValue* v = object.optional("source")) in_.string(*v);
      object.finish();
      scene_.expectations.push_back(std::move(e));
    }
  }

  Scene& scene_;
  Model& model_;
  JsonReader in_;
  const JsonValue* contact_pairs_ = nullptr;
  const JsonValue* potential_ = nullptr;
  const JsonValue* friction_law_ = nullptr;
  const JsonValue* contact_damping_ = nullptr;
  const JsonValue* by_element_ = nullptr;  // the surface, where it is "element"
  std::vector<std::string> names_;         // of all bodies
  std::vector<int> has_poisson_;           // materials that say their Poisson's ratio
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
