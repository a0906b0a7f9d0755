// What is said of the time that the scheme "auto" would save, and of its phases before the run.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/run/run.hpp"
#include "tests/folder.hpp"
#include "tests/program.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

using Json = nlohmann::json;

namespace quiet_share {
namespace {

// A block `height` (m) above a floor, for 1 s. It has the speed (m/s) downwards, and friction if
// asked.
Json falling_block(double height, double speed = 0, bool friction = true) {
  Json block{{"name", "block"},
             {"material", "stone"},
             {"polygon", {{-.5, 0}, {.5, 0}, {.5, 1}, {-.5, 1}}},
             {"position", {0, .5 + height}},
             {"velocity", {0, -speed}}};
  Json floor{{"name", "floor"},
             {"material", "stone"},
             {"motion", "fixed"},
             {"polygon", {{-3, -1}, {3, -1}, {3, 0}, {-3, 0}}}};
  Json scene{
      {"name", "block"},
      {"time", {{"end", 1}}},
      {"gravity", {0, -9.81}},
      {"materials", {{"stone", {{"density", 2000}}}}},
      {"contact", {{"normal_stiffness", 1e9}, {"damping", {{"model", "viscous"}, {"ratio", .3}}}}},
      {"output", {{"frames", 0}}},
      {"bodies", {block, floor}}};
  if (friction) {
    scene["contact"]["friction"] = {{"coefficient", .5}};
  } else {
    scene["contact"].erase("damping");
  }
  return scene;
}

double share_of(const Folder& folder, const Json& json) {
  Run run(scene_of(folder, json.dump()), {});
  REQUIRE(run.run() == Run::Status::done);
  return run.quiet_share().value();
}

TEST_CASE("a run by velocity Verlet counts how long nothing has moved", "[run][implicit]") {
  const Folder folder;
  // A fall of .1 m takes .143 s.
  CHECK(share_of(folder, falling_block(0)) > .98);
  const double fallen = share_of(folder, falling_block(.1));
  CHECK(fallen < 1 - .143);
  CHECK(fallen > .5);
  CHECK(share_of(folder, falling_block(20)) == 0);  // flies all the time
}

TEST_CASE("the share of rest is the same after a run was stopped", "[run][implicit]") {
  const Folder folder;
  const Json json = falling_block(.1);
  const Scene scene = scene_of(folder, json.dump());
  Run whole(scene, {.folder = folder / "whole"});
  whole.run();
  Run first(scene, {.folder = folder / "parts"});
  first.run(.37);
  Run second(scene, {.folder = folder / "parts", .resume = true});
  second.run();
  CHECK(second.quiet_share().value() == whole.quiet_share().value());
  const Json written = Json::parse(content(folder / "parts/run.json"));
  CHECK(written["at_rest"] == whole.quiet_share().value());
}

TEST_CASE("nothing is said of a scheme that the scene does not go with", "[run][implicit]") {
  const Folder folder;
  Json with_step = falling_block(0), automatic = falling_block(0), with_servo = falling_block(0);
  with_step["time"]["step"] = 1e-4;
  automatic["time"]["scheme"] = "auto";
  with_servo["bodies"][1]["motion"] = {
      {"servo", {{"direction", {0, 1}}, {"stress", 1e5}, {"length", 2}, {"speed", 1}}}};
  for (const Json& json : {with_step, automatic, with_servo}) {
    Run run(scene_of(folder, json.dump()), {});
    run.run(.01);
    CHECK_FALSE(run.quiet_share());
  }
}

Result check(const Folder& folder, const Json& json, std::vector<std::string> options = {}) {
  options.insert(options.begin(),
                 {"check", folder.write("scene.json", json.dump()), "--set", "time.scheme=auto"});
  const Result result = apothem::test::run(options, folder);
  REQUIRE(result.code == 0);
  return result;
}

TEST_CASE("check says which phases it expects", "[run][implicit]") {
  const Folder folder;
  const auto phases = [&](const Json& json) {
    const Result result = check(folder, json, {"--json"});
    return Json::parse(result.out)["phases"];
  };
  CHECK(phases(falling_block(0))["implicit_from_start"] == true);
  const Json falls = phases(falling_block(.2, 1));
  CHECK(falls["implicit_from_start"] == false);
  const double v = std::sqrt(1 + 2 * 9.81 * .2);
  CHECK(falls["verlet_until"].get<double>() == Approx((v - 1) / 9.81).epsilon(1e-12));
  CHECK_THAT(check(folder, falling_block(.2)).out,
             Catch::Matchers::Contains("when the last one has fallen; implicit steps"));
  CHECK_THAT(check(folder, falling_block(.2, 0, false)).out,
             Catch::Matchers::Contains("they may never rest"));
}

}  // namespace
}  // namespace quiet_share
