// apothem reproduce as its users meet it.
#include <catch2/catch.hpp>
#include <filesystem>

#include "lib/output/history.hpp"
#include "tests/pixels.hpp"
#include "tests/program.hpp"

using namespace apothem;
using test::content;
using test::exchanged;
using test::Folder;
using test::Result;
using test::run;

namespace {

// A stone's fall for 10 ms, and a table of what theory says.
const char* const kStudy = R"({ "materials": { "rock": { "density": 2000 } }, "gravity": [0, -10],
  "bodies": [ { "name": "stone", "material": "rock", "polygon": [[0,0],[1,0],[1,1],[0,1]] } ],
  "time": { "end": 0.01, "step": 1e-4 }, "output": { "frames": 1, "history": { "interval": 1e-3 } },
  "expect": [ { "label": "speed <at the end>", "quantity": "stone.vy", "take": "last", "value": -0.1, "tolerance": 1e-9,
                "basis": "theory", "source": "free fall" },
              { "quantity": "stone.spin", "take": "max_abs", "value": 0, "tolerance": 1e-9 },
              { "quantity": "stone.vy", "take": "max", "value": 0.5, "tolerance": 1e-6 } ] })";
const char* const kFigure = R"({ "title": "Free fall & more", "about": "A stone.",
  "panels": [ { "title": "it's falling", "x": "time [ms]", "y": "speed [mm/s]", "x_range": [0, 10],
    "curves": [ { "label": "ours", "scene": "fall", "x_scale": 1e3, "y": "stone.vy", "y_offset": -0.5, "y_scale": -1e3 },
                { "label": "theory", "reference": "fall.csv", "y": "speed", "style": "marks" },
                { "points": [[0, 500], [10, 600]], "style": "dashed", "colour": 1 } ] } ] })";

// A block pulled along x by 1 MPa, in two load steps; a table of its stress with one wrong cell.
const char* const kPulled =
    R"({ "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
  "bodies": [ { "name": "block", "material": "rock", "mesh": { "rectangle": { "size": [2, 1], "cells": [8, 4] } },
    "supports": [ { "where": { "group": "left" }, "fix": ["x"] }, { "where": { "nearest": [0, 0] }, "fix": ["y"] } ],
    "loads": [ { "where": { "group": "right" }, "traction": [1e6, 0], "history": [[0, 0], [1, 1]] } ] } ],
  "time": { "end": 1, "mode": "static", "load_steps": 2 },
  "output": { "history": { "track": [ { "body": "block", "point": [1, 0.5], "name": "A" } ] } },
  "expect": [ { "quantity": "A.sxx", "value": 1e6, "relative": 2e-4 },
              { "quantity": "A.s1", "take": "max", "between": [0.4, 0.6], "value": 0.5e6, "relative": 2e-4 },
              { "quantity": "A.s2", "take": "max_abs", "value": 0, "tolerance": 100 },
              { "quantity": "A.sxy", "take": "max_abs", "value": 0, "tolerance": 100 } ] })";
const char* const kFieldFigure = R"({ "title": "Pulled", "panels": [
  { "field": "sxx", "title": "along", "unit": "MPa", "scale": 1e-6, "range": [0, 2], "window": [[-0.5, -0.5], [2.5, 1.5]],
    "fields": [ { "label": "ours", "scene": "pulled", "time": 1, "compare": { "rms": 0.2, "max": 0.4 } },
                { "label": "table", "reference": "pulled.csv", "column": "sxx", "cell": [0.5, 0.5] } ] },
  { "field": "ux", "fields": [ { "scene": "pulled", "time": 0.5 } ] },
  { "x": "time [s]", "y": "stress [Pa]", "curves": [ { "scene": "fall", "y": "stone.vy" } ] } ] })";

// A data folder with one figure.
std::string data_folder(const Folder& folder, const std::string& figure = kFigure) {
  for (const char* part : {"data/figures", "data/scenes", "data/reference"}) {
    std::filesystem::create_directories(folder / part);
  }
  folder.write("data/scenes/fall.json", kStudy);
  folder.write("data/reference/fall.csv", "time [ms],speed [mm/s]\n0,500\n5,550\n10,600\n");
  folder.write("data/scenes/pulled.json", kPulled);
  std::string cells = "x,y,sxx\n";
  for (int i = 0; i < 8; ++i) {
    cells += std::to_string(.25 + .5 * (i % 4)) + "," + (i < 4 ? "0.25," : "0.75,") +
             (i == 6 ? "2e6\n" : "1e6\n");
  }
  folder.write("data/reference/pulled.csv", cells);
  folder.write("data/reference/bare.csv", "t,speed\n0,500\n");
  folder.write("data/reference/empty.csv", "x,y,sxx\n");
  folder.write("data/reference/lost.csv", "x,y,sxx\n0,0,1\n0,nan,1\n");
  folder.write("data/figures/fig-7.json", figure);
  for (const char* text : {"about.html", "left-out.html"}) {
    folder.write(std::string("data/figures/") + text,
                 content(test::kSource + "/data/figures/" + text));
  }
  return folder / "data";
}

}  // namespace

