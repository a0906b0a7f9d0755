#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "lib/mesh/locate.hpp"
#include "lib/scene/scene.hpp"
#include "lib/text/file.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using test::Folder;
using Json = nlohmann::json;

namespace {

const char* const kGood = R"({
  "name": "good", // a comment
  "gravity": [0, -9.81],
  "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2, "plane": "stress" } },
  "contact": { "potential": "distance", "normal_stiffness": 20e9, "reference": "roof" },
  "bodies": [
    { "name": "target", "material": "rock", "motion": "fixed",
      "polygon": [[-1, -1], [1, -1], [1, 0], [-1, 0]] },
    { "name": "falling", "material": "rock", "velocity": [0, -1], "spin": 0.5,
      "polygon": [[0, 0.1], [0.5, 0.9], [-0.5, 0.9]] }
  ],
  "time": { "end": 1.0, "step": "auto", "safety": 0.1 },
  "output": { "frames": 10, "history": { "interval": 1e-3, "track": [ { "body": "falling" } ] } },
  "expect": [ { "quantity": "falling.y", "take": "max", "between": [0, 1], "value": 1, "tolerance": 1 } ]
})";

const char* const kImport = R"({
  "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
  "contact": { "normal_stiffness": 20e9 },
  "import": [ { "file": "wall.dxf", "scale": 0.001, "offset": [0, 1], "material": "rock", "tolerance": 1e-3,
                "layers": { "ground": { "motion": "fixed" }, "notes": false },
                "mesh": { "size": 0.1, "element": "Q4" } } ],
  "time": { "end": 1.0 }
})";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

