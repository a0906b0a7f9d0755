// `apothem polygon` as its users meet it.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "geometry/skeleton/skeleton.hpp"
#include "tests/folder.hpp"
#include "tests/program.hpp"
#include "tests/public_rings.hpp"
#include "tests/shapes.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace {

const std::string kQuad = "[[0,0],[1.2,0.1],[1,0.8],[0.2,1]]";
const std::string kBowTie = "[[0,0],[1,1],[1,0],[0,1]]";

std::string text(const Ring& ring) {
  Json list = Json::array();
  for (const Vec2& p : ring) list.push_back({p.x(), p.y()});
  return list.dump();
}

Vec2 point(const Json& list) { return {list[0].get<double>(), list[1].get<double>()}; }

double area_of(const Json& ring) {
  const Vec2 zero = point(ring[0]);
  double twice = 0;
  for (size_t i = 2; i < ring.size(); ++i) {
    twice += apothem::cross(point(ring[i - 1]) - zero, point(ring[i]) - zero);
  }
  return twice / 2;
}

double faces_area(const Json& object) {
  double sum = 0;
  for (const Json& face : object["faces"]) sum += area_of(face["polygon"]);
  return sum;
}

std::vector<Json> objects(const std::string& lines) {
  std::istringstream stream(lines);
  std::vector<Json> list;
  for (std::string line; std::getline(stream, line);) list.push_back(Json::parse(line));
  return list;
}

}  // namespace

TEST_CASE("polygon prints the contract's keys and the benchmark's numbers", "[program][polygon]") {
  const Folder folder;
  const Result r = run({"polygon", folder.write("q.json", kQuad), "--json"}, folder);
  REQUIRE(r.code == 0);
  CHECK(r.err.empty());
  const Json o = Json::parse(r.out);
  CHECK(o["area"] == Approx(.85).epsilon(1e-15));
  CHECK(o["centroid"][0] == Approx(.568627450980392).epsilon(1e-14));
  CHECK(o["centroid"][1] == Approx(.448235294117647).epsilon(1e-14));
  CHECK(o["polar_moment"] == Approx(.125169084967320).epsilon(1e-14));
  for (const char* key : {"inradius", "roof_height", "reference_length"}) {
    CHECK(o[key] == Approx(.428926743204019).epsilon(1e-14));
  }
  REQUIRE(o["incircle_centres"].size() == 1);
  CHECK(o["singular_area"]["kind"] == "point");
  REQUIRE(o["singular_area"]["points"].size() == 1);
  CHECK((point(o["singular_area"]["points"][0]) - point(o["incircle_centres"][0])).norm() < 1e-14);
  CHECK(o["singular_area"]["polygons"].empty());
  CHECK(o["faces"].size() == 4);
  CHECK(faces_area(o) == Approx(.85).epsilon(1e-14));
  CHECK(o["arithmetic"] == "inexact");
}

TEST_CASE("polygon reads WKT and objects, and --reference chooses the depth",
          "[program][polygon]") {
  const Folder folder;
  const std::string wkt = folder.write("r.wkt", "POLYGON((10 20, 14 20, 14 22, 10 22, 10 20))");
  const Json ridge = Json::parse(run({"polygon", wkt, "--json"}, folder).out)["singular_area"];
  CHECK(ridge["kind"] == "segment");
  CHECK(ridge["segments"].size() == 1);
  CHECK(ridge["points"] == ridge["segments"][0]);  // the ends
  const Json plateau =
      Json::parse(run({"polygon", wkt, "--json", "--reference", "0.5"}, folder).out);
  CHECK(plateau["reference_length"] == .5);
  CHECK(plateau["singular_area"]["kind"] == "polygons");
  REQUIRE(plateau["singular_area"]["polygons"].size() == 1);
  CHECK(area_of(plateau["singular_area"]["polygons"][0]) == Approx(3).epsilon(1e-14));
  CHECK(plateau["singular_area"]["area"] == Approx(3).epsilon(1e-14));
  for (const Json& p : plateau["singular_area"]["polygons"][0]) {
    CHECK((p[0] == Approx(10.5) || p[0] == Approx(13.5)));
    CHECK((p[1] == Approx(20.5) || p[1] == Approx(21.5)));
  }
  const std::string cross = folder.write("c.json", R"({"polygon": )" + text(cross_ring()) + "}");
  const Json circle =
      Json::parse(run({"polygon", cross, "--json", "--reference", "inscribed_circle"}, folder).out);
  CHECK(circle["reference_length"] == Approx(M_SQRT1_2).epsilon(1e-13));
  CHECK(circle["roof_height"] == Approx(.5).epsilon(1e-13));
  CHECK(circle["singular_area"]["kind"] == "none");
  const Json plus = Json::parse(run({"polygon", cross, "--json"}, folder).out)["singular_area"];
  CHECK(plus["kind"] == "segment");
  CHECK(plus["segments"].size() == 4);
}

