// What time.accuracy promises of impacts, on random ones and on those that have been known to fail.
// APOTHEM_LONG asks for a thousand of each kind and prints a row for docs/verification.md.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "apps/cases/samples.hpp"
#include "lib/dynamics/simulation.hpp"
#include "tests/dynamics/random_impacts.hpp"
#include "tests/support.hpp"

using namespace apothem;
using samples::ImpactKind;
using samples::ImpactResult;
using samples::RandomImpact;

namespace {

struct ImpactRow {
  std::vector<double> errors;  // ascending
  std::int64_t steps = 0, changes = 0;
  std::string worst;  // what the impact with the largest error is
  int missed = 0;     // impacts that ended with an error or in which nothing touched

  void add(double error, const ImpactResult& result, const RandomImpact& impact) {
    if (errors.empty() || error > *std::ranges::max_element(errors)) worst = impact.summary;
    errors.push_back(error);
    steps += result.steps, changes += result.changes;
    missed += result.touched && result.unstable.empty() ? 0 : 1;
  }
  [[nodiscard]] int above(double limit) const {
    return static_cast<int>(
        std::ranges::count_if(errors, [&](double error) { return !(error <= limit); }));
  }
  void print(const std::string& name, double accuracy) {
    if (!test::long_run()) return;
    std::ranges::sort(errors);
    const auto quantile = [&](double q) {
      return errors[static_cast<size_t>(q * static_cast<double>(errors.size() - 1))];
    };
    fmt::print("| {} | {:.0e} | {} | {:.1e} | {:.1e} | {:.1e} | {} |\n", name, accuracy,
               errors.size(), quantile(.5), quantile(.99), errors.back(), steps);
  }
};

int share_of(int few, int many) { return test::long_run() ? many : test::scaled(few); }

void add_polygon_body(Model& model, const Polygon& polygon, const Vec2& velocity) {
  RigidBody body;
  body.name = std::to_string(model.bodies.size());
  set_shape(body, polygon, model);
  body.velocity = velocity;
  model.bodies.push_back(body);
}

Model model_with(double density, double stiffness) {
  Model model;
  model.materials = {{"rock", density}};
  model.contact.normal_stiffness = stiffness;
  return model;
}

double error_at_end(const Model& model, double end, const TimeSettings& time) {
  Simulation simulation(model, time, 1, 1);
  const double kinetic = simulation.energies().kinetic;
  while (simulation.state().time < end) simulation.step();
  return std::abs(simulation.energies().total_error) / kinetic;
}

}  // namespace

TEST_CASE("random impacts of rigid bodies keep the accuracy", "[accuracy_of_impacts][slow]") {
  const int count = share_of(100, 1000);
  for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
    ImpactRow row;
    for (int seed = 1; seed <= count; ++seed) {
      const RandomImpact impact = samples::random_impact(static_cast<std::uint64_t>(seed));
      const ImpactResult result = run_impact(impact, {.accuracy = accuracy});
      row.add(std::abs(result.error), result, impact);
    }
    row.print("rigid", accuracy);
    CAPTURE(accuracy, row.worst, row.changes);
    CHECK(row.missed == 0);
    CHECK(row.above(accuracy) * 100 <= count);
    CHECK(row.above(3 * accuracy) == 0);
  }
}

// Against a step that is 30 times shorter.
TEST_CASE("damped impacts leave the kinetic energy that they should",
          "[accuracy_of_impacts][slow]") {
  const double accuracy = 1e-4;
  const int count = share_of(30, 200);
  const ImpactKind kind{.damping = 1, .least_damping = .02};
  ImpactRow row;
  for (int seed = 1; seed <= count; ++seed) {
    const RandomImpact impact = samples::random_impact(static_cast<std::uint64_t>(seed), kind);
    TimeSettings time{.accuracy = accuracy};
    const ImpactResult result = run_impact(impact, time);
    time.fixed_step = start_step(impact, {.end = impact.time, .accuracy = accuracy}) / 30;
    row.add(std::abs(result.kept - run_impact(impact, time).kept), result, impact);
  }
  row.print("damped", accuracy);
  CAPTURE(row.worst);
  CHECK(row.missed == 0);
  CHECK(row.above(10 * accuracy) * 25 <= count);
  CHECK(row.above(50 * accuracy) == 0);
}

