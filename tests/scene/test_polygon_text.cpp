// Polygons as text: what is a polygon is read the same from every notation, and what is none is
// refused with its place and a remedy, never read as something else.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <sstream>

#include "lib/scene/json.hpp"
#include "lib/scene/pair_file.hpp"
#include "lib/scene/polygon_file.hpp"
#include "lib/scene/ring_line.hpp"
#include "lib/text/decimal.hpp"
#include "tests/folder.hpp"

using namespace apothem;
using test::Folder;

namespace {

const std::vector<Vec2> kTriangle{{0, 0}, {1.5, 0}, {0.25, 1e-3}};

struct Refused {
  std::string text;
  int line, vertex;  // that the error names; line 0 and vertex -1: none
  std::string says;
};

void check_refused(const Folder& folder, const std::string& name, const Refused& bad) {
  INFO(bad.text);
  const std::string file = folder.write(name, bad.text);
  try {
    polygon_of_file(file);
    FAIL("is accepted");
  } catch (const SceneError& error) {
    INFO(error.what());
    CHECK(std::string(error.what()).starts_with(file));
    CHECK(error.reason().find(bad.says) != std::string::npos);
    CHECK(error.line() == bad.line);
    const auto* at_vertex = dynamic_cast<const PolygonError*>(&error);
    CHECK((at_vertex ? at_vertex->vertex() : -1) == bad.vertex);
  }
}

}  // namespace

TEST_CASE("a number is a whole word in decimal notation", "[scene][text]") {
  for (const auto& [word, value] :
       {std::pair<const char*, double>{"0", 0},
        {"-1.5", -1.5},
        {"+1", 1},
        {".5", .5},
        {"5.", 5},
        {"1e-3", 1e-3},
        {"1E+3", 1e3},
        {"-0", 0},
        {"1e-999", 0},
        {"0.1", .1},
        {"4.9406564584124654e-324", std::numeric_limits<double>::denorm_min()}}) {
    INFO(word);
    CHECK(parse_decimal(word) == value);
  }
  for (const auto& [word, reason] : {std::pair<const char*, const char*>{"", "not a decimal"},
                                     {"+", "not a decimal"},
                                     {"+-1", "not a decimal"},
                                     {"1e", "not a decimal"},
                                     {"1.2.3", "not a decimal"},
                                     {"1,5", "not a decimal"},
                                     {"0x10", "not a decimal"},
                                     {"0x1p4", "not a decimal"},
                                     {"1d5", "not a decimal"},
                                     {" 1", "not a decimal"},
                                     {"1m", "not a decimal"},
                                     {"nan", "not finite"},
                                     {"-INF", "not finite"},
                                     {"Infinity", "not finite"},
                                     {"1e999", "out of the range"},
                                     {"-1e999", "out of the range"}}) {
    INFO(word);
    CHECK_THROWS_WITH(parse_decimal(word), Catch::Contains(reason));
    CHECK_THROWS_AS(parse_decimal(word), BadNumber);
  }
  CHECK(parse_count("12") == 12);
  for (const char* word : {"", "-1", "1.5", "3x", "99999999999"}) {
    CHECK_THROWS_AS(parse_count(word), BadNumber);
  }
}

