// Prescribed motion about a pivot: exact places after many turns, the step that it allows, and the
// ledgers of what it pushes.
#include <catch2/catch.hpp>
#include <cmath>

#include "lib/fem/finite_elements.hpp"
#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

Vec2 rotated(const Vec2& p, long double angle) {
  const long double c = std::cos(angle), s = std::sin(angle);
  return {static_cast<double>(c * p.x() - s * p.y()), static_cast<double>(s * p.x() + c * p.y())};
}

// 1 m long and 0.1 m thick, with the end of its upper side at `pivot`, about which it turns.
RigidBody paddle(const Model& model, const Vec2& pivot, double angle, double spin) {
  RigidBody body;
  body.name = "paddle";
  body.motion = Motion::prescribed;
  set_shape(body, Polygon({{0, -.1}, {1, -.1}, {1, 0}, {0, 0}}), model);
  body.pivot = -body.position;
  body.angle = angle;
  body.position = pivot + rotated(body.position, angle);
  body.history.spin = {{0, spin}};
  return body;
}

Model still_model(double coefficient = 0) {
  Model model;
  model.materials = {{"rock", 1000}};
  model.contact.normal_stiffness = 1e9;
  model.contact.friction.coefficient = coefficient;
  return model;
}

// A square on its corner, (0.8, 0), which the paddle reaches after 0.2 s, when it lies along x.
Model batted(double coefficient) {
  Model model = still_model(coefficient);
  model.bodies.push_back(paddle(model, {0, 0}, -.2, 1));
  RigidBody ball;
  ball.name = "ball";
  set_shape(ball, Polygon({{.8, 0}, {.9, .1}, {.8, .2}, {.7, .1}}), model);
  model.bodies.push_back(ball);
  return model;
}

void turn_until(Simulation& simulation, double time) {
  while (simulation.state().time < time) simulation.step();
}

}  // namespace

TEST_CASE("a paddle is where its angle says after many turns about its end", "[pivot]") {
  const Vec2 start(3, -2);
  const double spin = 2 * M_PI * 7;
  Model model = still_model();
  model.bodies.push_back(paddle(model, start, .3, spin));
  model.bodies[0].history.velocity = {{0, {.25, -.5}}};
  const Vec2 arm = model.bodies[0].position - start;
  Simulation simulation(model, {.end = 100, .fixed_step = 1e-3}, 1, 1);
  const int steps = scaled(100000);
  double off = 0, radius = 0, turn = 0, slower = 0;
  for (int i = 1; i <= steps; ++i) {
    simulation.step();
    if (i % 997 != 0 && i < steps) continue;
    const State& state = simulation.state();
    const Vec2 pivot = start + state.time * Vec2(.25, -.5);
    const Vec2 now = state.pose(0).head<2>() - pivot;
    const double angle = spin * state.time;
    off = std::max(off, (now - rotated(arm, angle)).norm());
    radius = std::max(radius, std::abs(now.norm() - arm.norm()));
    turn = std::max(turn, std::abs(state.pose(0)[2] - .3 - angle));
    const Vec2 velocity = Vec2(.25, -.5) + cross(spin, now);
    slower = std::max(slower, (Vec2(state.pose_rate(0).head<2>()) - velocity).norm());
    CHECK(state.pose_rate(0)[2] == spin);
  }
  CHECK(simulation.state().time * 7 == Approx(700. * steps / 100000));
  // The rounding of a distance of 50 m, and of an angle of 4400 rad.
  CHECK(radius < 4e-14);
  CHECK(off < 1e-12);
  CHECK(turn < 4e-12);
  CHECK(slower < 1e-10);
}

TEST_CASE("what turns about a pivot moves as a rigid body", "[pivot]") {
  MotionHistory history;
  history.velocity = {{0, {1, 2}}, {3, {-1, .5}}};
  history.spin = {{0, .5}, {2, -4}};
  for (const double time : {0., .7, 2.5, 9.}) {
    const Vec2 arm(.3, -.8);
    const auto all = history.displacement(time, arm);
    const auto own = history.displacement(time);
    const Vec2 there = Vec2(own[0], own[1]) + rotated(arm, own[2]) - arm;
    CHECK((Vec2(all[0], all[1]) - there).norm() < 1e-15);
    CHECK(all[2] == own[2]);
    const double h = 1e-5;
    const auto before = history.displacement(time - h, arm),
               after = history.displacement(time + h, arm);
    const auto rate = history.rate(time, arm);
    if (time == 0) continue;  // a history begins here
    for (size_t k = 0; k < 3; ++k) {
      CHECK((after[k] - before[k]) / (2 * h) == Approx(rate[k]).margin(1e-7));
    }
  }
}

TEST_CASE("the step respects the reach from the pivot", "[pivot]") {
  Model model = batted(0);
  const RigidBody& turning = model.bodies[0];
  CHECK(turning.reach() == Approx(std::hypot(1, .1)));
  CHECK(motion_step_limit(model).step ==
        Approx(kLargestStride * .05 / (1 * std::hypot(1, .1))).epsilon(1e-12));
  model.bodies[0].pivot = Vec2::Zero();
  CHECK(motion_step_limit(model).step ==
        Approx(kLargestStride * .05 / (1 * std::hypot(.5, .05))).epsilon(1e-12));
}

