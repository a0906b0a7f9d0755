// Contact beyond the collars in motion: bodies squeezed to half between plates, soft impacts many
// collars deep, fins and membranes, and a tip that is driven through a plate.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cstdlib>

#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/dynamics/surface_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

Model soft_model(double stiffness) {
  Model model = empty_model();
  model.materials = {{"rubber", 1000, {ElasticLaw::neo_hookean, Plane::strain, 1e6, .3}}};
  model.contact.normal_stiffness = stiffness;
  return model;
}

// Plates on both sides of the height of a body, 0 to `height`, that squeeze it until half of it is
// left.
void add_plates(Model& model, double height, double time) {
  for (const double side : {-1., 1.}) {
    RigidBody plate;
    plate.name = side < 0 ? "lower" : "upper";
    plate.motion = Motion::prescribed;
    const double y = side < 0 ? -.4 : height;
    set_shape(plate, samples::block(-2, y, 2, y + .4), model);
    const double speed = height / 4 / time;
    plate.history.velocity = {{0, {0, 0}}, {time, {0, -2 * side * speed}}};
    model.bodies.push_back(plate);
  }
}

struct DeepRun {
  double energy = 0, momentum = 0;  // largest errors, J and N s
  double strain = 0, contact = 0;   // largest energies, J
  double total = 0;                 // largest sum of the energies, J
  double penetration = 0;           // m
  std::string what;                 // why it stopped early
};

DeepRun run_deep(const Model& model, double safety, double end) {
  TimeSettings time;
  time.end = end;
  time.element_safety = time.safety = safety;
  Simulation simulation(model, time, 1, 1);
  DeepRun result;
  try {
    while (simulation.state().time < end) {
      simulation.step();
      if (simulation.state().step % 5 != 0) continue;
      const Energies e = simulation.energies();
      const Momenta p = simulation.momenta();
      result.energy = std::max(result.energy, std::abs(e.total_error));
      for (const double error : {p.x_error, p.y_error, p.angular_error}) {
        result.momentum = std::max(result.momentum, std::abs(error));
      }
      result.strain = std::max(result.strain, e.strain);
      result.contact = std::max(result.contact, e.contact);
      result.total = std::max(result.total, e.kinetic + e.strain + e.contact);
    }
  } catch (const Unstable& error) {
    result.what = error.what();
  }
  result.penetration = simulation.extremes().penetration.value;
  return result;
}

double collar_of(const Mesh& mesh) {
  OutlineSurfaces outlines;
  outlines.add_mesh(mesh, boundary(mesh), 0);
  return outlines.bodies[0].depth;
}

}  // namespace

TEST_CASE("a block, a disc and a membrane are squeezed to half between plates", "[deep][slow]") {
  struct Squeezed {
    const char* name;
    Mesh mesh;
    ElementKind kind;
    double height;
  };
  const std::vector<Squeezed> bodies{
      {"block", rectangle_mesh({1, .5}, {16, 8}, {-.5, 0}, ElementShape::quadrilateral),
       ElementKind::quad4, .5},
      {"block of T3", rectangle_mesh({1, .5}, {16, 8}, {-.5, 0}, ElementShape::triangle),
       ElementKind::tri3, .5},
      {"disc", disc({0, .5}, Shape::triangles), ElementKind::tri3, 1},
      {"membrane", rectangle_mesh({1, .05}, {20, 1}, {-.5, 0}, ElementShape::quadrilateral),
       ElementKind::quad4, .05},
  };
  for (const Squeezed& body : bodies) {
    // From contact that is much softer than the body, which gives way instead, to a stiff one.
    for (const double stiffness : {2e5, 1e6, 1e7}) {
      Model model = soft_model(stiffness);
      const double time = .04 * body.height;
      add_plates(model, body.height, time);
      add(model, "body", body.mesh, body.kind, {0, 0});
      const DeepRun coarse = run_deep(model, .2, time), fine = run_deep(model, .1, time);
      const double relative = coarse.energy / coarse.total;
      const double depth = coarse.penetration / collar_of(body.mesh);
      CAPTURE(body.name, stiffness, coarse.what, relative, coarse.momentum, depth);
      CAPTURE(coarse.energy / fine.energy);
      CHECK(coarse.what.empty());
      CHECK(relative < 1e-3);
      CHECK(coarse.energy / fine.energy > 3);
      CHECK(coarse.momentum < 1e-9);
      if (std::getenv("APOTHEM_PRINT")) {
        fmt::print(
            "{:12} k {:5.1f} E: energy error {:.1e} {:.1e}, depth/H {:.2f}, strain {:.3g} J\n",
            body.name, stiffness / 1e6, relative, fine.energy / fine.total, depth, coarse.strain);
      }
    }
  }
}

