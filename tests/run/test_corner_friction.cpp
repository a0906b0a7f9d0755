// Friction of meshes at corners: the force is mu times the normal force whatever the angles, the
// reference lengths and the number of edges, in statics and in motion. The laws are those of a
// point on a plane.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967296.;
  }
  int below(int count) { return static_cast<int>(between(0, count)); }

 private:
  std::mt19937 engine_;
};

std::string text_of(const std::vector<Vec2>& polygon) {
  std::string text = "[";
  for (const Vec2& v : polygon)
    text += fmt::format("{}[{}, {}]", &v == polygon.data() ? "" : ", ", v.x(), v.y());
  return text + "]";
}

// A tip with straight flanks of these angles from the vertical, with a flat or a round end of a
// breadth or a radius, `depth` below y = 0.
std::vector<Vec2> tip(double left, double right, double end, bool round, double depth) {
  constexpr double kHeight = .3;
  std::vector<Vec2> low{{0, 0}};
  if (end > 0 && !round) low = {{-end / 2, 0}, {end / 2, 0}};
  if (end > 0 && round) {
    low.clear();
    const double from = -(std::numbers::pi / 2 - left), to = std::numbers::pi / 2 - right;
    for (int i = 0; i <= 16; ++i) {
      const double t = from + (to - from) * i / 16;
      low.emplace_back(end * std::sin(t), end * (1 - std::cos(t)));
    }
  }
  std::vector<Vec2> polygon = low;
  polygon.push_back(low.back() + (kHeight - low.back().y()) * Vec2(std::tan(right), 1));
  polygon.push_back(low.front() + (kHeight - low.front().y()) * Vec2(-std::tan(left), 1));
  for (Vec2& v : polygon) v.y() -= depth;
  return polygon;
}

enum class Kind { rigid_on_mesh, mesh_on_rigid, mesh_on_mesh };

std::string held(const std::string& motion) {
  return R"("supports": [ { "where": { "box": [[-9, -9], [9, 9]] }, "fix": ["x", "y"])" + motion +
         " } ]";
}

// A tip that is dragged over a floor; all nodes of meshes are held.
std::string dragged(Kind kind, const std::vector<Vec2>& polygon, int cells, double size) {
  const bool meshed_tip = kind != Kind::rigid_on_mesh, meshed_floor = kind != Kind::mesh_on_rigid;
  const std::string body =
      meshed_tip
          ? fmt::format(
                R"("material": "m", "mesh": {{ "fill": {{ "polygon": {}, "size": {} }} }}, )",
                text_of(polygon), size) +
                held(R"(, "velocity": [[0, 0.31, 0]])")
          : fmt::format(
                R"("material": "r", "polygon": {}, "motion": {{ "velocity": [[0, 0.31, 0]] }})",
                text_of(polygon));
  const std::string floor =
      meshed_floor
          ? fmt::format(
                R"("material": "m", "mesh": {{ "rectangle": {{ "size": [2.5, 0.4], "cells": [{}, {}], "origin": [-1.2, -0.4] }} }}, )",
                cells, std::max(1, cells / 6)) +
                held("")
          : std::string(
                R"("material": "r", "motion": "fixed", "polygon": [[-1.2, -0.4], [1.3, -0.4], [1.3, 0], [-1.2, 0]])");
  return fmt::format(R"({{
    "materials": {{ "m": {{ "density": 2000, "young": 1e8, "poisson": 0.3 }}, "r": {{ "density": 2000 }} }},
    "contact": {{ "normal_stiffness": 1e8, "friction": {{ "coefficient": 0.3 }}, "overlaps": "accept" }},
    "bodies": [ {{ "name": "tip", {} }}, {{ "name": "floor", {} }} ],
    "time": {{ "mode": "static", "end": 1, "load_steps": 24 }} }})",
                     body, floor);
}

// The sizes of friction and normal force on the tip, of each load step.
std::vector<std::pair<double, double>> forces(const Scene& scene) {
  Run run(scene, {});
  std::vector<std::pair<double, double>> found;
  while (run.step()) {
    Vec2 sum = Vec2::Zero();
    for (const ContactRecord& r : run.simulation().contacts()) sum += r.normal + r.tangential;
    found.emplace_back(std::abs(sum.x()), std::abs(sum.y()));
  }
  return found;
}

}  // namespace

