// Walls that hold a force.
#include <catch2/catch.hpp>
#include <cmath>

#include "lib/run/run.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace servo {
namespace {

// Blocks in a box under a lid that presses on them.
std::string box(const std::string& mesh, const std::string& press, double end) {
  return R"({ "materials": { "rock": { "density": 2000, "young": 1e7, "poisson": 0.2 } }, "thickness": 0.5,
    "contact": { "normal_stiffness": 1e7, "damping": { "model": "viscous", "ratio": 0.5 } },
    "bodies": [
      { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-1, -1], [2, -1], [2, 0], [-1, 0]] },
      { "name": "lid", "material": "rock", "polygon": [[-1, 2], [2, 2], [2, 2.5], [-1, 2.5]],
        "motion": { "servo": { "direction": [0, -2], )" +
         press + R"(, "speed": 0.2 } } },
      { "name": "lower", "material": "rock", )" +
         (mesh.empty() ? R"("polygon": [[0, 0], [1, 0], [1, 1], [0, 1]])"
                       : R"("mesh": { "rectangle": { "size": [1, 1], "cells": [4, 4] } })") +
         R"( },
      { "name": "upper", "material": "rock", "polygon": [[0, 1], [1, 1], [1, 2], [0, 2]] } ],
    "time": { "end": )" +
         std::to_string(end) + R"( }, "output": { "frames": 1 } })";
}

}  // namespace

TEST_CASE("a servo wall holds its force, and its work is on the ledger", "[servo]") {
  const bool meshed = GENERATE(false, true);
  const Folder folder;
  const double end = meshed && kSanitized ? .02 : 3;
  const Scene scene = read_scene(folder.write(
      "scene.json", box(meshed ? "mesh" : "",
                        R"("stress": 4e4, "length": 1, "history": [[0, 0], [0.5, 1]])", end)));
  Run run(scene, {.folder = ""});
  double most = 0;
  while (run.state().time < end - 1e-9) {
    run.step();
    const Energies e = run.simulation().energies();
    most = std::max(most, std::abs(e.external_work));
    REQUIRE(std::abs(e.total_error) < 5e-3 * std::max(most, 1e-3));
    REQUIRE(std::abs(run.state().pose_rate(1)[1]) <= .2 * (1 + 1e-12));
    REQUIRE(run.state().pose_rate(1)[0] == 0);
  }
  if (end < 1) return;
  // 4e4 Pa on 1 m x 0.5 m.
  CHECK(run.state().force(1)[1] == Approx(2e4).epsilon(2e-4));
  CHECK(std::abs(run.state().pose_rate(1)[1]) < 1e-4);
}

TEST_CASE("the force of a servo wall follows its history", "[servo]") {
  const Folder folder;
  const Scene scene = read_scene(folder.write(
      "scene.json", box("", R"("force": 1000, "history": [[0, 0], [0.5, 1], [2, 1], [3, 3]])", 4)));
  Run run(scene, {.folder = ""});
  while (run.state().time < 2) run.step();
  CHECK(run.state().force(1)[1] == Approx(1000).epsilon(1e-5));
  while (run.state().time < 4 - 1e-9) run.step();
  CHECK(run.state().force(1)[1] == Approx(3000).epsilon(1e-5));
}

