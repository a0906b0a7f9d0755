// apothem reproduce as its users meet it.
#include <catch2/catch.hpp>
#include <filesystem>

#include "output/history.hpp"
#include "program.hpp"

using namespace apothem;
using test::content;
using test::Folder;
using test::Result;
using test::run;

namespace {

// A stone's fall for 10 ms, and a table of what theory says.
const char* const kScene = R"({ "materials": { "rock": { "density": 2000 } }, "gravity": [0, -10],
  "bodies": [ { "name": "stone", "material": "rock", "polygon": [[0,0],[1,0],[1,1],[0,1]] } ],
  "time": { "end": 0.01, "step": 1e-4 }, "output": { "frames": 1, "history": { "interval": 1e-3 } },
  "expect": [ { "label": "speed <at the end>", "quantity": "stone.vy", "take": "last", "value": -0.1, "tolerance": 1e-9 },
              { "quantity": "stone.spin", "take": "max_abs", "value": 0, "tolerance": 1e-9 },
              { "quantity": "stone.vy", "take": "max", "value": 0.5, "tolerance": 1e-6 } ] })";
const char* const kFigure = R"({ "title": "Free fall & more", "about": "A stone.",
  "panels": [ { "title": "it's falling", "x": "time [ms]", "y": "speed [mm/s]", "x_range": [0, 10],
    "curves": [ { "label": "ours", "scene": "fall", "x_scale": 1e3, "y": "stone.vy", "y_offset": -0.5, "y_scale": -1e3 },
                { "label": "theory", "reference": "fall.csv", "y": "speed", "style": "marks" },
                { "points": [[0, 500], [10, 600]], "style": "dashed", "colour": 1 } ] } ] })";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

// A data folder with one figure.
std::string data_folder(const Folder& folder, const std::string& figure = kFigure) {
  for (const char* part : {"data/figures", "data/scenes", "data/reference"}) {
    std::filesystem::create_directories(folder / part);
  }
  folder.write("data/scenes/fall.json", kScene);
  folder.write("data/reference/fall.csv", "time [ms],speed [mm/s]\n0,500\n5,550\n10,600\n");
  folder.write("data/figures/fig-7.json", figure);
  return folder / "data";
}

}  // namespace

TEST_CASE("every shipped figure passes the loader", "[reproduce]") {
  const Folder folder;
  const Result r = run({"reproduce"}, folder);
  INFO(r.err);
  REQUIRE(r.code == 0);
  int shipped = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::kSource + "/data/figures")) {
    INFO(entry.path());
    CHECK(r.out.find(entry.path().stem().string() + " ") != std::string::npos);
    ++shipped;
  }
  CHECK(test::lines(r.out) == shipped);
  CHECK(r.out.find("fig-13") < r.out.find("fig-20"));
}

TEST_CASE("a figure becomes curves, a picture and a report", "[reproduce]") {
  const Folder folder;
  const std::string data = data_folder(folder);
  const std::vector<std::string> all{"reproduce", "fig-7,fig-7", "fig-7",       "--data",
                                     data,        "-o",          folder / "out"};
  const Result r = run(all, folder);
  INFO(r.out << r.err);
  REQUIRE(r.code == 0);
  CHECK(r.out.find("MISSED fall: max of stone.vy") != std::string::npos);
  CHECK(r.out.find("1 of 2 numbers") != std::string::npos);

  const HistoryTable history = read_history(folder / "out/runs/fall/history.csv");
  const HistoryTable curve = read_history(folder / "out/fig-7/curve-1-1.csv");
  CHECK(content(folder / "out/fig-7/curve-1-1.csv").starts_with("time [ms],speed [mm/s]\n"));
  REQUIRE(curve.columns[0].size() == 11);
  for (size_t i = 0; i < 11; ++i) {
    CHECK(curve.columns[0][i] == 1e3 * history.columns[0][i]);
    CHECK(curve.columns[1][i] == ((*history.column("stone.vy"))[i] - .5) * -1e3);
  }
  CHECK(content(folder / "out/fig-7/curve-1-2.csv") == content(folder / "data/reference/fall.csv"));
  CHECK(content(folder / "out/fig-7/curve-1-3.csv") == "time [ms],speed [mm/s]\n0,500\n10,600\n");

  const std::string report = content(folder / "out/report.html");
  for (const char* text :
       {"Free fall &amp; more", "A stone.", "speed &lt;at the end&gt; (last of stone.vy)",
        "href=\"fig-7/curve-1-1.csv\"", "href=\"runs/fall/run.json\"",
        "1 figures, 2 numbers, 1 missed", "<tr class=\"missed\">",
        "<td class=\"number\">0.5</td><td class=\"number\">0</td>",
        "<td class=\"number\">-5.0e-01</td><td class=\"number\">-1.0e+00</td>"}) {
    INFO(text);
    CHECK(report.find(text) != std::string::npos);
  }
  // Quantities that the figure does not show are not stated; nothing is fetched from elsewhere.
  CHECK(report.find("stone.spin") == std::string::npos);
  CHECK(report.find("http") == std::string::npos);
  const bool picture = std::filesystem::exists(folder / "out/fig-7/picture.png");
  CHECK(picture == std::filesystem::exists(folder / "out/fig-7/picture.svg"));
  CHECK(picture == (report.find("src=\"data:image/png;base64,iVBORw0KGgo") != std::string::npos));
  CHECK(picture == (r.out.find("no pictures") == std::string::npos));

  std::vector<std::string> strict = all;
  strict.emplace_back("--verify");
  CHECK(run(strict, folder).code == 1);
}