TEST_CASE("every shipped figure passes the loader", "[reproduce][slow]") {
  const Folder folder;
  const Result r = run({"reproduce"}, folder);
  INFO(r.err);
  REQUIRE(r.code == 0);
  int shipped = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::kSource + "/data/figures")) {
    if (entry.path().extension() != ".json") continue;
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
  CHECK(r.out.find("MISSED fall: largest stone.vy") != std::string::npos);
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

  const std::string numbers = content(folder / "out/numbers.csv");
  CHECK(numbers.find("figure,run,number,unit,value,reference,tolerance,within,basis,source\n") ==
        0);
  const std::string report = content(folder / "out/report.html");
  for (const char* text :
       {"Free fall &amp; more", "A stone.", "speed &lt;at the end&gt; (last stone.vy)",
        "href=\"fig-7/curve-1-1.csv\"", "href=\"runs/fall/run.json\"",
        "1 figures, 2 numbers, 1 missed", "<tr class=\"missed\">",
        "data-head=\"reference\">0.5</td><td class=\"number\" data-head=\"result\">0</td>",
        "data-head=\"error\">-5.0e-01</td><td class=\"number\" "
        "data-head=\"relative\">-1.0e+00</td>",
        "data-head=\"unit\">m/s</td>", "data-head=\"source\">free fall</td>",
        "<h3>Against theory or an independent code</h3>", "<h3>Internal checks</h3>",
        "data-head=\"rests on\">closed form</td>", "data-head=\"theory or code\">1 of 1</td>",
        "data-head=\"internal checks\">0 of 1</td>",
        "not reproduced by this run: 1 of 2 numbers missed", "doi:10.1007/s00466-020-01913-2",
        "Figures of the paper that are not here"}) {
    INFO(text);
    CHECK(report.find(text) != std::string::npos);
  }
  // Quantities that the figure does not show are not stated; nothing is fetched from elsewhere.
  CHECK(report.find("stone.spin") == std::string::npos);
  CHECK(report.find("src=\"http") == std::string::npos);
  CHECK(report.find("<h3>Against the paper") == std::string::npos);
  const bool picture = std::filesystem::exists(folder / "out/fig-7/picture.png");
  CHECK(picture == std::filesystem::exists(folder / "out/fig-7/picture.svg"));
  CHECK(picture == (report.find("src=\"data:image/png;base64,iVBORw0KGgo") != std::string::npos));
  CHECK(picture == (r.out.find("no pictures") == std::string::npos));

  std::vector<std::string> strict = all;
  strict.emplace_back("--verify");
  CHECK(run(strict, folder).code == 1);
}

TEST_CASE("a curve along a surface", "[reproduce][slow]") {
  const Folder folder;
  const std::string figure = R"({ "title": "Pressure",
  "panels": [ { "x": "x [mm]", "y": "pressure [kPa]",
    "curves": [ { "scene": "press", "surface": "block", "time": 1, "x_scale": 1e3, "y": "pressure", "y_scale": 1e-3 } ] } ] })";
  const std::string data = data_folder(folder, figure);
  folder.write("data/scenes/press.json", R"({
  "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0 } },
  "contact": { "normal_stiffness": 1e10 },
  "bodies": [
    { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-3,-1],[3,-1],[3,0],[-3,0]] },
    { "name": "block", "material": "rock",
      "mesh": { "rectangle": { "size": [2, 1], "cells": [4, 2], "origin": [-1, 0] } },
      "supports": [ { "where": { "nearest": [0, 1] }, "fix": ["x"] } ],
      "loads": [ { "where": { "group": "top" }, "traction": [0, -1e5] } ] } ],
  "time": { "end": 1, "mode": "static", "load_steps": 1 } })");
  const std::vector<std::string> all{"reproduce", "fig-7", "--data", data, "-o", folder / "out"};
  const Result r = run(all, folder);
  INFO(r.out << r.err);
  REQUIRE(r.code == 0);
  const HistoryTable curve = read_history(folder / "out/fig-7/curve-1-1.csv");
  REQUIRE(curve.columns[0].size() == 4);  // not the sides, whose tips are in the floor
  for (int i = 0; i < 4; ++i) {
    CHECK(curve.columns[0][i] == Approx(500 * i - 750).epsilon(1e-3));
    CHECK(curve.columns[1][i] == Approx(100).epsilon(1e-3));
  }
  for (const auto& [from, to, what] :
       {std::array{"\"block\"", "\"floor\"", "unknown choice \"floor\""},
        {"\"time\": 1", "\"time\": 0.7", "is not the time of a frame"},
        {"\"y\": \"pressure\"", "\"y\": \"presure\"", "pressure"}}) {
    folder.write("data/figures/fig-7.json", exchanged(figure, from, to));
    const Result wrong = run(all, folder);
    INFO(wrong.err);
    CHECK(wrong.code == 2);
    CHECK(wrong.err.find(what) != std::string::npos);
  }
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

