// Bodies from drawings. The drawings are written by the tests: small DXF files as R12 has them, and
// the same outlines as WKT, GeoJSON and CSV.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "lib/run/hash.hpp"
#include "lib/run/start.hpp"
#include "lib/scene/scene.hpp"
#include "tests/program.hpp"

using namespace apothem;
using test::Folder;

namespace {

using Ring = std::vector<std::pair<const char*, const char*>>;

struct Stone {
  const char *layer, *name;
  Ring ring;
};

// Two courses whose joints are no round numbers, and their ground.
const std::vector<Stone> kWall{
    {"ground", "base", {{"-500", "-200"}, {"1500", "-200"}, {"1500", "0"}, {"-500", "0"}}},
    {"stones",
     "left",
     {{"0", "0"}, {"333.3333333333333", "0"}, {"333.3333333333333", "200"}, {"0", "200"}}},
    {"stones",
     "right",
     {{"333.3333333333333", "0"},
      {"1000.1", "0"},
      {"1000.1", "200"},
      {"333.3333333333333", "200"}}},
    {"stones",
     "top",
     {{"100.7", "200"}, {"900.3", "200"}, {"812.3456789012345", "405.5"}, {"100.7", "405.5"}}}};

// A DXF file has a code and a value in turn, one in each line; here they stand in one line.
std::string dxf(const std::string& entities, const std::string& blocks = "") {
  std::string text = "0 SECTION 2 HEADER 0 ENDSEC " + blocks + "0 SECTION 2 ENTITIES " + entities +
                     " 0 ENDSEC 0 EOF ";
  text.erase(
      std::unique(text.begin(), text.end(), [](char a, char b) { return a == ' ' && b == ' '; }),
      text.end());
  std::replace(text.begin(), text.end(), ' ', '\n');
  return text;
}

std::string polyline(const std::string& layer, const Ring& ring, bool closed = true) {
  std::string text = fmt::format("0 POLYLINE 8 {} 66 1 70 {} ", layer, closed ? 1 : 0);
  for (const auto& [x, y] : ring) text += fmt::format("0 VERTEX 8 {} 10 {} 20 {} ", layer, x, y);
  return text + "0 SEQEND";
}

std::string line(double x0, double y0, double x1, double y1) {
  return fmt::format("0 LINE 8 joints 10 {} 20 {} 11 {} 21 {} ", x0, y0, x1, y1);
}

std::string points(const Ring& ring, const char* point, const char* between) {
  std::string text;
  for (size_t i = 0; i <= ring.size(); ++i) {
    const auto& [x, y] = ring[i % ring.size()];
    text += (i > 0 ? between : "") + fmt::format(fmt::runtime(point), x, y);
  }
  return text;
}

std::string wall_as(const std::string& format) {
  std::string text, separator;
  if (format == "csv") text = "id,x,y,layer,name\n";
  if (format == "geojson") text = R"({"type": "FeatureCollection", "features": [)";
  for (const Stone& s : kWall) {
    if (format == "dxf") text += separator + polyline(s.layer, s.ring);
    if (format == "wkt") text += fmt::format("POLYGON (({}))\n", points(s.ring, "{} {}", ", "));
    if (format == "csv") {
      for (const auto& [x, y] : s.ring) {
        text += fmt::format("{0},{1},{2},{3},{0}\n", s.name, x, y, s.layer);
      }
    }
    if (format == "geojson") {
      text += separator +
              fmt::format(R"({{"type": "Feature", "properties": {{"layer": "{}", "name": "{}"}},
        "geometry": {{"type": "Polygon", "coordinates": [[{}]]}}}})",
                          s.layer, s.name, points(s.ring, "[{}, {}]", ", "));
    }
    separator = format == "dxf" ? " " : ", ";
  }
  if (format == "geojson") text += "]}";
  return format == "dxf" ? dxf(text) : text;
}

// A scene with these entries of "import".
std::string scene_with(const std::string& imports) {
  return R"({ "gravity": [0, -9.81],
  "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 }, "clay": { "density": 1800 } },
  "contact": { "normal_stiffness": 20e9 },
  "import": [)" +
         imports + R"(],
  "time": { "end": 1 } })";
}

Scene imported(const Folder& folder, const std::string& imports) {
  return read_scene(folder.write("scene.json", scene_with(imports)));
}

// The same with the distance to the boundary as the depth.
Scene imported_distance(const Folder& folder, const std::string& imports) {
  std::string text = scene_with(imports);
  const std::string contact = "\"normal_stiffness\": 20e9";
  text.insert(text.find(contact), R"("field": "distance", "reference": 0.1, )");
  return read_scene(folder.write("scene.json", text));
}

std::string error_of(const Folder& folder, const std::string& imports) {
  try {
    imported(folder, imports);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

std::vector<double> coordinates(const Scene& scene) {
  std::vector<double> result;
  for (const RigidBody& body : scene.model.bodies) {
    for (const Vec2& v : body.potential.vertices) {
      result.push_back(v.x());
      result.push_back(v.y());
    }
    result.insert(result.end(), {body.position.x(), body.position.y(), body.area, body.mass});
  }
  return result;
}

std::map<std::string, double> areas(const Scene& scene) {
  std::map<std::string, double> result;
  for (const RigidBody& body : scene.model.bodies) result[body.name] = body.area;
  return result;
}

}  // namespace

TEST_CASE("a drawing gives the same bodies in every format", "[import]") {
  const Folder folder;
  std::vector<double> first;
  for (const std::string format : {"dxf", "wkt", "geojson", "csv"}) {
    INFO(format);
    folder.write("wall." + format, wall_as(format));
    const Scene scene =
        imported(folder, R"({ "file": "wall.)" + format +
                             R"(", "scale": 0.001, "offset": [0.1, 7], "material": "rock" })");
    REQUIRE(scene.model.bodies.size() == 4);
    if (first.empty()) first = coordinates(scene);
    CHECK(coordinates(scene) == first);
    CHECK(scene.model.bodies[0].area == Approx(2 * 0.2));
    CHECK(scene.model.bodies[0].position.x() == Approx(0.1 + 0.5));
    CHECK(scene.model.bodies[0].position.y() == Approx(7 - 0.1));
    const bool has_names = format == "geojson" || format == "csv";
    CHECK(scene.model.bodies[3].name == (has_names ? "wall-top" : "wall-3"));
  }
}