TEST_CASE("edges are those of the ring as it was given, in either sense", "[program][polygon]") {
  const Folder folder;
  for (const bool clockwise : {false, true}) {
    Ring ring = star_ring(5, .5);
    for (Vec2& v : ring) v += Vec2(3, 4);
    if (clockwise) std::reverse(ring.begin(), ring.end());
    const Json o =
        Json::parse(run({"polygon", folder.write("s.json", text(ring)), "--json"}, folder).out);
    REQUIRE(o["faces"].size() == ring.size());
    for (size_t e = 0; e < ring.size(); ++e) {
      const Json& face = o["faces"][e];
      CHECK(face["edge"] == e);
      CHECK(area_of(face["polygon"]) > 0);
      const Vec2 &a = ring[e], &b = ring[(e + 1) % ring.size()];
      bool has_a = false, has_b = false;
      for (const Json& p : face["polygon"]) {
        has_a = has_a || point(p) == a;
        has_b = has_b || point(p) == b;
        const double height = std::abs(apothem::cross((b - a).normalized(), point(p) - a));
        CHECK(height == Approx(p[2].get<double>()).margin(1e-13));
      }
      CHECK(has_a);  // to the last bit
      CHECK(has_b);
    }
  }
}

TEST_CASE("far from the origin all coordinates are the file's", "[program][polygon]") {
  const Folder folder;
  Ring ring = l_ring();
  for (Vec2& v : ring) v += Vec2(1e9, -2e9);
  const Json o = Json::parse(
      run({"polygon", folder.write("l.json", text(ring)), "--json", "--reference", "0.25"}, folder)
          .out);
  CHECK(o["area"] == 3);
  CHECK(o["inradius"] == Approx(2 - M_SQRT2).epsilon(1e-13));
  CHECK(faces_area(o) == Approx(3).margin(1e-6));  // the grid of doubles is 2e-7 wide there
  CHECK(o["singular_area"]["area"] == Approx(3 - 8 * .25 + 4 * .25 * .25).epsilon(1e-13));
  for (const Json& p : o["singular_area"]["polygons"][0]) {
    CHECK(std::abs(p[0].get<double>() - 1e9 - 1) < 1);
    CHECK(std::abs(p[1].get<double>() + 2e9 - 1) < 1);
  }
}