TEST_CASE("one ring, in every notation, with and without its closing vertex", "[scene][text]") {
  const Folder folder;
  const std::string ring = "[[0,0],[1.5,0],[0.25,1e-3]]";
  const std::string closed = "[[0,0],[1.5,0],[0.25,1e-3],[0,0]]";
  const std::string geometry = R"({"type": "Polygon", "coordinates": [)" + closed + "]}";
  const std::string feature =
      R"({"type": "Feature", "id": 7, "properties": {"type": "rock"}, "geometry": )" + geometry +
      "}";
  const std::string cases[]{
      ring,
      closed,
      "// a comment\n" + ring,
      "\xEF\xBB\xBF" + ring,
      R"({"polygon": )" + ring + "}",
      R"({"polygon": )" + closed + "}",
      geometry,
      R"({"type": "Polygon", "coordinates": [)" + ring + "]}",
      R"({"type": "MultiPolygon", "coordinates": [[)" + closed + "]]}",
      feature,
      R"({"type": "FeatureCollection", "name": "one", "features": [)" + feature + "]}",
      R"({"type": "GeometryCollection", "geometries": [)" + geometry + "]}",
      "POLYGON((0 0, 1.5 0, 0.25 1e-3, 0 0))\n",
      "POLYGON ((0 0, 1.5 0, 0.25 1e-3))",
      "polygon((0 0,1.5 0,0.25 1e-3,0 0))",
      "\xEF\xBB\xBFPOLYGON((0 0, 1.5 0, 0.25 1e-3, 0 0))",
      "POLYGON\t((\n0 0,\n1.5\t0,\n0.25\n1e-3,\n0 0\n))\n\n",
      "\r\nPOLYGON ((\r\n  0 0,\r\n  1.5 0,\r\n  0.25 1e-3,\r\n  0 0\r\n))\r\n",
      "POLYGON((+0 -0, 15e-1 0., .25 0.001, 0 0));",
      "SRID=25832;POLYGON((0 0, 1.5 0, 0.25 1e-3, 0 0))",
      "MULTIPOLYGON(((0 0, 1.5 0, 0.25 1e-3, 0 0)))",
      "MultiPolygon\n( ( ( 0 0 , 1.5 0 , 0.25 1e-3 , 0 0 ) ) )",
  };
  for (const std::string& text : cases) {
    INFO(text);
    const PolygonText read = read_polygon_file(folder.write("ring", text));
    CHECK(read.outer.ring == kTriangle);
    CHECK(read.outer.lines.size() >= 3);
    CHECK(read.holes.empty());
  }
  CHECK(
      read_polygon_file(folder.write("ring", "POLYGON((0 0,\n1.5 0,\n\n0.25 1e-3))")).outer.lines ==
      std::vector<int>{1, 2, 4});
  std::istringstream line(" 4 0 0 1.5 0 0.25 1e-3 0 0\r");
  CHECK(read_ring(line) == kTriangle);
  CHECK_NOTHROW(require_end(line));
}