TEST_CASE("layers of a drawing give their bodies materials, motions and meshes", "[import]") {
  const Folder folder;
  folder.write("wall.dxf", wall_as("dxf"));
  const Scene scene = imported(folder, R"({ "file": "wall.dxf", "name": "w", "scale": 0.001,
    "material": "rock", "mesh": { "size": 0.1, "element": "T3" },
    "layers": { "ground": { "motion": "fixed", "mesh": false, "material": "clay" } } })");
  REQUIRE(scene.model.bodies.size() == 1);
  CHECK(scene.model.bodies[0].name == "w-0");
  CHECK(scene.model.bodies[0].motion == Motion::fixed);
  CHECK(scene.model.materials[scene.model.bodies[0].material].name == "clay");
  REQUIRE(scene.model.deformables.size() == 3);
  const DeformableBody& top = scene.model.deformables[2];
  CHECK(top.name == "w-3");
  CHECK(top.element == ElementKind::tri3);
  CHECK(scene.model.materials[top.material].name == "rock");
  double area = 0;
  for (int e = 0; e < top.mesh.element_count(); ++e) {
    const auto nodes = top.mesh.element(e);
    area += cross(top.mesh.nodes[nodes[1]] - top.mesh.nodes[nodes[0]],
                  top.mesh.nodes[nodes[2]] - top.mesh.nodes[nodes[0]]) /
            2;
  }
  CHECK(area == Approx((0.7996 + 0.7116456789012345) / 2 * 0.2055));

  const Scene stones = imported(
      folder, R"({ "file": "wall.dxf", "scale": 0.001, "material": "rock", "velocity": [1, 0],
                   "layers": { "ground": false, "stones": { "velocity": [2, 0], "spin": 3, "fix": ["y"] } } })");
  REQUIRE(stones.model.bodies.size() == 3);
  CHECK(stones.model.bodies[0].name == "wall-0");
  CHECK(stones.model.bodies[0].velocity.x() == 2);
  CHECK(stones.model.bodies[0].spin == 3);
  CHECK(stones.model.bodies[0].held[1]);
}

TEST_CASE("imported bodies stand behind those of the scene, and may touch them", "[import]") {
  const Folder folder;
  folder.write("wall.csv", wall_as("csv"));
  std::string text = scene_with(
      R"({ "file": "wall.csv", "scale": 0.001, "material": "rock" },
         { "file": "wall.csv", "name": "second", "scale": 0.001, "offset": [5, 0], "material": "rock" })");
  text.replace(text.find("\"import\""), 0, R"("bodies": [ { "name": "own", "material": "rock",
    "motion": "fixed", "polygon": [[-1, -1.2], [9, -1.2], [9, -0.2], [-1, -0.2]] } ], )");
  const Scene scene = read_scene(folder.write("scene.json", text));
  REQUIRE(scene.model.bodies.size() == 9);
  CHECK(scene.model.bodies[0].name == "own");
  CHECK(scene.model.bodies[8].name == "second-top");
  const auto simulation = make_simulation(scene, 1, Start::scene);
  for (const PairDepth& pair : simulation->overlaps()) CHECK(pair.depth < 1e-12);
}

TEST_CASE("stones that are drawn edge to edge share their vertices to the bit", "[import]") {
  const Folder folder;
  folder.write("wall.dxf", wall_as("dxf"));
  const Scene scene = read_scene(folder.write(
      "scene.json",
      scene_with(
          R"({ "file": "wall.dxf", "scale": 0.0254, "offset": [0.3, 12.1], "material": "rock" })")));
  const JsonValue& bodies = *scene.document.find("bodies");
  const auto vertex = [&](int body, int i, int k) {
    return bodies.items()[body].find("polygon")->items()[i].items()[k].number();
  };
  for (int k = 0; k < 2; ++k) {
    CHECK(vertex(1, 1, k) == vertex(2, 0, k));
    CHECK(vertex(1, 2, k) == vertex(2, 3, k));
  }
}

TEST_CASE("arcs, hatches and blocks of a DXF file become bodies", "[import]") {
  const Folder folder;
  const std::string stone = R"({ "file": "a.dxf", "material": "rock" })";
  // A bulge of 1 is a half circle: a square with one on its right, by chords of four degrees.
  folder.write("a.dxf",
               dxf("0 LWPOLYLINE 5 2F 8 a 90 4 70 1 10 0 20 0 10 1 20 0 42 1 10 1 20 1 10 0 20 1"));
  CHECK(areas(imported(folder, stone)).at("a-0") == Approx(1 + M_PI / 8).epsilon(1e-3));
  folder.write(
      "a.dxf",
      dxf("0 HATCH 8 a 10 0 20 0 30 0 210 0 220 0 230 1 2 SOLID 70 1 71 0 91 1 92 2 72 0 73 1 93 4 "
          "10 0 20 0 10 2 20 0 10 2 20 1 10 0 20 1 97 0 75 0 76 1 98 0"));
  CHECK(areas(imported(folder, stone)) == std::map<std::string, double>{{"a-0", 2}});
  folder.write(
      "a.dxf",
      dxf("0 INSERT 8 y 2 B 10 5 20 5 0 INSERT 8 y 2 B 10 8 20 5 0 POINT 8 y 10 0 20 0 "
          "0 LWPOLYLINE 67 1 8 frame 90 3 70 1 10 0 20 0 10 1 20 0 10 0 20 1",
          "0 SECTION 2 BLOCKS 0 BLOCK 8 0 2 B 70 0 10 0 20 0 "
          "0 LWPOLYLINE 8 x 90 3 70 1 10 0 20 0 10 1 20 0 10 0 20 1 0 ENDBLK 8 0 0 ENDSEC "));
  const Scene blocks = imported(folder, stone);
  REQUIRE(blocks.model.bodies.size() == 2);
  CHECK((blocks.model.bodies[1].position - blocks.model.bodies[0].position).norm() == Approx(3));
}

