#include "lib/scene/body_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "lib/mesh/boundary.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/mesh/reorder.hpp"
#include "lib/model/rotation.hpp"
#include "lib/scene/deformable_reader.hpp"
#include "lib/scene/output_reader.hpp"
#include "lib/scene/polygon_value.hpp"
#include "lib/text/words.hpp"

namespace apothem {

std::string numbered(const std::string& name, int number) {
  return fmt::format("{}-{}", name, number);
}

void BodyReader::add(const JsonValue& alike, std::vector<Polygon> polygons) {
  series_.push_back(
      {shapes_.size(), shapes_.size() + polygons.size(), alike, in_.string(*alike.find("name"))});
  values_.resize(values_.size() + polygons.size(), &series_.back().value);
  shapes_.reserve(shapes_.size() + polygons.size());
  for (Polygon& polygon : polygons) shapes_.emplace_back(std::move(polygon));
}

void BodyReader::add(const std::vector<JsonValue>& bodies) {
  for (const JsonValue& value : bodies) {
    values_.push_back(&value);
    shapes_.push_back(read_shape(value));
  }
}

// All shapes are read before any body, because the origin of the model's coordinates depends on
// where the scene lies.
void BodyReader::read() {
  Box box;
  for (size_t i = 0; i < shapes_.size(); ++i) box.include(extent(*values_[i], shapes_[i]));
  model_.origin = local_origin(box);
  const Potentials potentials = find_potentials();
  model_.bodies.reserve(shapes_.size());
  size_t polygons = 0;
  auto series = series_.begin();
  const auto name_of_series = [&](size_t i) {
    while (series != series_.end() && i >= series->end) ++series;
    if (series == series_.end() || i < series->first) return;
    series->value.find("name")->set(numbered(series->name, static_cast<int>(i - series->first)));
  };
  const auto first = model_.bodies.size();
  for (size_t i = 0; i < shapes_.size(); ++i) {
    name_of_series(i);
    if (const auto* polygon = std::get_if<Polygon>(&shapes_[i])) {
      rigid_body(*values_[i], *polygon,
                 [&, number = polygons++] { return potentials.make(number); });
    } else {
      deformable_body(*values_[i], std::move(std::get<MeshSpec>(shapes_[i])));
    }
  }
  for (const auto& [polygon, attempts] : potentials.repeated()) {
    warnings_.push_back(fmt::format(
        "the straight skeleton of \"{}\" was found in attempt {}, after constructions with its "
        "vertices as given had failed: they are moved there by at most 1e-9 of its size",
        model_.bodies[first + polygon].name, attempts));
  }
}

Potentials BodyReader::find_potentials() const {
  std::vector<const Polygon*> polygons;
  for (const Shape& shape : shapes_) {
    if (const auto* polygon = std::get_if<Polygon>(&shape)) polygons.push_back(polygon);
  }
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  return {std::move(polygons), model_.contact.potential, processors};
}

std::vector<PolygonWithHoles> BodyReader::outlines() const {
  std::vector<PolygonWithHoles> outlines;
  for (size_t i = 0; i < shapes_.size(); ++i) {
    const auto there = [&](const std::vector<Vec2>& ring, const Vec2& centre) {
      return moved(*values_[i], ring, centre);
    };
    if (const auto* polygon = std::get_if<Polygon>(&shapes_[i])) {
      const Vec2 centre = polygon->origin() + area_moments(*polygon).centroid;
      Rings rings = rings_of(*polygon);
      for (std::vector<Vec2>& ring : rings) ring = there(ring, centre);
      outlines.push_back(polygon_of_rings(rings));
      continue;
    }
    const Mesh& mesh = std::get<MeshSpec>(shapes_[i]).mesh;
    const Vec2 centre = mesh_centroid(mesh);
    const Boundary border = boundary(mesh);
    for (const BoundaryLoop& loop : border.loops) {
      std::vector<Vec2> ring = there(mesh.places(loop.nodes), centre);
      if (!loop.is_hole) {
        outlines.push_back({std::move(ring), {}});
      } else if (border.components == 1) {
        outlines.back().holes.push_back(std::move(ring));
      }
    }
  }
  return outlines;
}

// To where "position" and "angle" put the centre.
std::vector<Vec2> BodyReader::moved(const JsonValue& value, std::vector<Vec2> points,
                                    const Vec2& centre) const {
  const JsonValue* position = value.find("position");
  const JsonValue* angle = value.find("angle");
  if (!position && !angle) return points;
  const Vec2 goal = position ? in_.vec2(*position, "m") : centre;
  const double a = angle ? in_.number(*angle, "rad") : 0;
  for (Vec2& x : points) x = goal + turned(Vec2(x - centre), a);
  return points;
}

BodyIndex BodyReader::body_at(size_t place) const {
  const int number = numbers_[place];
  return number >= 0 ? number : static_cast<int>(model_.bodies.size()) - 1 - number;
}

BodyReader::Shape BodyReader::read_shape(const JsonValue& value) {
  JsonObject object(in_, value);
  const JsonValue* holes = object.optional("holes");
  if (const JsonValue* mesh = object.optional("mesh")) {
    if (const JsonValue* v = object.optional("polygon")) {
      in_.fail(*v,
               "a body is rigid with a \"polygon\" or deformable with a \"mesh\": leave one out");
    }
    if (holes) {
      in_.fail(*holes,
               "belongs to a \"polygon\": the holes of a body with a mesh stand beside the polygon "
               "of its \"fill\"");
    }
    return read_mesh(in_, *mesh);
  }
  const JsonValue& outline = object.required("polygon",
                                             "[[x,y],...] in m, or the name of a file; "
                                             "or a \"mesh\"");
  return read_polygon(in_, outline, holes);
}

// A box around the place where the body starts, in world coordinates.
Box BodyReader::extent(const JsonValue& value, const Shape& shape) const {
  const auto* polygon = std::get_if<Polygon>(&shape);
  Box box = polygon ? bounding_box(*polygon) : box_of(std::get<MeshSpec>(shape).mesh.nodes);
  if (const JsonValue* v = value.find("position")) {
    const Vec2 p = in_.vec2(*v, "m");
    box = Box{p.x(), p.y(), p.x(), p.y()}.grown(box.extent());
  }
  return box;
}

void BodyReader::rigid_body(const JsonValue& value, const Polygon& polygon,
                            const PotentialSource& potential) {
  JsonObject object(in_, value);
  RigidBody body;
  name_and_material(object, body.name, body.material);
  rigid_pointers_.push_back(value.pointer());
  numbers_.push_back(static_cast<int>(model_.bodies.size()));
  features_.add(Feature::rigid_body, &value, place());
  object.required("polygon", "");
  object.optional("holes");
  if (const JsonValue* v = object.optional("materials")) {
    features_.add(Feature::element_materials, v, place());
  }
  give_shape(value, polygon, potential, body);
  if (const JsonValue* v = object.optional("position")) {
    body.position = in_.vec2(*v, "m") - model_.origin;
  }
  object.read("angle", body.angle, &JsonReader::number, "rad");
  if (const JsonValue* v = object.optional("motion")) {
    body.motion = motion(*v);
    if (body.motion == Motion::prescribed) prescribed_motion(*v, body);
  }
  if (const JsonValue* v = object.optional("fix")) held_coordinates(*v, body);
  initial_velocity(object, body.velocity, body.spin);
  refuse_held_velocity(value, body);
  object.finish();
  model_.bodies.push_back(std::move(body));
}

// Potential, mass and inertia. A polygon for which the area potential is not defined is left
// without them, because the scene is refused as soon as all of it has been read.
void BodyReader::give_shape(const JsonValue& value, const Polygon& polygon,
                            const PotentialSource& potential, RigidBody& body) {
  const JsonValue& outline = *value.find("polygon");
  if (polygon.size() > 3) {
    const bool ring = outline.type() == JsonValue::Type::array && outline.items().size() > 3;
    features_.add(Feature::polygon_beyond_triangle, ring ? &outline.items()[3] : &outline, place());
    if (features_.uses(Feature::area_potential)) return;
  }
  try {
    set_shape(body, polygon, potential(), model_);
  } catch (const InvalidPolygon& error) {
    refuse_polygon(in_, outline, error, value.find("holes"));
  }
  if (!(body.mass > 0 && body.inertia > 0 && std::isfinite(1 / body.mass) &&
        std::isfinite(1 / body.inertia) && std::isfinite(body.potential.steepest))) {
    in_.fail(value,
             fmt::format("has a mass of {:g} kg and an inertia of {:g} kg m^2, out of the range "
                         "of double precision; check density, thickness and size",
                         body.mass, body.inertia));
  }
}

void BodyReader::deformable_body(const JsonValue& value, MeshSpec spec) {
  JsonObject object(in_, value);
  DeformableBody body;
  name_and_material(object, body.name, body.material);
  numbers_.push_back(-1 - static_cast<int>(model_.deformables.size()));
  require_elastic(*value.find("material"), body.material);
  features_.add(Feature::body_with_mesh, &object.required("mesh", ""), place());
  body.element = spec.element;
  body.mesh = std::move(spec.mesh);
  place_mesh(object, body.mesh);
  reorder_along_curve(body.mesh);
  if (const JsonValue* v = object.optional("materials")) element_materials(*v, body);
  body.first_node = model_.node_count();
  if (const JsonValue* v = object.optional("supports")) read_supports(in_, *v, model_, body);
  if (const JsonValue* v = object.optional("loads")) read_loads(in_, *v, model_, body);
  initial_velocity(object, body.velocity, body.spin);
  if (const JsonValue* v = object.optional("motion")) motion(*v);
  object.finish();
  model_.deformables.push_back(std::move(body));
}

// Moves the mesh so that its centroid is at "position", and turns it about it by "angle".
void BodyReader::place_mesh(JsonObject& object, Mesh& mesh) const {
  const JsonValue* position = object.optional("position");
  const JsonValue* angle = object.optional("angle");
  for (Vec2& x : mesh.nodes) x -= model_.origin;
  if (!position && !angle) return;
  const Vec2 centre = mesh_centroid(mesh);
  const Vec2 goal = position ? Vec2(in_.vec2(*position, "m") - model_.origin) : centre;
  const double a = angle ? in_.number(*angle, "rad") : 0;
  for (Vec2& x : mesh.nodes) x = goal + turned(x - centre, a);
}

void BodyReader::name_and_material(JsonObject& object, std::string& name, MaterialIndex& material) {
  const JsonValue& name_value = object.required("name", "a string, unique among the bodies");
  name = in_.string(name_value);
  refuse_as_column(in_, name_value);
  if (!known_names_.insert(name).second) {
    in_.fail(
        name_value,
        fmt::format("\"{}\" is already the name of another body; give each body its own", name));
  }
  names_.push_back(name);
  material = this->material(object.required("material", "the name of a material"));
}

MaterialIndex BodyReader::material(const JsonValue& name) const {
  const std::string& wanted = in_.string(name);
  const auto found = std::ranges::find(model_.materials, wanted, &Material::name);
  if (found == model_.materials.end()) {
    in_.fail(name, "unknown material " + suggest(wanted, names_of(model_.materials)));
  }
  return static_cast<MaterialIndex>(found - model_.materials.begin());
}

// `name` is the value in the scene that gives elements this material.
void BodyReader::require_elastic(const JsonValue& name, MaterialIndex material) const {
  const Material& m = model_.materials[material];
  if (m.elastic.young > 0 && materials_.items()[material].find("poisson")) return;
  in_.fail(name, fmt::format("a body with a mesh needs \"young\" (Pa) and \"poisson\" of material "
                             "\"{}\"",
                             m.name));
}

// Materials of the groups of elements that have another one than their body.
void BodyReader::element_materials(const JsonValue& value, DeformableBody& body) const {
  if (value.type() != JsonValue::Type::object || value.items().empty()) {
    in_.fail(value, "must be {\"GROUP\": \"MATERIAL\", ...} with groups of the mesh");
  }
  std::vector<std::string> known;
  for (const MeshGroup& group : body.mesh.groups) {
    if (!group.elements.empty()) known.push_back(group.name);
  }
  const std::vector<std::string>& groups = value.keys();
  body.element_material.assign(static_cast<size_t>(body.mesh.element_count()), body.material);
  std::vector<int> taken(body.element_material.size(), -1);  // by which of the groups
  for (size_t i = 0; i < groups.size(); ++i) {
    const JsonValue& name = value.items()[i];
    if (std::ranges::find(known, groups[i]) == known.end()) {
      in_.fail(name, known.empty()
                         ? "the mesh has no groups of elements: those are the physical "
                           "surfaces of a file of gmsh"
                         : "the mesh has no group of elements " + suggest(groups[i], known));
    }
    const MaterialIndex chosen = material(name);
    require_elastic(name, chosen);
    const auto group = std::ranges::find_if(
        body.mesh.groups, [&](const MeshGroup& g) { return g.name == groups[i]; });
    for (const int e : group->elements) {
      MaterialIndex& of_element = body.element_material[e];
      if (taken[e] >= 0 && of_element != chosen) {
        in_.fail(name, fmt::format("\"{}\" and \"{}\" share elements; give them one material, or "
                                   "divide the mesh into groups that do not overlap",
                                   groups[taken[e]], groups[i]));
      }
      taken[e] = static_cast<int>(i);
      of_element = chosen;
    }
  }
  if (body.materials() == std::vector{body.material}) body.element_material.clear();
}

Motion BodyReader::motion(const JsonValue& value) {
  if (value.type() == JsonValue::Type::string) {
    if (in_.choice(value, {"free", "fixed"}) == 0) return Motion::free;
    features_.add(Feature::fixed_motion, &value, place());
    return Motion::fixed;
  }
  if (value.type() != JsonValue::Type::object) {
    in_.fail(value,
             "must be \"free\", \"fixed\", {\"velocity\": [[t,vx,vy],...], \"spin\": "
             "[[t,w],...], \"pivot\": [x,y]} or {\"servo\": {...}}");
  }
  features_.add(Feature::prescribed_motion, &value, place());
  return Motion::prescribed;
}

void BodyReader::servo(const JsonValue& value, RigidBody& body) const {
  JsonObject object(in_, value);
  Servo servo{};
  const JsonValue& direction = object.required("direction", "[x, y], in which the wall pushes");
  servo.direction = in_.vec2(direction, "");
  if (!(servo.direction.norm() > 0)) in_.fail(direction, "must not be zero");
  servo.direction /= servo.direction.norm();
  const JsonValue* force = object.optional("force");
  const JsonValue* stress = object.optional("stress");
  if (!force == !stress) in_.fail(value, "must give either \"force\" (N) or \"stress\" (Pa)");
  if (force) {
    servo.force = in_.positive(*force, "N");
  } else {
    const double length =
        in_.positive(object.required("length", "on which the stress acts, m"), "m");
    servo.force = in_.positive(*stress, "Pa") * length * model_.thickness;
  }
  servo.speed = in_.positive(object.required("speed", "the highest one, m/s"), "m/s");
  if (const JsonValue* v = object.optional("history")) servo.history = read_load_history(in_, *v);
  object.finish();
  body.servo = servo;
}

void BodyReader::prescribed_motion(const JsonValue& value, RigidBody& body) {
  JsonObject object(in_, value);
  if (const JsonValue* v = object.optional("servo")) {
    features_.add(Feature::servo, v, place());
    servo(*v, body);
    object.finish();
    return;
  }
  MotionHistory& history = body.history;
  if (const JsonValue* v = object.optional("velocity")) history.velocity = read_velocities(in_, *v);
  if (const JsonValue* v = object.optional("spin")) history.spin = read_spins(in_, *v);
  const JsonValue* pivot = object.optional("pivot");
  object.finish();
  if (history.velocity.empty() && history.spin.empty()) {
    in_.fail(value,
             "must give a velocity or a spin history with at least one row; for a body at rest use "
             "\"fixed\"");
  }
  if (pivot) {
    if (history.spin.empty()) in_.fail(*pivot, kPivotAtRest);
    const Vec2 arm = in_.vec2(*pivot, "m") - model_.origin - body.position;
    body.pivot = turned(arm, -body.angle);
  }
}

void BodyReader::held_coordinates(const JsonValue& value, RigidBody& body) {
  features_.add(Feature::held_coordinates, &value, place());
  for (const JsonValue& coordinate : in_.array(value)) {
    body.held[in_.choice(coordinate, {"x", "y", "angle"})] = true;
  }
}

void BodyReader::initial_velocity(JsonObject& object, Vec2& velocity, double& spin) {
  if (const JsonValue* v = object.optional("velocity")) {
    features_.add(Feature::initial_velocity, v, place());
    velocity = in_.vec2(*v, "m/s");
  }
  if (const JsonValue* v = object.optional("spin")) {
    features_.add(Feature::initial_velocity, v, place());
    spin = in_.number(*v, "rad/s");
  }
}

void BodyReader::refuse_held_velocity(const JsonValue& value, const RigidBody& body) const {
  constexpr const char* kHeldVelocity =
      "must be 0 in a direction that \"fix\" holds; leave it out or take the direction from "
      "\"fix\"";
  for (int k = 0; k < 2; ++k) {
    if (body.held[k] && body.velocity[k] != 0) {
      in_.fail(value.find("velocity")->items()[k], kHeldVelocity);
    }
  }
  if (body.held[2] && body.spin != 0) in_.fail(*value.find("spin"), kHeldVelocity);
}

}  // namespace apothem