TEST_CASE("text that is not the polygon it seems to be is refused", "[scene][text]") {
  const Folder folder;
  for (const Refused& bad : std::initializer_list<Refused>{
           {"POLYGON((0 0,1,5 0,0 1,0 0))", 1, 1, "vertex 1 has one coordinate, 1: give x y"},
           {"POLYGON((0 0,\n1 0,\n1,\n0 0))", 3, 2, "vertex 2 has one coordinate"},
           {"POLYGON((0 0, 1 0, 0 1, ))", 1, 3, "vertex 3 has no coordinates"},
           {"POLYGON((0 0, 1 0,, 0 1))", 1, 2, "vertex 2 has no coordinates"},
           {"POLYGON((0 0, 0x2 0, 0 1))", 1, 1, "\"0x2\" is not a decimal number"},
           {"POLYGON((0 0, 1 0, 0 nan))", 1, 2, "\"nan\" is not finite"},
           {"POLYGON((0 0, 1 0, 0 1e999))", 1, 2, "out of the range"},
           {"POLYGON((0 zero))", 1, 0, "\"zero\" is not a decimal number"},
           {"POLYGON Z ((0 0 5, 1 0 5, 0 1 5))", 1, -1, "two-dimensional: write POLYGON"},
           {"POLYGONZ((0 0 5, 1 0 5, 0 1 5))", 1, -1, "two-dimensional: write POLYGON"},
           {"POLYGON M ((0 0 5, 1 0 5, 0 1 5))", 1, -1, "two-dimensional: write POLYGON"},
           {"POLYGON ZM ((0 0 5 1, 1 0 5 1, 0 1 5 1))", 1, -1, "two-dimensional"},
           {"POLYGON((0 0 5, 1 0 5, 0 1 5))", 1, 0, "has 3 coordinates"},
           {"POLYGON EMPTY", 1, -1, "EMPTY; give it three vertices"},
           {"MULTIPOLYGON EMPTY", 1, -1, "EMPTY; give it three vertices"},
           {"POLYGON((0 0, 4 0, 4 4, 0 4),\n(3 1, 3 2, 2))", 2, 2, "hole 0, vertex 2 has one"},
           {"POLYGON((0 0, 4 0, 4 4, 0 4), 3 1)", 1, -1, "here stands \"3\" where it needs the ("},
           {"POLYGON((0 0, 4 0, 4 4, 0 4), (3 1, 3 2, 2 1)", 1, -1, "where it needs the second )"},
           {"POLYGON((0 0, 4 0, 4 4, 0 4), (3 1, 3 2, 2 1", 1, 2, "the text ends behind hole 0, v"},
           {"POLYGON((0 0, 4 0, 4 4, 0 4),\n(3 1, 3 2, 2 1), (1 1,\n2 1))", 3, 1,
            "hole 1: has 2 ver"},
           {"POLYGON((0 0, 4 0, 4 4, 0 4),\n(3 1, 5 2, 2 1))", 2, 0, "hole 0 crosses or touches"},
           {"POLYGON((0 0, 4 0, 4 4, 0 4),\n(5 1, 6 2, 5 2))", 2, 0, "outside of the outer ring"},
           {"MULTIPOLYGON(((0 0, 1 0, 0 1)),\n((5 0, 6 0, 5 1)))", 2, -1, "holds 2 polygons"},
           {"POLYGON((0 0, 1 0, 0 1))\nPOLYGON((5 0, 6 0, 5 1))", 2, -1, "more than one polygon"},
           {"POLYGON((0 0, 1 0, 0 1)) or so", 1, -1, "behind the polygon: \"or\""},
           {"POLYGON((0 0, 1 0, 0 1)", 1, -1, "the text ends where it needs the second )"},
           {"POLYGON((0 0, 1 0, 0 1", 1, 2, "the text ends behind vertex 2"},
           {"POLYGON(0 0, 1 0, 0 1)", 1, -1, "needs (( in front of the first vertex"},
           {"POINT(0 0)", 1, -1, "is a POINT; give a POLYGON"},
           {"GEOMETRYCOLLECTION(POINT(0 0))", 1, -1, "is a GEOMETRYCOLLECTION"},
           {"POLYGN((0 0, 1 0, 0 1))", 1, -1, "did you mean \"POLYGON\"?"},
           {"square 3 0 0 1 0 0 1", 1, -1, "is not a polygon as WKT or JSON"},
           {"SRID=x;POLYGON((0 0, 1 0, 0 1))", 1, -1, "SRID: \"x\" is not a whole number"},
           {"POLYGON((0 0,\n1 1,\n1 0,\n0 1))", 3, 2, "cross"},
           {"POLYGON((0 0, 1 0, 0 0))", 1, 1, "at least 3"},
           {"\xFF\xFEP\0O\0", 0, -1, "UTF-16 text; save it as UTF-8"},
           {"", 0, -1, "is empty"},
           {" \r\n", 0, -1, "is empty"}}) {
    check_refused(folder, "bad.wkt", bad);
  }
}