TEST_CASE("a servo wall meets bodies that no force moves", "[servo]") {
  // A mesh that does not touch anything makes outlines of all polygons.
  const std::string other =
      GENERATE(R"("motion": "fixed")", R"("motion": { "velocity": [[0, 0, 0.01]] })",
               R"("fix": ["x", "y", "angle"])",
               R"("motion": { "servo": { "direction": [0, 1], "force": 2000, "speed": 0.5 } })");
  const bool mesh = GENERATE(false, true);
  const double slope = GENERATE(0., .3);
  if (kSanitized && (mesh || slope > 0)) return;
  CAPTURE(other, mesh, slope);
  const Folder folder;
  const std::string far = R"(, { "name": "far", "material": "m",
      "mesh": { "rectangle": { "size": [0.2, 0.1], "cells": [4, 2], "origin": [-50, 0] } },
      "supports": [{ "where": { "group": "bottom" }, "fix": ["x", "y"] }] })";
  const Scene scene = read_scene(folder.write(
      "scene.json",
      R"({ "materials": { "m": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e7, "penetration_warning": 10, "damping": { "model": "viscous", "ratio": 0.5 } },
    "bodies": [
      { "name": "floor", "material": "m", "polygon": [[-1, -0.5], [1, -0.5], [1, 0], [-1, 0]], )" +
          other + R"( },
      { "name": "wall", "material": "m", "polygon": [[-0.2, 0.001], [0.2, 0.001], [0.2, 0.3], [-0.2, 0.3]],
        "motion": { "servo": { "direction": [)" +
          std::to_string(slope) + R"(, -1], "force": 2000, "speed": 0.5 } } })" +
          (mesh ? far : "") + R"( ],
    "time": { "end": )" +
          (mesh || kSanitized ? "0.15" : "0.6") + R"( }, "output": { "frames": 1 } })"));
  Run run(scene, {.folder = ""});
  double most = 0;
  while (run.state().time < scene.time.end - 1e-9) {
    run.step();
    const Energies e = run.simulation().energies();
    most = std::max(most, std::abs(e.external_work));
    REQUIRE(std::abs(e.total_error) < 5e-3 * std::max(most, 2.));  // 2 J: of 2000 N over the gap
    // It never sinks in deeper than a falling wall would press.
    REQUIRE(run.state().pose(1)[1] - .1495 - run.state().pose(0)[1] - .25 > -.005);
  }
  if (mesh || kSanitized) return;
  const Vec2 along = Vec2(slope, -1).normalized();
  if (slope > 0 && other.find("servo") != std::string::npos) return;  // they slide along each other
  CHECK(-Vec2(run.state().force(1).head<2>()).dot(along) == Approx(2000).epsilon(.02));
}

TEST_CASE("servo walls land on dashpots of any strength and come to rest", "[servo][damping]") {
  const auto [model, ratio] = GENERATE(table<std::string, double>(
      {{"viscous", .3}, {"viscous", 20}, {"normal_viscous", 20}, {"viscous", 1000}}));
  const bool meshed = GENERATE(false, true);
  const std::string direction = GENERATE("[0, -1]", "[0.3, -0.7]");
  if (kSanitized && meshed) return;
  CAPTURE(model, ratio, meshed, direction);
  const Folder folder;
  const Scene scene = read_scene(folder.write(
      "scene.json",
      R"({ "gravity": [0, -9.81], "materials": { "m": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e7, "reference": 0.02, "penetration_warning": 10,
      "friction": { "coefficient": 0.5 }, "damping": { "model": ")" +
          model + R"(", "ratio": )" + std::to_string(ratio) + R"( } },
    "bodies": [
      { "name": "floor", "material": "m", "motion": "fixed", "polygon": [[-1, -0.3], [1, -0.3], [1, 0], [-1, 0]] },
      { "name": "block", "material": "m", )" +
          (meshed
               ? R"("mesh": { "rectangle": { "size": [0.3, 0.2], "cells": [6, 4], "origin": [-0.15, 0] } })"
               : R"("polygon": [[-0.15, 0], [0.15, 0], [0.15, 0.2], [-0.15, 0.2]])") +
          R"( },
      { "name": "lid", "material": "m", "polygon": [[-0.2, 0.201], [0.2, 0.201], [0.2, 0.3], [-0.2, 0.3]],
        "motion": { "servo": { "direction": )" +
          direction + R"(, "force": 3000, "speed": 0.3 } } } ],
    "time": { "end": 0.3, "accuracy": 0.0005 }, "output": { "frames": 1 } })"));
  Run run(scene, {.folder = ""});
  const RigidIndex lid = meshed ? 1 : 2;
  const Vec2 start = run.state().pose(lid).head<2>();
  double lost = 0, thrown = 0;
  while (run.step()) {
    const Energies e = run.simulation().energies();
    // The wall has no kinetic energy on the ledger; at 0.3 m/s it would be 3.6 J.
    REQUIRE(std::abs(e.total_error) < (meshed ? .06 : .02));
    lost = std::max(lost, e.damping_loss);
    REQUIRE(e.damping_loss > lost - .02);
    thrown = std::min(thrown, Vec2(run.state().pose_rate(lid).head<2>())
                                  .dot(Vec2(run.state().pose(lid).head<2>()) - start));
  }
  // At the ratio 0.3 it may rebound, and so it may on an elastic body; strong dashpots stop it.
  if (ratio > 1 && !meshed) CHECK(thrown > -1e-6);
  const double speed = Vec2(run.state().pose_rate(lid).head<2>()).norm();
  CHECK(speed < (ratio < 100 ? 1e-3 : 2e-2));
  const Vec2 along = direction == "[0, -1]" ? Vec2(0, -1) : Vec2(.3, -.7).normalized();
  CHECK(-Vec2(run.state().force(lid).head<2>()).dot(along) == Approx(3000).epsilon(.01));
}

TEST_CASE("a servo wall goes on bit for bit", "[servo]") {
  const Folder folder;
  const Scene scene = read_scene(folder.write("scene.json", box("", R"("force": 1000)", .4)));
  Run whole(scene, {.folder = folder / "whole"});
  whole.run();
  Run part(scene, {.folder = folder / "part"});
  part.run(.17);
  Run rest(scene, {.folder = folder / "part", .resume = true});
  rest.run();
  CHECK(rest.state().x == whole.state().x);
  CHECK(rest.state().v == whole.state().v);
}

}  // namespace servo