TEST_CASE("what a drawing does not show is not read", "[import]") {
  const Folder folder;
  const std::string ring = "90 3 70 1 10 0 20 0 10 1 20 0 10 0 20 1 ";
  const auto stone = [&](const char* layer) {
    return fmt::format("0 LWPOLYLINE 8 {} {}", layer, ring);
  };
  // Names of layers and blocks are the same in upper and lower case.
  const std::string tables =
      "0 SECTION 2 TABLES 0 TABLE 2 LAYER 70 9 0 LAYER 2 on 70 0 62 7 0 LAYER 2 frozen 70 1 62 7 "
      "0 LAYER 2 off 70 0 62 -7 0 LAYER 2 locked 70 4 62 7 0 ENDTAB 0 ENDSEC ";
  const std::string blocks =
      "0 SECTION 2 BLOCKS 0 BLOCK 8 0 2 B 70 0 10 0 20 0 0 LWPOLYLINE 8 0 90 3 70 1 10 10 20 0 10 "
      "11 "
      "20 0 10 10 20 1 0 LWPOLYLINE 8 on 90 3 70 1 10 20 20 0 10 21 20 0 10 20 20 1 0 ENDBLK 0 "
      "ENDSEC ";
  const std::string keys = R"({ "file": "a.dxf", "material": "rock" })";
  using Counts = std::map<std::pair<std::string, std::string>, int>;
  const std::pair<std::string, std::string> hidden{"LWPOLYLINE", "off or frozen in the drawing"};

  folder.write(
      "a.dxf",
      dxf(stone("on") + stone("FROZEN") + stone("off") + "0 LWPOLYLINE 60 1 8 on " + ring, tables));
  Scene scene = imported(folder, keys);
  CHECK(scene.model.bodies.size() == 1);
  REQUIRE(scene.imports.size() == 1);
  CHECK(scene.imports[0].read == std::map<std::string, int>{{"LWPOLYLINE", 1}});
  CHECK(scene.imports[0].left_out == Counts{{hidden, 3}});
  folder.write("a.dxf", dxf(stone("locked"), tables));
  CHECK(imported(folder, keys).model.bodies.size() == 1);

  // A block on a frozen layer is not shown at all, on one that is off only what is on its layer 0.
  folder.write("a.dxf", dxf("0 INSERT 8 frozen 2 b 10 0 20 0 " + stone("on"), tables + blocks));
  CHECK(imported(folder, keys).imports[0].left_out == Counts{{hidden, 2}});
  folder.write("a.dxf", dxf("0 INSERT 8 off 2 b 10 0 20 0 " + stone("on"), tables + blocks));
  CHECK(imported(folder, keys).imports[0].left_out == Counts{{hidden, 1}});
  folder.write("a.dxf", dxf("0 INSERT 8 on 2 b 10 0 20 0 ", tables + blocks));
  CHECK(imported(folder, R"({ "file": "a.dxf", "material": "rock",
                             "layers": { "on": { "material": "clay" } } })")
            .model.bodies[0]
            .material == 1);

  // A scene that asks for a layer that is not shown is told so.
  folder.write("a.dxf", dxf(stone("on") + stone("frozen"), tables));
  const std::string error = error_of(
      folder,
      R"({ "file": "a.dxf", "material": "rock", "layers": { "frozen": { "motion": "fixed" } } })");
  CHECK(error.find("/import/0/layers/frozen: the layer \"frozen\" is off or frozen") !=
        std::string::npos);
  CHECK(
      imported(folder, R"({ "file": "a.dxf", "material": "rock", "layers": { "frozen": false } })")
          .model.bodies.size() == 1);
}

TEST_CASE("the unit of a DXF file is taken, unless the scene gives a scale", "[import]") {
  const Folder folder;
  const std::string stone = "0 LWPOLYLINE 8 a 90 4 70 1 10 0 20 0 10 1 20 0 10 1 20 1 10 0 20 1";
  const auto write = [&](const std::string& unit) {
    std::string text = dxf(stone);
    const std::string start = "HEADER\n";
    if (!unit.empty()) {
      text.insert(text.find(start) + start.size(), fmt::format("9\n$INSUNITS\n70\n{}\n", unit));
    }
    folder.write("a.dxf", text);
  };
  const std::string keys = R"({ "file": "a.dxf", "material": "rock")";
  for (const auto& [unit, metres] :
       std::vector<std::pair<const char*, double>>{{"", 1},
                                                   {"0", 1},
                                                   {"1", 0.0254},
                                                   {"2", 0.3048},
                                                   {"4", 1e-3},
                                                   {"5", 1e-2},
                                                   {"6", 1},
                                                   {"7", 1e3},
                                                   {"10", 0.9144},
                                                   {"13", 1e-6},
                                                   {"14", 0.1},
                                                   {"21", 1200.0 / 3937}}) {
    INFO("$INSUNITS " << unit);
    write(unit);
    const Scene scene = imported(folder, keys + " }");
    CHECK(scene.model.bodies[0].area == Approx(metres * metres).epsilon(1e-12));
    CHECK(scene.imports[0].scale == metres);
    const bool stated = *unit != '\0' && *unit != '0';
    CHECK((scene.imports[0].unit_source.find("$INSUNITS") != std::string::npos) == stated);
    CHECK(imported(folder, keys + R"(, "scale": 3 })").model.bodies[0].area == Approx(9));
  }
  write("99");
  CHECK(
      error_of(folder, keys + " }").find("a.dxf: states a unit that is not known ($INSUNITS 99)") !=
      std::string::npos);
  CHECK(imported(folder, keys + R"(, "scale": 3 })").model.bodies[0].area == Approx(9));

  // The program says it.
  write("4");
  const std::string file = folder.write("scene.json", scene_with(keys + " }"));
  const test::Result plan = test::run({"check", file}, folder);
  CHECK(plan.out.find("a.dxf: 1 body from 1 LWPOLYLINE; its unit is 0.001 m (millimetres, by "
                      "$INSUNITS 4)") != std::string::npos);
}

TEST_CASE("names of a DXF file are read in its encoding", "[import]") {
  const Folder folder;
  const auto read_as = [&](const std::string& header, const std::string& layer,
                           const std::string& name) {
    const std::string entity =
        fmt::format("0 LWPOLYLINE 8 {} 90 3 70 1 10 0 20 0 10 1 20 0 10 0 20 1", layer);
    std::string text = dxf(entity);
    const std::string start = "HEADER\n";
    text.insert(text.find(start) + start.size(), header);
    folder.write("a.dxf", text);
    const Scene scene = imported(folder, R"({ "file": "a.dxf", "material": "rock", "layers": { ")" +
                                             name + R"(": { "material": "clay" } } })");
    return scene.model.bodies[0].material == 1;
  };
  const auto header = [](const char* version, const char* page) {
    return fmt::format("9\n$ACADVER\n1\n{}\n9\n$DWGCODEPAGE\n3\n{}\n", version, page);
  };
  CHECK(read_as(header("AC1024", "ANSI_1252"), "Gew\u00f6lbe", "Gew\u00f6lbe"));
  CHECK(read_as(header("AC1015", "ANSI_1252"), "Gew\xf6lbe", "Gew\u00f6lbe"));
  CHECK(read_as(header("AC1024", "ANSI_1252"), "Gew\xf6lbe", "Gew\u00f6lbe"));
  CHECK(read_as(header("AC1015", "ANSI_1251"), "\xf1\xf2\xe5\xed\xe0",
                "\u0441\u0442\u0435\u043d\u0430"));
  CHECK(read_as(header("AC1015", "ANSI_932"), "\x90\xce", "\u77f3"));
  CHECK(read_as(header("AC1015", "ANSI_1252"), "\\U+77F3\\U+00f6", "\u77f3\u00f6"));
  CHECK(read_as(header("AC1015", "ANSI_1252"), "\\M+190CE", "\u77f3"));
  CHECK(read_as(header("AC1015", "ANSI_1252"), "\\U+D83E\\U+DEA8", "\U0001FAA8"));
  CHECK(read_as(header("AC1015", "ANSI_1252"), "\\U+D83E", R"(\\U+D83E)"));  // half a pair
  CHECK(read_as("", "Gew\u00f6lbe", "Gew\u00f6lbe"));
  CHECK(read_as("", "Gew\xf6lbe", "Gew\u00f6lbe"));
  CHECK_THROWS_WITH(
      read_as(header("AC1015", "ANSI_932"), "\x90", "\u77f3"),
      Catch::Contains("not in the code page \"ANSI_932\"") && Catch::Contains("DXF of 2007"));
}

