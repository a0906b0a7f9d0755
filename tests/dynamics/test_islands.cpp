// Islands at rest: what is not computed must not be seen in any result.
#include <catch2/catch.hpp>
#include <cmath>

#include "apps/cases/samples.hpp"
#include "lib/dynamics/islands.hpp"
#include "lib/dynamics/simulation.hpp"
#include "tests/dynamics/surface_models.hpp"
#include "tests/dynamics/term_of.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace islands {
namespace {

constexpr int kStacks = 3, kHigh = 3;
constexpr double kGravity = 9.81, kUp = 14, kEnd = 6;  // m/s^2, m/s, s

struct Kind {
  const char* name;
  bool feet;  // bodies that touch in two places
  double friction;
  FrictionLaw law;
  ContactDamping damping;
};

std::vector<Kind> kinds() {
  const ContactDamping none, viscous{.2, .2, 0};
  return {{"smooth blocks", false, 0, FrictionLaw::resultant, none},
          {"rough blocks", false, .5, FrictionLaw::resultant, none},
          {"rough blocks, a spring per edge", false, .5, FrictionLaw::per_edge, none},
          {"rough blocks with dashpots", false, .5, FrictionLaw::resultant, viscous},
          {"smooth tables", true, 0, FrictionLaw::resultant, none},
          {"rough tables", true, .5, FrictionLaw::resultant, none},
          {"rough tables with dashpots", true, .5, FrictionLaw::resultant, viscous}};
}

// A table, or a block, of 1 m x .6 m.
Polygon piece(bool feet, double x, double y) {
  if (!feet) return samples::block(x, y, x + 1, y + .6);
  return samples::shifted(
      Polygon({{0, 0}, {.3, 0}, {.3, .2}, {.7, .2}, {.7, 0}, {1, 0}, {1, .6}, {0, .6}}), {x, y});
}

// Stacks on a floor, each block a little beside the one below it, and a last body, the ball, which
// lies on the floor as well, left of them. It is always rough.
Model stacks(SeededRandom& random, const Kind& kind) {
  Model model;
  model.materials = {{"stone", 2000}};
  model.gravity = {0, -kGravity};
  model.contact.normal_stiffness = 1e7;
  model.contact.friction.coefficient = kind.friction;
  model.contact.friction.stiffness_ratio = kind.friction > 0 ? 1 : 0;
  model.contact.friction_law = kind.law;
  model.contact.damping = kind.damping;
  add_body(model, samples::block(-5, -1, 12, 0), Motion::fixed);
  for (int i = 0; i < kStacks; ++i) {
    for (int j = 0; j < kHigh; ++j) {
      RigidBody& body = add_body(
          model, piece(kind.feet, 3 * i + random.uniform(0, .05), .6 * j - 1e-4 * (j + 1)));
      body.held[0] = kind.friction == 0;  // or it could be anywhere
    }
  }
  add_body(model, samples::block(-2, -1e-4, -1.5, .5));
  ContactRule rough;
  rough.between = {{{true, 0}, {true, static_cast<int>(model.bodies.size()) - 1}}};
  rough.friction.emplace().coefficient = .5;
  rough.friction->stiffness_ratio = 1;
  model.contact.rules.push_back(rough);
  return model;
}

TimeSettings settled(TimeScheme scheme) {
  TimeSettings time;
  time.end = kEnd;
  time.scheme = scheme;
  time.settled = true;
  return time;
}

// Throws the ball up, so that it comes down on the top of stack `target`, or beside all of them
// for -1.
void launch(Simulation& simulation, int target) {
  std::vector<double> v(simulation.state().v.size(), 0);
  const size_t ball = v.size() - 3;
  const double rise = .6 * kHigh;
  const double flight = (kUp + std::sqrt(kUp * kUp - 2 * kGravity * rise)) / kGravity;
  v[ball] = target < 0 ? -.5 : (3 * target + .5 + 1.75) / flight;
  v[ball + 1] = kUp;
  simulation.set_velocities(v);
}

void run_until(Simulation& simulation, double time) {
  while (simulation.state().time < time - 1e-12) simulation.step(time);
}

std::int64_t resting(const Simulation& simulation) { return simulation.islands()->count(); }

bool rests(const Simulation& simulation, int stack) {
  const auto& flags = simulation.islands()->resting();
  const auto first = flags.begin() + 1 + stack * kHigh;
  return std::all_of(first, first + kHigh, [](auto flag) { return flag != 0; });
}

// The weight of all bodies, N.
double weight(const Model& model) {
  double sum = 0;
  for (const RigidBody& body : model.bodies) {
    if (body.motion == Motion::free) sum += kGravity * body.mass;
  }
  return sum;
}

void check_same_reports(const Simulation& one, const Simulation& other) {
  const double all = weight(one.model());
  const State& a = one.state();
  const State& b = other.state();
  for (size_t c = 0; c < a.x.size(); ++c) {
    CHECK(std::abs(a.x[c] - b.x[c]) < 1e-9);
    CHECK(std::abs(a.f[c] - b.f[c]) < 1e-6 * all);
  }
  const std::vector<ContactRecord> ours = one.contacts(), theirs = other.contacts();
  REQUIRE(ours.size() == theirs.size());
  for (size_t i = 0; i < ours.size(); ++i) {
    CHECK(ours[i].a == theirs[i].a);
    CHECK(ours[i].b == theirs[i].b);
    CHECK((ours[i].normal - theirs[i].normal).norm() < 1e-6 * all);
    CHECK((ours[i].tangential - theirs[i].tangential).norm() < 1e-6 * all);
    CHECK(std::abs(ours[i].penetration - theirs[i].penetration) < 1e-9);
  }
  CHECK(one.counts().touching_now == other.counts().touching_now);
  CHECK(springs(one).size() == springs(other).size());
  const Energies e = one.energies(), f = other.energies();
  CHECK(e.contact == Approx(f.contact).epsilon(1e-6));
  CHECK(std::abs(e.gravity - f.gravity) < 1e-6 * all);
  const Momenta p = one.momenta();
  CHECK(std::abs(p.x_error) < 1e-9 * all);
  CHECK(std::abs(p.y_error) < 1e-9 * all);
  CHECK(std::abs(p.angular_error) < 1e-8 * all);
}

}  // namespace
}  // namespace islands