TEST_CASE("soft impacts many collars deep keep energy with order 2", "[deep]") {
  struct Impact {
    double stiffness, speed, depth;
  };
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    const bool triangles = shape == ElementShape::triangle;
    // The disc comes back, or goes through, which ends the run.
    for (const Impact& impact : {Impact{1e5, 15, 5}, Impact{1e5, 30, 12}}) {
      Model model = soft_model(impact.stiffness);
      const Mesh lower = rectangle_mesh({1, .5}, {16, 8}, {-.5, 0}, shape);
      add(model, "lower", lower, triangles ? ElementKind::tri3 : ElementKind::quad4, {0, 0});
      add(model, "upper", disc({.07, 1.003}, Shape::triangles), ElementKind::tri3,
          {0, -impact.speed});
      const double end = 1.2 / impact.speed;
      const DeepRun coarse = run_deep(model, .4, end), fine = run_deep(model, .1, end);
      const double depth = coarse.penetration / collar_of(lower);
      CAPTURE(triangles, impact.speed, coarse.energy, fine.energy, coarse.momentum, depth);
      CAPTURE(coarse.what, fine.what);
      const bool comes_back = impact.speed < 20;
      for (const DeepRun* run : {&coarse, &fine}) {
        CHECK(run->what.empty() == comes_back);
        if (!comes_back) CHECK_THAT(run->what, Catch::Contains("pass through each other"));
      }
      CHECK(depth > impact.depth);
      CHECK(coarse.energy / coarse.total < 2e-4);
      CHECK(coarse.energy / fine.energy > 8);  // 16, but for the phase of single steps
      CHECK(coarse.momentum < 1e-9);
    }
  }
}

TEST_CASE(
    "a tip is driven through a thin plate until the plate folds or an element turns inside out",
    "[deep]") {
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    const bool triangles = shape == ElementShape::triangle;
    Model model = soft_model(1e6);
    for (const double x : {-.5, .35}) {
      RigidBody support;
      support.name = x < 0 ? "left" : "right";
      support.motion = Motion::fixed;
      set_shape(support, samples::block(x, -.2, x + .15, 0), model);
      model.bodies.push_back(support);
    }
    RigidBody tip;
    tip.name = "tip";
    tip.motion = Motion::prescribed;
    set_shape(tip, Polygon({{.003, .052}, {.103, .652}, {-.097, .652}}), model);
    tip.history.velocity = {{0, {0, -10}}};
    model.bodies.push_back(tip);
    const Mesh plate = rectangle_mesh({1, .05}, {40, 2}, {-.5, 0}, shape);
    add(model, "plate", plate, triangles ? ElementKind::tri3 : ElementKind::quad4, {0, 0});
    const DeepRun coarse = run_deep(model, .2, .04), fine = run_deep(model, .1, .04);
    const double depth = coarse.penetration / collar_of(plate);
    CAPTURE(triangles, coarse.what, coarse.energy, fine.energy, coarse.total, depth);
    if (std::getenv("APOTHEM_PRINT"))
      fmt::print("tip: {} {:.2e} {:.2e} of {:.3g}, depth/H {:.2f}\n", coarse.what, coarse.energy,
                 fine.energy, coarse.total, depth);
    // Not contact with the tip: Q4 are torn apart so far that the plate folds over the tip.
    CHECK(coarse.what.find("folds onto itself") == (triangles ? std::string::npos : 8));
    CHECK(coarse.what.empty() == triangles);
    CHECK(depth > 1);
    CHECK(coarse.energy / coarse.total < 1e-3);
  }
}