TEST_CASE("what a DXF file draws and cannot be read is refused, unless its layer is left out",
          "[import]") {
  const Folder folder;
  const std::string stone = "0 LWPOLYLINE 8 s 90 3 70 1 10 0 20 0 10 1 20 0 10 0 20 1 ";
  const std::string spline =
      "0 SPLINE 5 4F 8 n 70 8 71 3 72 0 73 0 74 3 11 5 21 0 11 6 21 1 11 7 21 0 ";
  const auto error_with = [&](const std::string& entities, const std::string& blocks = "") {
    folder.write("a.dxf", dxf(stone + entities, blocks));
    const std::string left_out =
        R"({ "file": "a.dxf", "material": "rock", "layers": { "n": false } })";
    CHECK(error_of(folder, left_out) == "");
    return error_of(folder, R"({ "file": "a.dxf", "material": "rock" })");
  };
  const auto contains = [](const char* text) { return Catch::Contains(text); };
  CHECK_THAT(
      error_with(spline),
      contains("a.dxf: the SPLINE at line 31 (handle 4F) on layer \"n\": is a spline that is "
               "given by fit points alone, which is not supported yet; ") &&
          !contains(".cpp"));
  const std::string controls = "73 4 72 8 10 5 20 0 10 6 20 1 10 7 20 0 10 5 20 0 ";
  const auto with_knots = [&](const char* knots) {
    return "0 SPLINE 8 n 71 3 " + controls + knots;
  };
  CHECK(error_with(with_knots("40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 ")) == "");
  CHECK_THAT(error_with(with_knots("40 0 40 1 40 2 40 3 40 4 40 5 40 6 40 7 ")),
             contains("the SPLINE at line 31 on layer \"n\": is a periodic spline"));
  CHECK_THAT(error_with("0 SPLINE 8 n 71 3 73 2 72 0 10 0 20 0 10 1 20 1 "),
             contains("degree 3 with 2 control points and 0 knots"));
  CHECK_THAT(error_with("0 REGION 8 n 70 1 "),
             contains("the REGION at line 31 on layer \"n\": is not "
                      "supported yet; turn it into a closed polyline"));
  CHECK_THAT(error_with("0 AEC_WALL 8 n "), contains("the AEC_WALL at line 31"));
  CHECK_THAT(error_with("0 CIRCLE 8 n 10 0,5 20 0 40 1 "),
             contains("the CIRCLE at line 31 on layer \"n\": line 36: \"0,5\" is not a decimal"));
  CHECK_THAT(error_with("0 INSERT 8 n 2 gone 10 0 20 0 "), contains("inserts the block \"gone\""));
  // In a block it has the layer of the insert, if its own is 0.
  const std::string in_block = "0 SPLINE 8 0 71 3 74 3 11 5 21 0 11 6 21 1 11 7 21 0 ";
  CHECK_THAT(error_with("0 INSERT 8 n 2 B 10 0 20 0 ",
                        "0 SECTION 2 BLOCKS 0 BLOCK 8 0 2 B 70 0 10 0 20 0 " + in_block +
                            "0 ENDBLK 0 ENDSEC "),
             contains("on layer \"n\": is a spline that is given by fit points"));
}

TEST_CASE("a hatch over an outline is its hatching, and annotations are left out", "[import]") {
  const Folder folder;
  const std::string ring = "10 0 20 0 10 2 20 0 10 2 20 1 10 0 20 1 ";
  const std::string outline = "0 LWPOLYLINE 8 a 90 4 70 1 " + ring;
  const auto hatch = [](const std::string& of) {
    return "0 HATCH 8 h 10 0 20 0 30 0 210 0 220 0 230 1 2 SOLID 70 1 71 0 91 1 92 2 72 0 73 1 93 "
           "4 " +
           of + "97 0 75 0 76 1 98 0 ";
  };
  const std::string keys = R"({ "file": "a.dxf", "material": "rock" })";
  for (const bool first : {true, false}) {
    folder.write("a.dxf", dxf(first ? hatch(ring) + outline : outline + hatch(ring)));
    const Scene scene = imported(folder, keys);
    CHECK(scene.model.bodies.size() == 1);
    CHECK(scene.imports[0].read == std::map<std::string, int>{{"LWPOLYLINE", 1}});
    CHECK(scene.imports[0].left_out_in_words() == "1 HATCH (over an outline that is drawn)");
  }
  // A hatch of a part of it is another body in the same place.
  folder.write("a.dxf", dxf(outline + hatch("10 0 20 0 10 1 20 0 10 1 20 1 10 0 20 1 ")));
  CHECK(error_of(folder, keys).find("the HATCH at line 35 on layer \"h\": covers 100 % of") !=
        std::string::npos);

  folder.write("a.dxf",
               dxf(outline + "0 TEXT 8 t 10 1 20 0.5 40 0.1 1 a 0 DIMENSION 8 d 2 *D1 10 0 20 "
                             "0 70 0 0 XLINE 8 x 10 0 20 0 11 1 21 0 0 LWPOLYLINE 67 1 8 p 90 2 "
                             "70 0 10 0 20 0 10 1 20 0"));
  CHECK(imported(folder, keys).imports[0].left_out_in_words() ==
        "1 DIMENSION (no outline), 1 LWPOLYLINE (in the paper space), 1 TEXT (no outline), 1 XLINE "
        "(no outline)");
  CHECK(error_of(folder, R"({ "file": "a.dxf", "material": "rock", "lines": "polygonize" })")
            .find("the XLINE at line 59 on layer \"x\": is a line without an end") !=
        std::string::npos);
}