TEST_CASE("friction that only follows an impact is not in its energy error",
          "[accuracy_of_impacts]") {
  // A square lands flat, obliquely and turning a little: it slides and sticks, and a corner leaves
  // before the other one. The error falls with the order 4 or more of the step.
  Model model = model_with(2000, 4e9);
  add_polygon_body(model, samples::block(-3, -1, 3, 1), Vec2::Zero());
  model.bodies.back().motion = Motion::fixed;
  add_polygon_body(model, samples::block(-.3, 1.002, .3, 1.602), {.4, -1});
  model.bodies.back().spin = .05;
  for (const double mu : {.1, .3, .7}) {
    model.contact.friction = {mu, .8 * model.contact.normal_stiffness};
    const auto error = [&](double safety) {
      return error_at_end(model, .02, {.end = .02, .safety = safety});
    };
    CAPTURE(mu);
    CHECK(error(.16) < 1e-4);
    CHECK(error(.04) < 1e-6);
  }
}

TEST_CASE("the step does not change while two bodies touch", "[accuracy_of_impacts]") {
  // Two free boxes, of which one has half the mass.
  Model boxes = model_with(1000, 1e9);
  add_polygon_body(boxes, samples::block(-.101, -.05, -.001, .05), {5, 0});
  add_polygon_body(boxes, samples::block(0, -.1, .1, .1), {-5, 0});
  // A wheel falls on a floor: many short edges touch at once.
  Model wheel = model_with(1000, 2e8);
  wheel.gravity = {0, -9.81};
  add_polygon_body(wheel, samples::block(-1, -.5, 1, 0), Vec2::Zero());
  wheel.bodies.back().motion = Motion::fixed;
  add_polygon_body(wheel, samples::shifted(samples::scaled(samples::regular(32), .1), {0, .3}),
                   {0, -3});
  // Two wheels of 100 corners.
  Model wheels = model_with(1000, 1e9);
  add_polygon_body(wheels, samples::scaled(samples::regular(100), .5), {10, 0});
  add_polygon_body(
      wheels, samples::shifted(samples::scaled(samples::regular(100), .5), {1.002, .1}), {-10, 0});
  for (const Model* model : {&boxes, &wheel, &wheels}) {
    for (const double friction : {0., .4}) {
      Model rough = *model;
      if (friction > 0) {
        rough.contact.friction = {friction, .8 * rough.contact.normal_stiffness};
      }
      const double end = model == &wheel ? .2 : .01;
      Simulation simulation(rough, {.end = end}, 1, 1);
      double most = 0;
      while (simulation.state().time < end) {
        simulation.step();
        most = std::max(most, simulation.energies().kinetic);
      }
      CHECK(simulation.extremes().penetration.value > 0);
      CHECK(simulation.step_changes().shortened == 0);
      CHECK(std::abs(simulation.energies().total_error) < 1e-4 * most);
    }
  }
}

TEST_CASE("a row of squares hands on its energy", "[accuracy_of_impacts]") {
  Model model = model_with(1000, 1e9);
  for (int i = 0; i < 5; ++i) {
    const double x = i * (1 + 1e-6);
    add_polygon_body(model, samples::block(x, -.5, x + 1, .5), {i == 0 ? 1. : 0., 0});
  }
  for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
    CAPTURE(accuracy);
    CHECK(error_at_end(model, .1, {.end = .1, .accuracy = accuracy}) < 3 * accuracy);
  }
}

TEST_CASE("vertices in the middle of edges and the order of bodies do not drive the step",
          "[accuracy_of_impacts]") {
  const auto step = [](bool divided, bool swapped) {
    Model model = model_with(2000, 1e9);
    model.contact.friction = {.3, 8e8};
    std::vector<Vec2> ring{{-.5, .1}, {.5, .1}, {.5, .9}, {-.5, .9}};
    if (divided) ring = {{-.5, .1}, {-.2, .1}, {.4, .1}, {.5, .1}, {.5, .9}, {0, .9}, {-.5, .9}};
    const Polygon floor = samples::block(-2, -1, 2, 0);
    const auto add_floor = [&] {
      add_polygon_body(model, floor, Vec2::Zero());
      model.bodies.back().motion = Motion::fixed;
    };
    if (!swapped) add_floor();
    add_polygon_body(model, Polygon(ring), {0, -1});
    add_polygon_body(model, samples::shifted(Polygon(ring), {0, 1}), {0, -1});
    if (swapped) add_floor();
    return Simulation(model, {.end = 1}, 1, 1).step_choice().stability;
  };
  CHECK(step(true, false) == Approx(step(false, false)).epsilon(1e-6));
  CHECK(step(false, true) == Approx(step(false, false)).epsilon(1e-12));
}
