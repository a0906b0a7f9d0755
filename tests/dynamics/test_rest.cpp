// Heaps of rigid blocks that should rest, and move beyond their limit.
#include <catch2/catch.hpp>
#include <cmath>

#include <fmt/format.h>

#include "lib/dynamics/simulation.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace heaps {
namespace {

Model empty() {
  Model model;
  model.materials = {{"stone", 2000}, {"lead", 2e6}};
  model.contact.normal_stiffness = 2e8;
  model.contact.damping = {.2, .2, .1};
  return model;
}

void add(Model& model, const Polygon& polygon, Motion motion = Motion::free,
         MaterialIndex material = 0) {
  RigidBody body;
  body.name = std::to_string(model.bodies.size());
  body.motion = motion;
  body.material = material;
  set_shape(body, polygon, model);
  model.bodies.push_back(body);
}

// Gravity on a slope along x, and friction of which it takes up this share.
void tilt(Model& model, double tangent, double share) {
  const double angle = std::atan(tangent);
  model.gravity = {9.81 * std::sin(angle), -9.81 * std::cos(angle)};
  model.contact.friction = {tangent / share, 1.2e8};
}

void add_floor(Model& model) { add(model, samples::block(-10, -2, 30, 0), Motion::fixed); }

Model stack(double share) {
  Model model = empty();
  tilt(model, .02, share);  // it falls over at .05
  add_floor(model);
  for (int i = 0; i < 20; ++i) add(model, samples::block(-.5, i, .5, i + 1));
  return model;
}

// A block of a thousand times the density on a light one.
Model ratio(double share) {
  Model model = empty();
  tilt(model, std::tan(M_PI / 9), share);
  add_floor(model);
  add(model, samples::block(-.5, 0, .5, .2));
  add(model, samples::block(-.5, .2, .5, .4), Motion::free, 1);
  return model;
}

// Courses of bricks that overlap by half: a quarter of them in short runs.
Model wall(double share) {
  const int size = long_run() ? 10 : 5;
  Model model = empty();
  tilt(model, .1, share);
  add_floor(model);
  for (int course = 0; course < size; ++course) {
    for (int k = 0; k < size + course % 2; ++k) {
      const double x0 = course % 2 == 0 ? k : std::max(0., k - .5);
      const double x1 = course % 2 == 0 ? k + 1 : std::min<double>(size, k + .5);
      add(model, samples::block(x0, .4 * course, x1, .4 * (course + 1)));
    }
  }
  return model;
}

// Rows of blocks on a slope, with joints along and across it: half of them in short runs.
Model jointed_slope(double share) {
  Model model = empty();
  tilt(model, std::tan(26.5 * M_PI / 180), share);
  add_floor(model);
  for (int i = 0; i < (long_run() ? 8 : 4); ++i) {
    for (int j = 0; j < 4; ++j) {
      add(model, samples::block(1.5 * i, .5 * j, 1.5 * (i + 1), .5 * (j + 1)));
    }
  }
  return model;
}

// Cards that lean against each other, with ends cut level and upright. Each foot pushes outwards
// with half the weight of a card times dx/dy.
void add_tent(Model& model, double x, double y, double dx, double dy, double foot) {
  add(model, Polygon({{x - dx - foot, y}, {x - dx, y}, {x, y + dy - foot * dy / dx}, {x, y + dy}}));
  add(model, Polygon({{x + dx, y}, {x + dx + foot, y}, {x, y + dy}, {x, y + dy - foot * dy / dx}}));
}

Model card_house(double share) {
  Model model = empty();
  model.gravity = {0, -9.81};
  add_floor(model);
  add_tent(model, 0, 0, .4, 1, .03);
  // The weight W of a card pushes out with W/2 dx/dy, from the middle of the card to its top.
  model.contact.friction = {.2 / share, 1.2e8};
  return model;
}

struct Moves {
  double speed = 0, sum = 0;  // the largest of any vertex at the end; of mass centres, m/s
  double error = 0;
};

double largest_speed(const Simulation& simulation, size_t bodies) {
  double speed = 0;
  for (size_t i = 0; i < bodies; ++i) {
    const auto rate = simulation.state().pose_rate(static_cast<RigidIndex>(i));
    speed = std::max(speed, std::hypot(rate[0], rate[1]) + std::abs(rate[2]));
  }
  return speed;
}

// Long runs, whose numbers are printed, go on to their end; others until nothing has moved for a
// second.
Moves run(const Model& model, double end, bool settled) {
  Simulation simulation(model, {.end = end, .settled = settled}, 1, 1);
  double rest_since = 0;
  while (simulation.state().time < std::min(end, long_run() ? end : rest_since + 1)) {
    simulation.step();
    if (largest_speed(simulation, model.bodies.size()) > 1e-6) rest_since = simulation.state().time;
  }
  Moves moves;
  moves.speed = largest_speed(simulation, model.bodies.size());
  const Energies e = simulation.energies();
  moves.error = std::abs(e.total_error) / (e.friction_loss + e.damping_loss);
  return moves;
}

}  // namespace

namespace {

// At rest below its limit, and on the move beyond it. Under the sanitizers only the first steps.
void check_heap(const char* name, Model (*model)(double), double end, bool settled) {
  if (kSanitized) {
    const Moves first = run(model(.9), .02, false);
    CHECK(std::isfinite(first.speed));
    return;
  }
  const Moves rests = run(model(.9), end, settled);
  const Moves moves = run(model(1.1), 1, false);
  if (long_run()) {
    fmt::print("{}: rest {:.1e} m/s, error {:.1e} of what is lost; beyond the limit {:.2f} m/s\n",
               name, rests.speed, rests.error, moves.speed);
  }
  CAPTURE(name, rests.speed, moves.speed);
  CHECK(rests.speed < 1e-6);
  CHECK(moves.speed > 1e-2);
}

}  // namespace

// With gravity at once heaps slip and rock first; the stack falls over, and starts settled.
TEST_CASE("a stack of twenty rests", "[rest]") { check_heap("stack", stack, 2, true); }
TEST_CASE("a heavy block on a light one rests", "[rest]") { check_heap("ratio", ratio, 12, false); }
TEST_CASE("a dry-stone wall rests", "[rest]") { check_heap("wall", wall, 8, false); }
TEST_CASE("a jointed slope rests", "[rest]") {
  check_heap("jointed slope", jointed_slope, 16, false);
}
TEST_CASE("a card house rests", "[rest]") { check_heap("card house", card_house, 8, false); }

}  // namespace heaps