TEST_CASE("a map in degrees is refused, and a plan in metres is read", "[import]") {
  const Folder folder;
  const auto write = [&](double x, double y, double size, const std::string& crs = "") {
    folder.write(
        "a.geojson",
        fmt::format(R"({{"type": "Polygon", {}"coordinates": [[[{}, {}], [{}, {}], [{}, {}]]]}})",
                    crs, x, y, x + size, y, x, y + size));
  };
  const auto named = [](const char* name) {
    return fmt::format(R"("crs": {{"type": "name", "properties": {{"name": "{}"}}}}, )", name);
  };
  const std::string keys = R"({ "file": "a.geojson", "material": "rock")";
  const auto is_refused = [&] {
    const std::string error = error_of(folder, keys + " }");
    CHECK((error.empty() || (error.find("degrees of longitude and latitude") != std::string::npos &&
                             error.find("\"scale\": 1") != std::string::npos &&
                             error.find("ogr2ogr -t_srs EPSG:32") != std::string::npos)));
    CHECK(imported(folder, keys + R"(, "scale": 1 })").model.bodies.size() == 1);
    return !error.empty();
  };
  for (const auto& [x, y, size] : {std::tuple(7.1, 50.9, 1e-4),
                                   {7.1, 50.9, 0.5},
                                   {-70.5, -33.4, 1e-3},
                                   {0.1, 51.5, 0.01},
                                   {144.9, -37.8, 2.0}}) {
    write(x, y, size);
    CHECK(is_refused());
  }
  for (const auto& [x, y, size] : {std::tuple(0.0, 0.0, 1.0),
                                   {-2, 3, 4},
                                   {10, 5, 30},
                                   {400, 30, 1},
                                   {32 * 1e4, 565 * 1e4, 10}}) {
    write(x, y, size);
    CHECK_FALSE(is_refused());
  }
  write(1, 2, 3, named("urn:ogc:def:crs:OGC:1.3:CRS84"));
  CHECK(is_refused());
  write(7, 50, 0.1, named("urn:ogc:def:crs:EPSG::25832"));
  CHECK_FALSE(is_refused());
  write(7, 50, 0.1, R"("crs": null, )");
  CHECK(is_refused());
  write(3, 4, 1, named("EPSG:2225"));
  CHECK(imported(folder, keys + " }").model.bodies[0].area ==
        Approx(0.5 * std::pow(1200.0 / 3937, 2)).epsilon(1e-9));
}

TEST_CASE("outlines that are closed but for a small gap are closed", "[import]") {
  const Folder folder;
  folder.write(
      "a.dxf",
      dxf(polyline("s", {{"0", "0"}, {"1", "0"}, {"1", "1"}, {"0", "1"}, {"0", "1e-7"}}, false)));
  CHECK(areas(imported(folder, R"({ "file": "a.dxf", "material": "rock" })")).at("a-0") == 1);
  folder.write("a.wkt", "POLYGON ((0 0, 1 0, 1 1, 0 1, 0 1, 0 0, 0 0))");
  const Scene repeated = imported(folder, R"({ "file": "a.wkt", "material": "rock" })");
  CHECK(repeated.model.bodies[0].potential.size() == 4);
  folder.write("a.wkt", "POLYGON ((0 0, 0.5 0, 1 0, 1 1, 0 1))");
  const Scene collinear = imported(folder, R"({ "file": "a.wkt", "material": "rock" })");
  CHECK(collinear.model.bodies[0].potential.size() == 5);
}

TEST_CASE("outlines are repaired by choice, with a report", "[import]") {
  const Folder folder;
  folder.write("a.wkt",
               "POLYGON ((0 0, 2 2, 2 0, 0 2, 0 0))\n"
               "POLYGON ((5 0, 6 0, 8 0, 6 0, 6 1, 5 1, 5 0))\n");
  CHECK_THAT(error_of(folder, R"({ "file": "a.wkt", "material": "rock" })"),
             Catch::Contains("\"repair\": true"));
  const Scene scene =
      imported(folder, R"({ "file": "a.wkt", "material": "rock", "repair": true })");
  CHECK(scene.model.bodies.size() == 3);
  double area = 0;
  for (const auto& [name, part] : areas(scene)) area += part;
  CHECK(area == 3);
  const std::vector<std::string>& faults = scene.imports.at(0).faults;
  REQUIRE(faults.size() == 3);
  CHECK(faults[0] == "line 1: edge 0 and edge 2 cross at (1, 1) m");
  CHECK(faults[1] == "line 2: vertex 2 is a spike at (8, 0) m");
  CHECK_THAT(error_of(folder, R"({ "file": "a.wkt", "material": "rock", "repair": "yes" })"),
             Catch::Contains("true or false"));
  // Only a tolerance that is given simplifies.
  folder.write("b.wkt", "POLYGON ((0 0, 1 0.001, 2 0, 2 2, 0 2, 0 0))");
  const auto size = [&](const std::string& keys) {
    const std::string text =
        R"({ "file": "b.wkt", "material": "rock", "repair": true)" + keys + "}";
    return imported(folder, text).model.bodies.at(0).potential.size();
  };
  CHECK(size("") == 5);
  CHECK(size(R"(, "tolerance": 0.01)") == 4);
}

TEST_CASE("faulty outlines are left out and counted by choice", "[import]") {
  const Folder folder;
  folder.write("a.wkt",
               "POLYGON ((0 0, 2 2, 2 0, 0 2, 0 0))\n"
               "LINESTRING (0 9, 1 9, 1 8)\n"
               "POLYGON ((5 0, 6 0, 6 1, 5 1, 5 0))\n"
               "POLYGON ((5 0, 6 0, 6 0.5, 5 0.5, 5 0))\n"
               "POLYGON ((10 0, 14 0, 14 4, 10 4, 10 0), (10 1, 12 1, 12 2, 11 2, 10 1))\n");
  const Scene scene =
      imported(folder, R"({ "file": "a.wkt", "material": "rock", "faults": "skip" })");
  CHECK(scene.model.bodies.size() == 1);
  const ImportReport& report = scene.imports.at(0);
  CHECK(report.faults.size() == 4);
  CHECK(report.left_out_in_words() == "1 line (faulty), 3 polygons (faulty)");
  folder.write("a.wkt", "LINESTRING (0 9, 1 9, 1 8)\n");
  CHECK_THAT(error_of(folder, R"({ "file": "a.wkt", "material": "rock", "faults": "skip" })"),
             Catch::Contains("left out: 1 line (faulty)"));
}

TEST_CASE("names that cannot head a column are replaced, and it is said", "[import]") {
  const Folder folder;
  folder.write("a.geojson", R"({"type": "FeatureCollection", "features": [{"type": "Feature",
    "properties": {"name": "Lechviertel, \"oestliches\"\nViertel"},
    "geometry": {"type": "Polygon", "coordinates": [[[0,0],[1,0],[1,1],[0,1],[0,0]]]}}]})");
  const Scene scene = imported(folder, R"({ "file": "a.geojson", "material": "rock" })");
  CHECK(scene.model.bodies.at(0).name == "a-Lechviertel_ _oestliches__Viertel");
  REQUIRE(scene.imports.at(0).renamed.size() == 1);
  CHECK_THAT(scene.imports[0].renamed[0], Catch::Contains("Lechviertel, "));
}

