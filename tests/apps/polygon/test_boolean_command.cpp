// `apothem boolean`, and the files of shapes that it and `apothem contact` write.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lib/output/vtu_file.hpp"
#include "lib/scene/polygon_file.hpp"
#include "tests/program.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace {

const std::string kSquare = "[[0,0],[4,0],[4,4],[0,4]]";
const std::string kInner = "POLYGON ((1 1, 3 1, 3 3, 1 3, 1 1))";
const std::string kTriangle = "[[3.3,3.1],[5,3],[5,5]]";

}  // namespace

TEST_CASE("boolean writes WKT on standard output, or a file", "[program][boolean]") {
  const Folder folder;
  const std::string a = folder.write("a.json", kSquare), b = folder.write("b.wkt", kInner);
  const Result hole = run({"boolean", a, b, "difference"}, folder);
  CHECK(hole.code == 0);
  CHECK(hole.out == "POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 1 3, 3 3, 3 1, 1 1))\n");
  CHECK(hole.err == "difference: 1 polygon with 1 hole, 12 m^2\n");
  const Result file = run({"boolean", a, b, "intersection", "-o", folder / "c.wkt"}, folder);
  CHECK(file.out == "intersection: 1 polygon with 0 holes, 4 m^2\n");
  CHECK(content(folder / "c.wkt") == "POLYGON ((1 1, 3 1, 3 3, 1 3, 1 1))\n");
  const Json json = Json::parse(run({"boolean", a, b, "difference", "--json"}, folder).out);
  CHECK(json["area"] == 12);
  CHECK(json["polygons"][0]["holes"][0] == Json::parse("[[1,1],[1,3],[3,3],[3,1]]"));
  CHECK(run({"boolean", b, a, "difference"}, folder).out == "GEOMETRYCOLLECTION EMPTY\n");
}

TEST_CASE("polygons with holes are written, read back and combined", "[program][boolean][holes]") {
  const Folder folder;
  const std::string a = folder.write("a.json", kSquare), b = folder.write("b.wkt", kInner);
  for (const char* name : {"frame.wkt", "frame.geojson"}) {
    INFO(name);
    const std::string frame = folder / name;
    REQUIRE(run({"boolean", a, b, "difference", "-o", frame}, folder).code == 0);
    CHECK(area_moments(polygon_of_file(frame)).area == 12);
    // The hole closes, and nothing of the inner square is in the frame.
    CHECK(run({"boolean", frame, b, "union"}, folder).err ==
          "union: 1 polygon with 0 holes, 16 m^2\n");
    CHECK(run({"boolean", frame, b, "intersection"}, folder).out == "GEOMETRYCOLLECTION EMPTY\n");
    const Json json = Json::parse(run({"boolean", a, frame, "difference", "--json"}, folder).out);
    CHECK(json["area"] == 4);
    CHECK(json["polygons"][0]["holes"].empty());
    // A square over a side of the hole: the overlap is what lies outside of it.
    const std::string c = folder.write("c.json", "[[2,2],[3.5,2],[3.5,2.5],[2,2.5]]");
    const Result contact = run({"contact", frame, c, "--method", "all", "--json", "--output",
                                "overlap", "-o", folder / "overlap.wkt"},
                               folder);
    INFO(contact.err);
    REQUIRE(contact.code == 0);
    CHECK(content(folder / "overlap.wkt") == "POLYGON ((3.5 2, 3.5 2.5, 3 2.5, 3 2, 3.5 2))\n");
    for (const Json& result : Json::parse(contact.out)["results"]) {
      INFO(result["method"]);
      CHECK(double(result["overlap_area"]) == Approx(.25).epsilon(1e-14));
      CHECK(double(result["force"][0]) > 0);
      CHECK(std::abs(double(result["force"][1])) < 1e-14);
    }
  }
}

TEST_CASE("what is written is read back to the same bits", "[program][boolean]") {
  const Folder folder;
  const std::string a = folder.write("a.json", kSquare), b = folder.write("b.json", kTriangle);
  REQUIRE(run({"boolean", a, b, "union", "-o", folder / "c.wkt"}, folder).code == 0);
  REQUIRE(run({"boolean", a, b, "union", "-o", folder / "c.geojson"}, folder).code == 0);
  const std::vector<Vec2> ring = polygon_of_file(folder / "c.wkt").vertices();
  CHECK(ring.size() == 8);
  CHECK(polygon_of_file(folder / "c.geojson").vertices() == ring);
  REQUIRE(run({"boolean", a, b, "union", "-o", folder / "c.vtu"}, folder).code == 0);
  CHECK(read_vtu(folder / "c.vtu").points == ring);
  REQUIRE(run({"boolean", a, b, "union", "-o", folder / "c.svg"}, folder).code == 0);
  CHECK(content(folder / "c.svg").find("L4 3.058823529411765 L5 3 L5 5 L4 3.8823529411764706") !=
        std::string::npos);
}

TEST_CASE("polygons with holes are convex cells in VTK", "[program][boolean]") {
  const Folder folder;
  const std::string a = folder.write("a.json", kSquare), b = folder.write("b.wkt", kInner);
  REQUIRE(run({"boolean", a, b, "difference", "-o", folder / "c.vtu"}, folder).code == 0);
  const GridFile file = read_vtu(folder / "c.vtu");
  double area = 0;
  for (size_t c = 0; c < file.cells(); ++c) {
    const std::vector<Vec2> ring = file.line(c);
    for (size_t i = 2; i < ring.size(); ++i) {
      area += cross(Vec2(ring[i - 1] - ring[0]), Vec2(ring[i] - ring[0])) / 2;
    }
  }
  CHECK(area == Approx(12));
}

TEST_CASE("contact writes the overlap", "[program][boolean]") {
  const Folder folder;
  const std::string a = folder.write("a.json", kSquare), b = folder.write("b.json", kTriangle);
  const Result result =
      run({"contact", a, b, "--output", "overlap", "-o", folder / "o.wkt", "--json"}, folder);
  REQUIRE(result.code == 0);
  const Polygon overlap = polygon_of_file(folder / "o.wkt");
  CHECK(overlap.size() == 3);
  const Json json = Json::parse(result.out);
  CHECK(area_moments(overlap).area ==
        Approx(json["results"][0]["overlap_area"].get<double>()).epsilon(1e-12));
}

TEST_CASE("a wrong call of boolean writes nothing", "[program][boolean]") {
  const Folder folder;
  const std::string a = folder.write("a.json", kSquare), b = folder.write("b.json", kTriangle);
  const std::string bow_tie = folder.write("bow.json", "[[0,0],[1,1],[1,0],[0,1]]");
  for (const std::vector<std::string>& call : std::vector<std::vector<std::string>>{
           {"boolean", a, b},
           {"boolean", a, b, "sum"},
           {"boolean", a, b, "union", "-o", folder / "c.txt"},
           {"boolean", a, folder / "missing", "union", "-o", folder / "c.wkt"},
           {"boolean", a, bow_tie, "union", "-o", folder / "c.wkt"},
           {"contact", a, b, "--output", "overlap"},
           {"contact", a, b, "--output", "union", "-o", folder / "c.wkt"},
           {"contact", a, b, "--output", "overlap", "-o", folder / "c.png"},
           {"contact", a, b, "-o", folder / "c.wkt"}}) {
    const Result result = run(call, folder);
    CHECK(result.code == 2);
    CHECK(lines(result.err) == 1);
  }
  for (const char* file : {"c.txt", "c.wkt", "c.png"}) {
    CHECK_FALSE(std::filesystem::exists(folder / file));
  }
}
