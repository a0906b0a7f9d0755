// One situation, said in several ways: a rigid body on a rigid floor and on one of stiff elements
// leaves with the same velocity after an impact, and with that of an integration by hand; a block
// that is pressed and dragged feels the same, rigid or of elements.
#include <fmt/format.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "geometry/polygon/polygon.hpp"
#include "tests/run/impact_by_hand.hpp"
#include "tests/run/scenes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

constexpr double kStiffness = 1e8, kReference = .02, kDensity = 2000, kEnd = .012;  // SI units

struct Impact {
  std::vector<Vec2> polygon;
  Vec2 velocity;  // m/s
  double spin;    // rad/s
  double friction, damping_ratio;
};

std::string vertices_text(const std::vector<Vec2>& polygon) {
  std::string text;
  for (const Vec2& v : polygon)
    text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", v.x(), v.y());
  return "[" + text + "]";
}

// Velocity and spin with which the body leaves. `cell` of the floor's mesh, m; 0: a rigid floor.
Eigen::Vector3d left_with(const Impact& impact, double cell, const std::string& friction = "") {
  const double stiff = 3000 * kStiffness;
  const int cells = cell > 0 ? static_cast<int>(1.2 / cell) : 0;
  const std::string floor =
      cell > 0
          ? fmt::format(
                R"("mesh": {{ "rectangle": {{ "size": [1.2, 0.2], "cells": [{}, 2], "origin": [-0.6, -0.2] }} }},
                   "supports": [ {{ "where": {{ "group": "bottom" }}, "fix": ["x", "y"] }} ])",
                cells)
          : std::string(
                R"("motion": "fixed", "polygon": [[-1, -0.2], [1, -0.2], [1, 0], [-1, 0]])");
  const Folder folder;
  const Scene scene = scene_of(
      folder,
      fmt::format(
          R"({{ "materials": {{ "m": {{ "density": {}, "young": {}, "poisson": 0.3 }} }},
      "contact": {{ "normal_stiffness": {}, "reference": {}, "penetration_warning": 10,
                    "friction": {{ "coefficient": {}{} }}{} }},
      "bodies": [ {{ "name": "floor", "material": "m", {} }},
                  {{ "name": "body", "material": "m", "polygon": {}, "velocity": [{}, {}], "spin": {} }} ],
      "time": {{ "end": {} }} }})",
          kDensity, stiff, kStiffness, kReference, impact.friction, friction,
          impact.damping_ratio > 0
              ? fmt::format(R"(, "damping": {{ "model": "viscous", "ratio": {}, "bulk": 0 }})",
                            impact.damping_ratio)
              : "",
          floor, vertices_text(impact.polygon), impact.velocity.x(), impact.velocity.y(),
          impact.spin, kEnd));
  Run run(scene, {});
  while (run.step()) {
  }
  const State& state = run.simulation().state();
  const RigidIndex body = cell > 0 ? 0 : 1;
  return state.pose_rate(body);
}

std::vector<Vec2> box(double width, double height) {
  constexpr double kGap = 1e-4;
  return {{-width / 2, kGap},
          {width / 2, kGap},
          {width / 2, height + kGap},
          {-width / 2, height + kGap}};
}

// A convex polygon above the floor, on a corner or with an edge along it.
std::vector<Vec2> random_polygon(samples::Random& random, int corners) {
  std::vector<Vec2> ring;
  const double squeeze = random.uniform(.5, 1);
  const bool flat = random.uniform(0, 1) < .3;
  for (int i = 0; i < corners; ++i) {
    const double at = 2 * std::numbers::pi * (i + random.uniform(0, .6)) / corners;
    ring.emplace_back(.1 * std::cos(at), .1 * squeeze * std::sin(at));
  }
  double turn = random.uniform(0, 2 * std::numbers::pi);
  if (flat) {
    const Vec2 edge = ring[1] - ring[0];
    turn = -std::atan2(edge.y(), edge.x());
  }
  double lowest = 1;
  for (Vec2& v : ring) {
    v = Vec2(std::cos(turn) * v.x() - std::sin(turn) * v.y(),
             std::sin(turn) * v.x() + std::cos(turn) * v.y());
    lowest = std::min(lowest, v.y());
  }
  for (Vec2& v : ring) v.y() += 1e-4 - lowest;
  return ring;
}