std::string error_of_file(const std::string& file) {
  try {
    read_scene(file);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

struct Broken {
  const char* what;     // in the good scene
  const char* by;       // instead
  const char* place;    // line:pointer that the message must name
  const char* message;  // and what it must say
  bool schema = true;   // whether the JSON Schema refuses it as well
};

const std::vector<Broken> kBroken{
    {"\"gravity\"", "\"gravty\"", ":3: /gravty", "did you mean \"gravity\""},
    {"\"density\"", "\"densty\"", ":4: /materials/rock/densty", "did you mean \"density\""},
    {"\"potential\"", "\"fricton\"", ":5: /contact/fricton", "did you mean \"friction\""},
    {"\"motion\"", "\"moton\"", ":7: /bodies/0/moton", "did you mean \"motion\""},
    {"\"safety\"", "\"safty\"", ":12: /time/safty", "did you mean \"safety\""},
    {"\"frames\"", "\"frame\"", ":13: /output/frame", "did you mean \"frames\""},
    {"\"interval\"", "\"intervall\"", ":13: /output/history/intervall",
     "did you mean \"interval\""},
    {"\"take\"", "\"takes\"", ":14: /expect/0/takes", "did you mean \"take\""},
    {"2000", "-2000", ":4: /materials/rock/density", "must be positive (in kg/m^3), not -2000"},
    {"2000", "0", ":4: /materials/rock/density", "must be positive"},
    {"2000", "NaN", ":4: ", "not valid JSON"},
    {"2000", "1e999", ":4: ", "out of the range", false},
    {"2000", "\"2000 kg/m3\"", ":4: /materials/rock/density",
     "must be a number in kg/m^3, not a string"},
    {"\"density\": 2000, ", "", ":4: /materials/rock", "missing key \"density\""},
    {"20e9, \"poisson\"", "-1, \"poisson\"", ":4: /materials/rock/young", "must be positive"},
    {"0.2, \"plane\"", "0.5, \"plane\"", ":4: /materials/rock/poisson", "between -1 and 0.5"},
    {"\"stress\"", "\"stres\"", ":4: /materials/rock/plane", "did you mean \"stress\""},
    {"[0, -9.81]", "-9.81", ":3: /gravity", "must be [x, y] in m/s^2"},
    {"[0, -9.81]", "[0, -9.81, 0]", ":3: /gravity", "must be [x, y]"},
    {"[0, -9.81]", "[0, null]", ":3: /gravity/1", "must be a number, not null"},
    {"\"good\"", "\"../good\"", ":2: /name", "name of a folder"},
    {"\"distance\"", "\"distanse\"", ":5: /contact/potential", "did you mean \"distance\""},
    {"\"normal_stiffness\": 20e9, ", "", ":5: /contact", "missing key \"normal_stiffness\""},
    {"\"normal_stiffness\": 20e9", "\"normal_stiffness\": -1", ":5: /contact/normal_stiffness",
     "must be positive (in Pa)"},
    {"\"roof\"", "\"floor\"", ":5: /contact/reference",
     "unknown choice \"floor\" (known: roof, inscribed_circle)"},
    {"\"roof\"", "-0.1", ":5: /contact/reference", "must be positive (in m)"},
    {"\"roof\"", "1e-320", ":5: /contact/reference", "too small", false},
    {"\"distance\"", "\"area\"", ":5: /contact/reference", "no reference length", false},
    {"\"reference\": \"roof\"", "\"field\": \"distanse\"", ":5: /contact/field",
     "did you mean \"distance\""},
    {"\"distance\", \"normal_stiffness\": 20e9, \"reference\": \"roof\"",
     "\"area\", \"normal_stiffness\": 20e9, \"field\": \"roof\"", ":5: /contact/field",
     "one field only", false},
    {"\"potential\": \"distance\", \"normal_stiffness\": 20e9, \"reference\": \"roof\"",
     "\"potential\": \"area\", \"normal_stiffness\": 1", ":8: /bodies/0/polygon/3",
     "triangles only", false},
    {"\"reference\": \"roof\"",
     "\"friction\": { \"coefficient\": -1, \"tangential_stiffness\": 1 }",
     ":5: /contact/friction/coefficient", "must be 0 or more"},
    {"\"reference\": \"roof\"",
     "\"friction\": { \"coefficient\": 0.5, \"tangential_stiffness\": 0 }",
     ":5: /contact/friction/tangential_stiffness", "must be positive (in Pa)"},
    {"\"reference\": \"roof\"", "\"surface\": \"elements\"", ":5: /contact/surface",
     "did you mean \"element\""},
    {"\"reference\": \"roof\"", "\"distribution\": \"sum\"", ":5: /contact/distribution",
     "unknown choice \"sum\" (known: variational, resultant, integrated)"},
    {"\"reference\": \"roof\"", "\"distribution\": \"resultant\"", ":5: /contact/distribution",
     "\"resultant\" needs \"surface\": \"element\"", false},
    {"\"reference\": \"roof\"", "\"surface\": \"element\", \"distribution\": \"variational\"",
     ":5: /contact/distribution", "\"variational\" needs \"surface\": \"body\"", false},
    {"\"reference\": \"roof\"", "\"damping\": { \"model\": \"sticky\" }",
     ":5: /contact/damping/model", "unknown choice"},
    {"\"reference\": \"roof\"", "\"damping\": { \"model\": \"mass\", \"ratio\": 1 }",
     ":5: /contact/damping", "\"rate\"", false},
    {"\"reference\": \"roof\"",
     "\"pairs\": [{ \"between\": [\"rock\", \"moon\"], \"friction\": { \"coefficient\": 0 } }]",
     ":5: /contact/pairs/0/between/1", "neither a body nor a material", false},
    {"\"name\": \"falling\"", "\"name\": \"target\"", ":9: /bodies/1/name",
     "already the name of another body", false},
    {"\"name\": \"falling\"", "\"name\": \"fall,ing\"", ":9: /bodies/1/name", "must not be empty"},
    {"\"name\": \"falling\", ", "", ":9: /bodies/1", "missing key \"name\""},
    {"\"material\": \"rock\", \"velocity\"", "\"material\": \"rok\", \"velocity\"",
     ":9: /bodies/1/material", "did you mean \"rock\"", false},
    {"[0.5, 0.9], [-0.5, 0.9]]", "[0.5, 0.9]]", ":10: /bodies/1/polygon/1", "needs at least 3"},
    {"[1, -1], [1, 0], [-1, 0]]", "[1, 0], [1, -1], [-1, 0]]", ":8: /bodies/0/polygon/2",
     "edge 0 and edge 2 cross or touch", false},
    {"[1, -1], [1, 0], [-1, 0]]", "[1, -1], [0, 2], [1, -1]]", ":8: /bodies/0/polygon/3",
     "vertex 3 repeats vertex 1", false},
    {"[1, -1], [1, 0], [-1, 0]]", "[1, -1], [0, -1], [-1, 0]]", ":8: /bodies/0/polygon/1", "spike",
     false},
    {"[1, 0], [-1, 0]]", "[1, 0], [-1]]", ":8: /bodies/0/polygon/3", "must be [x, y] in m"},
    {"[1, 0], [-1, 0]]", "[1, 0], [-1, 1e300]]", ":8: /bodies/0/polygon/3", "beyond 1e60", false},
    {"\"polygon\": [[-1, -1], [1, -1], [1, 0], [-1, 0]]", "\"polygon\": \"missing.wkt\"",
     ":8: /bodies/0/polygon", "cannot be opened", false},
    {"\"polygon\": [[-1, -1], [1, -1], [1, 0], [-1, 0]]", "\"polygon\": { }",
     ":8: /bodies/0/polygon", "must be an array"},
    {"\"motion\": \"fixed\"", "\"motion\": \"fixed\", \"velocity\": [1, 0]",
     ":7: /bodies/0/velocity", "a fixed body has no initial velocity", false},
    {"\"motion\": \"fixed\"", "\"motion\": \"fixed\", \"spin\": 1", ":7: /bodies/0/spin",
     "a fixed body has no initial velocity", false},
    {"\"motion\": \"fixed\"", "\"motion\": \"fix\"", ":7: /bodies/0/motion", "unknown choice"},
    {"\"motion\": \"fixed\"", "\"motion\": { \"velocity\": [] }", ":7: /bodies/0/motion",
     "at least one row", false},
    {"\"motion\": \"fixed\"", "\"motion\": { \"velocity\": [[1, 0, 0], [0, 0, 0]] }",
     ":7: /bodies/0/motion/velocity/1", "times must increase", false},
    {"\"motion\": \"fixed\"", "\"motion\": { \"velocity\": [[0, 1, 0]], \"pivot\": [0, 0] }",
     ":7: /bodies/0/motion/pivot", "nothing turns about it"},
    {"\"motion\": \"fixed\"", "\"motion\": { \"spin\": [[0, 1]], \"pivot\": 0 }",
     ":7: /bodies/0/motion/pivot", "must be [x, y] in m"},
    {"\"motion\": \"fixed\"", "\"materials\": { \"core\": \"rock\" }", ":7: /bodies/0/materials",
     "a polygon has no groups of elements"},
    {"\"motion\": \"fixed\"", "\"fix\": [\"z\"]", ":7: /bodies/0/fix/0", "unknown choice"},
    {"\"velocity\": [0, -1]", "\"fix\": [\"y\"], \"velocity\": [0, -1]", ":9: /bodies/1/velocity/1",
     "must be 0", false},
    {"\"end\": 1.0", "\"end\": 0", ":12: /time/end", "must be positive"},
    {"\"end\": 1.0, ", "", ":12: /time", "missing key \"end\""},
    {"\"auto\"", "\"automatic\"", ":12: /time/step", "unknown choice"},
    {"\"auto\"", "-1e-5", ":12: /time/step", "must be positive"},
    {"\"auto\"", "1e-5", ":12: /time/safety", "automatic step only", false},
    {"\"auto\", \"safety\": 0.1", "2", ":12: /time/step", "longer than the whole run", false},
    {"\"safety\": 0.1", "\"safety\": 1.5", ":12: /time/safety", "must not exceed 0.8"},
    {"\"frames\": 10", "\"frames\": -1", ":13: /output/frames", "whole number"},
    {"\"frames\": 10", "\"frames\": 1.5", ":13: /output/frames", "whole number"},
    {"{ \"body\": \"falling\" }", "{ \"body\": \"fallin\" }", ":13: /output/history/track/0/body",
     "did you mean \"falling\"", false},
    {"{ \"body\": \"falling\" }", "{ \"body\": \"falling\", \"surface\": \"contact\" }",
     ":13: /output/history/track/0/surface", "bodies with a mesh", false},
    {"{ \"body\": \"falling\" }", "\"falling\"", ":13: /output/history/track/0",
     "must be an object"},
    {"\"falling.y\"", "\"falling.z\"", ":14: /expect/0/quantity", "no history has a column", false},
    {"\"tolerance\": 1 ", "\"tolerance\": 1, \"relative\": 1 ", ":14: /expect/0", "either"},
    {"[0, 1], \"value\"", "[5, 6], \"value\"", ":14: /expect/0/between", "outside the run", false},
    {"2000", "1e-320", ":7: /bodies/0", "range of double precision", false},
    {"[0, 1], \"value\"", "[1, 0], \"value\"", ":14: /expect/0/between", "before it starts", false},
    {"\"gravity\": [0, -9.81],", "\"gravity\": [0, -9.81], \"gravity\": [0, 0],", ":3: /gravity",
     "duplicate key, first given in line 3", false},
    {"\"gravity\": [0, -9.81],", "\"gravity\": [0, -9.81]", ":4: ", "not valid JSON"},
    {"\"expect\"", "\"bodies\"", ":14: /bodies", "duplicate key, first given in line 6", false},
};

void read_schema(valijson::Schema& schema) {
  const Json text = Json::parse(std::ifstream(test::kSource + "/docs/scene.schema.json"));
  valijson::SchemaParser parser;
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema);
}

bool valid(const valijson::Schema& schema, const std::string& text) {
  const Json json =
      Json::parse(text, nullptr, /*allow_exceptions=*/false, /*ignore_comments=*/true);
  if (json.is_discarded()) return false;
  valijson::Validator validator;
  return validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(json), nullptr);
}

}  // namespace

