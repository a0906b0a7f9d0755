// Damping in proportion to the mass.
#include <catch2/catch.hpp>

#include "mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("mass damping slows meshes and rigid bodies alike", "[deformable]") {
  Model model = model_of(block({1, .1}, {10, 1}, ElementKind::quad4), rock());
  model.contact.mass_damping = 30;
  model.materials[0].mass_damping = 10;
  model.deformables[0].velocity = {2, -1};
  TimeSettings time;
  time.end = .02;
  Simulation simulation(model, time, 1, 1);
  const double kinetic = simulation.energies().kinetic;
  while (simulation.state().time < time.end) simulation.step();
  const double rest = std::exp(-40 * simulation.state().time);
  const State& state = simulation.state();
  REQUIRE(state.layout.nodes == 22);
  for (int i = 0; i < state.layout.nodes; ++i) {
    CHECK(state.node_velocity(i).x() == Approx(2 * rest).epsilon(1e-9));
    CHECK(state.node_velocity(i).y() == Approx(-rest).epsilon(1e-9));
  }
  const Energies energies = simulation.energies();
  CHECK(energies.damping_loss == Approx(kinetic * (1 - rest * rest)).epsilon(1e-9));
  CHECK(std::abs(energies.total_error) < 1e-9 * kinetic);
}
