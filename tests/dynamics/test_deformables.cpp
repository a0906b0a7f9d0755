// Bodies of finite elements in motion: free flight, supports, loads, ledgers.
#include <catch2/catch.hpp>
#include <numbers>

#include "dynamics/simulation.hpp"
#include "mesh/rectangle_mesh.hpp"

using namespace apothem;

namespace {

Material rock() {
  return {"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::stress, 20e9, .2}, 0, 0};
}

Model model_of(DeformableBody body, const Material& material) {
  Model model;
  model.materials = {material};
  body.name = "beam";
  model.deformables = {std::move(body)};
  return model;
}

DeformableBody block(const Vec2& size, std::array<int, 2> cells, ElementKind kind) {
  DeformableBody body;
  body.element = kind;
  body.mesh = rectangle_mesh(
      size, cells, {0, 0},
      kind == ElementKind::tri3 ? ElementShape::triangle : ElementShape::quadrilateral);
  return body;
}

}  // namespace

TEST_CASE("a spinning free body keeps energy and momenta over 100 turns", "[deformable]") {
  for (const ElementKind kind :
       {ElementKind::tri3, ElementKind::quad4, ElementKind::quad4_full, ElementKind::polygon}) {
    DeformableBody body = block({1, .5}, {8, 4}, kind);
    body.velocity = {3, -2};
    body.spin = 200;
    const Model model = model_of(body, rock());
    TimeSettings time;
    time.end = 200 * std::numbers::pi / body.spin;
    Simulation simulation(model, time, 10, 1);
    const Energies before = simulation.energies();
    // The centrifugal load comes at once: the body pulses, and Verlet's energy with it.
    double early = 0, late = 0;
    while (simulation.state().time < time.end) {
      simulation.step();
      if (simulation.state().step % 50 != 0) continue;
      const double error = std::abs(simulation.energies().total_error) / before.kinetic;
      if (simulation.state().time < .1 * time.end) early = std::max(early, error);
      if (simulation.state().time > .9 * time.end) late = std::max(late, error);
    }
    const Momenta p = simulation.momenta();
    INFO(static_cast<int>(kind));
    CHECK(early < 1e-5);
    CHECK(late < 1.05 * early);
    CHECK(std::abs(p.x_error) < 1e-10 * std::abs(p.x));
    CHECK(std::abs(p.angular_error) < 1e-10 * std::abs(p.angular));
  }
}