TEST_CASE("a refused polygon says why and where, as text or as JSON", "[program][polygon]") {
  const Folder folder;
  const std::string file = folder.write("bow.json", kBowTie);
  const Result plain = run({"polygon", file}, folder);
  CHECK(plain.code == 2);
  CHECK(plain.out.empty());
  CHECK(lines(plain.err) == 1);
  CHECK(plain.err.find("bow.json") != std::string::npos);
  CHECK(plain.err.find("cross") != std::string::npos);
  const Result json = run({"polygon", file, "--json"}, folder);
  CHECK(json.code == 2);
  const Json o = Json::parse(json.out);
  CHECK(o["error"].get<std::string>().find("cross") != std::string::npos);
  CHECK(o["file"] == file);
  CHECK(o["line"] == 1);
  CHECK(o["vertex"] == 2);
  for (const std::string& bad : {std::string("[[0,0],[1,"), std::string("POLYGON((0 0, 1 1"),
                                 std::string("POINT(1 1)"), std::string()}) {
    const Result r = run({"polygon", folder.write("bad.txt", bad), "--json"}, folder);
    CHECK(r.code == 2);
    CHECK(Json::parse(r.out).contains("error"));
    CHECK(lines(r.err) == 1);
    CHECK(r.err.find("bad.txt") != std::string::npos);
  }
}

TEST_CASE("polygon of many rings goes on after a refusal", "[program][polygon]") {
  const Folder folder;
  const std::string file = folder.write("rings.txt",
                                        "square 4 0 0 2 0 2 2 0 2\n"
                                        "\n"
                                        "bow#2 4 0 0 1 1 1 0 0 1\n"
                                        "short 3 0 0 1 0\n"
                                        "nan 3 0 0 1 0 0 nan\n"
                                        "long 3 0 0 1 0 0 1 7\n"
                                        "l 6 0 0 2 0 2 1 1 1 1 2 0 2\n"
                                        "frame POLYGON ((0 0,3 0,3 3,0 3),(1 1,1 2,2 2,2 1))\n"
                                        "touch POLYGON ((0 0,3 0,3 3,0 3),(1 1,1 2,3 2))\n"
                                        "cut POLYGON ((0 0,3 0,3 3,0 3),(1 1,1 2\n"
                                        "point POINT (0 0)\n");
  const Result r = run({"polygon", "--batch", file}, folder);
  CHECK(r.code == 2);
  CHECK(r.err.empty());
  const std::vector<Json> list = objects(r.out);
  REQUIRE(list.size() == 10);
  CHECK(list[0]["name"] == "square");
  CHECK(list[0]["area"] == 4);
  CHECK(list[0]["singular_area"]["kind"] == "point");
  CHECK(list[1]["name"] == "bow#2");
  CHECK(list[1]["vertex"] == 2);
  CHECK(list[3]["vertex"] == 2);
  for (int i = 1; i < 5; ++i) {
    CHECK(list[i].contains("error"));
    CHECK(list[i]["line"] == i + 2);
  }
  CHECK(list[5]["name"] == "l");
  CHECK(list[5]["singular_area"]["kind"] == "segment");
  CHECK(list[6]["name"] == "frame");
  CHECK(list[6]["area"] == 8);
  CHECK(list[6]["holes"] == Json::parse("[[[1,1],[1,2],[2,2],[2,1]]]"));
  for (int i = 7; i < 10; ++i) CHECK(list[i]["line"] == i + 2);
  CHECK(list[7]["hole"] == 0);
  CHECK(list[7]["vertex"].is_number_integer());
  CHECK(list[7]["error"].get<std::string>().find("touches the outer ring") != std::string::npos);
  CHECK(list[8]["hole"] == 0);
  CHECK(list[9]["name"].is_null());
  CHECK(run({"polygon", "--batch", folder.write("ok.txt", "t 3 0 0 1 0 0 1\n")}, folder).code == 0);
  for (const char* command : {"polygon", "contact"}) {
    const Result empty = run({command, "--batch", folder.write("empty.txt", "\n")}, folder);
    CHECK(empty.code == 2);
    CHECK(empty.err.find("empty.txt: is empty; write on each line name n x y ...") !=
          std::string::npos);
  }
}