namespace {

const char* const kMeshedScene = R"({
  "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 }, "sand": { "density": 1500 } },
  "bodies": [
    { "name": "beam", "material": "rock",
      "mesh": { "rectangle": { "size": [10, 1], "cells": [20, 2] }, "element": "Q4" },
      "supports": [ { "where": { "x": 0 }, "fix": ["x", "y"] } ],
      "loads": [ { "at": [9.8, 1.0], "force": [0, -1], "history": [[0, 0], [0.5, 1]] },
                 { "where": { "group": "top" }, "pressure": 5 } ] }
  ],
  "time": { "end": 1 },
  "output": { "history": { "track": [ { "body": "beam", "point": [10, 0.5] }, { "body": "beam" } ] } }
})";

const std::vector<Broken> kBrokenMeshed{
    {"\"young\": 20e9, ", "", ":4: /bodies/0/material", "needs \"young\" (Pa)", false},
    {"\"material\": \"rock\"", "\"material\": \"sand\"", ":4: /bodies/0/material", "needs", false},
    {"\"cells\": [20, 2]", "\"cells\": [20, 0]", ":5: ", "cells"},
    {"\"Q4\"", "\"Q5\"", ":5: /bodies/0/mesh/element", "did you mean \"Q4\""},
    {"\"Q4\"", "\"T3\"", "", "", false},  // fits: the rectangle is cut into triangles
    {"{ \"x\": 0 }", "{ \"x\": -1 }", ":6: /bodies/0/supports/0/where", "no node", false},
    {"{ \"x\": 0 }", "{ \"z\": 0 }", ":6: /bodies/0/supports/0/where/z", "unknown key"},
    {"\"fix\": [\"x\", \"y\"]", "\"fix\": []", ":6: ", "what it holds"},
    {"\"fix\": [\"x\", \"y\"]", "\"fix\": [\"angle\"]", ":6: ", "\"angle\""},
    {"\"fix\": [\"x\", \"y\"]", "\"spin\": [[0, 1]]", ":6: /bodies/0/supports/0",
     "missing key \"pivot\""},
    {"\"fix\": [\"x\", \"y\"]", "\"fix\": [\"x\"], \"spin\": [[0, 1]], \"pivot\": [0, 0]",
     ":6: /bodies/0/supports/0/spin", "both directions", false},
    {"\"fix\": [\"x\", \"y\"]", "\"fix\": [\"x\"], \"velocity\": [[0, 0, 0], [1, 1, -2]]",
     ":6: /bodies/0/supports/0/velocity", "moves nodes along y", false},
    {"\"fix\": [\"x\", \"y\"]", "\"spin\": [], \"pivot\": [0, 0]", ":6: /bodies/0/supports/0/spin",
     "at least one row", false},
    {"\"fix\": [\"x\", \"y\"]", "\"velocity\": [[0, 1, 0]], \"pivot\": [0, 0]",
     ":6: /bodies/0/supports/0/pivot", "nothing turns about it"},
    {"\"fix\": [\"x\", \"y\"]", "\"spin\": [[0, 1]], \"pivot\": [0, 0]", "", "", false},
    {"\"material\": \"rock\",", "\"material\": \"rock\", \"materials\": { \"top\": \"rock\" },",
     ":4: /bodies/0/materials/top", "no groups of elements", false},
    {"[9.8, 1.0]", "[9.8, 1.1]", ":7: /bodies/0/loads/0/at", "outside", false},
    {"\"force\": [0, -1]", "\"pressure\": 1", ":7: /bodies/0/loads/0/at", "\"force\""},
    {"[[0, 0], [0.5, 1]]", "[[0.5, 0], [0.5, 1]]", ":7: ", "times must increase", false},
    {"\"pressure\": 5", "\"pressure\": 5, \"traction\": [0, 1]", ":8: ", "one of"},
    {"\"top\"", "\"tip\"", ":8: ", "did you mean \"top\"", false},
    {"[10, 0.5]", "[11, 0.5]", ":11: ", "outside", false},
    {"\"point\": [10, 0.5]", "\"name\": \"A\"", ":11: /output/history/track/0/name", "leave it out",
     false},
    {"\"point\": [10, 0.5]", "\"surface\": \"contact\", \"name\": \"A\"",
     ":11: /output/history/track/0/name", "leave it out", false},
    {"\"mesh\":", "\"polygon\": [[0,0],[1,0],[0,1]], \"mesh\":", ":5: /bodies/0/polygon",
     "leave one out"},
    {"\"supports\"", "\"motion\": \"fixed\", \"supports\"", ":6: /bodies/0/motion", "\"free\"",
     false},
    {"  \"bodies\"",
     "  \"contact\": { \"normal_stiffness\": 1, \"friction\": { \"law\": \"per_edge\", "
     "\"coefficient\": 0.5, \"tangential_stiffness\": 1 } },\n  \"bodies\"",
     ":3: /contact/friction/law", "rigid bodies only", false},
    {"  \"bodies\"",
     "  \"contact\": { \"normal_stiffness\": 1, \"potential\": \"area\" },\n  \"bodies\"",
     ":3: /contact/potential", "use \"distance\"", false},
    {"  \"bodies\"",
     "  \"contact\": { \"normal_stiffness\": 1, \"pairs\": [ { \"between\": [\"rock\", \"beam\"], "
     "\"friction\": { \"coefficient\": 0 }, \"reference\": 2 } ] },\n  \"bodies\"",
     ":3: /contact/pairs/0/reference", "unknown key", false},
    {"\"time\"", "\"gravity\": { \"history\": [[0, 0]] }, \"time\"", ":10: /gravity",
     "missing key \"value\"", false},
    {"\"supports\"", "\"support\"", ":6: /bodies/0/support", "did you mean \"supports\""},
};

}  // namespace

