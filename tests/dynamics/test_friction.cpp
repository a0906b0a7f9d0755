// Friction and damping in the step loop: theory of sliding, ledgers, patches.
#include <catch2/catch.hpp>

#include "lib/contact/law/pair_table.hpp"
#include "tests/archive/saved.hpp"
#include "tests/dynamics/friction_models.hpp"
#include "tests/dynamics/term_of.hpp"

using namespace apothem;
using test::add;
using test::incline;
using test::kG;
using test::make_model;
using test::two_feet;

namespace {

double speed_after(Simulation& simulation, double until) {
  while (simulation.state().time < until) simulation.step();
  return simulation.state().pose_rate(1)[0];
}

// Velocity 0.4 s after the block has turned, minus theory.
double reversal_error(double tangential_stiffness) {
  const double angle = .5, coefficient = .3, speed = 3;
  const Model model = incline(angle, coefficient, speed, tangential_stiffness);
  const double up = kG * (std::sin(angle) + coefficient * std::cos(angle));
  const double down = kG * (std::sin(angle) - coefficient * std::cos(angle));
  const double end = speed / up + .4;
  Simulation simulation(model, {.end = end, .settled = true}, 1, 1);
  return speed_after(simulation, end) + down * (simulation.state().time - speed / up);
}

// Two free polygons that hit and rub.
Model collision(double coefficient) {
  Model model = make_model(coefficient);
  add(model, "T", samples::posed(test::triangle_t(), {.15, 1.3}, .4));
  add(model, "Q", samples::posed(test::quad_q(), {0, 0}, 0));
  model.bodies[0].velocity = {.3, -2};
  model.bodies[0].spin = 1;
  model.bodies[1].velocity = {.1, .5};
  model.bodies[1].spin = -.7;
  return model;
}

}  // namespace

TEST_CASE("sliding from equilibrium follows theory", "[friction]") {
  for (const auto& [angle, coefficient, speed] :
       {std::tuple(.5, .2, 4.), std::tuple(.4, .7, 5.), std::tuple(.3, .5, -2.)}) {
    const Model model = incline(angle, coefficient, speed, 1.25e9);
    const double slowing =
        kG * (std::copysign(coefficient * std::cos(angle), speed) + std::sin(angle));
    Simulation simulation(model, {.end = .3, .settled = true}, 1, 1);
    while (simulation.state().time < .3) {
      simulation.step();
      const State& state = simulation.state();
      REQUIRE(std::abs(state.pose_rate(1)[0] - (speed - slowing * state.time)) < 1e-8);
    }
    const RigidBody& block = model.bodies[1];
    // Every step rounds the place, and the roundings add up to a vibration like a random walk.
    const double rounding =
        0x1p-52 * std::abs(simulation.state().pose(1)[0]) * std::sqrt(simulation.own_steps());
    const double depth = simulation.extremes().penetration.value;
    CHECK(simulation.contact_forces()[1].friction ==
          Approx(coefficient * block.mass * kG * std::cos(angle)).epsilon(rounding / depth));
    CHECK(simulation.contact_forces()[0].friction == simulation.contact_forces()[1].friction);
    CHECK(std::abs(simulation.energies().total_error) <
          1e-8 * model.bodies[1].mass * speed * speed / 2);
  }
}

TEST_CASE("the error of a reversal falls as the root of the stiffness", "[friction]") {
  const double soft = reversal_error(1.25e7), stiff = reversal_error(1.25e9);
  INFO(soft << " " << stiff);
  CHECK(std::abs(soft) < .05);
  CHECK(std::abs(soft / stiff) == Approx(10).epsilon(.15));
}

