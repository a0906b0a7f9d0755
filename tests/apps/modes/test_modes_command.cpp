// apothem modes: its table, JSON, files and refusals.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lib/output/run_folder.hpp"
#include "tests/program.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace modes_command {
namespace {

// Two blocks on a floor, of which one floats; in JSON with marks to exchange.
const std::string kBlocks = R"({ "name": "blocks", "gravity": [0, -9.81],
  "materials": { "rock": { "density": 2000 } },
  "contact": { "normal_stiffness": 1e9, "friction": { "coefficient": 0.5 } },
  "bodies": [
    { "name": "floor", "material": "rock", "polygon": [[-3, -1], [3, -1], [3, 0], [-3, 0]], "motion": "fixed" },
    { "name": "block", "material": "rock", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]] } ],
  "time": { "end": 1, "start": "settled" } })";

const std::string kStrut = kSource + "/data/scenes/strut.json";

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace
}  // namespace modes_command

TEST_CASE("modes prints a table, JSON and frames that pictures can be made of", "[program]") {
  using namespace modes_command;
  const Folder folder;
  const std::string scene = folder.write("blocks.json", kBlocks), out = folder / "modes";
  const Result table = run({"modes", scene, "-n", "2", "-o", out}, folder);
  INFO(table.err);
  REQUIRE(table.code == 0);
  CHECK(contains(table.out, "3 free coordinates, 1 contact"));
  CHECK(contains(table.out, "friction counts as sticking"));
  CHECK(contains(table.out, "of 2000 and 2000 kg"));
  const Json json = Json::parse(run({"modes", scene, "--json"}, folder).out);
  CHECK(json == Json::parse(run({"modes", scene, "--json", "--threads", "3"}, folder).out));
  CHECK(json["analysis"] == "vibration");
  CHECK(json["state"] == "start");
  CHECK(json["rigid"] == 0);
  CHECK(json["unstable"] == 0);
  REQUIRE(json["modes"].size() == 3);
  // Upright: k_n (1/r + 1/r') of its width on its mass, with both inradii .5.
  CHECK(json["modes"][1]["kind"] == "vibration");
  const double exact = std::sqrt(1e9 * 4 / 2000) / (2 * M_PI);
  double nearest = 1;
  for (const Json& mode : json["modes"]) {
    const double frequency = mode["frequency"];
    CHECK(frequency * mode["period"].get<double>() == Approx(1));
    if (mode["mass_share"][1].get<double>() > .5) nearest = std::abs(frequency / exact - 1);
  }
  CHECK(nearest < 1e-4);

  // The files say the same.
  Json kept = Json::parse(content(out + "/modes.json"));
  CHECK(kept["modes"][1]["folder"] == "mode-02");
  CHECK(kept["modes"][1]["frequency"] == json["modes"][1]["frequency"]);
  CHECK(lines(content(out + "/modes.csv")) == 3);
  const RunFolder frames(out + "/mode-01");
  REQUIRE(frames.times().size() == 17);
  CHECK(frames.times().back() == json["modes"][0]["period"]);
  const Frame first = frames.frame(0), half = frames.frame(8), last = frames.frame(16);
  double largest = 0;
  for (size_t i = 0; i < first.displacement.size(); ++i) {
    largest = std::max(largest, first.displacement[i].norm());
    CHECK((first.displacement[i] - last.displacement[i]).norm() < 1e-12);
  }
  // 5 % of 6 m, less what a body that turns by half a radian moves.
  CHECK(largest > .1);
  CHECK(largest < .31);
  CHECK(first.bodies[1].rotation() == Approx(-half.bodies[1].rotation()).epsilon(1e-9));
  CHECK(run({"picture", out + "/mode-01", "-o", folder / "mode.svg"}, folder).code == 0);
  CHECK(contains(content(folder / "mode.svg"), "</svg>"));

  // Results are replaced only if that is asked for, and then all of them.
  const Result again = run({"modes", scene, "-n", "1", "-o", out}, folder);
  CHECK(again.code == 2);
  CHECK(contains(again.err, "--overwrite"));
  CHECK(run({"modes", scene, "-n", "1", "-o", out, "--overwrite"}, folder).code == 0);
  CHECK(std::filesystem::exists(out + "/mode-01/frames.pvd"));
  CHECK_FALSE(std::filesystem::exists(out + "/mode-02"));
}

