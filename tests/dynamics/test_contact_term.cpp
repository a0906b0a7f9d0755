// Deformable bodies that touch each other and rigid bodies, in the step loop.
#include <catch2/catch.hpp>
#include <map>

#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/select.hpp"
#include "tests/dynamics/surface_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// Three discs of different elements between four walls; their contact by the bodies' surfaces, or
// by potentials of elements.
Model box_of_three(std::optional<ForceDistribution> elements) {
  Model model = empty_model();
  if (elements) {
    model.contact.surface = ContactSurface::element;
    model.contact.distribution = *elements;
  }
  for (const auto& [name, x, y, w, h] :
       {std::tuple("left", -.6, -.6, .5, 3.), std::tuple("right", 2.1, -.6, .5, 3.),
        std::tuple("bottom", -.1, -.6, 2.2, .5), std::tuple("top", -.1, 1.9, 2.2, .5)}) {
    RigidBody wall;
    wall.name = name;
    wall.motion = Motion::fixed;
    set_shape(wall, Polygon({{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}}), model);
    model.bodies.push_back(wall);
  }
  add(model, "one", disc({.5, .5}, Shape::quads), ElementKind::quad4, {20, 7});
  add(model, "two", disc({1.59, .51}, Shape::voronoi), ElementKind::polygon, {-15, 3});
  add(model, "three", disc({1, 1.39}, Shape::triangles), ElementKind::tri3, {4, -18});
  return model;
}

}  // namespace

TEST_CASE("discs that collide obliquely keep energy with order 2, and momenta", "[surface][slow]") {
  for (const Shape shape : {Shape::quads, Shape::triangles, Shape::voronoi}) {
    for (const double mu : {0., .3}) {
      Model model = empty_model();
      model.contact.friction = {mu, 12e9};
      add(model, "one", disc({0, 0}, shape), element_of(shape), {2, 0}, mu > 0 ? 5 : 0);
      add(model, "two", disc({.96, .3}, shape), element_of(shape), {-2, 0});
      const Result coarse = collide(model, .2, 3e-3);
      const Result fine = collide(model, .1, 3e-3);
      INFO(static_cast<int>(shape) << " mu " << mu);
      CHECK(coarse.touched);
      CHECK(coarse.energy < 1e-4);
      CHECK(coarse.energy / fine.energy > 2.5);
      CHECK(coarse.momentum < 1e-8);
      if (mu > 0) CHECK(coarse.last.friction_loss > 1);
    }
  }
}

TEST_CASE("discs that rub by their elements keep momenta, and the ledger knows the loss",
          "[surface][slow]") {
  for (const Shape shape : {Shape::quads, Shape::triangles, Shape::voronoi}) {
    Model model = empty_model();
    model.contact.surface = ContactSurface::element;
    model.contact.distribution = ForceDistribution::resultant;
    model.contact.friction = {.3, 12e9};
    add(model, "one", disc({0, 0}, shape), element_of(shape), {2, 0}, 5);
    add(model, "two", disc({.96, .3}, shape), element_of(shape), {-2, 0});
    const Result result = collide(model, .1, 3e-3);
    CAPTURE(static_cast<int>(shape), result.energy, result.last.friction_loss);
    CHECK(result.touched);
    CHECK(result.energy < 5e-4);
    CHECK(result.momentum < 1e-8);
    CHECK(result.last.friction_loss > .1);
    CHECK(collide(model, .1, 3e-3, 3).last.kinetic == result.last.kinetic);
  }
}

TEST_CASE("a deformable body bounces on a rigid one as on a meshed one", "[surface]") {
  Model rigid = empty_model();
  add_floor(rigid);
  add(rigid, "ball", disc({0, .5001}, Shape::quads), ElementKind::quad4, {0, -1});
  CHECK(collide(rigid, .2, 2e-3).energy < 1e-4);

  Model meshed = empty_model();
  Mesh floor = rectangle_mesh({2, .5}, {20, 5}, {-1, -.5}, ElementShape::quadrilateral);
  reorder_along_curve(floor);
  add(meshed, "floor", std::move(floor), ElementKind::quad4, {0, 0});
  meshed.deformables[0].supports = {
      {nodes_where(meshed.deformables[0].mesh, {.y = -.5}), {true, true}, {}}};
  add(meshed, "ball", disc({0, .5001}, Shape::quads), ElementKind::quad4, {0, -1});
  CHECK(collide(meshed, .2, 2e-3).energy < 1e-4);
}

TEST_CASE("a free rigid body and a deformable one exchange momentum", "[surface]") {
  Model model = empty_model();
  RigidBody wedge;
  wedge.name = "wedge";
  set_shape(wedge, Polygon({{-.3, .6}, {0, .448}, {.3, .6}, {0, .9}}), model);
  wedge.velocity = {0, -1};
  wedge.spin = 2;
  model.bodies.push_back(wedge);
  model.contact.friction = {.2, 12e9};
  add(model, "ball", disc({.05, -.05}, Shape::quads), ElementKind::quad4, {0, .5});
  const Result result = collide(model, .1, 4e-3);
  CHECK(result.touched);
  CHECK(result.energy < 3e-4);
  CHECK(result.momentum < 1e-8);
}