Impact random_impact(samples::Random& random) {
  const int corners = random.integer(3, random.integer(0, 1) == 0 ? 8 : 64);
  Impact impact{random_polygon(random, corners),
                {random.uniform(-1.5, 1.5), -random.uniform(.5, 2)},
                random.uniform(-3, 3),
                random.integer(0, 1) == 0 ? 0 : .3,
                0};
  impact.damping_ratio = std::array{0., .1, .5}[static_cast<size_t>(random.integer(0, 2))];
  return impact;
}

// The same impact without the kernels.
Eigen::Vector3d left_by_hand(const Impact& impact, ImpactByHand::Springs springs) {
  const Polygon polygon(impact.polygon);
  const AreaMoments moments = area_moments(polygon);
  ImpactByHand hand;
  hand.stiffness = kStiffness / kReference;
  hand.friction = impact.friction, hand.damping_ratio = impact.damping_ratio;
  hand.mass = kDensity * moments.area, hand.inertia = kDensity * moments.polar;
  hand.place = polygon.origin() + moments.centroid;
  for (const Vec2& v : impact.polygon) hand.polygon.emplace_back(v - hand.place);
  hand.rate = {impact.velocity.x(), impact.velocity.y(), impact.spin};
  hand.springs = springs;
  return hand.after(kEnd, 4e-6);
}

// The largest difference of two velocities over the speed of the impact.
double apart(const Impact& impact, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).head<2>().cwiseAbs().maxCoeff() / impact.velocity.norm();
}

}  // namespace

TEST_CASE("a box that lands flat leaves floors of both kinds alike, with friction and damping",
          "[friction][damping][slow]") {
  // By integrations with springs and dashpots spread over the length in contact.
  struct Row {
    double friction, ratio;
    Vec2 right;
  };
  for (const auto& [friction, value, right] :
       {Row{0, 0, {1.2, 2}}, Row{.3, 0, {.2406, 2.2561}}, Row{.3, .1, {.2312, 1.7445}},
        Row{.3, .5, {.3553, .8524}}}) {
    const Impact impact{box(.2, .2), {1.2, -2}, 0, friction, value};
    CAPTURE(friction, value);
    const double one_percent = .01 * impact.velocity.norm();
    for (const double cell : {0., .02}) {
      CAPTURE(cell);
      const Eigen::Vector3d left = left_with(impact, cell);
      CHECK(std::abs(left.x() - right.x()) < one_percent);
      CHECK(std::abs(left.y() - right.y()) < one_percent);
    }
  }
}

TEST_CASE("a constant tangential stiffness is softer the longer the contact", "[friction]") {
  const Impact impact{box(.2, .2), {1.2, -2}, 0, .3, 0};
  const Eigen::Vector3d left = left_with(impact, 0, ", \"tangential_stiffness\": 8e7");
  CHECK(left.x() == Approx(.992).epsilon(.01));
  CHECK(left.y() == Approx(2.006).epsilon(.005));
}

TEST_CASE("a flat landing has the restitution of a spring and a dashpot that cannot pull",
          "[damping]") {
  // T. Schwager and T. Poeschel, Granular Matter 9 (2007) 465, below critical damping.
  for (const double z : {.05, .2, .5}) {
    const double w = std::sqrt(1 - z * z);
    double angle = std::atan2(2 * z * w, 2 * z * z - 1);
    const double right = std::exp(-z / w * angle);
    for (const double cell : {0., .05}) {
      CAPTURE(z, cell);
      const Eigen::Vector3d left = left_with({box(.2, .2), {0, -2}, 0, 0, z}, cell);
      CHECK(left.y() / 2 == Approx(right).epsilon(.01));
    }
  }
}

TEST_CASE("impacts of random polygons leave floors of both kinds alike, and as they do by hand",
          "[friction][damping][slow]") {
  SeededRandom random(41);
  const int cases = long_run() ? 200 : kSanitized ? 1 : 6;
  int compared = 0, alike = 0;
  // A body that lands again in the meantime magnifies what was different before.
  const auto compare = [&](double difference) {
    CHECK(difference < .025);
    ++compared, alike += difference < .01;
  };
  for (int i = 0; i < cases; ++i) {
    const Impact impact = random_impact(random);
    const Eigen::Vector3d rigid = left_with(impact, 0), meshed = left_with(impact, .01);
    const Eigen::Vector3d hand = left_by_hand(impact, ImpactByHand::Springs::one);
    CAPTURE(i, impact.polygon.size(), impact.friction, impact.damping_ratio);
    CAPTURE(rigid.transpose(), meshed.transpose(), hand.transpose());
    compare(apart(impact, rigid, hand));
    if (impact.friction == 0) {
      compare(apart(impact, rigid, meshed));
      compare(apart(impact, meshed, hand));
      continue;
    }
    // The patch of a rigid body slides as a whole, and the edges of a mesh one by one: the latter
    // lies between one spring and springs in columns, which differ by up to 6 %.
    const Eigen::Vector3d spread = left_by_hand(impact, ImpactByHand::Springs::in_columns);
    CAPTURE(spread.transpose());
    CHECK(apart(impact, rigid, meshed) < .05);
    CHECK(apart(impact, meshed, hand) + apart(impact, meshed, spread) <
          apart(impact, hand, spread) + .03);
  }
  CAPTURE(alike, compared);
  CHECK(compared - alike <= 2 + compared / 50);
}