TEST_CASE("holes are read from every notation", "[scene][text]") {
  const Folder folder;
  const std::vector<std::string> cases{
      R"({"polygon": [[0,0],[4,0],[4,4],[0,4]], "holes": [[[1,1],[2,1],[1,2]], [[3,3],[3,2],[2,3]]]})",
      R"({"type": "Polygon", "coordinates": [[[0,0],[4,0],[4,4],[0,4],[0,0]],
          [[1,1],[2,1],[1,2],[1,1]], [[3,3],[3,2],[2,3],[3,3]]]})",
      R"({"type": "MultiPolygon", "coordinates": [[[[0,0],[4,0],[4,4],[0,4]],
          [[1,1],[2,1],[1,2]], [[3,3],[3,2],[2,3]]]]})",
      "POLYGON((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 2 1, 1 2, 1 1), (3 3, 3 2, 2 3, 3 3))",
      "POLYGON ((0 0,4 0,4 4,0 4)\n,\n(1 1,2 1,1 2),(3 3,3 2,2 3));",
      "MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4), (1 1, 2 1, 1 2), (3 3, 3 2, 2 3)))"};
  for (const std::string& text : cases) {
    INFO(text);
    const Polygon polygon = polygon_of_file(folder.write("holed", text));
    const Rings rings = rings_of(polygon);
    REQUIRE(rings.size() == 3);
    CHECK(rings[0] == std::vector<Vec2>{{0, 0}, {4, 0}, {4, 4}, {0, 4}});
    CHECK(rings[1] == std::vector<Vec2>{{1, 1}, {1, 2}, {2, 1}});  // clockwise
    CHECK(rings[2] == std::vector<Vec2>{{3, 3}, {3, 2}, {2, 3}});
    CHECK(area_moments(polygon).area == 15);
  }
  // The error knows the hole and the line of its vertex.
  const std::string file = folder.write("bad",
                                        "POLYGON((0 0, 4 0, 4 4, 0 4),\n(1 1, 2 1, 1 2),\n"
                                        "(3 3,\n3 2,\n2 3,\n2.2 2.5))");
  try {
    polygon_of_file(file);
    FAIL("is accepted");
  } catch (const PolygonError& error) {
    CHECK(error.hole() == 1);
    CHECK(error.vertex() == 3);
    CHECK(error.line() == 6);
  }
}

TEST_CASE("JSON that is not the polygon it seems to be is refused", "[scene][text]") {
  const Folder folder;
  const std::string ring = "[[0,0],[1,0],[0,1],[0,0]]";
  for (const Refused& bad : std::initializer_list<Refused>{
           {"[[0,0],\n[1,5,0],[0,1]]", 2, -1, "has 3 coordinates, and bodies are two-dimensional"},
           {"[[0,0],\n[1],[0,1]]", 2, -1, "must be [x, y] in m"},
           {"[[0,0],[1,0],[0,1],]", 1, -1, "not valid JSON"},
           {"[[0,0],[0x1,0],[0,1]]", 1, -1, "not valid JSON"},
           {"[[0,0],[+1,0],[0,1]]", 1, -1, "not valid JSON"},
           {"[[0,0],[nan,0],[0,1]]", 1, -1, "not valid JSON"},
           {"[[0,0],\n[1e999,0],[0,1]]", 2, -1, "out of the range of double precision"},
           {"[[0,0],[\"1\",0],[0,1]]", 1, -1, "must be a number"},
           {"[[0,0],\n[1,1],\n[1,0],\n[0,1]]", 3, 2, "cross"},
           {"{\"polygon\": " + ring + ",\n\"polygon\": " + ring + "}", 2, -1, "duplicate key"},
           {"{\"polygons\": " + ring + "}", 1, -1, "did you mean \"polygon\"?"},
           {R"({"type": "Polygon"})", 1, -1, "GeoJSON without \"coordinates\""},
           {R"({"type": "Polygone", "coordinates": []})", 1, -1, "did you mean \"Polygon\"?"},
           {R"({"type": "Point", "coordinates": [0, 0]})", 1, -1, "is a Point; give a Polygon"},
           {R"({"type": "Polygon", "coordinates": []})", 1, -1, "is empty"},
           {R"({"type": "Polygon", "coordinates": [[[0,0,1,2],[1,0,1,2],[0,1,1,2]]]})", 1, -1,
            "must be [x, y] in m"},
           {R"({"type": "Polygon", "coordinates": [)" + ring + ",\n" + ring + "]}", 2, 0,
            "hole 0 crosses or touches the outer ring"},
           {"{\"polygon\": " + ring + ",\n\"holes\": [[[0.1,0.1],[0.2,0.1],[0.1]]]}", 2, -1,
            "must be [x, y] in m"},
           {"{\"polygon\": " + ring + ",\n\"holes\": " + ring + "}", 2, -1, "must be [x, y] in m"},
           {R"({"type": "MultiPolygon", "coordinates": [[)" + ring + "],[" + ring + "]]}", 1, -1,
            "holds 2 polygons; give one"},
           {R"({"type": "FeatureCollection", "features": []})", 1, -1, "holds 0 features"},
           {R"({"type": "Feature", "geometry": null})", 1, -1, "must be an object of GeoJSON"}}) {
    check_refused(folder, "bad.json", bad);
  }
}

