// What a run says at its end about its own results.
#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "lib/run/hash.hpp"
#include "lib/run/warnings.hpp"
#include "tests/folder.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// A block that slides off a shelf, and falls farther than the scene at its start tells.
std::string sliding_block(const std::string& contact) {
  return R"({ "gravity": [0, -10], "materials": { "rock": { "density": 2000 } },
    "contact": { )" +
         contact + R"( },
    "bodies": [
      { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-2, -1], [9, -1], [9, 0], [-2, 0]] },
      { "name": "shelf", "material": "rock", "motion": "fixed", "polygon": [[-2, 3], [0, 3], [0, 4], [-2, 4]] },
      { "name": "block", "material": "rock", "velocity": [0.7, 0], "polygon": [[-0.6, 4], [0.4, 4], [0.4, 5], [-0.6, 5]] } ],
    "time": { "end": 1.6 }, "output": { "frames": 2 } })";
}

// A block of 1 m x 1 m falls flat on a floor of 4 m x 1 m: both have an inradius of 0.5 m.
std::string falling_block(double stiffness, const std::string& more = "") {
  return R"({ "gravity": [0, -10], "materials": { "rock": { "density": 2000 } },
    "contact": { "normal_stiffness": )" +
         std::to_string(stiffness) + more + R"( },
    "bodies": [
      { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-2, -1], [2, -1], [2, 0], [-2, 0]] },
      { "name": "block", "material": "rock", "velocity": [0, -1], "polygon": [[-0.5, 0.01], [0.5, 0.01], [0.5, 1.01], [-0.5, 1.01]] } ],
    "time": { "end": 0.1 }, "output": { "frames": 2 } })";
}

nlohmann::json summary(const std::string& folder) {
  return nlohmann::json::parse(content(folder + "/run.json"));
}

}  // namespace

TEST_CASE("a run warns of bodies that were deep in each other", "[run][warnings]") {
  const Folder folder;
  Run soft(scene_of(folder, falling_block(1e6)), {.folder = folder / "soft"});
  CHECK(soft.run() == Run::Status::done);
  REQUIRE(soft.warnings().size() == 1);
  const Extremes extremes = soft.simulation().extremes();
  // m (v^2 / 2 + g (h + d)) = k d^2 / 2 (1/r + 1/r), but for the corners of the block.
  const double depth = extremes.penetration.value;
  CHECK(depth == Approx(.0302).epsilon(.01));
  CHECK(extremes.relative_penetration.value == Approx(depth / .5).epsilon(1e-12));
  CHECK(extremes.relative_penetration.time == extremes.penetration.time);
  const std::string& warning = soft.warnings()[0];
  for (const char* part :
       {"\"floor\"", "\"block\"", "0.0302 m", "6.0", "% of the inradius of", "(0.5 m)",
        "at t = 0.0", "contact.penetration_warning (1 %)", "raise contact.normal_stiffness"}) {
    CHECK_THAT(warning, Catch::Contains(part));
  }
  const nlohmann::json json = summary(folder / "soft");
  CHECK(json["warnings"] == nlohmann::json::array({warning}));
  CHECK(json["largest_penetration"] == depth);
  CHECK(json["largest_relative_penetration"] == extremes.relative_penetration.value);
  CHECK(json["largest_relative_penetration_at"]["bodies"] == nlohmann::json({"floor", "block"}));

  Run stiff(scene_of(folder, falling_block(1e8)), {.folder = folder / "stiff"});
  CHECK(stiff.run() == Run::Status::done);
  CHECK(stiff.warnings().empty());
  CHECK(summary(folder / "stiff")["warnings"] == nlohmann::json::array());
}

TEST_CASE("contact.penetration_warning sets how deep is too deep", "[run][warnings]") {
  const Folder folder;
  const auto warnings = [&](double stiffness, const char* limit) {
    const Scene scene = scene_of(
        folder, falling_block(stiffness, std::string(R"(, "penetration_warning": )") + limit));
    Run run(scene, {.folder = ""});
    run.run();
    return run.warnings();
  };
  CHECK(warnings(1e6, "0.1").empty());
  CHECK(warnings(1e8, "0.001").size() == 1);
  CHECK_THAT(warnings(1e8, "0.001").at(0), Catch::Contains("(0.1 %)"));
  CHECK_THROWS_WITH(warnings(1e8, "0"), Catch::Contains("/contact/penetration_warning"));
}

TEST_CASE("a run warns of energy that a coarse contact has made and taken back",
          "[run][warnings]") {
  Extremes extremes;
  extremes.energy_error = 1.5, extremes.energy_in_play = 10, extremes.energy_allowed = 1;
  const std::vector<std::string> warnings = warnings_of(Model(), extremes);
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Catch::Contains("1.5 J") && Catch::Contains("the 10 J in play") &&
                              Catch::Contains("reduce the time step"));
  extremes.energy_error = .9;
  CHECK(warnings_of(Model(), extremes).empty());
}

