// Gravity whose strength follows a history: motion, ledgers, static runs.
#include <catch2/catch.hpp>

#include "tests/dynamics/friction_models.hpp"
#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

void run_until(Simulation& simulation, double end) {
  while (simulation.state().time < end * (1 - 1e-9)) simulation.step();
}

}  // namespace

TEST_CASE("a body falls as gravity grows", "[gravity]") {
  Model model = make_model(0);
  model.gravity = {1, -kG};
  model.gravity_history.points = {{0, 0}, {1, 1}, {2, -.5}};
  add(model, "block", flat_block());
  model.bodies[0].velocity = {.5, 0};
  TimeSettings time;
  time.end = 2.5;
  time.fixed_step = 1e-3;
  Simulation simulation(model, time, 1, 1);
  const double m = model.bodies[0].mass;
  const auto check = [&](double speed, double fall) {
    const State& s = simulation.state();
    CHECK(s.pose_rate(0)[1] == Approx(-kG * speed).epsilon(1e-9));
    CHECK(s.pose(0)[1] - model.bodies[0].position.y() == Approx(-kG * fall).epsilon(1e-5));
    CHECK(s.pose_rate(0)[0] == Approx(.5 + speed).epsilon(1e-9));
  };
  run_until(simulation, 1);
  check(.5, 1. / 6);
  Energies e = simulation.energies();
  // In gravity as it is now, from where the body was.
  const double moved = simulation.state().pose(0)[0] - model.bodies[0].position.x();
  CHECK(e.gravity == Approx(m * (-kG * kG / 6 - moved)).epsilon(1e-5));
  CHECK(e.external_work < -.3 * e.kinetic);
  run_until(simulation, 2.5);
  check(.5, 1. / 6 + .5 + .5 - 1.5 / 6 + .75 * .5 - .5 * .125);
  e = simulation.energies();
  CHECK(std::abs(e.total_error) < 1e-6 * e.kinetic);
  const Momenta p = simulation.momenta();
  CHECK(std::abs(p.x_error) < 1e-10 * std::abs(p.x));
  CHECK(std::abs(p.y_error) < 1e-10 * std::abs(p.x));
  CHECK(std::abs(p.angular_error) < 1e-10 * std::abs(p.angular));
}

TEST_CASE("ledgers close where gravity changes while bodies touch", "[gravity]") {
  Model model = make_model(.5);
  model.gravity = {-2, -kG};
  model.gravity_history.points = {{0, .2}, {.02, 2}, {.04, .5}};
  add(model, "slope", samples::block(-10, -1, 20, 0), Motion::fixed);
  add(model, "block", flat_block());
  TimeSettings time;
  time.end = .05;
  time.safety = .02;
  Simulation simulation(model, time, 1, 1);
  run_until(simulation, time.end);
  const Energies e = simulation.energies();
  CHECK(e.contact > 0);
  CHECK(e.external_work != 0);
  CHECK(std::abs(e.total_error) < 1e-3 * (e.contact + e.kinetic));
  const Momenta p = simulation.momenta();
  const double impulse = model.bodies[1].mass * kG * time.end;
  CHECK(std::abs(p.x_error) < 1e-12 * impulse);
  CHECK(std::abs(p.y_error) < 1e-12 * impulse);
  CHECK(std::abs(p.angular_error) < 1e-11 * impulse);
}

