// Contact force of two squares that overlap by 0.1 m along a whole side.
#include <cmath>
#include <cstdio>

#include "apothem/dynamics/simulation.hpp"
#include "apothem/geometry/integrals/edge_integral.hpp"

int main() {
  using namespace apothem;
  const Polygon a({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const Polygon b({{0.9, 0}, {1.9, 0}, {1.9, 1}, {0.9, 1}});
  const PairResult pair = edge_method(a, make_potential(a), b, make_potential(b));
  std::printf("force on a for k_n = 1 Pa: %.15g N/m\n", pair.integral.force.x());

  Model model;  // the same square, falling freely
  model.gravity = {0, -9.81};
  model.materials = {{"rock", 2000}};
  RigidBody body;
  body.name = "a";
  set_shape(body, a, model);
  model.bodies.push_back(body);
  Simulation simulation(model, {.end = 1}, 100, 1);
  while (simulation.state().step < 100) simulation.step();
  std::printf("fallen in 1 s: %.15g m\n", body.position.y() - simulation.state().position[1]);
  // On each of the two edges phi = min(0.1, y, 1 - y) / 0.5, with the integral (0.1 - 0.01) / 0.5.
  const bool right = std::abs(pair.integral.force.x() + 0.36) < 1e-14 &&
                     std::abs(body.position.y() - simulation.state().position[1] - 4.905) < 1e-12;
  return right ? 0 : 1;
}
