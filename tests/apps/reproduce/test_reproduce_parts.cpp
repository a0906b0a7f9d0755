// The parts of a report that apothem reproduce makes: words and verdicts, potentials, tables,
// studies, players, and what is not done again.
#include <catch2/catch.hpp>
#include <filesystem>

#include "lib/output/history.hpp"
#include "tests/program.hpp"

using namespace apothem;
using test::content;
using test::exchanged;
using test::Folder;
using test::Result;
using test::run;

namespace {

// A stone falls for 10 ms.
const char* const kMeasuredFall =
    R"({ "materials": { "rock": { "density": 2000 } }, "gravity": [0, -10],
  "bodies": [ { "name": "stone", "material": "rock", "polygon": [[0,0],[1,0],[1,1],[0,1]] } ],
  "time": { "end": 0.01, "step": 1e-4 }, "output": { "frames": 2, "history": { "interval": 1e-3 } },
  "measure": [ { "name": "fast", "stopped_by": "fast" }, { "name": "speed", "quantity": "stone.vy", "take": "min" } ],
  "stop": [ { "name": "fast", "region": "above", "count_below": 1 } ],
  "regions": { "above": { "polygon": [[-1, 0.2], [2, 0.2], [2, 2], [-1, 2]] } },
  "expect": [ { "quantity": "stone.vy", "take": "last", "value": -0.1, "tolerance": 1e-9, "basis": "paper", "source": "Sec. 9" } ] })";

std::string folder_of(const Folder& folder, const std::string& figure) {
  for (const char* part : {"data/figures", "data/scenes", "data/reference"}) {
    std::filesystem::create_directories(folder / part);
  }
  folder.write("data/scenes/fall.json", kMeasuredFall);
  folder.write("data/reference/fall.csv", "time,speed\n0,0\n0.005,-0.05\n0.01,-0.1\n");
  folder.write("data/reference/trials.csv",
               "kind,width,n,events,rate\na,1,10,10,\na,2,10,4,5\nb,2,20,2,8\n");
  folder.write("data/figures/fig-7.json", figure);
  return folder / "data";
}

Result reproduce_all(const Folder& folder, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"reproduce",     "all", "--data",
                                 folder / "data", "-o",  folder / "out"};
  words.insert(words.end(), more.begin(), more.end());
  return run(words, folder);
}

}  // namespace

TEST_CASE("words, verdict and difference from a reference curve", "[reproduce][slow]") {
  const Folder folder;
  const std::string figure = R"({ "title": "Fall", "paper": "A stone & its fall.", "about": "Ours.",
  "open": [ { "question": "How high?", "choice": "It does not matter." } ],
  "verdict": { "is": "explained", "because": "air is left out." }, "players": ["fall"],
  "panels": [ { "x": "time [s]", "y": "speed [m/s]", "curves": [
    { "label": "ours", "scene": "fall", "y": "stone.vy", "compare": { "rms": 1e-9, "max": 1e-9, "basis": "theory" } },
    { "label": "theory", "reference": "fall.csv", "y": "speed", "style": "marks" } ] } ] })";
  folder_of(folder, figure);
  REQUIRE(reproduce_all(folder).code == 0);
  const std::string report = content(folder / "out/report.html");
  for (const char* text :
       {"What the paper shows</h3>\n<p>A stone &amp; its fall.",
        "<dt>How high?</dt><dd>It does not matter.",
        "<span class=\"badge explained\">reproduced with an explained difference</span> air is "
        "left out.",
        "<h3>Against the paper</h3>", "data-head=\"paper\">1 of 1<",
        "data-head=\"theory or code\">2 of 2<", "largest difference from &quot;theory&quot;",
        "href=\"players/fall.html\""}) {
    INFO(text);
    CHECK(report.find(text) != std::string::npos);
  }
  CHECK(content(folder / "out/players/fall.html").find("<!DOCTYPE html>") != std::string::npos);

  // A changed number of the reference takes the verdict away.
  folder.write("data/reference/fall.csv", "time,speed\n0,0\n0.005,-0.06\n0.01,-0.1\n");
  const Result changed = reproduce_all(folder, {"--verify"});
  CHECK(changed.code == 1);
  CHECK(changed.out.find("fall done (unchanged, not run again)") != std::string::npos);
  const std::string again = content(folder / "out/report.html");
  CHECK(again.find("not reproduced by this run: 2 of 3 numbers missed") != std::string::npos);
  CHECK(again.find("badge explained") == std::string::npos);

  for (const auto& [what, by, place] :
       {std::tuple("\"explained\"", "\"explain\"", "/verdict/is: "),
        std::tuple("\"choice\"", "\"chosen\"", "/open/0"),
        std::tuple("[\"fall\"]", "[\"fell\"]", "/players/0: "),
        std::tuple("\"rms\": 1e-9, ", "", "/panels/0/curves/0/compare"),
        std::tuple("\"reference\": \"fall.csv\", \"y\": \"speed\"", "\"points\": [[0, 0]]",
                   "/panels/0/curves/0: is compared with a \"reference\"")}) {
    folder.write("data/figures/fig-7.json", exchanged(figure, what, by));
    const Result wrong = reproduce_all(folder);
    INFO(wrong.err);
    CHECK(wrong.code == 2);
    CHECK(test::lines(wrong.err) == 1);
    CHECK(wrong.err.find(place) != std::string::npos);
  }
}