TEST_CASE("a file of WKT holds geometries of several kinds", "[import]") {
  const Folder folder;
  folder.write("a.wkt",
               "# two triangles\r\nSRID=25832;MULTIPOLYGON (((0 0, 1 0, 0 1, 0 0)),\n((2 0, 4 0, 2 "
               "1, 2 0)))\n"
               "GEOMETRYCOLLECTION (POINT (9 9), POLYGON ((5 0, 8 0, 5 1, 5 0)))\n"
               "CURVEPOLYGON (COMPOUNDCURVE (CIRCULARSTRING (10 0, 11 1, 12 0), (12 0, 10 0)))\n");
  const auto found = areas(imported(folder, R"({ "file": "a.wkt", "material": "rock" })"));
  REQUIRE(found.size() == 4);
  CHECK(found.at("a-0") == 0.5);
  CHECK(found.at("a-1") == 1);
  CHECK(found.at("a-2") == 1.5);
  CHECK(found.at("a-3") == Approx(M_PI / 2).epsilon(1e-3));
}

TEST_CASE("a table may hold WKT, or vertices without an id", "[import]") {
  const Folder folder;
  folder.write("a.csv",
               "ID,Layer,WKT\n7,s,\"POLYGON ((0 0, 1 0, 0 1, 0 0))\"\n8,t,\"POLYGON ((2 0, 4 0, 2 "
               "1, 2 0))\"\n");
  const Scene scene = imported(
      folder,
      R"({ "file": "a.csv", "material": "rock", "layers": { "t": { "material": "clay" } } })");
  CHECK(areas(scene) == std::map<std::string, double>{{"a-7", 0.5}, {"a-8", 1}});
  CHECK(scene.model.bodies[1].material != scene.model.bodies[0].material);
  folder.write("a.csv", "x,y\n0,0\n1,0\n0,1\n");
  CHECK(areas(imported(folder, R"({ "file": "a.csv", "material": "rock" })")).at("a-0") == 0.5);
  // The same name twice names neither of them.
  folder.write("a.csv",
               "id,name,x,y\n1,n,0,0\n1,n,1,0\n1,n,0,1\n2,n,2,0\n2,n,3,0\n2,n,2,1\n3,m,4,0\n3,m,5,"
               "0\n3,m,4,1\n");
  CHECK(areas(imported(folder, R"({ "file": "a.csv", "material": "rock" })")) ==
        std::map<std::string, double>{{"a-0", 0.5}, {"a-1", 0.5}, {"a-m", 0.5}});
}

TEST_CASE("lines that cross divide the plane into bodies", "[import]") {
  const Folder folder;
  const std::string frame =
      line(0, 0, 3, 0) + line(3, 0, 3, 2) + line(3, 2, 0, 2) + line(0, 2, 0, 0);
  // One joint is too long, one ends within the tolerance of the frame, and one ends in a block.
  const std::string joints = line(1, -0.5, 1.2, 2.5) + line(1e-7, 0.9, 3 - 2e-7, 1.1) +
                             line(2, 0, 2, 0.3) + "0 TEXT 8 core 10 2 20 1.5 40 0.1 1 key";
  folder.write("a.dxf", dxf(frame + joints));
  const std::string entry = R"({ "file": "a.dxf", "material": "rock", "lines": "polygonize",
                                "layers": { "core": { "material": "clay" } } })";
  const Scene scene = imported(folder, entry);
  const auto found = areas(scene);
  REQUIRE(found.size() == 4);
  double sum = 0;
  for (const auto& [name, area] : found) sum += area;
  CHECK(sum == Approx(6));
  CHECK(found.count("a-key") == 1);
  for (const RigidBody& body : scene.model.bodies) {
    CHECK((scene.model.materials[body.material].name == "clay") == (body.name == "a-key"));
  }
  const auto simulation = make_simulation(scene, 1, Start::scene);
  for (const PairDepth& pair : simulation->overlaps()) CHECK(pair.depth < 1e-12);

  // Four blocks meet at the crossing, with the same bits.
  std::map<std::pair<double, double>, int> uses;
  for (const JsonValue& body : scene.document.find("bodies")->items()) {
    for (const JsonValue& v : body.find("polygon")->items()) {
      ++uses[{v.items()[0].number(), v.items()[1].number()}];
    }
  }
  int four = 0, two = 0;
  for (const auto& [vertex, n] : uses) {
    four += n == 4;
    two += n == 2;
  }
  CHECK(four == 1);
  CHECK(two == 4);
  CHECK(uses.size() == 4 + 4 + 1 + 1);  // the last one where the joint begins that ends in a block

  // A gap that is larger than the tolerance leaves two blocks in one.
  folder.write("a.dxf", dxf(frame + line(1, 0, 1, 1.99)));
  const std::string plain = R"({ "file": "a.dxf", "material": "rock", "lines": "polygonize")";
  CHECK(imported(folder, plain + " }").model.bodies.size() == 1);
  CHECK(imported(folder, plain + R"(, "tolerance": 0.02 })").model.bodies.size() == 2);
}

TEST_CASE("bodies with a mesh may be drawn with holes", "[import]") {
  const Folder folder;
  folder.write("a.wkt", "POLYGON ((0 0, 4 0, 4 4, 0 4), (1 1, 1 3, 3 3, 3 1))");
  const Scene scene =
      imported(folder, R"({ "file": "a.wkt", "material": "rock", "mesh": { "size": 0.5 } })");
  REQUIRE(scene.model.deformables.size() == 1);
  for (const Vec2& x : scene.model.deformables[0].mesh.nodes) {
    CHECK_FALSE((std::abs(x.x() - 2) < 0.99 && std::abs(x.y() - 2) < 0.99));
  }
}

TEST_CASE("rigid bodies have the holes of the drawing", "[import][holes]") {
  const Folder folder;
  // A solid inside of a hole is a body of its own.
  folder.write("a.wkt",
               "POLYGON ((0 0, 4 0, 4 4, 0 4), (1 1, 1 3, 3 3, 3 1))\n"
               "POLYGON ((1.5 1.5, 2.5 1.5, 2.5 2.5, 1.5 2.5))");
  const Scene scene = imported_distance(folder, R"({ "file": "a.wkt", "material": "rock" })");
  REQUIRE(scene.model.bodies.size() == 2);
  CHECK(scene.model.bodies[0].rings().size() == 2);
  CHECK(scene.model.bodies[0].area == 12);
  CHECK(scene.model.bodies[0].mass == Approx(24000).epsilon(1e-14));
  CHECK(scene.model.bodies[0].inertia == Approx(2000 * (16 * 32. - 4 * 8.) / 12).epsilon(1e-14));
  CHECK(scene.model.bodies[1].area == 1);
  // The same from GeoJSON, and with a line that crosses itself into a frame.
  folder.write("a.geojson", R"({"type": "Polygon", "coordinates": [[[0,0],[4,0],[4,4],[0,4],[0,0]],
    [[1,1],[1,3],[3,3],[3,1],[1,1]]]})");
  const Scene json =
      imported_distance(folder, R"({ "file": "a.geojson", "scale": 1, "material": "rock" })");
  REQUIRE(json.model.bodies.size() == 1);
  CHECK(json.model.bodies[0].potential.vertices == scene.model.bodies[0].potential.vertices);
  CHECK(scene_hash(json) != scene_hash(scene));
}

