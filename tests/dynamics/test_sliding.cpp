// Friction on really tilted slopes, with other shapes, angles and coefficients.
#include <catch2/catch.hpp>

#include "tests/dynamics/friction_models.hpp"

using namespace apothem;
using test::add;
using test::kG;
using test::make_model;

namespace {

// 0.5 m wide and high, on one of its sides.
Polygon hexagon() {
  const double side = .25;
  const Polygon upright = samples::turned(samples::scaled(samples::regular(6), side), M_PI / 3);
  return samples::shifted(upright, {0, side * std::sqrt(.75)});
}

// Slope and block turned by the angle, gravity downwards.
Model tilted(double angle, double coefficient, double speed, const Polygon& block) {
  Model model = make_model(coefficient);
  model.gravity = {0, -kG};
  add(model, "slope", samples::turned(samples::block(-10, -1, 20, 0), angle), Motion::fixed);
  add(model, "block", samples::turned(block, angle));
  model.bodies[1].velocity = samples::turned(Vec2(speed, 0), angle);
  return model;
}

// Along the slope, upwards.
double speed_on(double angle, const State& state) {
  return std::cos(angle) * state.pose_rate(1)[0] + std::sin(angle) * state.pose_rate(1)[1];
}

// A floor that moves to and fro below a block that is held: at the end it is where it was.
Model shaken(const Polygon& block, double way) {
  Model model = make_model(.5);
  model.gravity = {0, -kG};
  add(model, "floor", samples::block(-2, -1, 2, 0), Motion::prescribed);
  add(model, "block", block);
  model.bodies[1].held = {true, false, true};
  const double rate = way / .01;
  // Ramps of 0.1 ms around 0.01 s forth, 0.02 s back and 0.01 s forth.
  for (const auto& [time, share] : {std::pair(0., 0.),
                                    {.0001, 1.},
                                    {.01, 1.},
                                    {.0102, -1.},
                                    {.0301, -1.},
                                    {.0303, 1.},
                                    {.0402, 1.},
                                    {.0403, 0.}}) {
    model.bodies[0].history.velocity.push_back({time, {share * rate, 0}});
  }
  return model;
}

// A wheel of radius 0.25 m on a slope of 20 degrees; gravity is tilted.
Model wheel(int sides) {
  Model model = make_model(.5);
  const double angle = M_PI / 9;
  model.gravity = {kG * std::sin(angle), -kG * std::cos(angle)};
  add(model, "slope", samples::block(-2, -1, 8, 0), Motion::fixed);
  const double turn = -M_PI / 2 + M_PI / sides;  // one side below
  const Polygon rim = samples::turned(samples::scaled(samples::regular(sides), .25), turn);
  add(model, "wheel", samples::shifted(rim, {0, .25 * std::cos(M_PI / sides)}));
  return model;
}

}  // namespace

TEST_CASE("blocks of any shape slide by theory on tilted slopes", "[friction]") {
  const Polygon flat = test::flat_block();
  const double degree = M_PI / 180;
  struct Case {
    double angle, coefficient, speed;
    Polygon block;
  };
  for (const Case& c : {Case{15 * degree, .35, 3, flat},
                        {15 * degree, .1, -1, flat},
                        {25 * degree, .25, 4, flat},
                        {40 * degree, .5, 6, flat},
                        {40 * degree, .3, -2, flat},
                        {25 * degree, .3, 3, hexagon()},
                        {15 * degree, .2, -2, hexagon()},
                        {20 * degree, .25, 3, test::two_feet()},
                        {35 * degree, .6, -2, test::two_feet()}}) {
    INFO(c.angle / degree << " degrees, " << c.block.vertices().size() << " vertices");
    const Model model = tilted(c.angle, c.coefficient, c.speed, c.block);
    const double slowing =
        kG * (std::copysign(c.coefficient * std::cos(c.angle), c.speed) + std::sin(c.angle));
    Simulation simulation(model, {.end = .1, .settled = true}, 1, 1);
    double worst = 0;
    while (simulation.state().time < .1) {
      simulation.step();
      const State& state = simulation.state();
      worst =
          std::max(worst, std::abs(speed_on(c.angle, state) - (c.speed - slowing * state.time)));
    }
    CHECK(worst < 1e-8 * slowing * .1);
  }
}