TEST_CASE("constant gravity by a history is the same gravity, and meshes feel it", "[gravity]") {
  DeformableBody body = block({1, .4}, {5, 2}, ElementKind::quad4);
  body.supports = {{nodes_at(body.mesh, 0), {true, true}, {}}};
  Model model = model_of(std::move(body), rock());
  model.gravity = {100, -1000};
  Model same = model;
  same.gravity_history.points = {{0, 2}};
  model.gravity *= 2;
  TimeSettings time;
  time.end = 5e-4;
  time.element_safety = .05;
  Simulation one(model, time, 1, 1), two(same, time, 1, 1);
  run_until(one, time.end);
  run_until(two, time.end);
  CHECK(one.state().x == two.state().x);
  CHECK(one.energies().gravity == Approx(two.energies().gravity).epsilon(1e-14));
  CHECK(two.energies().external_work == 0);
  same.gravity_history.points = {{0, 0}, {5e-4, 2}};
  Simulation growing(same, time, 1, 1);
  run_until(growing, time.end);
  const Energies e = growing.energies();
  CHECK(e.strain > 0);
  CHECK(std::abs(e.total_error) < 1e-4 * e.kinetic);
  CHECK(std::abs(growing.momenta().y_error) < 1e-9 * std::abs(growing.momenta().y));
}

TEST_CASE("static runs follow gravity from load step to load step", "[gravity][equilibrium]") {
  DeformableBody body = block({1, .4}, {10, 4}, ElementKind::quad4);
  body.supports = {{nodes_at(body.mesh, 0), {true, true}, {}}};
  Model model = model_of(std::move(body), rock());
  model.gravity = {0, -1000};
  model.gravity_history.points = {{0, 0}, {1, 1}, {2, .5}};
  TimeSettings time;
  time.end = 2;
  time.statics = true;
  time.load_steps = 4;
  time.tolerance = 1e-9;
  Simulation simulation(model, time, 4, 1);
  const int tip = nodes_where(model.deformables[0].mesh, {.nearest = Vec2(1, .4)})[0];
  std::vector<double> sag;
  for (const double t : {.5, 1., 1.5, 2.}) {
    simulation.balance(t);
    sag.push_back(simulation.state().node(tip).y());
    const Energies e = simulation.energies();
    // The trapezoid rule over a load step is exact where displacements follow the loads.
    CHECK(std::abs(e.total_error) < 1e-3 * e.strain);
    CHECK(e.gravity == Approx(-2 * e.strain).epsilon(1e-3));
    CHECK(e.external_work == Approx(-e.strain).epsilon(2e-3));
  }
  CHECK(sag[1] < 0);
  CHECK(sag[0] == Approx(sag[1] / 2).epsilon(1e-3));
  CHECK(sag[2] == Approx(sag[1] * .75).epsilon(1e-3));
  CHECK(sag[3] == Approx(sag[0]).epsilon(1e-6));
}

TEST_CASE("a body falls in gravity that turns, and the ledgers close", "[gravity]") {
  Model model = make_model(.5);
  GravityPart part;
  part.value = {0, -kG};
  part.tilt.points = {{0, 0}, {1, .5}};
  GravityPart shake;
  shake.value = {3, 0};
  shake.history.points = {{0, 0}, {.5, 1}, {1, 0}};
  model.gravity_parts = {part, shake};
  model.gravity = model.gravity_at(0);
  add(model, "block", flat_block());
  add(model, "slope", samples::block(-10, -21, 20, -20), Motion::fixed);
  TimeSettings time;
  time.end = 1;
  time.fixed_step = 1e-4;
  Simulation simulation(model, time, 1, 1);
  run_until(simulation, 1);
  // The integrals of -g sin(t/2) with the pulse of area 1.5, and of -g cos(t/2).
  const State& s = simulation.state();
  CHECK(s.pose_rate(0)[0] == Approx(-2 * kG * (1 - std::cos(.5)) + 1.5).epsilon(1e-7));
  CHECK(s.pose_rate(0)[1] == Approx(-2 * kG * std::sin(.5)).epsilon(1e-7));
  const Energies e = simulation.energies();
  CHECK(std::abs(e.external_work) > .01 * e.kinetic);
  CHECK(std::abs(e.total_error) < 1e-7 * e.kinetic);
  const Momenta p = simulation.momenta();
  CHECK(std::abs(p.x_error) + std::abs(p.y_error) < 1e-10 * std::abs(p.y));
  CHECK(std::abs(p.angular_error) < 1e-9 * std::abs(p.angular));
}