TEST_CASE("repaired outlines keep their holes", "[import][holes]") {
  const Folder folder;
  // The hole is drawn twice over itself, and the outline has a spike.
  folder.write("a.wkt",
               "POLYGON ((0 0, 4 0, 4 4, 6 6, 4 4, 0 4), (1 1, 1 3, 2 3, 2 5, 2 3, 3 3, 3 1))");
  const Scene scene =
      imported_distance(folder, R"({ "file": "a.wkt", "material": "rock", "repair": true })");
  REQUIRE(scene.model.bodies.size() == 1);
  CHECK(scene.model.bodies[0].rings().size() == 2);
  CHECK(scene.model.bodies[0].area == Approx(12).epsilon(1e-15));
}

TEST_CASE("outlines inside of each other are holes by turns if the import says so",
          "[import][holes]") {
  const Folder folder;
  const auto square = [](const char* layer, const char* from, const char* to) {
    return polyline(layer, {{from, from}, {to, from}, {to, to}, {from, to}});
  };
  // From outside: a ring, a ring in its hole, and in the hole of that a solid on another layer.
  folder.write("a.dxf", dxf(square("steel", "2", "8") + " " + square("steel", "0", "10") + " " +
                            square("rubber", "4.5", "5.5") + " " + square("steel", "3", "7") + " " +
                            square("steel", "4", "6")));
  const std::string plain = R"({ "file": "a.dxf", "material": "rock", "scale": 1)";
  CHECK_THAT(error_of(folder, plain + " }"), Catch::Contains("covers 100 %"));
  const Scene scene = imported_distance(folder, plain + R"(, "holes": "nested" })");
  REQUIRE(scene.model.bodies.size() == 3);
  std::multiset<double> areas;
  for (const RigidBody& body : scene.model.bodies) areas.insert(body.area);
  CHECK(areas == std::multiset<double>{1, 16 - 4, 100 - 36});
  CHECK(scene.model.bodies[0].rings().size() == 2);
  CHECK(scene.model.bodies[1].rings().size() == 1);
  CHECK(scene.model.bodies[2].rings().size() == 2);
  REQUIRE(scene.imports.size() == 1);
  CHECK(scene.imports[0].bodies == 3);
  CHECK_THAT(error_of(folder, plain + R"(, "holes": "neted" })"),
             Catch::Contains("did you mean \"nested\"?"));

  // A hole that crosses its outline is faulty, and with it the outline.
  folder.write("a.dxf", dxf(square("steel", "0", "10") + " " +
                            polyline("steel", {{"1", "1"}, {"11", "1"}, {"2", "2"}}) + " " +
                            square("steel", "20", "21")));
  CHECK_THAT(error_of(folder, plain + R"(, "holes": "nested" })"), Catch::Contains("covers"));
}