TEST_CASE("islands at rest tell the same as if they were computed, until something comes near",
          "[islands]") {
  SeededRandom random(51);
  for (const islands::Kind& kind : islands::kinds()) {
    INFO(kind.name);
    const Model model = islands::stacks(random, kind);
    Simulation automatic(model, islands::settled(TimeScheme::automatic), 1, 1);
    Simulation verlet(model, islands::settled(TimeScheme::verlet), 1, 1);
    const int target = random.whole(0, islands::kStacks - 1);
    for (Simulation* simulation : {&automatic, &verlet}) islands::launch(*simulation, target);
    islands::run_until(automatic, .3);
    islands::run_until(verlet, .3);
    CHECK(islands::resting(automatic) == islands::kStacks * islands::kHigh);
    islands::check_same_reports(automatic, verlet);
    // The ball has hit its stack, and the others have not noticed.
    double time = .3;
    while (islands::rests(automatic, target) && time < islands::kEnd / 2)
      islands::run_until(automatic, time += .001);
    for (int i = 0; i < islands::kStacks; ++i) {
      CHECK(islands::rests(automatic, i) == (i != target));
    }
    CHECK(automatic.islands()->woken() == islands::kHigh);
    time += .03;
    islands::run_until(automatic, time);
    islands::run_until(verlet, time);
    const State& a = automatic.state();
    const State& b = verlet.state();
    REQUIRE(a.time == Approx(b.time));
    CHECK(std::abs(a.v.back() - b.v.back()) < 1e-4);
    CHECK(b.v[b.v.size() - 2] > -islands::kUp + 1);  // it has been slowed down
    for (size_t c = 0; c < a.x.size(); ++c) CHECK(std::abs(a.x[c] - b.x[c]) < 1e-6);
    const Energies e = automatic.energies();
    CHECK(std::abs(e.numerical_loss) < 1e-6 * islands::weight(model));
    CHECK(automatic.momenta().y_error == Approx(0).margin(1e-9 * islands::weight(model)));
  }
}