TEST_CASE("a block starts to slide at atan(mu)", "[friction][slow]") {
  const double coefficient = .5;
  for (const auto& [share, slides] : {std::pair(.999, false), std::pair(1.001, true)}) {
    Model model = incline(std::atan(coefficient) * share, coefficient, 0, 1.25e9);
    model.contact.damping.normal = .3;
    Simulation simulation(model, {.end = 1}, 1, 1);
    const double early = speed_after(simulation, .5);
    const double late = speed_after(simulation, 1);
    INFO(early << " " << late);
    CHECK((std::abs(late) > 1e-4) == slides);
    if (slides) {
      const double pull = kG * (std::sin(std::atan(coefficient) * share) -
                                coefficient * std::cos(std::atan(coefficient) * share));
      CHECK(late - early == Approx(-pull * .5).epsilon(.01));
    }
  }
}

TEST_CASE("normal damping keeps the momenta of free bodies", "[friction]") {
  for (const double coefficient : {0., .4}) {
    Model model = collision(coefficient);
    model.contact.damping.normal = .3;
    Simulation simulation(model, {.end = 1}, 1, 1);
    while (simulation.state().time < 1) simulation.step();
    const Momenta p = simulation.momenta();
    const double scale = model.bodies[0].mass * 2;
    CHECK(simulation.energies().damping_loss > .01 * simulation.energies().kinetic);
    CHECK(std::abs(p.x_error) < 1e-12 * scale);
    CHECK(std::abs(p.y_error) < 1e-12 * scale);
    CHECK(std::abs(p.angular_error) < 1e-10 * scale);
  }
}

TEST_CASE("free bodies that rub keep their momenta, and the ledger closes with order 2",
          "[friction]") {
  double errors[2];
  for (const int k : {0, 1}) {
    const Model model = collision(.4);
    Simulation simulation(model, {.end = 1, .safety = k == 0 ? .1 : .05}, 1, 1);
    const double before = simulation.energies().kinetic;
    double worst = 0;
    while (simulation.state().time < 1) {
      simulation.step();
      worst = std::max(worst, std::abs(simulation.energies().total_error));
    }
    const Momenta p = simulation.momenta();
    const double scale = model.bodies[0].mass * 2;
    CHECK(std::abs(p.x_error) < 1e-12 * scale);
    CHECK(std::abs(p.y_error) < 1e-12 * scale);
    CHECK(std::abs(p.angular_error) < 1e-10 * scale);
    const Energies e = simulation.energies();
    CHECK(e.friction_loss > 1e-3 * before);
    CHECK(std::abs(e.total_error) < 1e-5 * before);
    errors[k] = worst;
  }
  INFO(errors[0] << " " << errors[1]);
  CHECK(errors[1] < errors[0] / 3);
}

TEST_CASE("straight approach meets no friction, not even round-off, but per edge it does",
          "[friction]") {
  for (const FrictionLaw law : {FrictionLaw::resultant, FrictionLaw::per_edge}) {
    for (const double half : {.3, .523, 1.1}) {
      Model model = make_model(.1);
      model.contact.friction_law = law;
      model.gravity = {0, -kG};
      const double x = std::sin(half), y = std::cos(half);
      add(model, "target", Polygon({{0, 0}, {-x, -y}, {x, -y}}), Motion::fixed);
      add(model, "falling", Polygon({{0, .01}, {x, .01 + y}, {-x, .01 + y}}));
      model.bodies[1].held = {true, false, true};
      Simulation simulation(model, {.end = .1}, 1, 1);
      double most = 0;
      while (simulation.state().time < .1) {
        simulation.step();
        most = std::max(most, simulation.contact_forces()[1].friction);
      }
      CHECK(simulation.extremes().force.value > 1e4);
      if (law == FrictionLaw::resultant) CHECK(most == 0);
      if (law == FrictionLaw::per_edge) CHECK(most > 100);
      CHECK((simulation.energies().friction_loss > 0) == (law == FrictionLaw::per_edge));
    }
  }
}

