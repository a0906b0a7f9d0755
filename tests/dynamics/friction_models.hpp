// Blocks on slopes and the like, for the tests of friction.
#pragma once

#include "lib/dynamics/simulation.hpp"
#include "tests/support.hpp"

namespace apothem::test {

inline constexpr double kG = 9.81;

inline Model make_model(double coefficient, double tangential_stiffness = 1.25e9) {
  Model model;
  model.materials = {{"rock", 2500}};
  model.contact.normal_stiffness = 2e9;
  model.contact.friction = {coefficient, tangential_stiffness};
  return model;
}

inline void add(Model& model, const std::string& name, const Polygon& polygon,
                Motion motion = Motion::free) {
  RigidBody body;
  body.name = name;
  body.motion = motion;
  set_shape(body, polygon, model);
  model.bodies.push_back(body);
}

inline Polygon flat_block() { return samples::block(-.25, 0, .25, .125); }

// A block with two feet, 0.5 m wide: a U upside down, on y = 0.
inline Polygon two_feet() {
  return Polygon({{-.25, 0},
                  {-.15, 0},
                  {-.15, .05},
                  {.15, .05},
                  {.15, 0},
                  {.25, 0},
                  {.25, .125},
                  {-.25, .125}});
}

/// A block (standing on y = 0) on a slope of that angle along x: gravity is tilted.
inline Model incline(double angle, double coefficient, double speed, double tangential_stiffness,
                     const Polygon& block = flat_block()) {
  Model model = make_model(coefficient, tangential_stiffness);
  model.gravity = {-kG * std::sin(angle), -kG * std::cos(angle)};
  add(model, "slope", samples::block(-10, -1, 20, 0), Motion::fixed);
  add(model, "block", block);
  model.bodies[1].velocity = {speed, 0};
  return model;
}

}  // namespace apothem::test
