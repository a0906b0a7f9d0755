// Loads, supports and gravity on bodies of finite elements.
#include <catch2/catch.hpp>

#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("supports, loads and gravity exchange momentum with what is outside", "[deformable]") {
  DeformableBody body = block({1, .4}, {10, 4}, ElementKind::quad4);
  body.supports = {{nodes_at(body.mesh, 0), {true, false}, {}},
                   {nodes_where(body.mesh, {.nearest = Vec2(0, 0)}), {false, true}, {}}};
  body.supports.push_back({nodes_where(body.mesh, {.nearest = Vec2(1, 0)}), {false, true}, {}});
  body.supports[2].motion.velocity = {{0, {0, 0}}, {1e-3, {0, .5}}};
  body.dead_loads = {{{nodes_where(body.mesh, {.nearest = Vec2(1, .4)})}, {{3e6, 1e6}}, {}}};
  body.dead_loads[0].history.points = {{0, 0}, {5e-4, 1}};
  for (const MeshEdge& e : edges_where(body.mesh, {.y = .4})) {
    if (body.pressures.empty()) body.pressures.push_back({{}, 2e7, {}});
    body.pressures[0].edges.push_back(e.nodes);
  }
  Model model = model_of(std::move(body), rock());
  model.gravity = {100, -1000};
  TimeSettings time;
  time.end = 2e-3;
  time.element_safety = .1;
  Simulation simulation(model, time, 1, 1);
  while (simulation.state().time < time.end) simulation.step();
  const Momenta p = simulation.momenta();
  const Energies e = simulation.energies();
  CHECK(std::abs(p.x_error) < 1e-9 * std::hypot(p.x, p.y));
  CHECK(std::abs(p.y_error) < 1e-9 * std::hypot(p.x, p.y));
  CHECK(std::abs(p.angular_error) < 1e-9 * std::hypot(p.x, p.y));
  CHECK(std::abs(e.total_error) < 1e-3 * e.kinetic);
}