TEST_CASE("a spring that only sticks loses nothing and adds nothing", "[friction]") {
  // Pressed on by its held height, to and fro on its spring.
  Model model = make_model(10, 1e8);
  add(model, "floor", samples::block(-10, -1, 20, 0), Motion::fixed);
  add(model, "block", samples::block(-.25, -1e-5, .25, .125));
  model.bodies[1].held = {false, true, true};
  model.bodies[1].velocity = {.001, 0};
  // The plain energy of Verlet wanders by 2 safety^2 of what oscillates.
  Simulation simulation(model, {.end = .1, .safety = .005}, 1, 1);
  const double kinetic = simulation.energies().kinetic;
  double highest = 0, lowest = kinetic, worst = 0;
  while (simulation.state().time < .1) {
    simulation.step();
    const Energies e = simulation.energies();
    REQUIRE(std::abs(e.friction_loss) < 1e-12 * kinetic);  // no more than round-off
    highest = std::max(highest, e.kinetic);
    lowest = std::min(lowest, e.kinetic);
    worst = std::max(worst, std::abs(e.total_error));
  }
  CHECK(lowest < .01 * kinetic);
  CHECK(highest < (1 + 1e-4) * kinetic);
  CHECK(worst < 1e-4 * kinetic);
}

TEST_CASE("a block squeezed in one U-shaped body rubs on both sides", "[friction]") {
  const double d = 1e-4, mu = .3;
  Model model = make_model(mu);
  model.gravity = {0, -200};
  const double w = .5 - d;
  add(model, "U", Polygon({{-2, -3}, {2, -3}, {2, 3}, {w, 3}, {w, -2}, {-w, -2}, {-w, 3}, {-2, 3}}),
      Motion::fixed);
  add(model, "block", samples::block(-.5, -.5, .5, .5));
  Simulation simulation(model, {.end = .05}, 1, 1);
  while (simulation.state().time < .05) simulation.step();
  // Flat on flat: N = k d (W/r_U + (W - d)/r_block) on each side, by the roof height of the U.
  const double normal =
      2e9 * d * (1 / model.bodies[0].inradius + (1 - d) / model.bodies[1].inradius);
  CHECK(simulation.state().force(1)[0] == Approx(0).margin(1e-3 * normal));
  CHECK(simulation.state().force(1)[1] == Approx(2 * mu * normal).epsilon(1e-6));
}

TEST_CASE("springs follow patches that split and merge", "[friction]") {
  // A comb slides over a comb: teeth meet gaps and teeth again.
  Model model = make_model(.3);
  model.gravity = {0, -kG};
  add(model, "lower", samples::comb(6), Motion::fixed);
  std::vector<Vec2> ring = samples::comb(3).vertices();
  for (Vec2& v : ring) v = {v.x() + .3, 6 - v.y()};
  add(model, "upper", Polygon(ring));
  model.bodies[1].velocity = {3, 0};
  model.bodies[1].held = {false, false, true};
  Simulation simulation(model, {.end = .8, .safety = .05}, 1, 1);
  const double before = simulation.energies().kinetic;
  double worst = 0;
  while (simulation.state().time < .8) {
    simulation.step();
    worst = std::max(worst, std::abs(simulation.energies().total_error));
  }
  INFO(worst / before << " after " << simulation.state().pose(1)[0]);
  CHECK(simulation.energies().friction_loss > 0);
  CHECK(worst < 3e-4 * before);
}

