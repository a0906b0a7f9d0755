// Random scenes of a few bodies that fall, collide and rub: rigid ones, and in every third scene a
// meshed one. They are short and cost little.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>

namespace apothem::test {

class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : engine_(seed) {}

  [[nodiscard]] std::string text() {
    const int count = 2 + static_cast<int>(below(4));
    const int meshed = below(3) == 0 ? static_cast<int>(below(count)) : -1;
    const double stiffness = std::pow(10, between(6, 8));
    std::string bodies =
        R"({ "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-1, -1], [4, -1], [4, 0], [-1, 0]] })";
    for (int i = 0; i < count; ++i) bodies += body(i, i == meshed);
    const double sideways = between(-3, 3), end = between(.2, 1.5);
    const double accuracy = std::pow(10, between(-4, -1));
    const double interval = end * std::pow(10, between(-3.3, -1.5));
    const std::string rubs = friction(stiffness), damps = damping();
    return fmt::format(
        R"({{ "gravity": [{}, -9.81],
             "materials": {{ "rock": {{ "density": 2000, "young": {}, "poisson": 0.2 }} }},
             "contact": {{ "normal_stiffness": {}{}{} }},
             "bodies": [ {} ],
             "time": {{ "end": {}, "accuracy": {} }},
             "output": {{ "frames": 0, "history": {{ "interval": {} }} }} }})",
        sideways, 10 * stiffness, stiffness, rubs, damps, bodies, end, accuracy, interval);
  }

 private:
  // The distributions of the standard library differ between libraries.
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967296.;
  }
  std::uint32_t below(int count) {
    return static_cast<std::uint32_t>(between(0, static_cast<double>(count)));
  }

  // In a cell of its own of 0.8 m, so that bodies do not overlap at the start.
  std::string body(int i, bool meshed) {
    const double x = .8 * (i % 3) + between(0, .1), y = .42 + .8 * static_cast<int>(i / 3);
    const double radius = between(.1, .35);
    const double vx = between(-4, 4), vy = between(-6, 1), spin = between(-5, 5);
    const std::string speed = fmt::format(R"("velocity": [{}, {}], "spin": {})", vx, vy, spin);
    if (meshed) {
      const double height = between(.1, .3);
      return fmt::format(
          R"(, {{ "name": "body {}", "material": "rock", {}, "mesh": {{ "rectangle": {{ "size": [{}, {}], "cells": [3, 3], "origin": [{}, {}] }} }} }})",
          i, speed, radius, height, x, y);
    }
    const int corners = 3 + static_cast<int>(below(5));
    std::string polygon;
    const double turn = between(0, 1);
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * (k + turn + between(-.2, .2)) / corners;
      polygon += fmt::format("{}[{}, {}]", k == 0 ? "" : ", ", x + radius * std::cos(angle),
                             y + radius * std::sin(angle));
    }
    return fmt::format(R"(, {{ "name": "body {}", "material": "rock", {}, "polygon": [{}] }})", i,
                       speed, polygon);
  }
  std::string friction(double stiffness) {
    if (below(2) == 0) return "";
    const double coefficient = between(.1, .8), tangential = stiffness * between(.1, .6);
    return fmt::format(R"(, "friction": {{ "coefficient": {}, "tangential_stiffness": {} }})",
                       coefficient, tangential);
  }
  std::string damping() {
    if (below(3) > 0) return "";
    return fmt::format(R"(, "damping": {{ "model": "viscous", "ratio": {} }})", between(.02, 1.5));
  }

  std::mt19937 engine_;
};

}  // namespace apothem::test