TEST_CASE("blocks of any shape slip at atan(mu) on tilted slopes", "[friction][slow]") {
  for (const auto& [coefficient, block] : {std::pair(.3, test::flat_block()),
                                           {.8, test::flat_block()},
                                           {.4, hexagon()},
                                           {.6, test::two_feet()}}) {
    for (const auto& [share, slides] : {std::pair(.999, false), std::pair(1.001, true)}) {
      const double angle = std::atan(coefficient) * share;
      INFO(coefficient << ", " << block.vertices().size() << " vertices, " << share);
      Model model = tilted(angle, coefficient, 0, block);
      model.contact.damping.normal = .3;
      // What can rest does so from the start; the other one slides when its landing is over.
      Simulation simulation(model, {.end = .4, .settled = !slides}, 1, 1);
      while (simulation.state().time < .2) simulation.step();
      const State early = simulation.state();
      while (simulation.state().time < .4) simulation.step();
      const State& late = simulation.state();
      const double pull = kG * (std::sin(angle) - coefficient * std::cos(angle));
      if (slides) {
        CHECK(speed_on(angle, early) - speed_on(angle, late) == Approx(pull * .2).epsilon(.02));
      } else {
        const Vec2 way(late.pose(1)[0] - early.pose(1)[0], late.pose(1)[1] - early.pose(1)[1]);
        CHECK(way.norm() < 1e-10);
      }
    }
  }
}

TEST_CASE("a closed cycle of sticking gives back what it took", "[friction]") {
  for (const Polygon& block : {test::flat_block(), test::two_feet()}) {
    Model model = shaken(block, 0);
    const double limit = .5 * model.bodies[1].mass * kG;
    for (const double share : {.3, .95}) {
      model = shaken(block, share * limit / 1.25e9 / (block.is_convex() ? 1 : 2));
      Simulation simulation(model, {.end = .05, .settled = true}, 1, 1);
      const double before = simulation.energies().contact;
      double most = 0, work = 0;
      while (simulation.state().time < .05) {
        simulation.step();
        most = std::max(most, simulation.contact_forces()[1].friction);
        work = std::max(work, std::abs(simulation.energies().external_work));
      }
      const Energies e = simulation.energies();
      INFO(block.vertices().size() << " vertices, " << share << ": " << most / limit);
      CHECK(most > .9 * share * limit);
      CHECK(most < limit);
      CHECK(work > 0);
      CHECK(std::abs(e.friction_loss) < 1e-6 * work);
      CHECK(std::abs(e.external_work) < 1e-6 * work);
      CHECK(std::abs(e.contact - before) < 1e-6 * work);
      CHECK(simulation.contact_forces()[1].friction < 1e-6 * limit);
    }
  }
}

TEST_CASE("wheels of other numbers of sides roll", "[friction]") {
  for (const int sides : {32, 128}) {
    const Model model = wheel(sides);
    const RigidBody& body = model.bodies[1];
    Simulation simulation(model, {.end = .5}, 1, 1);
    while (simulation.state().time < .5) simulation.step();
    const State& state = simulation.state();
    const double inertia = body.inertia / (body.mass * .25 * .25);
    const double theory = model.gravity.x() / (1 + inertia) * state.time;
    // Every side knocks on the slope, at an angle of 2 pi / sides.
    const double knocks = 2 * std::pow(2 * M_PI / sides, 2);
    CHECK(state.pose_rate(1)[0] == Approx(theory).epsilon(knocks));
    CHECK(state.pose_rate(1)[2] == Approx(-theory / .25).epsilon(knocks));
  }
}

// Friction mu N on both flanks of an apex, N the pressure of the flat below on them: mu k d^2/r_t
// up while it sinks in, down while it rises, beside the normal force of the closed form.
TEST_CASE("an apex of any angle bounces by either law as its closed form says", "[friction]") {
  const double mu = .1, height = .1;
  for (const double half : {M_PI / 4, .7}) {
    for (const FrictionLaw law : {FrictionLaw::resultant, FrictionLaw::per_edge}) {
      Model model = make_model(mu);
      model.contact.friction_law = law;
      model.gravity = {0, -kG};
      const double x = std::sin(half), y = std::cos(half);
      add(model, "target", Polygon({{-1, 0}, {0, -std::sqrt(3)}, {1, 0}}), Motion::fixed);
      add(model, "falling", Polygon({{0, height}, {x, height + y}, {-x, height + y}}));
      const RigidBody& body = model.bodies[1];
      const double share =
          mu / (std::tan(half) * (1 + std::sin(half) * model.bodies[0].inradius / body.inradius));
      const double stiffness =
          2e9 * std::tan(half) * (1 / model.bodies[0].inradius + std::sin(half) / body.inradius);
      double depth = 0;  // m g (h + d) = (1 + share) stiffness d^3 / 3
      for (int i = 0; i < 60; ++i) {
        depth = std::cbrt(3 * body.mass * kG * (height + depth) / ((1 + share) * stiffness));
      }
      const double lower = (height + depth) * (1 - share) / (1 + share) - depth;
      Simulation simulation(model, {.end = .35, .safety = .05}, 1, 1);
      double top = 0;
      while (simulation.state().time < .35) {
        simulation.step();
        if (simulation.state().time > .2) top = std::max(top, simulation.state().pose(1)[1]);
      }
      top -= body.position.y() - height;
      INFO(half << ": " << top << " " << lower);
      if (law == FrictionLaw::resultant) CHECK(top == Approx(height).epsilon(1e-6));
      if (law == FrictionLaw::per_edge) CHECK(top == Approx(lower).epsilon(.01));
    }
  }
}
