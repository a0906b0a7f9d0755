// What time.accuracy promises of impacts of meshed blocks, on random ones: on a fixed rigid floor,
// on a free rigid block, on a free meshed one, and on one that is supported. APOTHEM_LONG asks for
// 200 of each and prints a row for each accuracy.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "lib/dynamics/simulation.hpp"
#include "lib/scene/scene.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using samples::Random;

namespace {

double exp_uniform(Random& random, double a, double b) {
  return std::exp(random.uniform(std::log(a), std::log(b)));
}

std::string floor_of_mesh_impact(Random& random) {
  switch (random.integer(0, 3)) {
    case 0:
      return R"("motion": "fixed", "polygon": [[-3, -1], [3, -1], [3, 0], [-3, 0]])";
    case 1:
      return R"("polygon": [[-0.4, -0.5], [0.5, -0.5], [0.5, 0], [-0.4, 0]])";
    case 2:
      return fmt::format(
          R"("mesh": {{ "rectangle": {{ "size": [0.9, 0.5], "cells": [{}, {}], "origin": [-0.4, -0.5] }} }})",
          random.integer(1, 5), random.integer(1, 4));
    default:
      return fmt::format(
          R"("mesh": {{ "rectangle": {{ "size": [1.5, 0.5], "cells": [{}, {}], "origin": [-0.8, -0.5] }} }},
             "supports": [ {{ "where": {{ "y": -0.5 }}, "fix": ["x", "y"] }} ])",
          random.integer(1, 5), random.integer(1, 4));
  }
}

// A meshed block of .2 to 1 m falls, flat in half of all cases, or tilted by up to half a radian.
std::string mesh_impact(std::uint64_t seed, double accuracy, bool friction) {
  Random random(seed * 7919 + 3);
  const double w = random.uniform(.2, 1), h = random.uniform(.2, 1);
  const int columns = random.integer(1, 6), rows = random.integer(1, 6);
  const double speed = exp_uniform(random, .1, 10), depth = exp_uniform(random, 1e-4, 3e-3);
  const double stiffness = 200 * speed * speed / (depth * depth);
  const double young = stiffness * exp_uniform(random, .3, 30);
  const double ratio = exp_uniform(random, .03, 30);
  const char* element = std::array{"Q4", "T3", "Q4-full", "polygon"}[random.integer(0, 3)];
  double tilt = 0;
  switch (random.integer(0, 3)) {
    case 0:
      tilt = exp_uniform(random, 1e-4, .5);
      break;
    case 1:
      tilt = random.uniform(0, .5);
      break;
    default:;
  }
  const double spin = random.integer(0, 1) == 0 ? 0 : random.uniform(-1, 1) * speed;
  const double aside = random.integer(0, 1) == 0 ? 0 : random.uniform(-.5, .5) * speed;
  const double gap = .01 * std::min(w, h) * random.uniform(0, 1);
  const double reach = w / 2 * std::sin(tilt) + h / 2 * std::cos(tilt);
  const double softer = exp_uniform(random, .1, 10);
  const double mu = friction ? random.uniform(.05, .8) : 0;
  const std::string rubs =
      friction ? fmt::format(R"(, "friction": {{ "coefficient": {}, "tangential_stiffness": {} }})",
                             mu, .5 * stiffness)
               : "";
  return fmt::format(
      R"({{ "materials": {{ "a": {{ "density": 2000, "young": {}, "poisson": 0.2 }},
                            "b": {{ "density": {}, "young": {}, "poisson": 0.2 }} }},
           "contact": {{ "normal_stiffness": {}{} }},
           "bodies": [
             {{ "name": "block", "material": "a", "position": [0, {}], "angle": {}, "velocity": [{}, {}], "spin": {},
                "mesh": {{ "rectangle": {{ "size": [{}, {}], "cells": [{}, {}] }}, "element": "{}" }} }},
             {{ "name": "floor", "material": "b", {} }} ],
           "time": {{ "end": {}, "accuracy": {} }} }})",
      young, 2000 * ratio, young * softer, stiffness, rubs, gap + reach, tilt, aside, -speed, spin,
      w, h, columns, rows, element, floor_of_mesh_impact(random),
      (gap + .25 * std::min(w, h)) / speed, accuracy);
}

}  // namespace

TEST_CASE("random impacts of meshed blocks keep the accuracy", "[accuracy_of_impacts][slow]") {
  const test::Folder folder;
  const int count = test::long_run() ? 200 : test::scaled(40);
  for (const bool friction : {false, true}) {
    // Twelve million steps, each of a few elements, are for the long form.
    for (const double accuracy : {1e-2, 1e-4, 1e-6}) {
      if (accuracy < 1e-5 && !test::long_run()) continue;
      std::vector<double> errors;
      std::int64_t steps = 0;
      int touched = 0;
      for (int seed = 1; seed <= count; ++seed) {
        const Scene scene = read_scene(folder.write(
            "scene.json", mesh_impact(static_cast<std::uint64_t>(seed), accuracy, friction)));
        Simulation simulation(scene.model, scene.time, 1, 1);
        const double kinetic = simulation.energies().kinetic;
        while (simulation.state().time < scene.time.end) simulation.step();
        errors.push_back(std::abs(simulation.energies().total_error) / kinetic);
        steps += simulation.own_steps();
        touched += simulation.extremes().penetration.value > 0 ? 1 : 0;
      }
      std::ranges::sort(errors);
      const auto above = [&](double limit) {
        return std::ranges::count_if(errors, [&](double error) { return !(error <= limit); });
      };
      if (test::long_run()) {
        fmt::print("| meshed{} | {:.0e} | {} | {:.1e} | {:.1e} | {:.1e} | {} |\n",
                   friction ? ", friction" : "", accuracy, count, errors[errors.size() / 2],
                   errors[errors.size() * 99 / 100], errors.back(), steps);
      }
      CAPTURE(friction, accuracy, errors.back());
      CHECK(touched == count);
      CHECK(above(accuracy) * 100 <= std::max(count, 100));
      CHECK(above(3 * accuracy) == 0);
    }
  }
}
