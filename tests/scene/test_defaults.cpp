// The defaults that the JSON Schema publishes are those that the reader takes.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "lib/scene/scene.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using test::Folder;
using Json = nlohmann::json;

namespace {

const Json kMaterials = {{"rock", {{"density", 2000}, {"young", 20e9}, {"poisson", 0.2}}}};

Json scene_with(const char* key, const Json& value) {
  return {{"materials", kMaterials},
          {"contact", {{"normal_stiffness", 1e9}}},
          {"time", {{"end", 1}}},
          {key, value}};
}

// A triangle that falls, for what any scene may say.
Json rigid() {
  return scene_with(
      "bodies",
      {{{"name", "stone"}, {"material", "rock"}, {"polygon", {{0, 0}, {1, 0}, {0.5, 1}}}}});
}

Json with(Json scene, const char* pointer, const Json& value) {
  scene[Json::json_pointer(pointer)] = value;
  return scene;
}

Json meshed(const Json& mesh) {
  return scene_with("bodies", {{{"name", "block"}, {"material", "rock"}, {"mesh", mesh}}});
}
Json rectangle() { return meshed({{"rectangle", {{"size", {2, 1}}, {"cells", {2, 1}}}}}); }

Json filled(const Json& shape) {
  const Json region = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  return scene_with("fill", {{{"name", "stone"},
                              {"material", "rock"},
                              {"region", region},
                              {"shapes", Json::array({shape, {{"cross", Json::object()}}})},
                              {"diameter", 0.5},
                              {"count", 6}}});
}
Json with_random_polygons() { return filled({{"polygon_random", {{"corners", 7}}}}); }

Json imported(const char* file = "square.wkt") {
  return scene_with("import", {{{"file", file}, {"material", "rock"}}});
}
// Open lines are no outlines: this drawing is refused unless its faces become bodies.
const char* const kOpenLines = "lines.wkt";
// And this one unless the inner outline is a hole.
const char* const kNested = "nested.wkt";

// All that the defaults decide, as text.
std::string digest(const Scene& s) {
  std::string text;
  const auto add = [&](const auto&... values) { ((text += fmt::format("{} ", values)), ...); };
  const auto add2 = [&](const Vec2& v) { add(v.x(), v.y()); };
  const Model& m = s.model;
  add2(m.gravity);
  add(m.thickness);
  for (const Material& material : m.materials) {
    add(int(material.elastic.law), int(material.elastic.plane));
  }
  const ContactLaw& law = m.contact;
  add(int(law.potential.kind), int(law.potential.field), int(law.potential.reference));
  add(int(law.friction_law), int(law.surface), law.self, law.accepts_overlaps, law.damping.bulk,
      law.friction.stiffness_ratio, law.penetration_warning);
  for (const RigidBody& body : m.bodies) {
    add(int(body.motion), body.angle, body.spin);
    add2(m.origin + body.position);
    add2(body.velocity);
    for (const Vec2& v : body.potential.vertices) add2(v);
  }
  for (const DeformableBody& body : m.deformables) {
    add(int(body.element), body.spin);
    add2(body.velocity);
    for (const Vec2& node : body.mesh.nodes) add2(m.origin + node);
  }
  for (const Inflow& inflow : m.inflows) add(inflow.every);
  for (const StopRule& rule : s.stops) add(rule.hold, rule.after);
  for (const Expectation& e : s.expectations) add(int(e.take));
  const TimeSettings& t = s.time;
  add(t.statics, t.load_steps, t.tolerance, t.fixed_step.value_or(0), t.settled, t.accuracy,
      t.onsets, static_cast<int>(t.scheme));
  add(s.rigid, t.automatic_load_steps);
  add(s.output.frames, s.output.checkpoint_interval.value_or(0), int(s.frame_format));
  return text;
}

// A default of the schema: a scene without the key, the place of the key, and another value that
// must make a difference (null: there is no other value).
struct Default {
  const char* schema;
  Json scene;
  const char* place;
  Json other;
};

std::vector<Default> rigid_defaults() {
  const Json friction = with(rigid(), "/contact/friction", {{"coefficient", 0.5}});
  const Json damping = with(rigid(), "/contact/damping", {{"model", "viscous"}, {"ratio", 0.2}});
  const Json stop = with(rigid(), "/stop", {{{"name", "end"}, {"count_below", 1}}});
  const Json expect =
      with(rigid(), "/expect", {{{"quantity", "kinetic"}, {"value", 1}, {"tolerance", 1}}});
  return {
      {"/properties/gravity", rigid(), "/gravity", {0, -9.81}},
      {"/properties/thickness", rigid(), "/thickness", 2},
      {"/properties/contact/properties/potential", rigid(), "/contact/potential", "area"},
      {"/properties/contact/properties/field", rigid(), "/contact/field", "distance"},
      {"/properties/contact/properties/reference", rigid(), "/contact/reference",
       "inscribed_circle"},
      {"/properties/contact/properties/overlaps", rigid(), "/contact/overlaps", "accept"},
      {"/properties/contact/properties/friction/properties/stiffness_ratio", friction,
       "/contact/friction/stiffness_ratio", 0.6},
      {"/properties/contact/properties/friction/properties/law", friction, "/contact/friction/law",
       "per_edge"},
      {"/properties/contact/properties/penetration_warning", rigid(),
       "/contact/penetration_warning", 0.1},
      {"/definitions/damping/properties/bulk", damping, "/contact/damping/bulk", 0.2},
      {"/properties/stop/items/properties/for", stop, "/stop/0/for", 1},
      {"/properties/stop/items/properties/after", stop, "/stop/0/after", 1},
      {"/definitions/take", expect, "/expect/0/take", "max"},
      {"/definitions/rigid_body/properties/angle", rigid(), "/bodies/0/angle", 0.1},
      {"/definitions/rigid_body/properties/motion", rigid(), "/bodies/0/motion", "fixed"},
      {"/definitions/rigid_body/properties/velocity", rigid(), "/bodies/0/velocity", {1, 0}},
      {"/definitions/rigid_body/properties/spin", rigid(), "/bodies/0/spin", 1},
  };
}

std::vector<Default> settings_defaults() {
  const Json statics = with(rectangle(), "/time/mode", "static");
  return {
      {"/properties/time/properties/mode", rectangle(), "/time/mode", "static"},
      {"/properties/contact/properties/rigid", with(rigid(), "/time/mode", "static"),
       "/contact/rigid", true},
      {"/properties/time/properties/load_steps", statics, "/time/load_steps", 5},
      {"/properties/time/properties/tolerance", statics, "/time/tolerance", 1e-5},
      {"/properties/time/properties/scheme", rigid(), "/time/scheme", "auto"},
      {"/properties/time/properties/step", rigid(), "/time/step", 1e-5},
      {"/properties/time/properties/start", rigid(), "/time/start", "settled"},
      {"/properties/time/properties/accuracy", rigid(), "/time/accuracy", 1e-3},
      {"/properties/time/properties/onsets", rigid(), "/time/onsets", "plain"},
      {"/properties/output/properties/frames", rigid(), "/output/frames", 7},
      {"/properties/output/properties/format", rigid(), "/output/format", "xdmf"},
      {"/properties/output/properties/checkpoint", rigid(), "/output/checkpoint", false},
  };
}

std::vector<Default> meshed_defaults() {
  const Json disc = meshed({{"disc", {{"radius", 1}, {"cells", 4}}}});
  const Json half = meshed({{"half_disc", {{"radius", 1}, {"fine", 0.2}, {"cells", 4}}}});
  const Json voronoi = meshed({{"voronoi", {{"size", {2, 1}}, {"cells", 12}}}});
  const Json notched = meshed({{"voronoi",
                                {{"polygon", {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}},
                                 {"cells", 4},
                                 {"lloyd", 0}}}});
  return {
      {"/properties/materials/additionalProperties/properties/plane", rectangle(),
       "/materials/rock/plane", "strain"},
      {"/properties/materials/additionalProperties/properties/law", rectangle(),
       "/materials/rock/law", "neo_hookean"},
      {"/properties/contact/properties/surface", rectangle(), "/contact/surface", "element"},
      {"/properties/contact/properties/self_contact", rectangle(), "/contact/self_contact",
       "compute"},
      {"/definitions/mesh/properties/rectangle/properties/origin",
       rectangle(),
       "/bodies/0/mesh/rectangle/origin",
       {1, 0}},
      {"/definitions/mesh/properties/disc/properties/centre",
       disc,
       "/bodies/0/mesh/disc/centre",
       {1, 0}},
      {"/definitions/mesh/properties/disc/properties/grading", disc, "/bodies/0/mesh/disc/grading",
       2},
      {"/definitions/mesh/properties/half_disc/properties/pole",
       half,
       "/bodies/0/mesh/half_disc/pole",
       {1, 0}},
      {"/definitions/mesh/properties/half_disc/properties/growth", half,
       "/bodies/0/mesh/half_disc/growth", 1.3},
      {"/definitions/mesh/properties/voronoi/properties/origin",
       voronoi,
       "/bodies/0/mesh/voronoi/origin",
       {1, 0}},
      {"/definitions/mesh/properties/voronoi/properties/seed", voronoi,
       "/bodies/0/mesh/voronoi/seed", 2},
      {"/definitions/mesh/properties/voronoi/properties/lloyd", voronoi,
       "/bodies/0/mesh/voronoi/lloyd", 3},
      {"/definitions/mesh/properties/voronoi/properties/shortest_edge",
       with(voronoi, "/bodies/0/mesh/voronoi/lloyd", 0), "/bodies/0/mesh/voronoi/shortest_edge",
       0.3},
      {"/definitions/mesh/properties/voronoi/properties/convex", notched,
       "/bodies/0/mesh/voronoi/convex", true},
      {"/definitions/mesh/properties/voronoi/properties/smallest_angle",
       with(voronoi, "/bodies/0/mesh/voronoi/lloyd", 0), "/bodies/0/mesh/voronoi/smallest_angle",
       1.0},
      {"/definitions/deformable_body/properties/angle", rectangle(), "/bodies/0/angle", 0.1},
      {"/definitions/deformable_body/properties/motion", rectangle(), "/bodies/0/motion", nullptr},
      {"/definitions/deformable_body/properties/velocity",
       rectangle(),
       "/bodies/0/velocity",
       {1, 0}},
      {"/definitions/deformable_body/properties/spin", rectangle(), "/bodies/0/spin", 1},
  };
}

std::vector<Default> population_defaults() {
  const Json polygons = with_random_polygons();
  const Json quads = filled({{"quadrilateral", Json::object()}});
  const Json meshes = with(quads, "/fill/0/mesh", {{"size", 0.2}});
  const Json batches = with(quads, "/fill/0/repeat", {{"times", 2}});
  const Json cells =
      scene_with("fill", {{{"name", "stone"},
                           {"material", "rock"},
                           {"region", {{0, 0}, {4, 0}, {4, 4}, {0, 4}}},
                           {"holes", Json::array({{{1, 1}, {2.9, 1.2}, {2.7, 3.1}, {1.2, 2.8}}})},
                           {"arrangement", "voronoi"},
                           {"count", 12}}});
  return {
      {"/definitions/fill/properties/convex", cells, "/fill/0/convex", true},
      {"/definitions/fill/properties/smallest_angle", with(cells, "/fill/0/convex", true),
       "/fill/0/smallest_angle", 0.9},
      {"/definitions/shape/properties/quadrilateral/properties/angles",
       quads,
       "/fill/0/shapes/0/quadrilateral/angles",
       {1.4, 1.8}},
      {"/definitions/shape/properties/polygon_random/properties/aspect", polygons,
       "/fill/0/shapes/0/polygon_random/aspect", 2},
      {"/definitions/shape/properties/polygon_random/properties/roundness", polygons,
       "/fill/0/shapes/0/polygon_random/roundness", 1},
      {"/definitions/shape/properties/cross/properties/arm", quads, "/fill/0/shapes/1/cross/arm",
       2},
      {"/definitions/shape/properties/weight", quads, "/fill/0/shapes/0/weight", 100},
      {"/definitions/fill/properties/arrangement", quads, "/fill/0/arrangement", "lattice"},
      {"/definitions/fill/properties/gap", quads, "/fill/0/gap", 0.3},
      {"/definitions/fill/properties/seed", quads, "/fill/0/seed", 2},
      {"/definitions/fill/properties/angle", quads, "/fill/0/angle", 0.5},
      {"/definitions/fill/properties/velocity", quads, "/fill/0/velocity", {1, 0}},
      {"/definitions/fill/properties/spin", quads, "/fill/0/spin", 1},
      {"/definitions/fill/properties/mesh/properties/element", meshes, "/fill/0/mesh/element",
       "T3"},
      {"/definitions/fill/properties/repeat/properties/every", batches, "/fill/0/repeat/every", 1},
      {"/definitions/import/properties/offset", imported(), "/import/0/offset", {1, 0}},
      {"/definitions/import/properties/repair", imported(), "/import/0/repair", nullptr},
      {"/definitions/import/properties/faults", imported(), "/import/0/faults", nullptr},
      {"/definitions/import/properties/lines", imported(kOpenLines), "/import/0/lines",
       "polygonize"},
      {"/definitions/import/properties/holes", imported(kNested), "/import/0/holes", "nested"},
  };
}

std::vector<Default> all_defaults() {
  std::vector<Default> all = rigid_defaults();
  for (const auto& more : {settings_defaults(), meshed_defaults(), population_defaults()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

// JSON pointers of all parts of the schema that publish a default.
void find_defaults(const Json& node, const std::string& pointer, std::set<std::string>& found) {
  if (node.is_object() && node.contains("default")) found.insert(pointer);
  if (!node.is_structured()) return;
  for (const auto& [key, value] : node.items()) find_defaults(value, pointer + "/" + key, found);
}

}  // namespace

TEST_CASE("the defaults of the JSON Schema are those of the reader", "[scene][slow]") {
  const Json schema = Json::parse(std::ifstream(test::kSource + "/docs/scene.schema.json"));
  std::set<std::string> published, tested;
  find_defaults(schema, "", published);
  const Folder folder;
  folder.write("square.wkt", "POLYGON((0 0, 1 0, 1 1, 0 1, 0 0))\n");
  folder.write(kOpenLines, "LINESTRING(0 0, 1 0, 1 1)\nLINESTRING(1 1, 0 1, 0 0)\n");
  folder.write(kNested, "POLYGON((0 0, 4 0, 4 4, 0 4))\nPOLYGON((1 1, 2 1, 2 2, 1 2))\n");
  const auto read = [&](const Json& scene) -> std::string {
    const std::string file = folder.write("scene.json", scene.dump());
    try {
      return digest(read_scene(file));
    } catch (const SceneError& error) {
      return std::string("refused: ") + error.what();
    }
  };
  for (const Default& d : all_defaults()) {
    INFO(d.schema);
    tested.insert(d.schema);
    REQUIRE_FALSE(d.scene.contains(Json::json_pointer(d.place)));
    const std::string without = read(d.scene);
    INFO(without);
    const bool is_refused = d.scene == imported(kOpenLines) || d.scene == imported(kNested);
    CHECK(without.starts_with("refused") == is_refused);
    const Json value = schema.at(Json::json_pointer(std::string(d.schema) + "/default"));
    CHECK(read(with(d.scene, d.place, value)) == without);
    if (d.other.is_null()) continue;
    const std::string other = read(with(d.scene, d.place, d.other));
    CHECK(other != without);
    CHECK_FALSE(other.starts_with("refused"));
  }
  CHECK(tested == published);
}
