// Implicit steps in time: against closed forms, laws of conservation, and velocity Verlet.
#include <catch2/catch.hpp>
#include <cmath>

#include "apps/cases/samples.hpp"
#include "lib/dynamics/simulation.hpp"
#include "tests/dynamics/mesh_models.hpp"
#include "tests/dynamics/surface_models.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace implicit {
namespace {

Model empty(double friction = 0) {
  Model model;
  model.materials = {{"stone", 2000}};
  model.contact.normal_stiffness = 1e8;
  model.contact.friction.coefficient = friction;
  model.contact.friction.stiffness_ratio = 1;
  return model;
}

TimeSettings time_of(TimeScheme scheme, double end = 10) {
  TimeSettings time;
  time.end = end;
  time.scheme = scheme;
  return time;
}

TimeSettings fixed(double step, double end = 10) {
  TimeSettings time = time_of(TimeScheme::implicit, end);
  time.fixed_step = step;
  return time;
}

// Two polygons that meet in free space, with friction.
Model meeting(SeededRandom& random, double speed) {
  Model model = empty(.3);
  add_body(model, samples::random_star_shaped(random, 7, .5)).velocity = {speed, 0};
  add_body(model, samples::posed(samples::random_star_shaped(random, 6, .5),
                                 {1.2, random.uniform(-.3, .3)}, 0))
      .velocity = {-speed, random.uniform(-.1, .1) * speed};
  return model;
}

double fastest(const State& state) {
  double fastest = 0;
  for (const double v : state.v) fastest = std::max(fastest, std::abs(v));
  return fastest;
}

// Columns of blocks of random widths in a trough, each block a little above the one below it.
Model heap(SeededRandom& random, int rows, double gap) {
  Model model = empty(.5);
  model.gravity = {0, -9.81};
  model.contact.damping = {.3, .3, 0};
  add_body(model, samples::block(-.2, -1, 3.2, 0), Motion::fixed);
  add_body(model, samples::block(-.2, 0, 0, 4), Motion::fixed);
  add_body(model, samples::block(3, 0, 3.2, 4), Motion::fixed);
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < 5; ++i) {
      const double half = random.uniform(.1, .25), x = .32 + .58 * i, y = row * (.3 + gap) + gap;
      add_body(model, samples::block(x - half, y, x + half, y + .3));
    }
  }
  return model;
}

}  // namespace
}  // namespace implicit

TEST_CASE("implicit steps: free flight is exact", "[implicit]") {
  Model model = implicit::empty();
  model.gravity = {0, -9.81};
  RigidBody& body = add_body(model, samples::block(-.5, -.1, .5, .1));
  body.velocity = {3, 4};
  body.spin = 2;
  add_body(model, samples::block(-100, -101, 100, -100), Motion::fixed);
  Simulation simulation(model, implicit::fixed(.05), 1, 1);
  const Vec2 start = simulation.state().pose(0).head<2>();
  while (simulation.state().time < 1) simulation.step();
  const double t = simulation.state().time;
  const auto pose = simulation.state().pose(0);
  CHECK(pose.x() - start.x() == Approx(3 * t).epsilon(1e-12));
  CHECK(pose.y() - start.y() == Approx(4 * t - 9.81 / 2 * t * t).epsilon(1e-12));
  CHECK(pose.z() == Approx(2 * t).epsilon(1e-12));
  CHECK(simulation.state().v[1] == Approx(4 - 9.81 * t).epsilon(1e-12));
  CHECK(std::abs(simulation.energies().total_error) < 1e-9);
  CHECK(std::abs(simulation.energies().numerical_loss) < 1e-9);
}

TEST_CASE("implicit steps: a block slides to rest where friction says", "[implicit]") {
  const auto slide = [](double step) {
    Model model = implicit::empty(.4);
    model.gravity = {0, -9.81};
    add_body(model, samples::block(-10, -1, 20, 0), Motion::fixed);
    add_body(model, samples::block(-.5, 0, .5, .2)).velocity = {3, 0};
    TimeSettings time = implicit::fixed(step);
    time.settled = true;
    Simulation simulation(model, time, 1, 1);
    const double start = simulation.state().pose(1).x();
    while (simulation.state().time < 2) simulation.step();
    CHECK(implicit::fastest(simulation.state()) == 0);
    const Energies e = simulation.energies();
    CHECK(e.friction_loss == Approx(2000 * .2 * 9 / 2).epsilon(.02));
    CHECK(e.numerical_loss > 0);
    return simulation.state().pose(1).x() - start;
  };
  const double way = 9 / (2 * .4 * 9.81);
  CHECK(slide(1. / 150) == Approx(way).epsilon(.01));
  CHECK(slide(1e-3) == Approx(way).epsilon(1e-4));
}