TEST_CASE("a meshed body becomes elements, supports, loads and points", "[scene]") {
  const Folder folder;
  const Scene scene = read_scene(folder.write("meshed.json", kMeshedScene));
  REQUIRE(scene.model.deformables.size() == 1);
  const DeformableBody& beam = scene.model.deformables[0];
  CHECK(beam.element == ElementKind::quad4);
  CHECK(beam.mesh.element_count() == 40);
  REQUIRE(beam.supports.size() == 1);
  CHECK(beam.supports[0].nodes.size() == 3);
  REQUIRE(beam.dead_loads.size() == 1);
  Vec2 sum = Vec2::Zero();
  for (const Vec2& f : beam.dead_loads[0].forces) sum += f;
  CHECK(sum.y() == Approx(-1).epsilon(1e-14));
  REQUIRE(beam.pressures.size() == 1);
  CHECK(beam.pressures[0].edges.size() == 20);
  REQUIRE(scene.output.points.size() == 1);
  CHECK(scene.output.points[0].name == "beam");
  CHECK(scene.output.points[0].body == 0);
  const std::optional<MeshPoint> place = find_point(beam.mesh, Vec2(10, .5) - scene.model.origin);
  CHECK(scene.output.points[0].element == place->element);
  CHECK(scene.output.track_deformables == std::vector<int>{0});
  CHECK(scene.model.contact.surface == ContactSurface::body);
  CHECK(scene.model.contact.distribution == ForceDistribution::variational);
  const std::vector<std::pair<std::string, ForceDistribution>> distributions{
      {"", ForceDistribution::resultant},
      {", \"distribution\": \"integrated\"", ForceDistribution::integrated}};
  for (const auto& [text, distribution] : distributions) {
    const std::string contact =
        R"("contact": { "normal_stiffness": 1, "surface": "element")" + text + " }, \"bodies\"";
    const Scene by_element =
        read_scene(folder.write("element.json", replaced(kMeshedScene, "\"bodies\"", contact)));
    CHECK(by_element.model.contact.surface == ContactSurface::element);
    CHECK(by_element.model.contact.distribution == distribution);
  }
  for (const Broken& broken : kBrokenMeshed) {
    const std::string file =
        folder.write("broken.json", replaced(kMeshedScene, broken.what, broken.by));
    INFO(broken.what << " -> " << broken.by);
    if (*broken.message == 0) {
      CHECK_NOTHROW(read_scene(file));
      continue;
    }
    const std::string error = error_of_file(file);
    INFO(error);
    CHECK(error.find(file + broken.place) == 0);
    CHECK(error.find(broken.message) != std::string::npos);
    CHECK(error.find('\n') == std::string::npos);
  }
}