TEST_CASE("a file that is none, or too large, is refused at once", "[scene][text]") {
  const Folder folder;
  CHECK_THROWS_WITH(read_polygon_file(folder / "none.wkt"),
                    Catch::Contains("No such file or directory"));
  CHECK_THROWS_WITH(read_polygon_file(folder.path()), Catch::Contains("is a directory"));
  CHECK_THROWS_WITH(read_polygon_file("/dev/zero"), Catch::Contains("a device or a socket"));
}

TEST_CASE("a line of a batch is read strictly, and says where it is wrong", "[scene][text]") {
  const auto refused = [](const std::string& words, int vertex, const char* why) {
    INFO(words);
    std::istringstream line(words);
    try {
      read_ring(line);
      require_end(line);
      FAIL("is accepted");
    } catch (const InvalidPolygon& error) {
      CHECK(error.vertex() == vertex);
      CHECK(std::string(error.what()).find(why) != std::string::npos);
    }
  };
  refused("", 0, "the number of vertices is missing");
  refused("3.5 0 0 1 0 0 1", 0, "\"3.5\" is not a whole number");
  refused("-3 0 0", 0, "\"-3\" is not a whole number");
  refused("0x3 0 0 1 0 0 1", 0, "neither a whole number of vertices nor POLYGON");
  refused("3 0 0 1 0 0", 2, "the line ends before vertex 2 of 3 has its y");
  refused("3 0 0 1 0", 2, "the line ends before vertex 2 of 3 begins");
  refused("3 0 0 1 0 0 0x1", 2, "vertex 2: \"0x1\" is not a decimal number");
  refused("3 0 0 1 0, 0 1", 1, "vertex 1: \"0,\" is not a decimal number");
  refused("3 0 0 1 inf 0 1", 1, "vertex 1: \"inf\" is not finite");
  refused("3 0 0 1 0 0 1 7", 0, "text behind the last vertex: \"7\"");
}

