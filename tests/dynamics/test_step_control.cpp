#include "lib/dynamics/step_control.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "apps/cases/samples.hpp"
#include "lib/dynamics/unstable.hpp"

using namespace apothem;

namespace {

constexpr double kLimit = 1e-2;  // known before the run, s
constexpr double kSoft = 1.01 * kLimit;
constexpr std::int64_t kWait = 512;  // soft steps before a longer one

struct Controlled {
  Model model;
  std::unique_ptr<StepControl> control;
  State state{Layout{1, 0}};

  explicit Controlled(const TimeSettings& time = {.end = 10, .safety = .1}, int frames = 10) {
    model.materials = {{"rock", 2000}};
    RigidBody body;
    body.name = "wedge";
    set_shape(body, samples::block(0, 0, 1, 1), model);
    model.bodies.push_back(body);
    StepBounds bounds;
    bounds.bodies = {kLimit, "contact"};
    control = std::make_unique<StepControl>(model, time, bounds, frames, false);
  }
  // Steps in which the contacts allow a step of `limit` over the safety.
  void take(std::int64_t steps, double limit) {
    const double lambda = 4 / (limit * limit);
    for (std::int64_t i = 0; i < steps; ++i) {
      control->advance(state);
      control->follow(state, {&lambda, 1});
    }
  }
  [[nodiscard]] double step() const { return control->choice().step; }
};

}  // namespace

TEST_CASE("a step is halved at once and doubled after a while", "[step_control]") {
  Controlled c;
  const double start = c.step();
  CHECK(start == Approx(1e-3));
  c.take(10, kSoft);
  CHECK(c.step() == start);
  c.take(1, kLimit / 3);  // a transient
  CHECK(c.step() == start / 4);
  REQUIRE(c.control->changes().first.size() == 1);
  CHECK(c.control->changes().first[0].body == 0);
  CHECK(c.control->changes().first[0].time == Approx(11e-3));
  c.take(kWait - 10, kSoft);
  CHECK(c.step() == start / 4);
  c.take(20, kSoft);
  CHECK(c.step() == start / 2);
  c.take(kWait + 10, kSoft);
  CHECK(c.step() == start);
  c.take(5 * kWait, 10 * kLimit);
  CHECK(c.step() == start);  // never longer than at the start
  CHECK(c.control->changes().shortened == 1);
  CHECK(c.control->changes().lengthened == 2);
  CHECK(c.control->changes().shortest == start / 4);
}

TEST_CASE("a body between others does not change the step", "[step_control]") {
  Controlled c;
  const double start = c.step();
  c.take(kWait, kLimit / 1.9);
  CHECK(c.step() == start);
}

TEST_CASE("contacts that stay stiff keep the step short", "[step_control]") {
  Controlled c;
  c.take(1, kLimit / 2.1);
  CHECK(c.step() == Approx(5e-4));
  c.take(20 * kWait, kLimit / 2.1);
  CHECK(c.control->changes().lengthened == 0);
}

TEST_CASE("a step that is shortened soon after it was lengthened waits longer", "[step_control]") {
  Controlled c;
  for (int i = 0; i < 20; ++i) c.take(1, kLimit / 2.1), c.take(2 * kWait, kSoft);
  CHECK(c.control->changes().shortened < 8);  // of 20 transients
}

TEST_CASE("whole intervals of the output end with a step, however the step changes",
          "[step_control]") {
  const TimeSettings time{.end = 10, .safety = .1};
  Controlled c(time, 10);
  samples::Random random(3);
  std::vector<double> times;
  while (c.state.time < 10 - 1e-9) {
    const double hard = random.integer(0, 1500) == 0 ? random.uniform(2.1, 5) : .99;
    c.take(1, kLimit / hard);
    times.push_back(c.state.time);
  }
  CHECK(c.control->changes().lengthened > 0);
  for (int k = 1; k <= 10; ++k) {
    const double goal = k;
    const auto nearest = std::min_element(times.begin(), times.end(), [&](double a, double b) {
      return std::abs(a - goal) < std::abs(b - goal);
    });
    CHECK(std::abs(*nearest - goal) < 1e-8);
  }
}

TEST_CASE("a fixed step never changes", "[step_control]") {
  Controlled c({.end = 10, .fixed_step = .9 * kLimit});
  c.take(10, kLimit);
  CHECK(c.step() == .9 * kLimit);
  CHECK_THROWS_AS(c.take(1, kLimit / 2), Unstable);
}

TEST_CASE("the accuracy chooses the step", "[step_control]") {
  const auto step = [](double accuracy) {
    return Controlled(TimeSettings{.end = 10, .accuracy = accuracy}).step();
  };
  CHECK(step(1e-4) == Approx(.16 * kLimit).epsilon(.01));
  CHECK(step(1e-3) > 1.5 * step(1e-4));
  CHECK(step(1e-6) < .5 * step(1e-4));
  CHECK(step(.1) <= .6 * kLimit);
}