TEST_CASE("threads change no bit of deformable contact", "[surface]") {
  std::vector<double> serial;
  for (const int threads : {1, 3}) {
    Model model = empty_model();
    model.contact.friction = {.3, 12e9};
    add(model, "one", disc({0, 0}, Shape::quads), ElementKind::quad4, {2, 0});
    add(model, "two", disc({.95, .3}, Shape::quads), ElementKind::quad4, {-2, 0});
    TimeSettings time;
    time.end = 1;
    Simulation simulation(model, time, 1, threads);
    for (int i = 0; i < 300; ++i) simulation.step();
    CHECK(simulation.energies().contact > 0);
    if (threads == 1) serial = simulation.state().x;
    CHECK((simulation.state().x == serial));
  }
}

TEST_CASE("friction of a pair overrides that of the scene, and is in the records", "[surface]") {
  for (const ContactSurface surface : {ContactSurface::body, ContactSurface::element}) {
    Model model = empty_model();
    model.contact.surface = surface;
    model.contact.distribution = surface == ContactSurface::body ? ForceDistribution::variational
                                                                 : ForceDistribution::resultant;
    model.contact.friction = {.3, 12e9};
    add_floor(model);
    for (const double side : {-1., 1.}) {
      add(model, side < 0 ? "rough" : "smooth",
          rectangle_mesh({.5, .2}, {5, 2}, {side - .25, -1e-5}, ElementShape::quadrilateral),
          ElementKind::quad4, {1, 0});
    }
    model.contact.rules = {{{{{true, 0}, {true, 2}}}, Friction{}}};  // floor and "smooth"
    TimeSettings time;
    time.end = 1;
    Simulation simulation(model, time, 1, 1);
    for (int i = 0; i < 4; ++i) simulation.step();
    const std::vector<BodyForce> on = simulation.contact_forces();
    CHECK(on[1].friction > 0);
    CHECK(on[2].friction == 0);
    const std::vector<ContactRecord> records = simulation.contacts();
    REQUIRE(records.size() == 2);
    // On the floor, along the motion; what is not normal force is friction.
    CHECK(records[0].tangential.x() > .01 * records[0].normal.norm());
    CHECK((records[0].tangential + records[0].normal + Vec2(on[1].fx, on[1].fy)).norm() <
          1e-12 * records[0].normal.norm());
    CHECK(records[0].tangential.norm() <= .3 * records[0].normal.norm() * (1 + 1e-12));
    CHECK(records[0].penetration > 0);
    CHECK(records[1].tangential == Vec2::Zero());
    // The lower side of the block carries the same.
    double traction = 0, pressure = 0;
    for (const SurfaceRecord& s : simulation.surfaces()) {
      const Vec2 edge = s.to - s.from;
      if (s.body != 1 || std::abs(edge.y()) > .1 * std::abs(edge.x())) continue;
      traction += s.traction * edge.x();
      pressure += s.pressure * edge.x();
    }
    CHECK(pressure == Approx(-records[0].normal.y()).epsilon(1e-3));
    CHECK(traction == Approx(-records[0].tangential.x()).epsilon(1e-2));
  }
}

TEST_CASE("a body on two feet has two contact patches", "[surface]") {
  for (const ContactSurface surface : {ContactSurface::body, ContactSurface::element}) {
    for (const bool meshed_floor : {false, true}) {
      Model model = empty_model();
      model.contact.surface = surface;
      model.contact.distribution = surface == ContactSurface::body ? ForceDistribution::variational
                                                                   : ForceDistribution::resultant;
      model.contact.friction = {.3, 12e9};
      if (meshed_floor) {
        add(model, "floor",
            rectangle_mesh({3, .4}, {20, 3}, {-1, -.4}, ElementShape::quadrilateral),
            ElementKind::quad4, {0, 0});
      } else {
        add_floor(model);
      }
      const Polygon table({{0, 0}, {.2, 0}, {.2, .3}, {.8, .3}, {.8, 0}, {1, 0}, {1, .5}, {0, .5}});
      Mesh mesh = fill_mesh(table, {}, .1, ElementShape::triangle);
      for (Vec2& x : mesh.nodes) x.y() -= 1e-5;
      reorder_along_curve(mesh);
      add(model, "table", std::move(mesh), ElementKind::tri3, {1, 0});
      TimeSettings time;
      time.end = 1;
      Simulation simulation(model, time, 1, 1);
      for (int i = 0; i < 4; ++i) simulation.step();
      const std::vector<ContactRecord> records = simulation.contacts();
      REQUIRE(records.size() == 2);
      Vec2 sum = Vec2::Zero();
      std::vector<double> x;
      for (const ContactRecord& r : records) {
        x.push_back(r.point.x());
        sum += r.normal + r.tangential;
        CHECK(r.normal.y() < 0);
        CHECK(r.tangential.x() > 0);
        CHECK(std::abs(r.point.y()) < 1e-4);
      }
      std::sort(x.begin(), x.end());
      CHECK(x[0] == Approx(.1).margin(.05));
      CHECK(x[1] == Approx(.9).margin(.05));
      const BodyForce on = simulation.contact_forces().back();
      CHECK((sum + Vec2(on.fx, on.fy)).norm() < 1e-9 * sum.norm());
    }
  }
}