TEST_CASE("a line of a batch holds polygons with holes as WKT", "[scene][text]") {
  const Rings rings{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {2, 1}, {1, 2}}};
  const std::string wkt = "POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0),(1 1, 2 1, 1 2, 1 1))";
  for (const std::string& words : std::vector<std::string>{
           wkt, " SRID=4326; " + wkt + "\r", "multipolygon(((0 0,4 0,4 4,0 4),(1 1,2 1,1 2)))"}) {
    INFO(words);
    std::istringstream line(words);
    CHECK(rings_of(read_line_polygon(line)) == rings);
    CHECK_NOTHROW(require_end(line));
  }
  // Either polygon of a pair in either notation, and nothing of one is taken for the other's.
  for (const std::string& text :
       {"p " + wkt + " 3 0 0 1.5 0 0.25 1e-3", "p " + wkt + "POLYGON((0 0,1.5 0,0.25 1e-3))",
        "p 4 0 0 1.5 0 0.25 1e-3 0 0 " + wkt}) {
    INFO(text);
    PolygonPair pair = parse_pair(text);
    if (pair.a.holes.empty()) std::swap(pair.a, pair.b);
    CHECK(rings_of(pair.a) == rings);
    CHECK(rings_of(pair.b) == Rings{kTriangle});
  }
  const auto refused = [](const std::string& text, const std::string& polygon,
                          std::optional<int> hole, int vertex, const char* why) {
    INFO(text);
    try {
      parse_pair(text);
      FAIL("is accepted");
    } catch (const BadPairLine& error) {
      CHECK(error.polygon() == polygon);
      CHECK(error.hole() == hole);
      CHECK(error.vertex() == vertex);
      CHECK_THAT(error.what(), Catch::Contains(why));
    }
  };
  refused("p POLYGON ((0 0, 1 0, 0 1", "a", {}, 2, "the text ends behind vertex 2");
  refused("p " + wkt + " POLYGON ((0 0, 4 0, 0 4), (1 1, 2 1, 1))", "b", 0, 2, "has one coordina");
  refused("p " + wkt, "b", {}, 0, "the number of vertices is missing");
  refused("p " + wkt + " POINT (1 1)", "b", {}, 0,
          "neither a whole number of vertices nor POLYGON");
  refused("p " + wkt + wkt + " 7", "", {}, 0, "text behind the last vertex: \"7\"");
  refused("p POLYGON Z ((0 0 1, 1 0 1, 0 1 1))", "a", {}, 0, "two-dimensional");
}

TEST_CASE("pairs with holes in JSON", "[scene][text]") {
  const Folder folder;
  const auto pairs = [&](const std::string& a) {
    return read_pair_file(folder.write("pairs.json", R"({"pairs": [{"name": "p", "a": )" + a +
                                                         R"(, "b": [[0,0],[1,0],[0,1]]}]})"));
  };
  const std::vector<PolygonPair> read =
      pairs(R"({"polygon": [[0,0],[4,0],[4,4],[0,4]], "holes": [[[1,1],[2,1],[1,2]]]})");
  REQUIRE(read.size() == 1);
  CHECK(rings_of(read[0].a) == Rings{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {2, 1}, {1, 2}}});
  CHECK(read[0].b.holes.empty());
  CHECK_THROWS_WITH(pairs(R"({"polygon": [[0,0],[4,0],[4,4]], "hole": []})"),
                    Catch::Contains("did you mean \"holes\"?"));
}

TEST_CASE("blank lines and comments of a batch are skipped, one without a line is refused",
          "[scene][text]") {
  const Folder folder;
  std::vector<std::string> names;
  std::vector<int> numbers;
  const auto note = [&](const BatchLine& line) {
    names.push_back(line.name);
    numbers.push_back(line.number);
  };
  for_each_line(folder.write("rings",
                             "\xEF\xBB\xBF"
                             "one 3\r\n\r\n# a comment\n  \n#2 3\nlast 3"),
                "name n x y ...", note);
  CHECK(names == std::vector<std::string>{"one", "#2", "last"});
  CHECK(numbers == std::vector<int>{1, 5, 6});
  for (const char* nothing : {"", "\n \r\n", "# only a comment\n"}) {
    INFO(nothing);
    const std::string file = folder.write("rings", nothing);
    CHECK_THROWS_WITH(for_each_line(file, "name n x y ...", note),
                      Catch::Contains("is empty; write on each line name n x y ..."));
    CHECK_THROWS_AS(read_pair_file(file), SceneError);
  }
  CHECK_THROWS_WITH(read_pair_file(folder.write("pairs", R"({"pairs": []})")),
                    Catch::Contains("has no pair"));
  CHECK_THROWS_WITH(
      read_pair_file(folder.write("pairs", "# a\np 3 0 0 1 0 0 1 3 0 0 1 0 0 0x1")),
      Catch::Contains("pairs:2: p, polygon b, vertex 2: vertex 2: \"0x1\" is not a decimal"));
}
