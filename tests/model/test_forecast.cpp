// The depths that a scene will reach, against its run.
#include "lib/model/forecast.hpp"

#include <catch2/catch.hpp>

#include "lib/dynamics/simulation.hpp"
#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/model/inradius.hpp"
#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

Model on_floor(const Polygon& polygon, double gap, const PotentialChoice& potential = {}) {
  Model model;
  model.contact.potential = potential;
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

namespace {

// The model with the stiffness that the penetration over the smallest inradius asks for.
Model stiffened(Model model, double share, double NeededStiffness::*which) {
  model.contact.normal_stiffness = stiffness_for(model, share).*which;
  return model;
}

double smallest_inradius(const Model& model) {
  return std::min(model.bodies[0].inradius, model.bodies[1].inradius);
}

}  // namespace

TEST_CASE("the stiffness for a penetration is reached by impacts, and hardly passed",
          "[forecast]") {
  test::SeededRandom random(451);
  for (int i = 0; i < test::scaled(16); ++i) {
    const double share = std::pow(10, random.uniform(-3, -1.5));
    const double gap = random.uniform(.05, .4), size = random.uniform(.3, 2);
    INFO("share " << share << ", gap " << gap << ", size " << size);
    const Model flat = stiffened(on_floor(samples::block(-size / 2, 0, size / 2, size), gap), share,
                                 &NeededStiffness::flat);
    const double until = 1.2 * std::sqrt(2 * gap / 9.81) + .02;
    CHECK(deepest(flat, until) <= 1.05 * share * smallest_inradius(flat));
    CHECK(deepest(flat, until) >= .85 * share * smallest_inradius(flat));
    // On the apex of a triangle with the mass centre above it.
    const double half = random.uniform(.2, .6) * size;
    const Model tip = stiffened(on_floor(Polygon({{0, 0}, {half, size}, {-half, size}}), gap),
                                share, &NeededStiffness::corner);
    CHECK(deepest(tip, until) <= 1.1 * share * smallest_inradius(tip));
    CHECK(deepest(tip, until) >= .75 * share * smallest_inradius(tip));
  }
}

TEST_CASE("the stiffness for a penetration carries the weight of a pile", "[forecast]") {
  Model model = on_floor(samples::block(-.5, 0, .5, 1), 0);
  for (int i = 1; i < 3; ++i) {
    RigidBody body = model.bodies[1];
    body.position.y() += i;
    model.bodies.push_back(body);
  }
  // 2 rho g 3 h = k_n (1/r_a + 1/r_b) share r, with r_a = .5 m, the smallest, and r_b = 1 m: as
  // gravity acts at once, the pile sinks twice as deep as it will rest.
  const double exact = 2 * 2000 * 9.81 * 3 / ((1 / .5 + 1) * .01 * .5);
  const NeededStiffness needed = stiffness_for(model, .01);
  CHECK(needed.flat >= exact * (1 - 1e-9));
  CHECK(needed.flat <= 1.1 * exact);
  CHECK(needed.corner == 0);
  model.contact.normal_stiffness = needed.flat;
  CHECK(deepest(model, .2) <= 1.05 * .01 * .5);
  CHECK(deepest(model, .2) >= .8 * .01 * .5);
}

TEST_CASE("the stiffness for a penetration holds where two free bodies meet", "[forecast]") {
  test::SeededRandom random(453);
  for (int i = 0; i < test::scaled(24); ++i) {
    const double share = std::pow(10, random.uniform(-3, -1.5));
    const double a = random.uniform(.3, 2), b = i % 2 == 0 ? a : random.uniform(.3, 2);
    Model model = on_floor(samples::block(.001, -b / 2, .001 + b, b / 2), 0);
    set_shape(model.bodies[0], samples::block(-a, -a / 2, 0, a / 2), model);
    model.bodies[0].motion = Motion::free;
    model.gravity = Vec2::Zero();
    const double speed = random.uniform(.2, 3);
    model.bodies[0].velocity = {speed, 0};
    model.bodies[1].velocity = {i % 2 == 0 ? -speed : random.uniform(-3, 0), 0};
    INFO("share " << share << ", sides " << a << ", " << b);
    model = stiffened(model, share, &NeededStiffness::flat);
    Simulation simulation(model, {.end = .1}, 1, 1);
    while (simulation.state().time < .1) simulation.step();
    const double depth =
        simulation.extremes().penetration.value / (share * smallest_inradius(model));
    CHECK(depth > 0);
    CHECK(depth <= 1.05);
    if (i % 2 == 0) CHECK(depth >= .85);
  }
}

TEST_CASE("vertices in the middle of straight sides are no corners", "[forecast]") {
  test::SeededRandom random(454);
  for (int i = 0; i < test::scaled(200); ++i) {
    const double turn = random.uniform(0, 6), c = std::cos(turn), s = std::sin(turn);
    const int n = random.integer(3, 9), cuts = random.integer(1, 4);
    std::vector<Vec2> plain, cut;
    for (int k = 0; k < n; ++k) {
      const double angle = 2 * M_PI * k / n, after = 2 * M_PI * (k + 1) / n;
      const Vec2 a(std::cos(angle), std::sin(angle)), b(std::cos(after), std::sin(after));
      const auto turned = [&](const Vec2& v) {
        return Vec2(c * v.x() - s * v.y(), s * v.x() + c * v.y() + 1.5);
      };
      plain.push_back(turned(a));
      for (int j = 0; j < cuts; ++j) cut.push_back(turned(a + (b - a) * (double(j) / cuts)));
    }
    const NeededStiffness one = stiffness_for(on_floor(Polygon(plain), 0), .01);
    // With round-off some of these vertices are reflex: the polygon is not quite convex.
    const NeededStiffness other = stiffness_for(on_floor(Polygon(cut), 0), .01);
    INFO(n << " sides, " << cuts << " parts each");
    CHECK(other.corner == Approx(one.corner).epsilon(.11));  // both are rounded to two digits
    // Of a mesh the same.
    const Model rigid = on_floor(Polygon(plain), 0, test::length_choice(1));
    Model mesh = rigid;
    mesh.bodies.pop_back();
    DeformableBody body;
    body.name = "body";
    body.mesh = fill_mesh(Polygon(plain), .5, ElementShape::triangle);
    mesh.deformables = {body};
    const double as_mesh = stiffness_for(mesh, .01).corner;
    const double as_rigid = stiffness_for(rigid, .01).corner;
    const double inradii =
        std::pow(std::min(1., inradius_of(rigid, 1)) / std::min(1., inradius_of(mesh, 1)), 3);
    CHECK(as_mesh == Approx(as_rigid * inradii).epsilon(.15));
  }
}

TEST_CASE("no stiffness follows where nothing moves or presses", "[forecast]") {
  Model model = on_floor(samples::block(-.5, 0, .5, 1), 0);
  model.gravity = Vec2::Zero();
  CHECK(stiffness_for(model, .01).flat == 0);
  CHECK(stiffness_for(model, .01).corner == 0);
}

TEST_CASE("the stiffness for a penetration holds for meshes: flat, on a corner, round",
          "[forecast]") {
  test::SeededRandom random(452);
  std::array<double, 3> worst{};  // penetration over the one allowed
  for (int i = 0; i < test::scaled(12); ++i) {
    Model model = on_floor(samples::block(-.5, 0, .5, 1), .1);
    model.bodies.pop_back();
    model.materials[0].elastic.young = std::pow(10, random.uniform(6, 9));
    DeformableBody body;
    body.name = "body";
    body.mesh = i % 3 == 2
                    ? disc_mesh({0, 0}, .5, {4, 2}, ElementShape::quadrilateral)
                    : rectangle_mesh({1, 1}, {4, 4}, {-.5, -.5}, ElementShape::quadrilateral);
    // On its corner it does not topple, and so falls no farther.
    const double turn = i % 3 == 1 ? M_PI / 4 : 0;
    const double c = std::cos(turn), s = std::sin(turn);
    for (Vec2& x : body.mesh.nodes) x = Vec2(c * x.x() - s * x.y(), s * x.x() + c * x.y() + .8);
    body.velocity = {0, -random.uniform(.1, 3)};
    model.deformables = {body};
    const double share = random.uniform(.01, .1);
    const NeededStiffness needed = stiffness_for(model, share);
    const bool flat = i % 3 == 0;
    model.contact.normal_stiffness = flat ? needed.flat : std::max(needed.flat, needed.corner);
    const Forecast expected = Simulation(model, {.end = 1}, 1, 1).forecast();
    INFO(i << ": share " << share << ", k_n " << needed.flat << ", " << needed.corner);
    const double smallest = std::min(inradius_of(model, 0), inradius_of(model, 1));
    const double depth = flat ? std::max(expected.by_speed.depth, 2 * expected.by_weight.depth)
                              : std::max(expected.by_speed.depth, expected.by_speed.corner);
    CHECK(depth <= share * smallest * (1 + 1e-9));
    CHECK(depth >= .8 * share * smallest);
    Simulation simulation(model, {.end = .3}, 1, 1);
    while (simulation.state().time < .3) simulation.step();
    CHECK(simulation.extremes().relative_penetration.value > 0);
    double& most = worst[i % 3];
    most = std::max(most, simulation.extremes().penetration.value / (share * smallest));
  }
  INFO("flat " << worst[0] << ", on a corner " << worst[1] << ", round " << worst[2]);
  // The elements at the surface are stopped by more than the pressure of the wave.
  CHECK(worst[0] <= 1.3);
  CHECK(worst[1] <= 1.05);
  CHECK(worst[2] <= 1.05);
}