TEST_CASE("implicit steps: what collides and flies is velocity Verlet's, bit for bit",
          "[implicit]") {
  SeededRandom random(31);
  const int pairs = std::max(8, scaled(20));
  int met = 0;
  for (int n = 0; n < pairs; ++n) {
    const Model model = implicit::meeting(random, 1);
    Simulation verlet(model, implicit::time_of(TimeScheme::verlet), 1, 1);
    Simulation automatic(model, implicit::time_of(TimeScheme::automatic), 1, 1);
    while (verlet.state().time < .4) {
      verlet.step();
      automatic.step();
    }
    met += verlet.counts().touching_pairs > 0;
    CHECK(verlet.state().x == automatic.state().x);
    CHECK(verlet.state().v == automatic.state().v);
    CHECK(automatic.implicit_counts()->steps == 0);
  }
  CHECK(4 * met >= pairs);
}

TEST_CASE("implicit steps keep momentum, and collisions converge to velocity Verlet's",
          "[implicit]") {
  SeededRandom random(32);
  for (int n = 0; n < scaled(6); ++n) {
    const Model model = implicit::meeting(random, .5);
    const auto end = [&](const TimeSettings& time) {
      Simulation simulation(model, time, 1, 1);
      while (simulation.state().time < 1) simulation.step();
      const Momenta p = simulation.momenta();
      const double size = model.bodies[0].mass * .5;
      CHECK(std::abs(p.x_error) < 1e-11 * size);
      CHECK(std::abs(p.y_error) < 1e-11 * size);
      CAPTURE(n, simulation.energies().numerical_loss);
      CHECK(std::abs(p.angular_error) < 1e-5 * size);
      CHECK(std::abs(simulation.energies().total_error) < 1e-6 * size);
      return simulation.state().v;
    };
    Simulation verlet(model, implicit::time_of(TimeScheme::verlet), 1, 1);
    while (verlet.state().time < 1) verlet.step();
    REQUIRE(verlet.counts().touching_pairs > 0);
    double before = 0;
    for (const double step : {8e-5, 4e-5, 2e-5}) {
      const std::vector<double> v = end(implicit::fixed(step));
      double off = 0;
      for (size_t c = 0; c < v.size(); ++c)
        off = std::max(off, std::abs(v[c] - verlet.state().v[c]));
      CAPTURE(n, step, off, before);
      if (before > 0) CHECK(off < .7 * before);
      before = off;
    }
  }
}

TEST_CASE("implicit steps: heaps come to rest exactly, and stay where velocity Verlet leaves them",
          "[implicit]") {
  SeededRandom random(33);
  for (int n = 0; n < scaled(4); ++n) {
    const Model model = implicit::heap(random, 3, .002);
    TimeSettings time = implicit::time_of(TimeScheme::automatic, 6);
    time.accuracy = 1e-3;
    Simulation simulation(model, time, 60, 1);
    time.scheme = TimeScheme::verlet;
    Simulation verlet(model, time, 60, 1);
    for (int row = 1; row <= 60; ++row) {
      const double horizon = time.end * row / 60;
      while (simulation.state().time < horizon - 1e-9) simulation.step(horizon);
    }
    while (verlet.state().time < 6 - 1e-9) verlet.step();
    CHECK(implicit::fastest(simulation.state()) == 0);
    const Energies e = simulation.energies();
    CHECK(e.numerical_loss < 10);  // of about 2 kJ that have been lost
    CHECK(std::abs(e.total_error) < .01 * e.damping_loss);
    CHECK(simulation.implicit_counts()->ticks > simulation.state().step / 2);
    for (size_t c = 0; c < verlet.state().x.size(); ++c) {
      CHECK(std::abs(verlet.state().x[c] - simulation.state().x[c]) < 2e-3);
    }
    const Momenta p = simulation.momenta();
    double impulse = 0;  // of the weights
    for (const RigidBody& body : model.bodies) {
      if (body.motion == Motion::free) impulse += 9.81 * time.end * body.mass;
    }
    CHECK(std::abs(p.y_error) < 1e-7 * impulse);
  }
}