TEST_CASE("runs that are there are kept, others are done again", "[reproduce][slow]") {
  const Folder folder;
  folder_of(folder, R"({ "title": "Fall", "numbers": ["fall"] })");
  CHECK(reproduce_all(folder).out.find("fall done (0.") != std::string::npos);
  CHECK(reproduce_all(folder).out.find("unchanged, not run again") != std::string::npos);
  folder.write("data/scenes/fall.json", exchanged(kMeasuredFall, "\"end\": 0.01", "\"end\": 0.02"));
  CHECK(reproduce_all(folder).out.find("unchanged") == std::string::npos);
  // One that was left in the middle is done again.
  folder.write("out/runs/fall/reproduced.json",
               exchanged(content(folder / "out/runs/fall/reproduced.json"), "true", "false"));
  CHECK(reproduce_all(folder).out.find("unchanged") == std::string::npos);
}

TEST_CASE("potentials over polygons, and their numbers", "[reproduce][slow]") {
  const Folder folder;
  const std::string figure = R"({ "title": "Maps", "panels": [ { "title": "two", "shapes": [
    { "label": "rectangle", "polygon": [[0,0],[4,0],[4,2],[0,2]], "reference": 0.5, "expect": [
      { "quantity": "phi", "at": [2, 0.2], "point": "p", "value": 0.4, "tolerance": 1e-14, "basis": "theory", "source": "0.2/0.5" },
      { "quantity": "singular_area", "value": 3, "tolerance": 1e-12, "basis": "theory", "source": "3 x 1" },
      { "quantity": "gradient", "edge": 1, "value": 2, "tolerance": 1e-13, "basis": "theory", "source": "1/r" } ] },
    { "label": "triangle", "potential": "area", "polygon": [[0,0],[3,0],[0,3]], "expect": [
      { "quantity": "phi", "at": [1, 1], "value": 0.9, "tolerance": 1e-3, "basis": "theory", "source": "wrong" } ] } ] } ] })";
  folder_of(folder, figure);
  const Result r = reproduce_all(folder);
  INFO(r.err);
  REQUIRE(r.code == 0);
  CHECK(r.out.find("3 of 4 numbers") != std::string::npos);
  CHECK(r.out.find("MISSED triangle: φ") != std::string::npos);
  CHECK(content(folder / "out/fig-7/potentials.png").starts_with("\x89PNG"));
  CHECK(content(folder / "out/report.html").find("href=\"fig-7/potentials.svg\"") !=
        std::string::npos);
  for (const auto& [what, by, place] :
       {std::tuple("[[0,0],[3,0],[0,3]]", "[[0,0],[3,0],[2,2],[0,3]]", "/shapes/1/polygon: "),
        std::tuple("\"edge\": 1", "\"edge\": 4", "/expect/2/edge: "),
        std::tuple("\"area\"", "\"arae\"", "did you mean \"area\""),
        std::tuple("\"reference\": 0.5", "\"reference\": -1", "/shapes/0/reference: "),
        std::tuple("\"quantity\": \"phi\", \"at\": [1, 1]", "\"quantity\": \"singular_area\"",
                   "only the distance potential")}) {
    folder.write("data/figures/fig-7.json", exchanged(figure, what, by));
    const Result wrong = reproduce_all(folder);
    INFO(wrong.err);
    CHECK(wrong.code == 2);
    CHECK(wrong.err.find(place) != std::string::npos);
  }
}

