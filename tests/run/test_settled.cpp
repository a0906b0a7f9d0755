// Settled starts: what may be in a scene that begins at rest.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "lib/dynamics/unstable.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace settled {
namespace {

constexpr double kWeight = 2000 * .3 * .2 * 9.81;  // of the block, N

// A block of 0.3 m x 0.2 m on a floor, and perhaps more. A mesh far away does not touch anything.
struct Parts {
  std::string contact = {};
  bool meshed = false;  // the block
  bool far_mesh = false;
  std::string floor = R"("fixed")";  // its motion
  std::string more = {};             // bodies
  double gravity = 0;                // along x
  double depth = 0;                  // of the block at the start
};

std::string text_of(const Parts& p) {
  const std::string block =
      p.meshed
          ? R"("mesh": { "rectangle": { "size": [0.3, 0.2], "cells": [6, 4], "origin": [-0.15, 0] } })"
          : fmt::format(R"("polygon": [[-0.15, {0}], [0.15, {0}], [0.15, {1}], [-0.15, {1}]])",
                        -p.depth, .2 - p.depth);
  const std::string far = R"(, { "name": "far", "material": "m",
      "mesh": { "rectangle": { "size": [0.2, 0.1], "cells": [4, 2], "origin": [-50, 0] } },
      "supports": [{ "where": { "group": "bottom" }, "fix": ["x", "y"] }] })";
  return fmt::format(R"({{ "gravity": [{}, -9.81],
    "materials": {{ "m": {{ "density": 2000, "young": 1e9, "poisson": 0.2 }} }},
    "contact": {{ "normal_stiffness": 1e7, "reference": 0.02, "penetration_warning": 10{} }},
    "bodies": [
      {{ "name": "floor", "material": "m", "motion": {}, "polygon": [[-1, -0.3], [1, -0.3], [1, 0], [-1, 0]] }},
      {{ "name": "block", "material": "m", {} }}{}{} ],
    "time": {{ "end": 0.02, "start": "settled" }}, "output": {{ "frames": 1 }} }})",
                     p.gravity, p.contact, p.floor, block, p.far_mesh ? far : "", p.more);
}

// The largest force on a wall or block, and how far the block moves, m.
struct Course {
  double force, moved;
};
Course course_of(Run& run, RigidIndex body) {
  Course course{0, 0};
  const Vec2 start = run.state().pose(body).head<2>();
  do {
    course.force = std::max(course.force, std::abs(run.state().force(body)[1]));
    course.moved = std::max(course.moved, (Vec2(run.state().pose(body).head<2>()) - start).norm());
  } while (run.step());
  return course;
}

const std::string kRough = R"(, "friction": { "coefficient": 0.5 })";

std::string lid(double force, const std::string& direction = "[0, -1]") {
  return fmt::format(
      R"(, {{ "name": "lid", "material": "m", "polygon": [[-0.2, 0.2], [0.2, 0.2], [0.2, 0.3], [-0.2, 0.3]],
      "motion": {{ "servo": {{ "direction": {}, "force": {}, "speed": 1 }} }} }})",
      direction, force);
}

}  // namespace

TEST_CASE("no dashpot acts while bodies settle, with and without a mesh in the scene",
          "[settled]") {
  const bool far = GENERATE(false, true);
  const std::string damping =
      GENERATE(R"("viscous", "ratio": 0.3)", R"("normal_viscous", "ratio": 0.3)",
               R"("viscous", "ratio": [0, 2])");
  const double depth = GENERATE(0., 1e-6, 1e-3);
  CAPTURE(far, damping, depth);
  const Folder folder;
  Parts parts;
  parts.contact = R"(, "damping": { "model": )" + damping + " }" + kRough;
  parts.far_mesh = far, parts.depth = depth;
  Run run(scene_of(folder, text_of(parts)), {.folder = ""});
  CHECK(run.state().force(1)[1] == Approx(kWeight).epsilon(1e-8));
  const double deep = .1 - run.state().pose(1)[1];
  // Flat: twice k_n d over the reference length, per length.
  const double slopes = 2 / .02;
  CHECK(deep == Approx(kWeight / (1e7 * slopes * .3)).epsilon(1e-3));
  const Course course = course_of(run, 1);
  CHECK(course.force == Approx(kWeight).epsilon(1e-8));
  CHECK(course.moved < 1e-12);
}