namespace {

// A block on a rigid floor, pressed and then dragged by a rigid plate in so many load steps.
struct Dragged {
  double across = 0, along = 0;  // force on the plate, N
  double sunk = 0;               // of the block's middle, m
  bool relaxed = false;          // whether a load step was found by relaxation
};
Dragged dragged(const std::string& block, double friction, double way, int load_steps) {
  const Folder folder;
  const Scene scene = scene_of(
      folder,
      fmt::format(
          R"({{ "gravity": [0, -9.81], "materials": {{ "m": {{ "density": 2000, "young": 1e13, "poisson": 0.2 }} }},
      "contact": {{ "normal_stiffness": 1e9, "reference": 0.25, "penetration_warning": 10, "friction": {{ "coefficient": {} }} }},
      "bodies": [ {{ "name": "floor", "material": "m", "motion": "fixed", "polygon": [[-2, -0.5], [2, -0.5], [2, 0], [-2, 0]] }},
                  {{ "name": "plate", "material": "m", "polygon": [[-1, 0.5], [1, 0.5], [1, 0.8], [-1, 0.8]],
                     "motion": {{ "velocity": [[0, 0, -2e-4], [1, 0, -2e-4], [1.0001, {}, 0]] }} }},
                  {{ "name": "block", "material": "m", {} }} ],
      "time": {{ "mode": "static", "end": 2, "load_steps": {}, "tolerance": 1e-9 }} }})",
          friction, way, block, load_steps));
  Run run(scene, {});
  while (run.step()) {
  }
  Dragged result;
  const RigidIndex plate = 1;
  result.along = run.state().force(plate)[0], result.across = run.state().force(plate)[1];
  for (const LoadStep& step : run.load_steps()) result.relaxed = result.relaxed || step.relaxed;
  if (scene.model.deformables.empty()) {
    result.sunk = run.state().pose(2)[1] - .25;
    return result;
  }
  // The block tilts; its grid is regular, so that the mean of its nodes is its middle.
  const auto nodes = static_cast<NodeIndex>(scene.model.deformables[0].mesh.nodes.size());
  for (NodeIndex n = 0; n < nodes; ++n) result.sunk += run.state().node(n).y() / nodes;
  return result;
}

}  // namespace

TEST_CASE(
    "a block that is pressed and dragged feels the same, rigid or of stiff elements, in few "
    "load steps or many",
    "[friction][static]") {
  const std::string rigid = R"("polygon": [[-0.5, 0], [0.5, 0], [0.5, 0.5], [-0.5, 0.5]])";
  const std::string meshed =
      R"("mesh": { "rectangle": { "size": [1, 0.5], "cells": [8, 4], "origin": [-0.5, 0] } })";
  for (const double friction : {.3, .6}) {
    for (const double way : {2e-5, 2e-3}) {  // m: it sticks; it slides
      CAPTURE(friction, way);
      const Dragged reference = dragged(rigid, friction, way, 2);
      CHECK(reference.across > 7e5);
      CHECK(reference.along < 0);
      if (way > 1e-3) {
        CHECK(reference.along == Approx(-friction * reference.across).epsilon(1e-4));
      } else {
        CHECK(-reference.along < .9 * friction * reference.across);
      }
      for (const std::string& block : {rigid, meshed}) {
        for (const int steps : {2, 8}) {
          const Dragged found = dragged(block, friction, way, steps);
          CAPTURE(block, steps);
          CHECK_FALSE(found.relaxed);
          CHECK(found.across == Approx(reference.across).epsilon(block == rigid ? 1e-6 : 1e-3));
          CHECK(found.along == Approx(reference.along).epsilon(block == rigid ? 1e-6 : 1e-3));
          CHECK(found.sunk == Approx(reference.sunk).epsilon(1e-3));
        }
      }
    }
  }
}