TEST_CASE("what cannot be imported is refused with its place and a remedy", "[import]") {
  const Folder folder;
  folder.write("wall.dxf", wall_as("dxf"));
  struct Case {
    const char *file, *text, *keys;
    std::vector<const char*> messages;
  };
  const std::string open = dxf(polyline("s", {{"0", "0"}, {"1", "0"}, {"1", "1"}}, false));
  const std::string hatch_and_frame =
      dxf(polyline("s", {{"0", "0"}, {"1", "0"}, {"1", "1"}}) + " " +
          polyline("t", {{"0", "0"}, {"1", "0"}, {"1", "1"}}));
  const std::string two_labels =
      dxf(polyline("s", {{"0", "0"}, {"1", "0"}, {"0", "1"}}) +
          " 0 TEXT 8 u 10 0.2 20 0.2 40 0.1 1 a 0 TEXT 8 v 10 0.3 20 0.2 40 0.1 1 b");
  const Case cases[]{
      {"a.dxf",
       open.c_str(),
       "",
       {":4: /import/0/file: a.dxf: the POLYLINE at line 11 on layer \"s\": ",
        "the line is open, with 1.41 m between its ends", "polygonize"}},
      {"a.dxf",
       hatch_and_frame.c_str(),
       "",
       {"a.dxf: the POLYLINE at line 45 on layer \"t\": covers 100 % of the POLYLINE at line 11 on "
        "layer \"s\"",
        "delete one of them"}},
      {"a.dxf",
       two_labels.c_str(),
       R"(, "lines": "polygonize")",
       {"the TEXT at line 57 on layer \"v\": is a second label of one face, besides the TEXT at "
        "line 45 on layer \"u\""}},
      {"a.dxf", "0\nSECTION\n2\nENTITIES\n0\nLINE\n", "", {"a.dxf: is not valid DXF"}},
      {"a.dxf", "PK\003", "", {"a.dxf: is not valid DXF"}},
      {"a.wkt",
       "POLYGON ((0 0, 4 0, 4 4, 0 4), (1 1, 1 3, 5 3, 3 1))",
       "",
       {"a.wkt: line 1: hole 0 crosses or touches the outer ring", "correct the drawing"}},
      {"a.wkt",
       "POLYGON ((0 0, 4 0, 4 4, 0 4))\nPOLYGON ((1 1, 1 3, 3 3, 3 1))",
       "",
       {"a.wkt: line 2: covers 100 % of line 1", "say \"holes\": \"nested\" if the inner one is"}},
      {"a.wkt",
       "POLYGON ((0 0, 9 0, 9 9, 0 9))\nPOLYGON ((1 1, 1 8, 8 8, 8 1), (2 2, 3 2, 2 3))",
       R"(, "holes": "nested")",
       {"a.wkt: line 2: lies inside of line 1 and has a hole itself"}},
      {"a.wkt",
       "\nPOLYGON ((0 0, 1 1, 1 0, 0 1, 0 0))",
       "",
       {"a.wkt: line 2: ", "edge 0 and edge 2 cross or touch", "correct the drawing"}},
      {"a.wkt",
       "POLYGON ((0 0, 2 0, 1 1, 2 2, 0 2, 1 1))",
       "",
       {"a.wkt: line 1: ", "vert", "correct the drawing"}},
      {"a.wkt", "POLYGON EMPTY", "", {"a.wkt: line 1: "}},
      {"a.wkt",
       "LINESTRING (0 0, 1 1)",
       R"(, "lines": "polygonize")",
       {"a.wkt: its lines enclose no face", "\"tolerance\""}},
      {"a.wkt", "POINT (0 0)", "", {"a.wkt: holds no closed outline"}},
      {"a.wkt", "", "", {"a.wkt: holds no closed outline"}},
      {"a.wkt",
       "POLYGON ((0 0, 1 0, 0 1))\nPOLYGON ((0 0, 1,5 0, 0 1))",
       "",
       {"a.wkt:2: is not valid WKT", "POLYGON ((x y, x y, ...))"}},
      {"a.wkt", "POLYGON ((0 0, 1 0, 0 1)) and more", "", {"a.wkt:1: is not valid WKT"}},
      {"a.wkt",
       "POLYGON ((0 0, 1 0, 0 1))",
       R"(, "layers": { "s": false })",
       {"/import/0/layers/s: the drawing has no layers"}},
      {"a.csv", "x,y\n0,0\n1,0\n1,a\n", "", {"a.csv: row 3: y: \"a\" is not a decimal number"}},
      {"a.csv", "a,b\n0,0\n", "", {"a.csv: row 1: has no shape", "columns x and y"}},
      {"a.csv",
       "WKT\n\"POLYGON ((0 0, 1 0, 0 1))\"\n",
       "",
       {"a.csv: is not valid CSV; give it a header and two columns"}},
      {"a.csv",
       "id,WKT\n1,\"POLYGON ((0 0, 1 0\"\n",
       "",
       {"a.csv: row 1: has no shape, or no valid one"}},
      {"a.geojson", "{\"type\": \"Feat", "", {"a.geojson: is not valid GeoJSON"}},
      {"a.geojson",
       R"({"type": "Feature", "properties": {}, "geometry": null})",
       "",
       {"a.geojson: feature 1: has no shape"}},
      {"a.dxf", "AC1032", "", {"a.dxf: is not valid DXF but a DWG file", "DXF (ASCII)"}},
      {"a.dxf",
       "AutoCAD Binary DXF\r\n",
       "",
       {"a.dxf: is a binary DXF file, which is not supported yet", "DXF (ASCII)"}},
      {"a.wkt",
       "SRID=4326;POLYGON ((7 50, 7.1 50, 7 50.1))",
       "",
       {"a.wkt: is in degrees of longitude and latitude (EPSG:4326)", "EPSG:32632",
        "\"scale\": 1"}},
      {"a.wkt",
       "SRID=4326;POLYGON ((7 50, 7.1 50, 7 50.1))\nSRID=25832;POLYGON ((7 50, 7.1 50, 7 50.1))",
       "",
       {"a.wkt: holds two coordinate systems, EPSG:4326 and EPSG:25832"}},
      {"a.dwg", "AC1032", "", {"a.dwg: is of no known format; drawings are .dxf"}},
      {"wall.dxf",
       nullptr,
       R"(, "layers": { "stone": { "motion": "fixed" } })",
       {":4: /import/0/layers/stone: the drawing has no layer \"stone\"; did you mean \"stones\"?",
        "ground, stones"}},
      {"wall.dxf",
       nullptr,
       R"(, "layers": { "stones": true })",
       {"/import/0/layers/stones: must be an object", "false"}},
      {"wall.dxf", nullptr, R"(, "layers": [])", {"/import/0/layers: must be {\"LAYER\""}},
      {"wall.dxf",
       nullptr,
       R"(, "layers": { "stones": { "scale": 2 } })",
       {"/import/0/layers/stones/scale: unknown key"}},
      {"wall.dxf", nullptr, R"(, "scale": 0)", {"/import/0/scale: must be positive (in m)"}},
      {"wall.dxf", nullptr, R"(, "tolerance": -1)", {"/import/0/tolerance: must be positive"}},
      {"wall.dxf",
       nullptr,
       R"(, "lines": "polygonise")",
       {"/import/0/lines: unknown choice \"polygonise\"; did you mean \"polygonize\""}},
      {"wall.dxf", nullptr, R"(, "mesh": { "fill": 1 })", {"/import/0/mesh: missing key \"size\""}},
      {"wall.dxf",
       nullptr,
       R"(, "mesh": { "size": 1, "cells": 1 })",
       {"/import/0/mesh/cells: unknown key"}},
      {"wall.dxf", nullptr, R"(, "mesh": true)", {"/import/0/mesh: must be {\"size\""}},
      {"wall.dxf",
       nullptr,
       R"(, "mesh": { "size": -1 })",
       {"/import/0/mesh/size: must be positive"}},
      {"wall.dxf", nullptr, R"(, "motion": "fix")", {"/import/0/motion: unknown choice"}},
      {"nothing.dxf",
       nullptr,
       "",
       {":4: /import/0/file: ", "nothing.dxf: cannot be opened", "check the name"}},
      {"nothing.wkt", nullptr, "", {"nothing.wkt: cannot be opened"}},
  };
  for (const Case& c : cases) {
    if (c.text) folder.write(c.file, c.text);
    const std::string error = error_of(
        folder, fmt::format(R"({{ "file": "{}", "material": "rock"{} }})", c.file, c.keys));
    INFO(c.file << ": " << (c.text ? c.text : c.keys) << "\n" << error);
    CHECK(error.find("scene.json:4: /import/0") != std::string::npos);
    for (const char* message : c.messages) CHECK(error.find(message) != std::string::npos);
    CHECK(error.find('\n') == std::string::npos);
  }
  CHECK(error_of(folder, R"({ "material": "rock" })").find("missing key \"file\"") !=
        std::string::npos);
  CHECK(error_of(folder, R"({ "file": "wall.dxf" })").find("/import/0: missing key \"material\"") !=
        std::string::npos);
  CHECK(error_of(folder, "").find("must hold at least one body") != std::string::npos);
}

TEST_CASE("the program refuses a drawing with exit code 2, and a checkpoint of another one",
          "[import]") {
  const Folder folder;
  folder.write("a.csv", "id,layer,x,y\n1,s,0,0\n1,s,1,0\n1,s,0,1\n");
  const std::string file = folder.write(
      "scene.json",
      scene_with(
          R"({ "file": "a.csv", "material": "rock", "layers": { "s": { "velocity": [1, 0] } } })"));
  CHECK(test::run({"check", file}, folder).code == 0);
  const std::string hash = scene_hash(read_scene(file));
  CHECK(scene_hash(read_scene(file)) == hash);
  folder.write("a.csv", "id,layer,x,y\n1,s,0,0\n1,s,1,0\n1,s,0,1.000001\n");
  CHECK(scene_hash(read_scene(file)) != hash);
  folder.write("a.csv", "id,layer,x,y\n2,s,0,0\n2,s,1,0\n2,s,0,1\n");
  CHECK(scene_hash(read_scene(file)) != hash);
  folder.write("a.csv", "id,layer,x,y\n1,s,0,0\n1,s,1,0\n");
  const test::Result result = test::run({"run", file, "-o", folder / "out"}, folder);
  CHECK(result.code == 2);
  CHECK(result.err.find("a.csv: the outline \"1\" from row 1 on layer \"s\": ") !=
        std::string::npos);
}