TEST_CASE("more vertices than the limit are refused, and a batch goes on", "[program][polygon]") {
  const Folder folder;
  const Ring big = samples::regular(kMostVertices + 1).vertices();
  const Result r = run({"polygon", folder.write("big.json", text(big))}, folder);
  CHECK(r.code == 2);
  CHECK(r.out.empty());
  CHECK(lines(r.err) == 1);
  for (const char* part : {"big.json", "100001 vertices", "limited to 100000", "simplify"}) {
    CHECK(r.err.find(part) != std::string::npos);
  }
  std::string batch = "big " + std::to_string(big.size());
  for (const Vec2& v : big) batch += fmt::format(" {} {}", v.x(), v.y());
  batch += "\nsquare 4 0 0 2 0 2 2 0 2\n";
  const Result b = run({"polygon", "--batch", folder.write("rings.txt", batch)}, folder);
  CHECK(b.code == 2);
  const std::vector<Json> list = objects(b.out);
  REQUIRE(list.size() == 2);
  CHECK(list[0]["error"].get<std::string>().find("limited to 100000") != std::string::npos);
  CHECK(list[1]["area"] == 4);
}

TEST_CASE("a big polygon shows its progress and ends on Ctrl-C", "[program][polygon][slow]") {
  const Folder folder;
  // A comb has as many largest inscribed circles as teeth, which takes a minute.
  const std::string file =
      folder.write("big.json", text(samples::comb(kMostVertices / 4, 9).vertices()));
  Result r{};
  std::chrono::steady_clock::time_point start;
  for (const double after : {2.5, 10., 20.}) {  // a slow machine may still read the file
    start = std::chrono::steady_clock::now();
    r = run({"polygon", file, "--json"}, folder, {.interrupt_after = after});
    if (r.err.find("100000 vertices: ") != std::string::npos) break;
  }
  REQUIRE(r.code == 130);
  CHECK(Json::parse(r.out).contains("error"));
  CHECK(r.err.find("100000 vertices: ") != std::string::npos);
  CHECK(r.err.find("interrupted") != std::string::npos);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(60));
}

TEST_CASE("every public ring is described or refused", "[program][polygon]") {
  const Folder folder;
  std::string text;
  std::vector<std::string> names;
  for (const test::PublicRing& ring : test::public_rings(300)) {
    names.push_back(ring.name);
    text += ring.line + '\n';
  }
  if (names.empty()) return;
  const Result r = run({"polygon", "--batch", folder.write("rings.txt", text)}, folder);
  CHECK((r.code == 0 || r.code == 2));
  const std::vector<Json> list = objects(r.out);
  REQUIRE(list.size() == names.size());
  for (size_t i = 0; i < list.size(); ++i) {
    INFO(names[i]);
    CHECK(list[i]["name"] == names[i]);
    if (list[i].contains("error")) {
      CHECK(list[i]["vertex"].is_number_integer());
      continue;
    }
    // Round-off of an area is that of the coordinates times the outline's length.
    double reach = 0, length = 0;
    for (const Json& face : list[i]["faces"]) {
      const Vec2 a = point(face["polygon"][0]);
      reach = std::max({reach, std::abs(a.x()), std::abs(a.y())});
      length += (point(face["polygon"][1]) - a).norm();
    }
    const double area = list[i]["area"];
    CHECK(std::abs(faces_area(list[i]) - area) < 1e-12 * area + 4e-16 * reach * length);
    CHECK(list[i]["singular_area"]["kind"] != "none");
  }
}