TEST_CASE("a good scene becomes a model", "[scene]") {
  const Folder folder;
  const Scene scene = read_scene(folder.write("good.json", kGood));
  CHECK(scene.model.name == "good");
  REQUIRE(scene.model.bodies.size() == 2);
  const RigidBody& falling = scene.model.bodies[1];
  CHECK(falling.mass == Approx(2000 * .4));
  CHECK(falling.position.y() + scene.model.origin.y() == Approx(.1 + .8 * 2 / 3));
  CHECK(falling.velocity.y() == -1);
  CHECK(scene.model.bodies[0].motion == Motion::fixed);
  CHECK(scene.output.track == std::vector<int>{1});
  CHECK_FALSE(scene.time.fixed_step);
}

TEST_CASE("every kind of broken scene gives one line that names the place", "[scene]") {
  REQUIRE(kBroken.size() >= 40);
  const Folder folder;
  for (const Broken& broken : kBroken) {
    const std::string file = folder.write("broken.json", replaced(kGood, broken.what, broken.by));
    const std::string error = error_of_file(file);
    INFO(broken.what << " -> " << broken.by << "\n" << error);
    CHECK(error.find(file + broken.place) == 0);
    CHECK(error.find(broken.message) != std::string::npos);
    CHECK(error.find('\n') == std::string::npos);
  }
  for (const auto& [what, by] : {std::pair("\"gravity\"", "\"grav\\nity\""),
                                 std::pair("\"rock\", \"motion\"", "\"ro\\nck\", \"motion\"")}) {
    const std::string error = error_of_file(folder.write("lines.json", replaced(kGood, what, by)));
    CHECK(error.find("lines.json:") != std::string::npos);
    CHECK(error.find('\n') == std::string::npos);
  }
  CHECK(error_of_file(folder.write("nul.json", std::string(kGood) + '\0' + "x")).find("NUL") !=
        std::string::npos);
  CHECK(error_of_file(folder.write("empty.json", "")).find("not valid JSON") != std::string::npos);
  CHECK(error_of_file(folder.write("array.json", "[]")).find("must be an object") !=
        std::string::npos);
  CHECK(error_of_file(folder.write("deep.json", std::string(100000, '[')))
            .find("nested too deeply") != std::string::npos);
  CHECK(error_of_file("/nowhere/scene.json").find("cannot be opened") != std::string::npos);
  CHECK(error_of_file("/tmp").find("is a directory") != std::string::npos);
}

TEST_CASE("the JSON Schema and the reader agree", "[scene][slow]") {
  valijson::Schema schema;
  read_schema(schema);
  CHECK(valid(schema, kGood));
  CHECK(valid(schema, kMeshedScene));
  CHECK(valid(schema, kImport));
  CHECK_FALSE(valid(schema, replaced(kImport, "\"notes\": false", "\"notes\": true")));
  CHECK_FALSE(valid(schema, replaced(kImport, "\"import\"", "\"imports\"")));
  for (const Broken& broken : kBrokenMeshed) {
    INFO(broken.what << " -> " << broken.by);
    if (broken.schema) CHECK_FALSE(valid(schema, replaced(kMeshedScene, broken.what, broken.by)));
  }
  for (const Broken& broken : kBroken) {
    INFO(broken.what << " -> " << broken.by);
    if (broken.schema) CHECK_FALSE(valid(schema, replaced(kGood, broken.what, broken.by)));
  }
  for (const auto& [checkpoint, good] : {std::pair<const char*, bool>{"false", true},
                                         {R"({ "wall_clock": 60 })", true},
                                         {"true", false},
                                         {"{}", false},
                                         {R"({ "wall_clock": 0 })", false}}) {
    INFO(checkpoint);
    const std::string text = replaced(kGood, "\"frames\": 10",
                                      std::string("\"frames\": 10, \"checkpoint\": ") + checkpoint);
    CHECK(valid(schema, text) == good);
    CHECK(error_of_file(Folder().write("checkpoint.json", text)).empty() == good);
  }
  int shipped = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::kSource + "/data/scenes")) {
    INFO(entry.path());
    CHECK(valid(schema, read_text(entry.path().string())));
    Scene scene;
    REQUIRE_NOTHROW(scene = read_scene(entry.path().string()));
    // What the report of `apothem reproduce` states beside each number.
    for (const Expectation& e : scene.expectations) {
      INFO(e.quantity);
      CHECK(e.basis.has_value());
      CHECK_FALSE(e.source.empty());
      CHECK_FALSE(e.unit.empty());
    }
    ++shipped;
  }
  CHECK(shipped >= 7);
}