TEST_CASE("a figure of fields becomes a picture, and its error is stated", "[reproduce][slow]") {
  const Folder folder;
  const std::string data = data_folder(folder, kFieldFigure);
  const Result r = run({"reproduce", "all", "--data", data, "-o", folder / "out"}, folder);
  INFO(r.out << r.err);
  REQUIRE(r.code == 0);
  // 1e6 of 2e6 in one of eight cells.
  const std::string report = content(folder / "out/report.html");
  for (const char* text : {"stress xx at 1 s: rms error in cells", "data-head=\"result\">0.1767",
                           "data-head=\"result\">0.4999", "1 figures, 8 numbers, 2 missed",
                           "href=\"fig-7/fields.svg\""}) {
    INFO(text);
    CHECK(report.find(text) != std::string::npos);
  }
  CHECK(r.out.find("MISSED pulled: stress xx at 1 s: largest error") != std::string::npos);
  const size_t first = report.find("src=\"data:image/png;base64,iVBORw0KGgo");
  CHECK(first != std::string::npos);
  CHECK((report.find("src=\"data:image/png", first + 1) != std::string::npos) ==
        std::filesystem::exists(folder / "out/fig-7/picture.png"));
  CHECK(content(folder / "out/fig-7/fields.svg").find("<image") != std::string::npos);
  // 1 MPa is the middle of the scale: of our 2 m^2 and of all cells of the table but one.
  const test::Pixels pixels = test::decode(content(folder / "out/fig-7/fields.png"));
  const auto share_of = [&](const Colour& colour) {
    const auto is = [&](std::uint32_t pixel) { return test::has_colour(pixel, colour); };
    return static_cast<double>(std::count_if(pixels.colours.begin(), pixels.colours.end(), is));
  };
  const double cell = share_of(viridis(1));
  CHECK(cell > 1000);
  CHECK(share_of(viridis(.5)) / cell == Approx(15).epsilon(.1));
}

TEST_CASE("a run that ends before its picture leaves a report", "[reproduce]") {
  const Folder folder;
  const std::string data = data_folder(
      folder,
      R"({ "title": "T", "panels": [ { "field": "speed", "fields": [ { "scene": "torn", "time": 1 } ] } ] })");
  folder.write("data/scenes/torn.json", exchanged(kPulled, "\"right\" }, \"traction\": [1e6, 0]",
                                                  "\"right\" }, \"traction\": [-1e12, 0]"));
  const Result r = run({"reproduce", "all", "--data", data, "-o", folder / "out"}, folder);
  INFO(r.out << r.err);
  CHECK(r.code == 3);
  CHECK(content(folder / "out/report.html").find("No picture: ") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "out/fig-7/fields.png"));
}

