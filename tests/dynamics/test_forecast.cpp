// The depths that a scene will reach, against its run.
#include "lib/dynamics/forecast.hpp"

#include <catch2/catch.hpp>

#include "lib/dynamics/simulation.hpp"
#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

Model on_floor(const Polygon& polygon, double gap) {
  Model model;
  model.gravity = {0, -9.81};
  model.materials = {rock()};
  model.contact.normal_stiffness = 1e9;
  for (const auto& [name, shape] : {std::pair("floor", samples::block(-5, -2, 5, 0)),
                                    std::pair("body", samples::shifted(polygon, {0, gap}))}) {
    RigidBody body;
    body.name = name;
    set_shape(body, shape, model);
    model.bodies.push_back(body);
  }
  model.bodies[0].motion = Motion::fixed;
  return model;
}

// Depth of the lowest vertex of body 1 below the floor, at its deepest.
double deepest(const Model& model, double until) {
  Simulation simulation(model, {.end = until}, 1, 1);
  double lowest = 0;
  while (simulation.state().time < until) {
    simulation.step();
    const Eigen::Vector3d pose = simulation.state().pose(1);
    for (const Vec2& v : model.bodies[1].potential.vertices) {
      lowest = std::min(lowest, pose[1] + std::sin(pose[2]) * v.x() + std::cos(pose[2]) * v.y());
    }
  }
  return -lowest;
}

}  // namespace

TEST_CASE("the depth of a flat impact is that of the forecast", "[forecast]") {
  const Model model = on_floor(samples::block(-.5, 0, .5, 1), .2);
  const Forecast expected = Simulation(model, {.end = 1}, 1, 1).forecast();
  CHECK(expected.by_speed.body == 1);
  CHECK(expected.by_speed.depth == Approx(deepest(model, .25)).epsilon(.02));
}

TEST_CASE("the depth of an impact on a corner is that of the forecast", "[forecast]") {
  const double c = std::sqrt(.75);
  const Model model = on_floor(Polygon({{0, 0}, {.5, c}, {-.5, c}}), .1);
  const Forecast expected = Simulation(model, {.end = 1}, 1, 1).forecast();
  CHECK(expected.by_speed.corner == Approx(deepest(model, .2)).epsilon(.1));
  CHECK(expected.by_speed.share == Approx(expected.by_speed.corner / model.bodies[1].inradius));
}

TEST_CASE("a pile presses with its height", "[forecast]") {
  Model model = on_floor(samples::block(-.5, 0, .5, 1), 0);
  const double one = Simulation(model, {.end = 1}, 1, 1).forecast().by_weight.depth;
  // A square of 1 m with the roof potential on a flat floor: rho g h = k_n (1/r_a + 1/r_b) depth.
  CHECK(one == Approx(2000 * 9.81 / (1e9 * (1 / .5 + 1 / 1.))));
  for (int i = 1; i < 4; ++i) {
    RigidBody body = model.bodies[1];
    body.position.y() += i;
    model.bodies.push_back(body);
  }
  CHECK(Simulation(model, {.end = 1}, 1, 1).forecast().by_weight.depth == Approx(4 * one));
}

TEST_CASE("nothing is expected where nothing moves or touches", "[forecast]") {
  Model model = on_floor(samples::block(-.5, 0, .5, 1), 0);
  model.gravity = Vec2::Zero();
  CHECK(Simulation(model, {.end = 1}, 1, 1).forecast().by_weight.body == -1);
  CHECK(Simulation(model, {.end = 1}, 1, 1).forecast().by_speed.body == -1);
  model.bodies.erase(model.bodies.begin());
  CHECK(Simulation(model, {.end = 1}, 1, 1).forecast().by_weight.body == -1);
}