TEST_CASE("a tip that is dragged over a floor has mu times the normal force", "[friction][mesh]") {
  Dice dice(42);
  const int cases = long_run() ? 200 : kSanitized ? 2 : 12;
  for (int i = 0; i < cases; ++i) {
    const Kind kind = static_cast<Kind>(i % 3);
    const double degree = std::numbers::pi / 180;
    const double left = dice.between(10, 80) * degree;
    const double right = dice.below(2) == 0 ? left : dice.between(10, 80) * degree;
    // What is deeper than the collar of a mesh slides freely (docs/theory.md, Friction).
    const double depth =
        kind == Kind::rigid_on_mesh ? dice.between(.001, .004) : dice.between(.0002, .0008);
    const int shape = dice.below(kind == Kind::rigid_on_mesh ? 3 : 2);
    const double end =
        shape == 0 ? 0 : depth * dice.between(kind == Kind::rigid_on_mesh ? .3 : 8, 12);
    const int cells = 20 + dice.below(160);
    const double size = dice.between(.03, .15);
    CAPTURE(i, static_cast<int>(kind), left / degree, right / degree, depth, shape, end, cells,
            size);
    const Folder folder;
    const auto found = forces(
        scene_of(folder, dragged(kind, tip(left, right, end, shape == 2, depth), cells, size)));
    REQUIRE(found.size() == 24);
    for (const auto& [friction, normal] : found) {
      REQUIRE(normal > 0);
      CHECK(friction / (.3 * normal) == Approx(1).epsilon(.01));
    }
  }
}

namespace {

// A body with feet on a slope whose tangent is `steep` times mu, in coordinates along it.
std::string on_slope(bool meshed_body, bool meshed_slope, double steep, double foot) {
  constexpr double kMu = .4;
  const double angle = std::atan(steep * kMu), gravity = 9.81;
  const std::string polygon = fmt::format(
      "[[-0.3, 0.3], [-0.3, 0.15], [{}, 0], [{}, 0.15], [{}, 0.15], [{}, 0], [0.3, 0.15], [0.3, "
      "0.3]]",
      -.3 + foot, -.3 + 2 * foot, .3 - 2 * foot, .3 - foot);
  const std::string body =
      meshed_body
          ? fmt::format(
                R"("material": "m", "mesh": {{ "fill": {{ "polygon": {}, "size": 0.1 }} }})",
                polygon)
          : fmt::format(R"("material": "m", "polygon": {})", polygon);
  const std::string slope =
      meshed_slope
          ? R"("material": "m", "mesh": { "rectangle": { "size": [4, 0.2], "cells": [80, 4], "origin": [-3, -0.2] } },
               "supports": [ { "where": { "group": "bottom" }, "fix": ["x", "y"] } ])"
          : R"("material": "m", "motion": "fixed", "polygon": [[-3, -0.2], [1, -0.2], [1, 0], [-3, 0]])";
  return fmt::format(R"({{ "gravity": [{}, {}],
    "materials": {{ "m": {{ "density": 2000, "young": 2e9, "poisson": 0.2 }} }},
    "contact": {{ "normal_stiffness": 2e8, "friction": {{ "coefficient": 0.4 }},
                  "damping": {{ "model": "viscous", "ratio": 0.2 }} }},
    "bodies": [ {{ "name": "slope", {} }}, {{ "name": "stool", {} }} ],
    "time": {{ "end": 0.3 }} }})",
                     -gravity * std::sin(angle), -gravity * std::cos(angle), slope, body);
}

// Down the slope, m.
double moved_by(const Run& run) {
  const Model& model = run.scene().model;
  if (!model.bodies.empty()) return model.bodies[0].position.x() - run.state().pose(0).x();
  const DeformableBody& body = model.deformables.back();
  double moved = 0;
  for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
    moved -= run.state().node(body.first_node + static_cast<NodeIndex>(i)).x();
  }
  return moved / static_cast<double>(body.mesh.nodes.size());
}

}  // namespace

TEST_CASE("a stool slides down a slope as a point does, and stands below the friction angle",
          "[friction][mesh][slow]") {
  Dice dice(7);
  for (const bool meshed_body : {false, true}) {
    for (const double steep : {.9, 1.7}) {
      const double foot = dice.between(.02, .14);
      if (!is_taken(meshed_body != (steep > 1) ? 1 : 0)) continue;
      CAPTURE(meshed_body, steep, foot);
      const Folder folder;
      Run run(scene_of(folder, on_slope(meshed_body, true, steep, foot)), {});
      REQUIRE(run.run() == Run::Status::done);
      const double angle = std::atan(steep * .4);
      const double acceleration = steep > 1 ? 9.81 * (std::sin(angle) - .4 * std::cos(angle)) : 0;
      const double right = acceleration * .3 * .3 / 2;
      const double moved = moved_by(run);
      if (steep > 1) CHECK(moved == Approx(right).epsilon(.01));
      // It slips while it lands, and stands then.
      if (steep < 1) CHECK(std::abs(moved) < 1e-2);
    }
  }
}