TEST_CASE("pictures and VTK files are complete or not there", "[program][polygon][slow]") {
  const Folder folder;
  const std::string file = folder.write("q.json", kQuad);
  const Result table =
      run({"polygon", file, "--picture", folder / "q.png", "--vtk", folder / "vtk"}, folder);
  CHECK(table.code == 0);
  CHECK(table.out.find("inradius") != std::string::npos);
  CHECK(content(folder / "q.png").starts_with("\x89PNG\r\n\x1a\n"));
  CHECK(std::filesystem::exists(folder / "vtk/faces.vtu"));
  CHECK(std::filesystem::exists(folder / "vtk/singular_area.vtu"));
  CHECK(run({"polygon", file, "--picture", folder / "q.svg"}, folder).code == 0);
  CHECK(content(folder / "q.svg").starts_with("<?xml"));
  // Another process draws the same bytes.
  CHECK(run({"polygon", file, "--picture", folder / "r.svg"}, folder).code == 0);
  CHECK(content(folder / "q.svg") == content(folder / "r.svg"));

  const std::string bow = folder.write("bow.json", kBowTie);
  CHECK(
      run({"polygon", bow, "--picture", folder / "no.png", "--vtk", folder / "no"}, folder).code ==
      2);
  const Result nowhere = run({"polygon", file, "--picture", folder / "no/such/q.png"}, folder);
  CHECK(nowhere.code == 4);
  CHECK(lines(nowhere.err) == 1);
  CHECK(run({"polygon", file, "--vtk", file + "/vtk"}, folder).code == 4);
  const Result full =
      run({"polygon", file, "--picture", folder / "no.png"}, folder, {.file_size = 1000});
  CHECK(full.code == 4);
  for (const char* name : {"no.png", "no.png.partial", "no"}) {
    CHECK(!std::filesystem::exists(folder / name));
  }
}

TEST_CASE("polygon describes a polygon with holes", "[program][polygon][holes]") {
  const Folder folder;
  const std::string file = folder.write(
      "a.wkt", "POLYGON ((0 0, 6 0, 6 4, 0 4), (1 1, 2 1, 2 3, 1 3), (4 1, 5 1, 5 3))");
  const Result r = run({"polygon", file, "--json", "--picture", folder / "a.svg", "--vtk",
                        folder / "vtk", "--output", "offset:0.1", "-o", folder / "o.geojson"},
                       folder);
  INFO(r.err);
  REQUIRE(r.code == 0);
  const Json o = Json::parse(r.out);
  CHECK(o["area"] == 24 - 2 - 1);
  REQUIRE(o["holes"].size() == 2);
  CHECK(o["holes"][0] == Json::parse("[[1,1],[1,3],[2,3],[2,1]]"));
  CHECK(o["holes"][1] == Json::parse("[[4,1],[5,3],[5,1]]"));
  // A face over each edge, numbered ring by ring, that tile the polygon.
  REQUIRE(o["faces"].size() == 11);
  for (int e = 0; e < 11; ++e) CHECK(o["faces"][e]["edge"] == e);
  CHECK(faces_area(o) == Approx(21).epsilon(1e-13));
  CHECK(std::filesystem::file_size(folder / "a.svg") > 1000);
  CHECK(std::filesystem::exists(folder / "vtk/faces.vtu"));
  const Json offset = Json::parse(content(folder / "o.geojson"))["features"];
  REQUIRE(offset.size() == 1);
  CHECK(offset[0]["geometry"]["coordinates"].size() == 3);
  CHECK(run({"polygon", file}, folder).out.find("holes             2\n") != std::string::npos);
  CHECK(Json::parse(run({"polygon", folder.write("q.json", kQuad), "--json"}, folder).out)["holes"]
            .empty());

  // Points in a hole are outside.
  const Json at = Json::parse(run({"polygon", file, "--at", "1.5,2", "--json"}, folder).out);
  CHECK(at["points"][0]["side"] == "outside");
  CHECK(at["points"][0]["phi"] == 0);
  CHECK(at["points"][0]["signed_distance"] == .5);

  // A wrong hole is named.
  const std::string bad = folder.write(
      "bad.wkt", "POLYGON ((0 0, 6 0, 6 4, 0 4), (1 1, 2 1, 2 3),\n(4 1, 5 3, 5 1,\n4 3))");
  const Result refused = run({"polygon", bad, "--json"}, folder);
  CHECK(refused.code == 2);
  const Json error = Json::parse(refused.out);
  CHECK(error["hole"] == 1);
  CHECK(error["vertex"] == 2);
  CHECK(error["line"] == 2);
}
