// apothem accuracy as its users meet it.
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <sstream>

#include "apps/peers/peers.hpp"
#include "lib/scene/pair_file.hpp"
#include "tests/program.hpp"

using namespace apothem;
using test::content;
using test::Folder;
using test::Result;
using test::run;

namespace {

// Rows of a CSV without quotes: by the first `keys` columns, the rest.
std::map<std::string, std::vector<std::string>> table(const std::string& file, int keys) {
  std::map<std::string, std::vector<std::string>> rows;
  std::istringstream lines(content(file));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, word;
    std::vector<std::string> cells;
    for (int i = 0; std::getline(words, word, ','); ++i) {
      if (i < keys) {
        key += (i > 0 ? "," : "") + word;
      } else {
        cells.push_back(word);
      }
    }
    rows[key] = cells;
  }
  return rows;
}

const char* const kMethods[] = {"exact", "edge", "overlap", "overlap-inexact", "boost", "clip"};

}  // namespace

TEST_CASE("accuracy measures every method and names what it refuses", "[accuracy]") {
  const Folder folder;
  const std::string file = folder.write("pairs.txt",
                                        "good#1 3 0 0 1 0 0 1 3 0.2 0.2 1 1 0 1\n"
                                        "bow#2 4 0 0 1 1 1 0 0 1 3 0 0 1 0 0 1\n"
                                        "\n"
                                        "L#3 6 0 0 2 0 2 1 1 1 1 2 0 2 4 1.5 0.25 3 0.5 3 3 1 3\n"
                                        "bow#4 3 0 0 1 0 0 1 4 0 0 1 1 1 0 0 1\n");
  const Result r = run({"accuracy", "--cases", file, "-o", folder / "out"}, folder);
  INFO(r.out << r.err);
  CHECK(r.code == 0);
  CHECK(test::lines(r.err) == 2);
  CHECK(r.err.find("bow#2: refused: polygon a, vertex 2") != std::string::npos);
  CHECK(r.err.find("bow#4: refused: polygon b, vertex 2") != std::string::npos);
  CHECK(r.out.find("refused pairs: 2") != std::string::npos);

  auto rows = table(folder / "out/accuracy.csv", 2);
  CHECK(rows.size() == 1 + std::size(kMethods));
  for (const char* method : kMethods) {
    INFO(method);
    const std::vector<std::string>& row = rows["pairs.txt," + std::string(method)];
    REQUIRE(row.size() == 11);
    CHECK(row[0] == "2");  // pairs
    CHECK(row[1] == "2");  // refused
    CHECK(row[2] == "0");  // failures
    CHECK(std::stod(row[3]) > 10);
    CHECK(std::stod(row[5]) < (std::string(method) == "boost" ? 1e-4 : 1e-14));
  }
  CHECK(r.out.find("failures on 2 pairs that are not random: exact 0, edge 0") !=
        std::string::npos);
  CHECK(rows["pairs.txt,exact"][5] == "0");
  auto pairs = table(folder / "out/pairs.csv", 3);
  CHECK(pairs.size() == 1 + 2 * std::size(kMethods));
  CHECK(pairs["L#3,pairs.txt,edge"][0] == "ok");
  // Gnuplot may be missing; half a picture may not be there.
  const bool picture = std::filesystem::exists(folder / "out/accuracy.png");
  CHECK(picture == (r.out.find("no picture") == std::string::npos));
  CHECK_FALSE(std::filesystem::exists(folder / "out/accuracy.png.partial"));
}

TEST_CASE("times that are measured again give the range of each and of its ratio to edge",
          "[accuracy]") {
  const Folder folder;
  const std::string file = folder.write("pairs.txt", "a 3 0 0 1 0 0 1 3 0.2 0.2 1 1 0 1\n");
  const Result r =
      run({"accuracy", "--cases", file, "--repeat", "3", "-o", folder / "out"}, folder);
  CHECK(r.code == 0);
  auto rows = table(folder / "out/accuracy.csv", 2);
  for (const char* method : kMethods) {
    INFO(method);
    const std::vector<std::string>& row = rows["pairs.txt," + std::string(method)];
    REQUIRE(row.size() == 11);
    const double time = std::stod(row[3]), longest = std::stod(row[8]);
    const double least = std::stod(row[9]), most = std::stod(row[10]);
    CHECK(time <= longest);
    CHECK(least <= most);
    if (std::string(method) == "edge") {
      CHECK(least == 1);
      CHECK(most == 1);
    } else {
      CHECK(least > 0);
    }
  }
}

