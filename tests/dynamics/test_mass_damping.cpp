// Damping in proportion to the mass.
#include <catch2/catch.hpp>

#include "tests/dynamics/mesh_models.hpp"

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

TEST_CASE("mass damping has the same bits for any number of threads", "[deformable][parallel]") {
  // A body of one material and one of two, with so many nodes that threads divide them.
  Model model = model_of(block({1.2, 1}, {120, 100}, ElementKind::quad4), rock());
  model.materials.push_back(rock());
  model.materials[0].mass_damping = 10;
  model.materials[1].mass_damping = 20;
  model.contact.mass_damping = 5;
  model.deformables[0].velocity = {2, -1};
  DeformableBody second = model.deformables[0];
  second.name = "second";
  for (Vec2& node : second.mesh.nodes) node.x() += 3;
  second.first_node = static_cast<int>(second.mesh.nodes.size());
  for (ElementIndex e = 0; e < second.mesh.element_count(); ++e) {
    second.element_material.push_back(e % 2);
  }
  model.deformables.push_back(second);
  State first{Layout{0, 0}};
  Energies energies;
  Momenta momenta;
  for (const int threads : {1, 3, 7}) {
    if (kSanitized && threads > 3) continue;
    Simulation simulation(model, {.end = 1}, 1, threads);
    const double kinetic = simulation.energies().kinetic;
    for (int i = 0; i < 5; ++i) simulation.step();
    const Energies e = simulation.energies();
    const Momenta p = simulation.momenta();
    CHECK(e.damping_loss > 0);
    CHECK(std::abs(e.total_error) < 1e-9 * kinetic);
    CHECK(std::abs(p.x_error) < 1e-10 * std::abs(p.x));
    CHECK(std::abs(p.angular_error) < 1e-9 * std::abs(p.angular));
    if (threads == 1) {
      first = simulation.state(), energies = e, momenta = p;
      continue;
    }
    CHECK((simulation.state().x == first.x));
    CHECK((simulation.state().v == first.v));
    CHECK(e.damping_loss == energies.damping_loss);
    CHECK(p.x_error == momenta.x_error);
    CHECK(p.y_error == momenta.y_error);
    CHECK(p.angular_error == momenta.angular_error);
  }
}