TEST_CASE("the JSON Schema lists exactly the keys that the reader knows", "[scene]") {
  // The reader lists its keys when it meets one it does not know.
  const Json schema = Json::parse(std::ifstream(test::kSource + "/docs/scene.schema.json"));
  const Json& top = schema["properties"];
  const Json& definitions = schema["definitions"];
  struct Case {
    const char* at;
    const Json* properties;
    const char* scene = kGood;
  };
  const Json& mesh = definitions["mesh"]["properties"];
  const Case cases[]{
      {"\"gravity\"", &top},
      {"\"density\"", &top["materials"]["additionalProperties"]["properties"]},
      {"\"normal_stiffness\"", &top["contact"]["properties"]},
      {"\"name\": \"target\"", &definitions["rigid_body"]["properties"]},
      {"\"end\"", &top["time"]["properties"]},
      {"\"frames\"", &top["output"]["properties"]},
      {"\"interval\"", &top["output"]["properties"]["history"]["properties"]},
      {"\"quantity\"", &definitions["expectation"]["properties"]},
      {"\"name\": \"beam\"", &definitions["deformable_body"]["properties"], kMeshedScene},
      {"\"rectangle\"", &mesh, kMeshedScene},
      {"\"size\"", &mesh["rectangle"]["properties"], kMeshedScene},
      {"\"where\": { \"x\"", &definitions["support"]["properties"], kMeshedScene},
      {"\"x\": 0", &definitions["place"]["properties"], kMeshedScene},
      {"\"at\"", &definitions["load"]["properties"], kMeshedScene},
      {"\"file\"", &definitions["import"]["properties"], kImport},
      {"\"motion\"", &definitions["import_layer"]["properties"], kImport},
      {"\"size\"", &definitions["filling"]["oneOf"][1]["properties"], kImport},
      {"\"body\": \"beam\", \"point\"",
       &top["output"]["properties"]["history"]["properties"]["track"]["items"]["properties"],
       kMeshedScene},
  };
  const Folder folder;
  for (const Case& c : cases) {
    const std::string error = error_of_file(folder.write(
        "keys.json", replaced(c.scene, c.at, std::string("\"qqqqqqqq\": 1, ") + c.at)));
    INFO(error);
    const size_t start = error.find("(known here: ");
    REQUIRE(start != std::string::npos);
    std::istringstream list(error.substr(start + 13, error.size() - start - 14));
    std::vector<std::string> known, published;
    for (std::string key; std::getline(list, key, ',');)
      known.push_back(key.substr(key.find_first_not_of(' ')));
    for (const auto& [key, value] : c.properties->items()) published.push_back(key);
    std::sort(known.begin(), known.end());
    CHECK(known == published);
  }
}

TEST_CASE("the polygon of a body may stand in a file", "[scene]") {
  const Folder folder;
  folder.write("c.wkt", "POLYGON((0 0, 1.5 0, 0.25 1e-3, 0 0))\n");
  const std::string polygon = "[[0, 0.1], [0.5, 0.9], [-0.5, 0.9]]";
  const std::string scene = replaced(kGood, polygon, "\"c.wkt\"");
  CHECK(read_scene(folder.write("file.json", scene)).model.bodies[1].area ==
        Approx(1.5 * 1e-3 / 2));
  folder.write("c.wkt", "POLYGON((0 0,\n1,5 0,0 1,0 0))");
  const std::string error = error_of_file(folder.write("file.json", scene));
  CHECK(error.find("file.json:10: /bodies/1/polygon: ") != std::string::npos);
  CHECK(error.find("c.wkt:2: vertex 1 has one coordinate, 1") != std::string::npos);
}

TEST_CASE("a ring in a scene may repeat its first vertex at the end", "[scene]") {
  const Folder folder;
  const std::string closed = replaced(kGood, "[-0.5, 0.9]]", "[-0.5, 0.9], [0, 0.1]]");
  const Scene scene = read_scene(folder.write("closed.json", closed));
  CHECK(scene.model.bodies[1].potential.size() == 3);
  CHECK(error_of_file(folder.write("z.json", replaced(kGood, "[0.5, 0.9]", "[0.5, 0.9, 0]")))
            .find("/bodies/1/polygon/1: has 3 coordinates, and bodies are two-dimensional") !=
        std::string::npos);
}

TEST_CASE("a body can be placed by mass centre and angle", "[scene]") {
  const Folder folder;
  const std::string scene =
      replaced(kGood, "\"velocity\": [0, -1]", "\"position\": [1e9, 5], \"angle\": 0.5");
  const Scene far = read_scene(folder.write("placed.json", scene));
  const RigidBody& body = far.model.bodies[1];
  CHECK(body.position.x() + far.model.origin.x() == 1e9);
  CHECK(body.position.y() + far.model.origin.y() == 5);
  CHECK(body.angle == 0.5);
}