TEST_CASE("a study becomes curves and comparisons", "[reproduce][slow]") {
  const Folder folder;
  const std::string figure = R"({ "title": "Study",
  "studies": [ { "name": "falls", "commands": [ ["sweep", "{data}/scenes/fall.json", "--vary", "time.end=0.01,0.2,0.3", "--quiet", "-o", "{out}"] ],
                 "quick": [ ["sweep", "{data}/scenes/fall.json", "--vary", "time.end=0.01,0.3", "--quiet", "-o", "{out}"] ] } ],
  "panels": [
    { "x": "end [s]", "y": "share [1]", "curves": [
      { "study": "falls/runs.csv", "where": { "status": "done" }, "take": "share", "style": "error_bars", "x": "time.end", "y": "fast" },
      { "table": "reference/trials.csv", "where": { "kind": "a*" }, "take": "counts", "style": "error_bars", "x": "width", "y": "events", "of": "n" } ] },
    { "x": "end [s]", "y": "speed [m/s]", "x_logarithmic": true, "curves": [
      { "study": "falls/runs.csv", "take": "mean", "x": "time.end", "y": "speed", "y_offset": 0.1, "y_absolute": true } ] } ],
  "compare": [
    { "label": "same", "state": "ratio", "at": "width", "value": 2.5, "tolerance": 0.1, "basis": "code", "source": "s",
      "first": { "table": "reference/trials.csv", "where": { "kind": ["a"] }, "x": "width", "y": "events", "y_scale": 0.125 },
      "second": { "table": "reference/trials.csv", "where": { "kind": "b" }, "x": "width", "y": "events", "y_scale": 0.1 } },
    { "label": "shares", "state": "difference", "at": "width", "value": 1, "tolerance": 0.95, "basis": "code", "source": "s",
      "first": { "table": "reference/trials.csv", "where": { "kind": "a" }, "take": "counts", "x": "width", "y": "events", "of": "n" },
      "second": { "table": "reference/trials.csv", "where": { "kind": "b" }, "take": "counts", "x": "width", "y": "events", "of": "n" } } ] })";
  folder_of(folder, figure);
  const Result quick = reproduce_all(folder, {"--quick"});
  INFO(quick.out << quick.err);
  REQUIRE(quick.code == 0);
  CHECK(read_history(folder / "out/fig-7/curve-2-1.csv").columns[0].size() == 2);
  const Result r = reproduce_all(folder);
  REQUIRE(r.code == 0);
  const HistoryTable shares = read_history(folder / "out/fig-7/curve-1-1.csv");
  CHECK(shares.columns[0] == std::vector<double>{.01, .2, .3});
  CHECK(shares.columns[1] == std::vector<double>{0, 0, 1});    // 0.2 m are fallen after 0.2 s
  CHECK(shares.columns[2][2] == Approx(.2065).epsilon(1e-3));  // Wilson, one of one
  const HistoryTable counts = read_history(folder / "out/fig-7/curve-1-2.csv");
  CHECK(counts.columns[1] == std::vector<double>{1, .4});
  CHECK(counts.columns[2][1] == Approx(.1682).epsilon(1e-3));
  CHECK(counts.columns[3][1] == Approx(.6873).epsilon(1e-3));
  const HistoryTable speeds = read_history(folder / "out/fig-7/curve-2-1.csv");
  CHECK(speeds.columns[1][0] == Approx(0).margin(1e-12));
  CHECK(speeds.columns[1][1] == Approx(1.9));
  const std::string report = content(folder / "out/report.html");
  CHECK(report.find("same, width = 2</td>") != std::string::npos);
  CHECK(report.find("data-head=\"result\">2.5</td>") != std::string::npos);
  // Fisher: 4 of 10 and 2 of 20.
  CHECK(report.find("data-head=\"result\">0.141316") != std::string::npos);
  CHECK(report.find("apothem sweep") != std::string::npos);
  CHECK(reproduce_all(folder).out.find("falls done (unchanged, not run again)") !=
        std::string::npos);

  for (const auto& [what, by, place] :
       {std::tuple("\"take\": \"counts\", \"style\"", "\"take\": \"sum\", \"style\"",
                   "/curves/1/take: "),
        std::tuple("\"where\": { \"kind\": \"a*\" }", "\"where\": { \"kind\": \"c\" }",
                   "has no row that is asked for"),
        std::tuple("\"y\": \"events\", \"of\"", "\"y\": \"event\", \"of\"",
                   "did you mean \"events\""),
        std::tuple("[\"sweep\"", "[\"rm\"", "must be a command"),
        std::tuple("\"name\": \"falls\"", "\"name\": \"../falls\"",
                   "letters, digits and hyphens")}) {
    folder.write("data/figures/fig-7.json", exchanged(figure, what, by));
    const Result wrong = reproduce_all(folder);
    INFO(wrong.err);
    CHECK(wrong.code == 2);
    CHECK(wrong.err.find(place) != std::string::npos);
  }
}