TEST_CASE("without gnuplot the numbers are written all the same", "[accuracy]") {
  const Folder folder;
  const std::string file = folder.write("pairs.txt", "a 3 0 0 1 0 0 1 3 0.2 0.2 1 1 0 1\n");
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const Result r = run({"accuracy", "--cases", file, "-o", folder / "out"}, folder);
  setenv("PATH", path.c_str(), 1);
  CHECK(r.code == 0);
  CHECK(r.out.find("install gnuplot-nox") != std::string::npos);
  CHECK(table(folder / "out/accuracy.csv", 2).size() == 1 + std::size(kMethods));
  CHECK_FALSE(std::filesystem::exists(folder / "out/accuracy.png"));
}

TEST_CASE("accuracy compares with the expected values of a file", "[accuracy]") {
  const Folder folder;
  const auto pair = [](const std::string& force) {
    return R"({"pairs": [ {"name": "flat", "kind": "flat on flat",
      "a": [[-0.5,-0.25],[0.5,-0.25],[0.5,0.75],[-0.5,0.75]], "b": [[-2,-1],[2,-1],[2,0],[-2,0]],
      "expected": {"force": )" +
           force + R"(, "moment_a": 0, "moment_b": 0, "weight": 1,
      "energy": 0.11458333333333333, "overlap_area": 0.25, "own_length": 2.5, "tolerance": 1e-12}} ]})";
  };
  const Result good =
      run({"accuracy", "--cases", folder.write("a.json", pair("[0, 0.875]")), "-o", folder / "a"},
          folder);
  INFO(good.out << good.err);
  CHECK(good.code == 0);
  CHECK(good.out.find("1 of 1 agree") != std::string::npos);
  const Result off = run(
      {"accuracy", "--cases", folder.write("b.json", pair("[0, 0.875001]")), "-o", folder / "b"},
      folder);
  CHECK(off.code == 1);
  CHECK(off.err.find("flat: the expected values of the file are off by 4e-07") !=
        std::string::npos);
}

TEST_CASE("bad files of pairs end with exit code 2, name and line", "[accuracy]") {
  const Folder folder;
  for (const auto& [text, place] :
       {std::pair("a 3 0 0 1 0 0 1 3 0 0 1 0 0 1\nshort 3 0 0 1 0\n", ":2: short, polygon a"),
        std::pair("words 3 0 0 1 0 0 up 3 0 0 1 0 0 1\n", ":1: words, polygon a, vertex 2"),
        std::pair("long 3 0 0 1 0 0 1 3 0 0 1 0 0 1 7\n", ":1: long: text behind"),
        std::pair("\n", "is empty"),
        std::pair("nan 3 0 0 1 0 0 1 3 0 0 1 0 nan 1\n", ":1: nan, polygon b, vertex 2"),
        std::pair("{\"pairs\": [\n{\"nam\": 1}]}", ":2: /pairs/0"),
        std::pair("{\"pairs\": [\n{\"name\": \"x\", \"a\": 1}]}", ":2: /pairs/0/a"),
        std::pair("bow 4 0 0 1 1 1 0 0 1 3 0 0 1 0 0 1\n", "no pair is left")}) {
    const std::string file = folder.write("bad.txt", text);
    const Result r = run({"accuracy", "--cases", file, "-o", folder / "out"}, folder);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(r.err.find(place) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "out"));
  }
  const std::string good = folder.write("good.txt", "a 3 0 0 1 0 0 1 3 0.2 0.2 1 1 0 1\n");
  CHECK(run({"accuracy", "--cases", good, "-o", "/dev/null/out"}, folder).code == 4);
}

TEST_CASE("the peers' overlap polygons", "[accuracy]") {
  const Polygon comb = samples::comb(3);
  const Polygon bar = samples::block(-1, 2.25, 7, 2.5);
  const auto area = [](const std::vector<OverlapPolygon>& polygons) {
    double twice = 0;
    for (const OverlapPolygon& p : polygons) {
      for (size_t i = 0; i < p.vertices.size(); ++i) {
        twice += cross(p.vertices[i], p.vertices[(i + 1) % p.vertices.size()]);
      }
    }
    return twice / 2;
  };
  for (const auto& polygons : {boost_overlap(comb, bar), clip_overlap(comb, bar, false)}) {
    CHECK(polygons.size() == 3);
    CHECK(area(polygons) == Approx(.75).epsilon(1e-6));
  }
  // One inside the other, both ways; apart.
  const Polygon l = samples::l_shape();
  const Polygon inside = samples::block(.25, .25, .5, .75);
  CHECK(area(clip_overlap(l, inside, false)) == Approx(.125));
  CHECK(area(clip_overlap(inside, l, false)) == Approx(.125));
  CHECK(clip_overlap(l, samples::block(1.25, 1.25, 2, 2), false).empty());
  CHECK(area(clip_overlap(inside, samples::block(0, 0, .3, 1), true)) == Approx(.025));
}