TEST_CASE("broken panels of fields end with exit code 2 and one line", "[reproduce][slow]") {
  const Folder folder;
  const std::string data = data_folder(folder);
  for (const auto& [what, by, place] :
       {std::tuple("\"sxx\", \"title\"", "\"sx\", \"title\"",
                   ":2: /panels/0/field: unknown choice \"sx\""),
        std::tuple("\"title\": \"along\"", "\"titel\": \"along\"",
                   ":2: /panels/0/titel: unknown key"),
        std::tuple("\"unit\": \"MPa\", ", "", ":2: /panels/0/scale: goes with a \"unit\""),
        std::tuple("1e-6", "-1", ":2: /panels/0/scale: "),
        std::tuple("[0, 2]", "[2, 0]", ":2: /panels/0/range: "),
        std::tuple("[2.5, 1.5]", "[2.5, -1.5]",
                   ":2: /panels/0/window: must be [[x0, y0], [x1, y1]]"),
        std::tuple("\"pulled\", \"time\": 1,", "\"pullet\", \"time\": 1,",
                   ":3: /panels/0/fields/0/scene: there is no scene \"pullet\"; did you mean"),
        std::tuple("\"pulled\", \"time\": 1,", "\"fall\", \"time\": 0,",
                   ":3: /panels/0/fields/0/scene: has no body with a mesh"),
        std::tuple("\"time\": 1,", "\"time\": 0.7,",
                   ":3: /panels/0/fields/0/time: is not the time of a frame: those of pulled are "
                   "0.5 s apart"),
        std::tuple("\"time\": 1,", "\"time\": 1.5,", ":3: /panels/0/fields/0/time: is not"),
        std::tuple("\"time\": 1,", "", ":3: /panels/0/fields/0"),
        std::tuple("\"max\": 0.4", "\"largest\": 0.4", ":3: /panels/0/fields/0/compare"),
        std::tuple("pulled.csv", "pushed.csv", ":4: /panels/0/fields/1/reference: "),
        std::tuple("pulled.csv", "empty.csv", ":4: /panels/0/fields/1/reference: has no rows"),
        std::tuple("pulled.csv\", \"column\": \"sxx\"", "fall.csv\", \"column\": \"time\"",
                   ":4: /panels/0/fields/1/reference: has no column \"x\""),
        std::tuple("\"column\": \"sxx\"", "\"column\": \"sxy\"", "did you mean \"sxx\""),
        std::tuple("[0.5, 0.5]", "[0.5, 0]", ":4: /panels/0/fields/1/cell: "),
        std::tuple("[0.5, 0.5]", "[2, 0.5]", ":4: /panels/0/fields/1/reference: the cell around "),
        std::tuple("pulled.csv", "lost.csv", ":4: /panels/0/fields/1/reference: the cell around "),
        std::tuple("[2.5, 1.5]", "[1e308, 1.5]", ":2: /panels/0/window: must lie within 1e+60 m"),
        std::tuple("\"reference\": \"pulled.csv\", \"column\": \"sxx\", \"cell\": [0.5, 0.5]",
                   "\"scene\": \"pulled\", \"time\": 1",
                   ":3: /panels/0/fields/0: is compared with a \"reference\""),
        std::tuple("\"scene\": \"pulled\", \"time\": 0.5", "\"label\": \"\"",
                   ":5: /panels/1/fields/0: must give either \"scene\" or \"reference\""),
        std::tuple("[ { \"scene\": \"pulled\", \"time\": 0.5 } ]", "[]",
                   ":5: /panels/1/fields: must hold at least one field")}) {
    folder.write("data/figures/fig-7.json", exchanged(kFieldFigure, what, by));
    const Result r = run({"reproduce", "all", "--data", data, "-o", folder / "bad"}, folder);
    INFO(by << ": " << r.err);
    CHECK(r.code == 2);
    CHECK(test::lines(r.err) == 1);
    CHECK(r.err.find("fig-7.json") != std::string::npos);
    CHECK(r.err.find(place) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "bad"));
  }
}

TEST_CASE("the stress of the impacted beam is that of the independent code", "[reproduce][slow]") {
  const Folder folder;
  const Result r = run({"reproduce", "fig-28", "--verify", "-o", folder / "out"}, folder);
  INFO(r.out << r.err);
  CHECK(r.code == 0);
  CHECK(std::filesystem::exists(folder / "out/fig-28/fields.png"));
}

TEST_CASE("unknown and broken figures end with exit code 2 and one line", "[reproduce][slow]") {
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
        std::tuple("\"fall.csv\"", "\"bare.csv\"",
                   ":4: /panels/0/curves/1/reference: has no column \"time\""),
        std::tuple("[[0, 500], [10, 600]]", "[]", ":5: /panels/0/curves/2/points: must hold"),
        std::tuple("\"marks\"", "\"mark\"", "did you mean \"marks\""),
        std::tuple("\"points\"", "\"scene\": \"fall\", \"points\"", ":5: /panels/0/curves/2: ")}) {
    folder.write("data/figures/fig-7.json", exchanged(kFigure, what, by));
    const Result r = run({"reproduce", "all", "--data", data, "-o", folder / "bad"}, folder);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(test::lines(r.err) == 1);
    CHECK(r.err.find("fig-7.json") != std::string::npos);
    CHECK(r.err.find(place) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "bad"));
  }
}