TEST_CASE("others add warnings of their own to a run", "[run][warnings]") {
  const Folder folder;
  Run run(scene_of(folder, flying_block()), {.folder = folder / "out"});
  run.warn("the moon is full: wait for a day");
  CHECK(run.run() == Run::Status::done);
  CHECK(summary(folder / "out")["warnings"] ==
        nlohmann::json::array({"the moon is full: wait for a day"}));
}

TEST_CASE("the stiffness may follow from a penetration, and a deeper one is said",
          "[run][warnings]") {
  const Folder folder;
  Run run(scene_of(folder, sliding_block(R"("penetration": 0.02)")), {.folder = folder / "out"});
  CHECK(run.run() == Run::Status::done);
  const double stiffness = run.scene().model.contact.normal_stiffness;
  CHECK(stiffness > 0);
  CHECK(summary(folder / "out")["normal_stiffness"] == stiffness);
  CHECK(run.simulation().extremes().relative_penetration.value > .02);
  REQUIRE(run.warnings().size() == 1);
  CHECK_THAT(run.warnings()[0], Catch::Contains("more than contact.penetration (2 %)"));
  CHECK_THAT(run.warnings()[0], Catch::Contains("lower contact.penetration"));

  // The same scene with the stiffness itself has the same bits.
  Run same(scene_of(folder, sliding_block(fmt::format("\"normal_stiffness\": {}", stiffness))),
           {.folder = folder / "same"});
  CHECK(same.run() == Run::Status::done);
  CHECK(state_hash(same.state()) == state_hash(run.state()));
}

TEST_CASE("a penetration that gives no stiffness is an error", "[run][warnings]") {
  const Folder folder;
  const auto message = [&](const std::string& contact, bool still = false) {
    std::string text = sliding_block(contact);
    if (still) text.replace(text.find("-10"), 3, "0"), text.replace(text.find("0.7"), 3, "0");
    try {
      scene_of(folder, text);
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK_THAT(message(R"("penetration": 0.01, "normal_stiffness": 1e9)"),
             Catch::Contains("/contact/penetration: cannot stand beside \"normal_stiffness\""));
  CHECK_THAT(message(R"("penetration": 1)"),
             Catch::Contains("/contact/penetration: must be below 1"));
  CHECK_THAT(message(R"("penetration": 0)"), Catch::Contains("/contact/penetration"));
  CHECK_THAT(message(R"("penetration": 0.01)", true),
             Catch::Contains("/contact/penetration: gives no stiffness"));
  CHECK_THAT(message(""), Catch::Contains("normal_stiffness"));
}

TEST_CASE("a static run says which body has gone to another place", "[run][warnings]") {
  const Folder folder;
  const std::string body = GENERATE(
      R"("polygon": [[0, 0], [0.4, 0], [0.4, 1], [0, 1]])",
      R"("mesh": { "rectangle": { "size": [0.4, 1], "cells": [4, 6] }, "element": "Q4" })");
  CAPTURE(body);
  // It stands up to a tilt of atan(.4). Beyond, it finds no equilibrium, or one on its side.
  const auto run_to = [&](double tilt) {
    auto run = std::make_unique<Run>(scene_of(folder, fmt::format(R"({{
      "gravity": {{ "value": [0, -9.81], "direction_history": [[0, 0], [1, {}]] }},
      "materials": {{ "rock": {{ "density": 2000, "young": 1e9, "poisson": 0.2 }} }},
      "contact": {{ "normal_stiffness": 1e9, "friction": {{ "coefficient": 0.8 }} }},
      "bodies": [
        {{ "name": "table", "material": "rock", "motion": "fixed", "polygon": [[-5, -1], [5, -1], [5, 0], [-5, 0]] }},
        {{ "name": "block", "material": "rock", {} }} ],
      "time": {{ "mode": "static", "end": 1, "load_steps": {} }} }})",
                                                                  tilt, body, tilt > .5 ? 6 : 3)),
                                     RunSettings{});
    run->run();
    return run;
  };
  const auto stands = run_to(.33);
  CHECK(stands->status() == Run::Status::done);
  CHECK(stands->warnings().empty());
  int lying = 0;
  for (const double tilt : {.45, .6}) {
    const auto tips = run_to(tilt);
    CAPTURE(tilt, tips->message());
    if (tips->status() == Run::Status::done) {
      ++lying;
      REQUIRE(tips->warnings().size() == 1);
      CHECK_THAT(tips->warnings()[0], Catch::Contains("\"block\" has moved by") &&
                                          Catch::Contains("in the load step to t = "));
    } else {
      CHECK_THAT(tips->message(), Catch::Contains("\"block\""));
    }
  }
  CHECK(lying > 0);
}