TEST_CASE("the largest force is that of all steps, also between meshes", "[surface]") {
  for (const ContactSurface surface : {ContactSurface::body, ContactSurface::element}) {
    for (const double softness : {1., 1e-3}) {  // the soft one is deep beyond the collars
      if (surface == ContactSurface::element && softness < 1) continue;
      Model model = empty_model();
      model.contact.surface = surface;
      model.contact.distribution = surface == ContactSurface::body ? ForceDistribution::variational
                                                                   : ForceDistribution::resultant;
      model.contact.normal_stiffness *= softness;
      add_floor(model);
      add(model, "one", disc({0, .5001}, Shape::quads), ElementKind::quad4, {0, -5});
      add(model, "two", disc({.3, 1.46}, Shape::triangles), ElementKind::tri3,
          {-1, softness < 1 ? -60. : -15.});
      OutlineSurfaces outlines;
      outlines.add_mesh(model.deformables[0].mesh, boundary(model.deformables[0].mesh), 0);
      const double collar = outlines.bodies[0].depth;
      Simulation simulation(model, {.end = 1, .element_safety = .2}, 1, 1);
      Peak largest;
      bool deep = false;
      for (int i = 0; i < 600; ++i) {
        simulation.step();
        std::map<std::pair<BodyIndex, BodyIndex>, Vec2> forces;
        for (const ContactRecord& r : simulation.contacts()) {
          forces.try_emplace({r.a, r.b}, Vec2::Zero()).first->second += r.normal;
          deep = deep || r.penetration > 1.5 * collar;
        }
        for (const auto& [pair, force] : forces) {
          if (!(force.norm() > largest.value)) continue;
          largest = {force.norm(), simulation.state().time, pair.first, pair.second};
        }
      }
      const Peak found = simulation.extremes().force;
      CAPTURE(static_cast<int>(surface), softness, deep);
      CHECK(deep == (softness < 1));
      CHECK(found.value == Approx(largest.value).epsilon(1e-11));
      CHECK(found.time == largest.time);
      CHECK(found.a == largest.a);
      CHECK(found.b == largest.b);
    }
  }
}

TEST_CASE("contact beyond the method's range stops the run with the place", "[surface]") {
  Model model = empty_model();
  model.contact.surface = ContactSurface::element;  // potentials of outlines go on
  model.contact.distribution = ForceDistribution::resultant;
  model.contact.normal_stiffness = 1e6;
  add_floor(model);
  add(model, "ball", disc({0, .51}, Shape::quads), ElementKind::quad4, {0, -20});
  try {
    collide(model, .2, 1e-2);
    FAIL("not noticed");
  } catch (const Unstable& error) {
    const std::string what = error.what();
    INFO(what);
    CHECK(what.find("\"ball\"") != std::string::npos);
    CHECK(what.find("normal_stiffness") != std::string::npos);
    CHECK(what.find("t = ") != std::string::npos);
  }
}

TEST_CASE("three bodies in a box for 120 000 steps", "[surface]") {
  // Potentials of elements with APOTHEM_LONG=1.
  std::vector<std::optional<ForceDistribution>> ways{std::nullopt};
  if (test::long_run()) {
    ways.insert(ways.end(), {ForceDistribution::resultant, ForceDistribution::integrated});
  }
  for (const std::optional<ForceDistribution>& elements : ways) {
    const Model model = box_of_three(elements);
    TimeSettings time;
    time.end = 1e3;
    time.element_safety = .4;
    Simulation simulation(model, time, 1, 1);
    const double kinetic = simulation.energies().kinetic;
    const int tenth = test::scaled(12000);
    double first = 0, last = 0, worst = 0;  // mean error in the first and in the last tenth
    for (int i = 0; i < 10 * tenth; ++i) {
      simulation.step();
      if (i % 10 != 0) continue;
      const double error = simulation.energies().total_error / kinetic;
      worst = std::max(worst, std::abs(error));
      if (i < tenth) first += error / (tenth / 10.);
      if (i >= 9 * tenth) last += error / (tenth / 10.);
    }
    CAPTURE(elements.has_value(), first, last, worst);
    if (elements) {
      CHECK(std::abs(last - first) > 1e-3);
    } else {
      CHECK(std::abs(last - first) < 1e-3);
      CHECK(worst < 1e-3);
    }
  }
}