TEST_CASE("a pivot is a point of the world that the body takes with it", "[scene]") {
  const Folder folder;
  const std::string motion = "\"motion\": { \"spin\": [[0, 2]], \"pivot\": [5, 7] }";
  for (const char* at : {"", ", \"position\": [3, 4], \"angle\": 0.5"}) {
    const Scene scene = read_scene(
        folder.write("pivot.json", replaced(kGood, "\"motion\": \"fixed\"", motion + at)));
    const RigidBody& body = scene.model.bodies[0];
    const double c = std::cos(body.angle), s = std::sin(body.angle);
    const Vec2 place =
        scene.model.origin + body.position +
        Vec2(c * body.pivot.x() - s * body.pivot.y(), s * body.pivot.x() + c * body.pivot.y());
    CHECK((place - Vec2(5, 7)).norm() < 1e-14);
  }
  const Scene centred =
      read_scene(folder.write("pivot.json", replaced(kGood, "\"motion\": \"fixed\"",
                                                     "\"motion\": { \"spin\": [[0, 2]] }")));
  CHECK(centred.model.bodies[0].pivot == Vec2::Zero());
  const Scene support =
      read_scene(folder.write("support.json", replaced(kMeshedScene, "\"fix\": [\"x\", \"y\"]",
                                                       "\"spin\": [[0, 1]], \"pivot\": [5, 7]")));
  const Support& turning = support.model.deformables[0].supports[0];
  CHECK(turning.held == std::array{true, true});
  CHECK((turning.pivot + support.model.origin - Vec2(5, 7)).norm() < 1e-14);
  CHECK(turning.motion.spin.size() == 1);
}

TEST_CASE("the stiffness of friction springs is a ratio or a constant", "[scene]") {
  const Folder folder;
  const auto between = [&](const std::string& friction, const std::string& pairs) {
    const std::string contact = "\"reference\": \"roof\"" + friction + pairs;
    const Scene scene = read_scene(
        folder.write("friction.json", replaced(kGood, "\"reference\": \"roof\"", contact)));
    return law_between(scene.model.contact, 0, 0, 1, 0).friction;
  };
  const std::string plain = ", \"friction\": { \"coefficient\": 0.5 }";
  const std::string given =
      ", \"friction\": { \"coefficient\": 0.5, \"tangential_stiffness\": 3e9 }";
  const auto pair = [](const char* more) {
    return std::string(", \"pairs\": [ { \"between\": [\"target\", \"rock\"], \"friction\": { ") +
           "\"coefficient\": 0.25" + more + " } } ]";
  };
  const std::string scene_ratio =
      ", \"friction\": { \"coefficient\": 0.5, \"stiffness_ratio\": 0.6 }";
  const auto is = [](const Friction& friction, double ratio, double constant) {
    return friction.stiffness_ratio == ratio && friction.tangential_stiffness == constant;
  };
  CHECK(kTangentialRatio == .8);
  CHECK(is(between(plain, ""), .8, 0));
  CHECK(is(between(given, ""), 0, 3e9));
  CHECK(is(between(scene_ratio, ""), .6, 0));
  for (const std::string& scene : {plain, std::string()}) {
    CHECK(between(scene, pair("")).coefficient == .25);
    CHECK(is(between(scene, pair("")), .8, 0));
    CHECK(is(between(scene, pair(", \"tangential_stiffness\": 7e9")), 0, 7e9));
    CHECK(is(between(scene, pair(", \"stiffness_ratio\": 0.7")), .7, 0));
  }
  CHECK(is(between(given, pair("")), 0, 3e9));
  CHECK(is(between(given, pair(", \"tangential_stiffness\": 7e9")), 0, 7e9));
  CHECK(is(between(given, pair(", \"stiffness_ratio\": 0.7")), .7, 0));
  CHECK(is(between(scene_ratio, pair("")), .6, 0));
  CHECK_THROWS_WITH(between(", \"friction\": { \"coefficient\": 0.5, \"stiffness_ratio\": 0.6, "
                            "\"tangential_stiffness\": 3e9 }",
                            ""),
                    Catch::Matchers::Contains("give one of the two"));
}

TEST_CASE("a ratio of damping may be 0", "[scene]") {
  const Folder folder;
  const auto damping = [&](const std::string& value) {
    const std::string text = R"({ "materials": { "rock": { "density": 2000 } },
      "contact": { "normal_stiffness": 1e9, "damping": )" +
                             value + R"( },
      "bodies": [ { "name": "block", "material": "rock", "polygon": [[0, 0], [1, 0], [0, 1]] } ],
      "time": { "end": 1 } })";
    return read_scene(folder.write("scene.json", text)).model.contact.damping;
  };
  const auto are = [](const ContactDamping& d, double normal, double tangential) {
    return d.normal == normal && d.tangential == tangential;
  };
  CHECK(are(damping(R"({ "model": "viscous", "ratio": 0 })"), 0, 0));
  CHECK(are(damping(R"({ "model": "viscous", "ratio": [0.1, 0] })"), .1, 0));
  CHECK(are(damping(R"({ "model": "viscous", "ratio": [0, 0.1] })"), 0, .1));
  CHECK(are(damping(R"({ "model": "normal_viscous", "ratio": 0 })"), 0, 0));
  CHECK_THROWS_WITH(damping(R"({ "model": "viscous", "ratio": -0.1 })"),
                    Catch::Contains("/contact/damping/ratio"));
  CHECK_THROWS_WITH(damping(R"([{ "model": "viscous", "ratio": 0 },
                                { "model": "normal_viscous", "ratio": 0.1 }])"),
                    Catch::Contains("given already"));
}