TEST_CASE("meshes settle with dashpots in their contacts", "[settled]") {
  const Folder folder;
  Parts parts;
  parts.contact = R"(, "damping": { "model": "viscous", "ratio": 0.3 })" + kRough;
  parts.meshed = true;
  Run run(scene_of(folder, text_of(parts)), {.folder = ""});
  double most = 0, moved = 0;
  const std::vector<double> start = run.state().x;
  do {
    most = std::max(most, std::abs(run.state().force(0)[1] / kWeight + 1));
    for (size_t c = 0; c < start.size(); ++c) {
      moved = std::max(moved, std::abs(run.state().x[c] - start[c]));
    }
  } while (run.step());
  CHECK(most < 1e-8);
  CHECK(moved < 1e-10);
}

TEST_CASE("servo walls press while bodies settle", "[settled]") {
  const bool meshed = GENERATE(false, true);
  const bool damped = GENERATE(false, true);
  CAPTURE(meshed, damped);
  const Folder folder;
  Parts parts;
  parts.contact = kRough;
  if (damped) parts.contact += R"(, "damping": { "model": "viscous", "ratio": 0.2 })";
  parts.meshed = meshed, parts.gravity = 2, parts.more = lid(3000);
  Run run(scene_of(folder, text_of(parts)), {.folder = ""});
  const RigidIndex wall = meshed ? 1 : 2;
  CHECK(run.state().force(wall)[1] == Approx(3000).epsilon(1e-7));
  CHECK(run.state().force(0)[1] == Approx(-3000 - kWeight).epsilon(1e-7));
  const Course course = course_of(run, wall);
  CHECK(course.force == Approx(3000).epsilon(1e-6));
  CHECK(course.moved < 1e-8);
}

TEST_CASE("a servo wall settles along its direction only", "[settled]") {
  const bool meshed = GENERATE(false, true);
  CAPTURE(meshed);
  const Folder folder;
  Parts parts;
  parts.contact = kRough, parts.meshed = meshed, parts.more = lid(2000, "[0.3, -0.7]");
  Run run(scene_of(folder, text_of(parts)), {.folder = ""});
  const RigidIndex wall = meshed ? 1 : 2;
  const Vec2 moved = Vec2(run.state().pose(wall).head<2>()) - Vec2(0, .25);
  CHECK(moved.norm() > 1e-7);
  CHECK(std::abs(moved.x() * .7 + moved.y() * .3) < 1e-9 * moved.norm());
  const Vec2 along = Vec2(.3, -.7).normalized();
  CHECK(Vec2(run.state().force(wall).head<2>()).dot(along) == Approx(-2000).epsilon(1e-7));
}

TEST_CASE("a servo wall that nothing resists does not settle", "[settled][slow]") {
  const Folder folder;
  Parts parts;
  parts.meshed = true, parts.more = lid(3000, "[0, 1]");
  CHECK_THROWS_WITH(Run(scene_of(folder, text_of(parts)), {.folder = ""}),
                    Catch::Contains("/time/start") && Catch::Contains("\"lid\""));
}

TEST_CASE("a floor that moves drags a block along, with a mesh or without", "[settled][slow]") {
  const bool meshed = GENERATE(false, true);
  CAPTURE(meshed);
  const Folder folder;
  Parts parts;
  parts.contact = kRough, parts.meshed = meshed;
  parts.floor = R"({ "velocity": [[0, 0.5, 0]] })";
  if (meshed) {  // the other one takes two million steps
    CHECK_THROWS_WITH(Run(scene_of(folder, text_of(parts)), {.folder = ""}),
                      Catch::Contains("/time/start") && Catch::Contains("\"block\"") &&
                          Catch::Contains("prescribed velocities begin at 0"));
  }
  // Against a stop it stands, with friction at its limit.
  parts.more = R"(, { "name": "stop", "material": "m", "motion": "fixed",
      "polygon": [[0.15, 0.02], [0.35, 0.02], [0.35, 0.3], [0.15, 0.3]] })";
  Run run(scene_of(folder, text_of(parts)), {.folder = ""});
  const RigidIndex stop = meshed ? 1 : 2;
  CHECK(run.state().force(stop)[0] > .4 * kWeight);
  CHECK(std::abs(run.state().force(0)[0]) ==
        Approx(.5 * std::abs(run.state().force(0)[1])).epsilon(meshed ? 1e-4 : 1e-6));
  CHECK(std::abs(run.state().force(0)[0]) == Approx(run.state().force(stop)[0]).epsilon(1e-6));
}

}  // namespace settled