TEST_CASE("friction by pair, and none where nobody asks for it", "[friction]") {
  Model model = incline(.3, .8, 2, 1.25e9);
  const auto slowing = [&] {
    Simulation simulation(model, {.end = .1, .settled = true}, 1, 1);
    return (2 - speed_after(simulation, .1)) / simulation.state().time;
  };
  CHECK(slowing() == Approx(kG * (std::sin(.3) + .8 * std::cos(.3))).epsilon(1e-6));
  model.contact.rules.push_back({{{{true, 1}, {false, 0}}}, Friction{.1, 1.25e9}});
  CHECK(slowing() == Approx(kG * (std::sin(.3) + .1 * std::cos(.3))).epsilon(1e-6));
  model.contact.rules.push_back({{{{true, 0}, {true, 1}}}, Friction{.2, 1e9}});
  CHECK(slowing() == Approx(kG * (std::sin(.3) + .2 * std::cos(.3))).epsilon(1e-6));

  for (const double coefficient : {0., .1}) {
    const ContactLaw law = make_model(coefficient).contact;
    CHECK(PairTable(law, {0, 0}, 1).rough() == (coefficient > 0));
  }
}

TEST_CASE("mass damping takes what it says", "[friction]") {
  Model model = collision(0);
  model.contact.mass_damping = 3;
  model.bodies[0].velocity.y() = 2;  // apart: nothing but damping
  Simulation simulation(model, {.end = .2}, 1, 1);
  const double before = simulation.energies().kinetic;
  while (simulation.state().time < .2) simulation.step();
  const Energies e = simulation.energies();
  const double time = simulation.state().time;
  CHECK(e.kinetic == Approx(before * std::exp(-6 * time)).epsilon(1e-12));
  CHECK(e.damping_loss == Approx(before - e.kinetic).epsilon(1e-12));
  CHECK(std::abs(simulation.momenta().y_error) < 1e-9);
}

TEST_CASE("the ledger of friction and normal damping closes in a landing", "[friction]") {
  // A block that lands nearly flat and turns: the energy error over the kinetic energy.
  const auto error = [](double friction, double damping, double safety) {
    Model model = incline(0, friction, .2, 1.25e9);
    model.contact.damping.normal = damping;
    model.bodies[1].position.y() += 1e-4;
    model.bodies[1].velocity = {.2, -1};
    model.bodies[1].spin = 1;
    Simulation simulation(model, {.end = .1, .safety = safety}, 1, 1);
    const double kinetic = simulation.energies().kinetic;
    while (simulation.state().time < .01) simulation.step();
    CHECK(simulation.counts().touching_now == 0);
    const Energies e = simulation.energies();
    CHECK((friction > 0) == (e.friction_loss > 0));
    CHECK((damping > 0) == (e.damping_loss > 0));
    return std::abs(e.total_error) / kinetic;
  };
  for (const auto& [friction, damping] :
       {std::pair(0., .3), std::pair(.3, 0.), std::pair(.3, .1), std::pair(.5, .3)}) {
    CAPTURE(friction, damping);
    // A dashpot begins with a jump of the force, which leaves an error of the order 3.
    const double jump = 1e-3 * damping;
    CHECK(error(friction, damping, .1) < 5e-5 + jump);
    CHECK(error(friction, damping, .2) < 3e-4 + 8 * jump);
    CHECK(error(friction, damping, .35) < 1e-2 + 43 * jump);
  }
}

