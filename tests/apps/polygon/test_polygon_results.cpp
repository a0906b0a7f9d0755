// Files, points and repairs of `apothem polygon`.
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

const std::string kPlate = "[[0,0],[4,0],[4,2],[0,2]]";

std::string shapes(const Folder& folder, const std::string& what, const std::string& ending) {
  const std::string file = folder / "shapes" + ending;
  const std::string plate = folder.write("plate.json", kPlate);
  REQUIRE(run({"polygon", plate, "--output", what, "-o", file}, folder).code == 0);
  return file;
}

}  // namespace

TEST_CASE("parts of a polygon's geometry are written as shapes", "[program][polygon]") {
  const Folder folder;
  CHECK(content(shapes(folder, "offset:0.5", ".wkt")) ==
        "POLYGON ((0.5 0.5, 3.5 0.5, 3.5 1.5, 0.5 1.5, 0.5 0.5))\n");
  CHECK(content(shapes(folder, "offset:1", ".wkt")) == "GEOMETRYCOLLECTION EMPTY\n");
  CHECK(content(shapes(folder, "singular-area", ".wkt")).starts_with("LINESTRING ("));
  const Json skeleton = Json::parse(content(shapes(folder, "skeleton", ".geojson")));
  CHECK(skeleton["features"].size() == 5);
  for (const Json& arc : skeleton["features"]) {
    CHECK(arc["geometry"]["type"] == "LineString");
    CHECK(arc["properties"]["end_height"].get<double>() <= 1);
  }
  const Json faces = Json::parse(content(shapes(folder, "faces", ".geojson")));
  REQUIRE(faces["features"].size() == 4);
  for (int e = 0; e < 4; ++e) CHECK(faces["features"][e]["properties"]["edge"] == e);
  const Json circle = Json::parse(content(shapes(folder, "incircle", ".geojson")));
  CHECK(circle["features"].size() == 2);  // at both ends of the segment of centres
  CHECK(circle["features"][0]["properties"]["radius"] == 1);
  const GridFile vtu = read_vtu(shapes(folder, "faces", ".vtu"));
  CHECK(vtu.cells() == 4);
  CHECK(vtu.cell_array("edge").values == std::vector<double>{0, 1, 2, 3});
  CHECK(content(shapes(folder, "skeleton", ".svg")).find("data-left_edge=\"0\"") !=
        std::string::npos);
}

TEST_CASE("points are evaluated as a table or JSON", "[program][polygon]") {
  const Folder folder;
  const std::string plate = folder.write("plate.json", kPlate);
  const Result one = run({"polygon", plate, "--at", "2,0.5"}, folder);
  CHECK(one.out ==
        "x [m],y [m],side,phi,gradient_x [1/m],gradient_y [1/m],nearest_edge,signed_distance [m]\n"
        "2,0.5,inside,0.5,0,1,0,-0.5\n");
  const std::string points = folder.write("points.csv", "x,y\n4,1\n-1,1\n2,1.5\n");
  const Json json = Json::parse(run({"polygon", plate, "--points", points, "--json"}, folder).out);
  REQUIRE(json["points"].size() == 3);
  CHECK(json["points"][0]["side"] == "boundary");
  CHECK(json["points"][1]["signed_distance"] == 1);
  CHECK(json["points"][1]["nearest_edge"] == 3);
  CHECK(json["points"][2]["gradient"] == Json::parse("[0,-1]"));
  CHECK(run({"polygon", plate, "--at", "-1,1"}, folder).out.find("-1,1,outside,0,0,0,3,1\n") !=
        std::string::npos);
  for (const char* text : {"", "x,y\n", "1\n", "1,a\n"}) {
    const Result bad = run({"polygon", plate, "--points", folder.write("bad.csv", text)}, folder);
    CHECK(bad.code == 2);
    CHECK(lines(bad.err) == 1);
  }
}

TEST_CASE("repair lists faults and writes what is valid", "[program][polygon][repair]") {
  const Folder folder;
  const std::string bow = folder.write("bow.json", "[[0,0],[2,2],[2,0],[0,2]]");
  const Result result = run({"polygon", bow, "--repair", "-o", folder / "fixed.wkt"}, folder);
  CHECK(result.code == 0);
  CHECK(result.out.starts_with("the ring: edge 0 and edge 2 cross at (1, 1) m\n"));
  CHECK(content(folder / "fixed.wkt") ==
        "MULTIPOLYGON (((0 0, 1 1, 0 2, 0 0)), ((2 2, 1 1, 2 0, 2 2)))\n");
  const std::string lines_file = folder.write(
      "lines.wkt", "LINESTRING (0 0, 4 0, 4 4, 0 4, 0 0.001)\nLINESTRING (8 0, 9 0, 9 1)\n");
  const Json json = Json::parse(
      run({"polygon", lines_file, "--repair", "--tolerance", "0.01", "--json"}, folder).out);
  CHECK(json["left_out"] == 1);
  CHECK(json["faults"].size() == 3);
  CHECK(json["area"] == 16);
  CHECK(json["hausdorff_distance"].get<double>() <= 0.01);
  CHECK(json["polygons"][0]["polygon"].size() == 4);
  // Without a tolerance the gap is too wide, and nothing is left.
  const Result none = run({"polygon", lines_file, "--repair", "-o", folder / "none.wkt"}, folder);
  CHECK(none.code == 2);
  CHECK(lines(none.err) == 1);
  CHECK_FALSE(std::filesystem::exists(folder / "none.wkt"));
}

TEST_CASE("wrong calls for results of a polygon write nothing", "[program][polygon]") {
  const Folder folder;
  const std::string plate = folder.write("plate.json", kPlate);
  const std::string file = folder / "shapes.wkt";
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--output", "faces"},
                                             {"-o", file},
                                             {"--output", "roof", "-o", file},
                                             {"--output", "offset:-1", "-o", file},
                                             {"--output", "offset:x", "-o", file},
                                             {"--output", "faces", "-o", file + ".txt"},
                                             {"--output", "faces", "-o", file, "--repair"},
                                             {"--tolerance", "1"},
                                             {"--repair", "--tolerance", "-1"},
                                             {"--at", "1"},
                                             {"--at", "1,2", "--repair"}}) {
    std::vector<std::string> call{"polygon", plate};
    call.insert(call.end(), more.begin(), more.end());
    const Result result = run(call, folder);
    CHECK(result.code == 2);
    CHECK(lines(result.err) == 1);
  }
  CHECK_FALSE(std::filesystem::exists(file));
}