TEST_CASE("without gnuplot there are curves and a report all the same", "[reproduce]") {
  const Folder folder;
  const std::string data = data_folder(folder);
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const Result r = run({"reproduce", "all", "--data", data, "-o", folder / "out"}, folder);
  setenv("PATH", path.c_str(), 1);
  CHECK(r.code == 0);
  CHECK(r.out.find("install gnuplot-nox") != std::string::npos);
  CHECK(std::filesystem::exists(folder / "out/fig-7/curve-1-2.csv"));
  CHECK(content(folder / "out/report.html").find("there was no gnuplot") != std::string::npos);
}

TEST_CASE("a figure of numbers alone, and a scene that fails", "[reproduce]") {
  const Folder folder;
  const std::string data =
      data_folder(folder, R"({ "title": "Table", "numbers": ["fall", "soft"] })");
  folder.write("data/scenes/soft.json",
               R"({ "materials": { "rock": { "density": 2000 } }, "gravity": [0, -9.81],
    "contact": { "normal_stiffness": 1e4 },
    "bodies": [ { "name": "flat", "material": "rock", "motion": "fixed", "polygon": [[-2,-1],[2,-1],[2,0],[-2,0]] },
                { "name": "square", "material": "rock", "polygon": [[-0.5,0.1],[0.5,0.1],[0.5,1.1],[-0.5,1.1]] } ],
    "time": { "end": 2 } })");
  const Result r = run({"reproduce", "all", "--data", data, "-o", folder / "out"}, folder);
  CHECK(r.code == 3);
  const std::string report = content(folder / "out/report.html");
  CHECK(report.find("1 figures, 3 numbers, 1 missed") != std::string::npos);
  CHECK(report.find("soft: bodies &quot;flat&quot; and &quot;square&quot; overlap") !=
        std::string::npos);
}

TEST_CASE("unknown and broken figures end with exit code 2 and one line", "[reproduce]") {
  const Folder folder;
  const std::string data = data_folder(folder);
  const Result unknown = run({"reproduce", "fig-17", "--data", data}, folder);
  CHECK(unknown.code == 2);
  CHECK(unknown.err.find("\"fig-17\"; did you mean \"fig-7\"?") != std::string::npos);
  CHECK(run({"reproduce", "--data", folder / "nowhere"}, folder).code == 2);
  for (const auto& [what, by, place] :
       {std::tuple("\"about\"", "\"abut\"", ":1: /abut: unknown key"),
        std::tuple("\"x\": \"time [ms]\"", "\"x\": \"time\"", ":2: /panels/0/x: "),
        std::tuple("[0, 10]", "[10, 0]", ":2: /panels/0/x_range: "),
        std::tuple("\"fall\"", "\"fal\"",
                   ":3: /panels/0/curves/0/scene: there is no scene \"fal\""),
        std::tuple("stone.vy", "stone.vz", "did you mean \"stone.vx\""),
        std::tuple("\"fall.csv\"", "\"rise.csv\"", ":4: /panels/0/curves/1/reference: "),
        std::tuple("\"y\": \"speed\"", "\"y\": \"sped\"", "did you mean \"speed\""),
        std::tuple("\"marks\"", "\"mark\"", "did you mean \"marks\""),
        std::tuple("\"points\"", "\"scene\": \"fall\", \"points\"", ":5: /panels/0/curves/2: ")}) {
    folder.write("data/figures/fig-7.json", replaced(kFigure, what, by));
    const Result r = run({"reproduce", "all", "--data", data, "-o", folder / "bad"}, folder);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(test::lines(r.err) == 1);
    CHECK(r.err.find("fig-7.json") != std::string::npos);
    CHECK(r.err.find(place) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "bad"));
  }
}