TEST_CASE("contacts are recorded patch by patch, and their forces sum to the bodies'",
          "[friction]") {
  struct Case {
    Polygon block;
    double friction, damping;
    FrictionLaw law;
    size_t patches;
  };
  const Polygon block = samples::block(-.25, 0, .25, .125);
  for (const Case& c : {Case{two_feet(), 0, 0, FrictionLaw::resultant, 2},
                        {two_feet(), .3, 0, FrictionLaw::resultant, 2},
                        {two_feet(), .3, .2, FrictionLaw::resultant, 2},
                        {two_feet(), .3, .2, FrictionLaw::per_edge, 2},
                        {two_feet(), 0, .2, FrictionLaw::resultant, 2},
                        {block, 0, 0, FrictionLaw::resultant, 1},
                        {block, .3, .2, FrictionLaw::resultant, 1},
                        {block, .3, .2, FrictionLaw::per_edge, 1}}) {
    Model model = make_model(c.friction);
    model.gravity = {-3, -kG};
    model.contact.damping.normal = c.damping;
    model.contact.friction_law = c.law;
    add(model, "slope", samples::block(-10, -1, 20, 0), Motion::fixed);
    add(model, "block", c.block);
    model.bodies[1].velocity = {1, -.01};
    Simulation simulation(model, {.end = 1}, 1, 1);
    while (simulation.extremes().force.value < 2000) simulation.step();
    const std::vector<ContactRecord> records = simulation.contacts();
    REQUIRE(records.size() == c.patches);
    Vec2 sum = Vec2::Zero();
    double sideways = 0;
    for (const ContactRecord& r : records) {
      CHECK((r.a == 0 && r.b == 1));
      CHECK(r.normal.y() < -100);
      CHECK(std::abs(r.normal.x()) < 1e-2 * std::abs(r.normal.y()));
      CHECK(r.penetration > 1e-8);
      CHECK(r.penetration < 1e-3);
      CHECK(r.phi > 0);
      sum -= r.normal + r.tangential + r.damping;
      sideways += r.tangential.x();
    }
    const Eigen::Vector3d force = simulation.state().force(1);
    CHECK(sum.x() == Approx(force.x()).margin(1e-12 * sum.norm()));
    CHECK(sum.y() == Approx(force.y()).epsilon(1e-12));
    CHECK((sideways > 10) == (c.friction > 0));
    if (c.patches == 2)
      CHECK(std::abs(records[1].point.x() - records[0].point.x()) == Approx(.4).margin(.1));
    // The same after a pause.
    Simulation resumed(model, {.end = 1}, 1, 1);
    test::restore(resumed, test::saved(simulation));
    const std::vector<ContactRecord> again = resumed.contacts();
    REQUIRE(again.size() == records.size());
    for (size_t i = 0; i < again.size(); ++i) {
      CHECK(again[i].normal == records[i].normal);
      CHECK(again[i].tangential == records[i].tangential);
    }
  }
}

TEST_CASE("the damping ratio is that of the contact's own oscillation", "[friction]") {
  for (const double ratio : {.02, .1}) {
    Model model = incline(0, 0, 0, 1.25e9);
    model.contact.damping.normal = ratio;
    model.bodies[1].held = {true, false, true};
    const RigidBody& block = model.bodies[1];
    // Pressure of a flat contact of width w: k_n d (w/r_slope + w/r_block).
    const double stiffness = 2e9 * .5 * (1 / model.bodies[0].inradius + 1 / block.inradius);
    const double omega = std::sqrt(stiffness / block.mass);
    const double depth = block.mass * kG / stiffness;
    const double first = block.position.y();
    model.bodies[1].position.y() -= 1.5 * depth;  // half a depth below equilibrium
    Simulation simulation(model, {.end = 1, .safety = .02}, 1, 1);
    const double period = 2 * M_PI / (omega * std::sqrt(1 - ratio * ratio));
    while (simulation.state().time < 3 * period) simulation.step();
    const double left = first - depth - simulation.state().pose(1)[1];
    CHECK(left / (.5 * depth) ==
          Approx(std::exp(-ratio * omega * simulation.state().time)).epsilon(.01));
  }
}

TEST_CASE("a saved simulation carries the springs", "[friction]") {
  const Model model = collision(.4);
  const TimeSettings time{.end = 1};
  Simulation whole(model, time, 1, 1);
  Simulation first(model, time, 1, 1);
  while (test::springs(first).empty() || first.state().step % 7 != 0) first.step();
  for (int i = 0; i < 20; ++i) first.step();
  Simulation second(model, time, 1, 1);
  test::restore(second, test::saved(first));
  while (second.state().time < 1) second.step();
  while (whole.state().time < 1) whole.step();
  CHECK(second.state().x == whole.state().x);
  CHECK(second.state().v == whole.state().v);
  CHECK(second.energies().friction_loss == whole.energies().friction_loss);
}