TEST_CASE("a paddle bats a body away with twice its speed there", "[pivot]") {
  const Model model = batted(0);
  const double mass = model.bodies[1].mass;
  CHECK(mass == Approx(20));
  Simulation simulation(model, {.end = .3}, 10, 1);
  turn_until(simulation, .3);
  const auto v = simulation.state().pose_rate(1);
  // The contact lasts 3 ms, in which the paddle turns a little further.
  CHECK(v[1] == Approx(1.6).epsilon(2e-3));
  CHECK(std::abs(v[0]) < .01);
  const Energies e = simulation.energies();
  CHECK(e.contact == 0);
  CHECK(e.external_work == Approx(mass * 1.6 * 1.6 / 2).epsilon(4e-3));
  CHECK(e.kinetic == Approx(e.external_work).epsilon(1e-4));
  CHECK(std::abs(e.total_error) < 1e-4 * e.external_work);
}

TEST_CASE("the ledgers close of what a turning paddle pushes", "[pivot]") {
  for (const double coefficient : {0., .1}) {
    for (const Vec2& velocity : {Vec2(0, 0), Vec2(.2, .1)}) {
      CAPTURE(coefficient, velocity.x());
      Model model = batted(coefficient);
      model.gravity = {.3, -2};
      model.bodies[0].history.velocity = {{0, velocity}};
      model.bodies[1].position.x() -= .2;
      model.bodies[1].velocity = {1, 0};
      Simulation simulation(model, {.end = 1}, 10, 1);
      turn_until(simulation, .6);
      const Energies e = simulation.energies();
      CHECK(e.external_work > 5);
      CHECK(simulation.counts().touching_pairs > 50);
      if (coefficient > 0) CHECK(e.friction_loss > .1);
      CHECK(std::abs(e.total_error) < 1e-3 * e.external_work);
      const Momenta p = simulation.momenta();
      CHECK(std::abs(p.angular) > 1);
      CHECK(std::abs(p.angular_error) < 3e-11 * std::abs(p.angular));
      CHECK(std::hypot(p.x_error, p.y_error) < 1e-11 * std::hypot(p.x, p.y));
    }
  }
}

TEST_CASE("a mesh whose nodes all turn about a pivot moves without strain", "[pivot]") {
  Model model = model_of(block({1, .5}, {4, 2}, ElementKind::quad4), rock());
  Support support{{}, {true, true}, {}, {2, -1}};
  for (int i = 0; i < model.node_count(); ++i) support.nodes.push_back(i);
  support.motion.spin = {{0, 3}, {1, 30}};
  model.deformables[0].supports = {support};
  const Mesh& mesh = model.deformables[0].mesh;
  FiniteElements elements(
      std::vector<ElementSet>{{.mesh = &mesh, .material = rock().elastic, .density = 2000}}, 1);
  DegreesOfFreedom dofs(model, elements.mass());
  State state = dofs.start();
  const double dt = 1e-3;
  for (int i = 1; i <= 8000; ++i) {
    state.time = i * dt;
    dofs.steer(state, dt);
    dofs.drift(state, dt);
  }
  dofs.follow(state);
  const double angle = (3 + 30) / 2. + 30 * (state.time - 1);
  double off = 0, slower = 0;
  for (int i = 0; i < model.node_count(); ++i) {
    const Vec2 arm = rotated(mesh.nodes[i] - Vec2(2, -1), angle);
    off = std::max(off, (mesh.nodes[i] + state.node(i) - (Vec2(2, -1) + arm)).norm());
    slower = std::max(slower, (state.node_velocity(i) - cross(30, arm)).norm());
  }
  CHECK(off < 1e-12);
  CHECK(slower < 1e-10);
  CHECK(std::abs(elements.strain_energy(state.x)) < 1e-15);
}

TEST_CASE("the ledgers close of a beam whose end turns about a pivot", "[pivot]") {
  Model model = model_of(block({1, .1}, {20, 2}, ElementKind::quad4), rock());
  Support support{nodes_at(model.deformables[0].mesh, 0), {true, true}, {}, {-.5, .2}};
  support.motion.spin = {{0, 0}, {.02, 20}};
  support.motion.velocity = {{0, {0, 0}}, {.02, {5, 0}}};
  model.deformables[0].supports = {support};
  Simulation simulation(model, {.end = .02}, 10, 1);
  turn_until(simulation, .01);  // half a period of its bending
  const Energies e = simulation.energies();
  CHECK(e.external_work > 1000);
  CHECK(e.strain > 1e-3 * e.external_work);
  CHECK(std::abs(e.total_error) < 1e-3 * e.external_work);
  const Momenta p = simulation.momenta();
  CHECK(std::abs(p.angular) > 100);
  CHECK(std::abs(p.angular_error) < 1e-11 * std::abs(p.angular));
}