TEST_CASE("gravity may turn and be a sum of parts", "[scene]") {
  const Folder folder;
  const auto model_with = [&](const std::string& gravity) {
    return read_scene(
               folder.write("gravity.json", replaced(kMeshedScene, "\"time\"",
                                                     "\"gravity\": " + gravity + ", \"time\"")))
        .model;
  };
  // A table that tilts counter-clockwise: things slide to the left.
  const Model tilts = model_with(
      R"({ "value": [0, -10], "history": [[0, 0.5], [2, 1]], "direction_history": [[0, 0], [2, 1]] })");
  CHECK(tilts.has_gravity());
  CHECK((tilts.gravity - Vec2(0, -5)).norm() < 1e-15);
  CHECK((tilts.gravity_at(1) - 7.5 * Vec2(-std::sin(.5), -std::cos(.5))).norm() < 1e-14);
  CHECK((tilts.gravity_at(9) - 10 * Vec2(-std::sin(1.), -std::cos(1.))).norm() < 1e-14);
  CHECK(tilts.strongest_gravity() == 10);
  const Model sum = model_with(R"([[0, -10], { "value": [4, 0], "history": [[0, 0], [1, 2]] }])");
  CHECK(sum.gravity == Vec2(0, -10));
  CHECK((sum.gravity_at(.25) - Vec2(2, -10)).norm() < 1e-15);
  CHECK(sum.strongest_gravity() == 18);
  // One part whose direction is constant is what it has been.
  CHECK(model_with(R"([{ "value": [0, -10] }])").gravity_at(3) == Vec2(0, -10));
  CHECK(model_with(R"({ "value": [0, -10] })").gravity_parts.empty());
  CHECK_THROWS_WITH(model_with(R"([[0, -10], [1]])"), Catch::Contains("/gravity/1"));
  CHECK_THROWS_WITH(model_with(R"({ "value": [0, -1], "direction_history": [] })"),
                    Catch::Contains("leave it out for 0"));
}

TEST_CASE("a static scene refuses what does not go with it", "[scene]") {
  const Folder folder;
  const std::string good =
      replaced(kMeshedScene, "\"time\": { \"end\": 1 }",
               "\"time\": { \"end\": 1, \"mode\": \"static\", \"load_steps\": 4 }");
  const Scene scene = read_scene(folder.write("static.json", good));
  CHECK(scene.time.statics);
  CHECK(scene.time.load_steps == 4);
  CHECK(scene.time.tolerance == 1e-6);
  struct Case {
    const char *what, *by, *message;
  };
  const Case cases[]{
      {"\"load_steps\": 4", "\"load_steps\": 0", "/time/load_steps"},
      {"\"load_steps\": 4", "\"load_steps\": \"many\"", "/time/load_steps"},
      {"\"load_steps\": 4", "\"tolerance\": 0.5", "between 1e-12 and 1e-2"},
      {"\"load_steps\": 4", "\"step\": 1e-3", "/time/step: has no meaning in a static run"},
      {"\"load_steps\": 4", "\"start\": \"settled\"", "/time/start: has no meaning"},
      {"\"static\"", "\"dynamic\"", "goes with \"mode\": \"static\""},
      {"\"supports\"", "\"velocity\": [0, 1], \"supports\"", "/bodies/0/velocity"},
      {"\"output\": {", "\"output\": { \"frames\": 3,", "a frame per load step"},
      {"\"young\"", "\"damping\": { \"model\": \"rayleigh\", \"mass\": 1 }, \"young\"", "damping"},
      {"\"bodies\": [",
       "\"contact\": { \"normal_stiffness\": 1e9, \"damping\": { \"model\": \"normal_viscous\", "
       "\"ratio\": 0.1 } }, \"bodies\": [",
       "/contact/damping: has no meaning"},
      {"\"bodies\": [",
       "\"contact\": { \"normal_stiffness\": 1e9, \"surface\": \"element\" }, \"bodies\": [",
       "/contact/surface: is not supported yet in a static run"},
  };
  for (const Case& c : cases) {
    const std::string error =
        error_of_file(folder.write("broken.json", replaced(good, c.what, c.by)));
    INFO(error);
    CHECK(error.find(c.message) != std::string::npos);
  }
}

TEST_CASE("the example in the documentation is a scene", "[scene]") {
  const Folder folder;
  const std::string document = test::content(test::kSource + "/docs/scene-format.md");
  const std::string fence = "```jsonc\n";
  const size_t start = document.find(fence) + fence.size();
  const std::string example = document.substr(start, document.find("```", start) - start);
  folder.write("block.wkt", "POLYGON((0 0, 1 0, 1 1, 0 1, 0 0))");
  CHECK(error_of_file(folder.write("example.json", example)) == "");
}