TEST_CASE("islands at rest: what comes from outside wakes them", "[islands]") {
  SeededRandom random(52);
  const islands::Kind kind = islands::kinds()[1];
  Model model = islands::stacks(random, kind);
  model.world.box = {-100, -100, 100, 100};
  model.world.outside = World::Outside::remove;
  Simulation simulation(model, islands::settled(TimeScheme::automatic), 1, 1);
  islands::launch(simulation, -1);
  islands::run_until(simulation, .3);
  REQUIRE(islands::resting(simulation) == islands::kStacks * islands::kHigh);
  const double error = simulation.energies().total_error;

  SECTION("given velocities") {
    std::vector<double> v = simulation.state().v;
    v[3] += .1;  // of the lowest block of the first stack
    simulation.set_velocities(v);
    CHECK(islands::resting(simulation) == 0);
    islands::run_until(simulation, .31);
    CHECK(std::abs(simulation.state().v[3]) > 0);
  }
  SECTION("a body that is taken out") {
    const std::vector<BodyIndex> lowest{1};
    simulation.change_population(lowest, {});
    CHECK(islands::resting(simulation) == 0);
    islands::run_until(simulation, .5);
    CHECK(simulation.state().v[7] < -1);  // the second one falls
    CHECK(islands::rests(simulation, 1));
    CHECK(islands::rests(simulation, 2));
  }
  const Energies e = simulation.energies();
  CHECK(std::abs(e.total_error - error) < 1e-4 * islands::weight(model));
  CHECK(std::abs(simulation.momenta().y_error) < 1e-9 * islands::weight(model));
}

TEST_CASE("islands at rest: nothing rests beside a body of prescribed motion", "[islands]") {
  SeededRandom random(53);
  Model model = islands::stacks(random, islands::kinds()[1]);
  RigidBody& driven = add_body(model, samples::block(1.06, .01, 1.2, .5), Motion::prescribed);
  driven.history.velocity = {{0, {0, 0}}, {2, {0, 0}}, {3, {1, 0}}};
  Simulation simulation(model, islands::settled(TimeScheme::automatic), 1, 1);
  std::vector<double> v(simulation.state().v.size(), 0);
  v[v.size() - 5] = islands::kUp;
  simulation.set_velocities(v);
  islands::run_until(simulation, .3);
  CHECK_FALSE(islands::rests(simulation, 0));
  CHECK(islands::rests(simulation, 1));
}

TEST_CASE("islands at rest: slow motion is not taken for rest beyond the accuracy", "[islands]") {
  // Without gravity and contact, at constant speed: whatever is held has been left behind by less
  // than what the accuracy allows at the end of the run.
  SeededRandom random(54);
  for (int n = 0; n < scaled(40); ++n) {
    Model model;
    model.materials = {{"stone", 2000}};
    model.contact.normal_stiffness = 1e8;
    TimeSettings time = islands::settled(TimeScheme::automatic);
    time.settled = false;
    time.accuracy = std::pow(10, random.uniform(-5, -1));
    const double speed = std::pow(10, random.uniform(-9, 0)), way = .5 * time.accuracy;
    add_body(model, samples::block(0, 0, 1, 1)).velocity = {speed, 0};
    add_body(model, samples::block(5, 0, 6, 1)).velocity = {0, 0};
    add_body(model, samples::block(-5, 0, -4, 1)).velocity = {-3, 0};
    Simulation simulation(model, time, 1, 1);
    islands::run_until(simulation, time.end);
    CAPTURE(speed, time.accuracy);
    CHECK(std::abs(simulation.state().x[0] - .5 - speed * time.end) < way);
    CHECK(simulation.islands()->is_resting(1));
    CHECK_FALSE(simulation.islands()->is_resting(2));
  }
}

TEST_CASE("islands at rest: nothing rests where a term of the user acts", "[islands]") {
  // It pushes the lowest block of the first stack after a while.
  struct Push final : Term {
    [[nodiscard]] std::string describe() const override { return "push"; }
    void add_forces(const Evaluation& now) override {
      if (now.state.time > .3) now.state.f[3] += 1e5;
    }
  };
  SeededRandom random(55);
  const Model model = islands::stacks(random, islands::kinds()[1]);
  Simulation simulation(model, islands::settled(TimeScheme::automatic), 1, 1);
  islands::launch(simulation, -1);
  islands::run_until(simulation, .2);
  REQUIRE(islands::resting(simulation) > 0);
  simulation.add(std::make_unique<Push>());
  CHECK(islands::resting(simulation) == 0);
  islands::run_until(simulation, .35);
  CHECK(islands::resting(simulation) == 0);
  CHECK(simulation.state().v[3] > .1);
}
