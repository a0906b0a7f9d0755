// Contact beyond the collars in motion: bodies squeezed to half between plates, soft impacts many
// collars deep, fins and membranes, and a tip that is driven through a plate.
#include <catch2/catch.hpp>

#include "apothem/dynamics/unstable.hpp"
#include "apothem/mesh/rectangle_mesh.hpp"
#include "dynamics/surface_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

Model soft_model(double stiffness) {
  Model model = empty_model();
  model.materials = {{"rubber", 1000, {ElasticLaw::neo_hookean, Plane::strain, 1e6, .3}}};
  model.contact.normal_stiffness = stiffness;
  return model;
}

// Plates that approach each other at a speed until only half of the height is left.
void add_plates(Model& model, double height, double speed) {
  for (const double side : {-1., 1.}) {
    RigidBody plate;
    plate.name = side < 0 ? "lower" : "upper";
    plate.motion = Motion::prescribed;
    plate.prescribed.vx = plate.prescribed.omega = {};
    set_shape(plate, side < 0 ? samples::block(-2, -.4, 2, 0) : samples::block(-2, height, 2, height + .4), model);
    plate.velocity = {0, -side * speed / 2};
    model.bodies.push_back(plate);
  }
}

struct Run {
  double energy = 0, momentum = 0;  // largest errors, J and N s
  double contact = 0;               // largest energy of the contact, J
  double work = 0;                  // largest energy at all, J
  double penetration = 0;           // m
  std::string what;                 // why it stopped early
};

Run run(const Model& model, double safety, double end) {
  TimeSettings time;
  time.end = end;
  time.element_safety = time.safety = safety;
  Simulation simulation(model, time, 1, 1);
  Run result;
  try {
    while (simulation.state().time < end) {
      simulation.step();
      const Energies e = simulation.energies();
      const Momenta p = simulation.momenta();
      result.energy = std::max(result.energy, std::abs(e.total_error));
      for (const double error : {p.x_error, p.y_error, p.angular_error}) {
        result.momentum = std::max(result.momentum, std::abs(error));
      }
      result.contact = std::max(result.contact, e.contact);
      result.work = std::max(result.work, e.kinetic + e.contact + e.elastic);
    }
  } catch (const Unstable& error) {
    result.what = error.what();
  }
  result.penetration = simulation.contact_peaks().penetration.value;
  return result;
}

}  // namespace