TEST_CASE("implicit steps: vibrations without damping are not drained little by little",
          "[implicit]") {
  SeededRandom random(34);
  Model model = implicit::heap(random, 2, .0005);
  model.contact.damping = {};
  TimeSettings time = implicit::time_of(TimeScheme::automatic, 4);
  time.accuracy = 1e-2;
  Simulation simulation(model, time, 40, 1);
  while (simulation.state().time < time.end - 1e-9) simulation.step(time.end);
  double unnoticed = 0;  // energy that lifts all blocks by accuracy times their inradii, J
  for (const RigidBody& body : model.bodies) {
    if (body.motion == Motion::free) unnoticed += body.mass * 9.81 * time.accuracy * body.inradius;
  }
  const auto times = std::log2(static_cast<double>(simulation.state().step) / 512) + 2;
  CAPTURE(unnoticed, times, simulation.implicit_counts()->phases);
  CHECK(simulation.energies().numerical_loss < times * unnoticed);
  CHECK(simulation.implicit_counts()->steps > 0);
}

// A beam of 2 m x .2 m, held at its left end, which its weight bends.
Model damped_beam(double stiffness_damping) {
  Material soft{"soft", 1000};
  soft.elastic.young = 1e7;
  soft.elastic.poisson = .3;
  soft.stiffness_damping = stiffness_damping;
  Model model = model_of(block({2, .2}, {20, 2}, ElementKind::quad4), soft);
  model.gravity = {0, -9.81};
  DeformableBody& body = model.deformables[0];
  body.supports.push_back({nodes_at(body.mesh, 0), {true, true}, {}});
  return model;
}

TEST_CASE("implicit steps: damping of elements converges to that of velocity Verlet",
          "[implicit]") {
  const Model model = damped_beam(.05);
  Simulation verlet(model, implicit::time_of(TimeScheme::verlet), 1, 1);
  while (verlet.state().time < .5 - 1e-9) verlet.step();
  REQUIRE(verlet.energies().damping_loss > 100);
  double before = 0, loss_before = 0;
  for (const double step : {.01, .005, .0025}) {
    Simulation simulation(model, implicit::fixed(step, .5), 1, 1);
    while (simulation.state().time < .5 - 1e-9) simulation.step();
    double off = 0;
    for (size_t c = 0; c < verlet.state().x.size(); ++c) {
      off = std::max(off, std::abs(simulation.state().x[c] - verlet.state().x[c]));
    }
    const double loss =
        std::abs(simulation.energies().damping_loss - verlet.energies().damping_loss);
    CAPTURE(step, off, before, loss, loss_before);
    if (before > 0) CHECK((off < .6 * before && loss < .6 * loss_before));
    CHECK(std::abs(simulation.energies().total_error) < 1e-9 * verlet.energies().strain);
    before = off, loss_before = loss;
  }
  CHECK(before < .02 * 2);
}

TEST_CASE("implicit steps: a beam whose damping has brought it to rest lies where statics says",
          "[implicit]") {
  TimeSettings time = implicit::time_of(TimeScheme::automatic, 14);
  time.accuracy = 1e-3;
  const Model model = damped_beam(.1);
  Simulation simulation(model, time, 1, 1);
  double lost = 0;
  while (simulation.state().time < time.end - 1e-9) {
    simulation.step(time.end);
    const Energies e = simulation.energies();
    CHECK(e.damping_loss >= lost - 1e-9);
    lost = e.damping_loss;
  }
  CHECK(simulation.implicit_counts()->ticks > simulation.state().step / 2);
  TimeSettings statics;
  statics.statics = true;
  const Model undamped = damped_beam(0);
  Simulation equilibrium(undamped, statics, 1, 1);
  equilibrium.balance(1);
  const std::vector<double>& x = simulation.state().x;
  const std::vector<double>& y = equilibrium.state().x;
  for (size_t c = 0; c < x.size(); ++c) CHECK(std::abs(x[c] - y[c]) < 1e-6);
  const Energies e = simulation.energies();
  CHECK(std::abs(e.total_error) < 1e-3 * e.damping_loss);
  CHECK(e.numerical_loss < 1e-2 * e.damping_loss);
}