TEST_CASE("modes tells rigid-body modes, unstable ones and doubtful contacts apart", "[program]") {
  using namespace modes_command;
  const Folder folder;
  const std::string as_given =
      folder.write("given.json", exchanged(kBlocks, R"(, "start": "settled")", ""));
  const Result given = run({"modes", as_given}, folder);
  CHECK(given.code == 0);
  CHECK(contains(given.out, "3 rigid-body modes at 0 Hz"));
  CHECK(contains(given.out, "1 pair of bodies touches without pressing"));
  CHECK(contains(given.out, "\"floor\" and \"block\""));
  CHECK(contains(given.out, "not in equilibrium"));

  const Result strut =
      run({"modes", kStrut, "-n", "2", "--json", "--set", "bodies.strut.loads.0.traction=[0,-2e7]"},
          folder);
  CHECK(strut.code == 0);
  const Json json = Json::parse(strut.out);
  CHECK(json["unstable"] == 1);
  CHECK(json["state"] == "equilibrium");
  CHECK(json["modes"][0]["kind"] == "unstable");
  CHECK(json["modes"][0]["growth_rate"] > 1);
  CHECK(json["modes"][0]["period"].is_null());
  CHECK(json["modes"][1]["kind"] == "vibration");
}

TEST_CASE("modes --buckling gives the factor of the loads", "[program]") {
  using namespace modes_command;
  const Folder folder;
  const Json json =
      Json::parse(run({"modes", kStrut, "--buckling", "-n", "1", "--json"}, folder).out);
  CHECK(json["analysis"] == "buckling");
  REQUIRE(json["modes"].size() == 1);
  CHECK(json["modes"][0]["load_factor"] == Approx(2).epsilon(2e-3));
  const Result table = run({"modes", kStrut, "--buckling", "-n", "1", "-o", folder / "b"}, folder);
  CHECK(table.code == 0);
  CHECK(contains(table.out, "load factor"));
  CHECK(RunFolder(folder / "b/mode-01").times().back() == 1);
  const Result idle =
      run({"modes", kStrut, "--buckling", "--set", "bodies.strut.loads.0.traction=[0,0]"}, folder);
  CHECK(idle.code == 0);
  CHECK(contains(idle.out, "no multiple of these loads"));
}

TEST_CASE("what has no modes is refused in one line", "[program]") {
  using namespace modes_command;
  const Folder folder;
  const std::string scene = folder.write("blocks.json", kBlocks);
  const std::string per_edge = folder.write(
      "edges.json",
      exchanged(kBlocks, R"("coefficient": 0.5)",
                R"("coefficient": 0.5, "law": "per_edge", "tangential_stiffness": 1e8)"));
  const std::string loose = folder.write(
      "loose.json", R"({ "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
  "bodies": [ { "name": "b", "material": "rock", "mesh": { "rectangle": { "size": [1, 1], "cells": [2, 2] } } } ],
  "time": { "end": 1, "mode": "static" } })");
  struct Case {
    std::vector<std::string> arguments;
    int code;
    const char* message;
  };
  for (const Case& c : std::initializer_list<Case>{
           {{scene, "--buckling"}, 2, "\"mode\": \"static\""},
           {{per_edge}, 2, "per_edge"},
           {{loose, "--buckling"}, 2, "support what can move freely"},
           {{scene, "-n", "0"}, 2, "--number"},
           {{folder / "none.json"}, 2, "none.json"},
           {{kStrut, "--set", "bodies.strut.loads.0.traction=[0,-1e14]"}, 3, "strut"}}) {
    std::vector<std::string> words{"modes"};
    words.insert(words.end(), c.arguments.begin(), c.arguments.end());
    const Result r = run(words, folder);
    INFO(r.err);
    CHECK(r.code == c.code);
    CHECK(lines(r.err) == 1);
    CHECK(contains(r.err, c.message));
    CHECK(r.out.empty());
  }
}
