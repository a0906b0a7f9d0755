// Contact of bodies one element thick, of a single element, with fins and needles: energy is kept
// with order 2 and momentum exactly, within the collar and beyond it.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/contact/outline_pairs.hpp"
#include "tests/dynamics/surface_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

struct Named {
  const char* name;
  ElementKind kind;
  Mesh mesh;
};

Mesh strip(ElementShape shape) { return rectangle_mesh({2, .1}, {20, 1}, {0, 0}, shape); }

Mesh fins() {
  return fill_mesh(Polygon({{0, 0},
                            {.3, 0},
                            {.3, .1},
                            {.28, .1},
                            {.28, .03},
                            {.16, .03},
                            {.16, .2},
                            {.14, .2},
                            {.14, .03},
                            {.02, .03},
                            {.02, .1},
                            {0, .1}}),
                   {}, .02, ElementShape::triangle);
}

std::vector<Named> thin_bodies() {
  const Polygon bar = samples::block(0, 0, 2, .1);
  VoronoiOptions cells;
  cells.cells = 20;
  Mesh graded = rectangle_mesh({.4, .1}, {4, 2}, {0, 0}, ElementShape::quadrilateral);
  for (Vec2& x : graded.nodes) x.x() *= .12 + 2.2 * x.x();
  return {
      {"row of Q4", ElementKind::quad4, strip(ElementShape::quadrilateral)},
      {"row of T3", ElementKind::tri3, strip(ElementShape::triangle)},
      {"row of cells", ElementKind::polygon,
       mesh_of_cells(bar, in_world(bar, voronoi_mesh(bar, cells).mesh))},
      {"one Q4", ElementKind::quad4, one_element({{0, 0}, {.1, .02}, {.13, .12}, {-.01, .08}})},
      {"one T3", ElementKind::tri3, one_element({{0, 0}, {.1, 0}, {.03, .1}})},
      {"needle", ElementKind::tri3, one_element({{0, 0}, {.1, 0}, {.1, .01}})},
      {"fins", ElementKind::tri3, fins()},
      {"graded", ElementKind::quad4, graded},
  };
}

// About the middle of its box, which goes to the origin.
Mesh turned(Mesh mesh, double angle) {
  Box box;
  for (const Vec2& x : mesh.nodes) box.include(x.x(), x.y());
  const Vec2 middle((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
  const Eigen::Rotation2Dd rotation(angle);
  for (Vec2& x : mesh.nodes) x = rotation * (x - middle);
  reorder_along_curve(mesh);
  return mesh;
}

Vec2 top(const Mesh& mesh) {
  return *std::max_element(mesh.nodes.begin(), mesh.nodes.end(),
                           [](const Vec2& p, const Vec2& q) { return p.y() < q.y(); });
}

// Its lowest node to a place.
Mesh standing(Mesh mesh, const Vec2& place) {
  const Vec2 low = *std::min_element(mesh.nodes.begin(), mesh.nodes.end(),
                                     [](const Vec2& p, const Vec2& q) { return p.y() < q.y(); });
  for (Vec2& x : mesh.nodes) x += place - low;
  return mesh;
}

enum class Against { floor, itself, wedge };

Model thin_model(const Named& body, Against against, double softness, double speed) {
  Model model = empty_model();
  model.contact.normal_stiffness *= softness;
  if (against == Against::floor) {
    add_floor(model);
    add(model, "body", standing(turned(body.mesh, .3), {0, 1e-5}), body.kind, {.2, -speed}, 3);
    return model;
  }
  const Mesh flat = turned(body.mesh, 0);
  const Vec2 tip(.9 * top(flat).x(), top(flat).y() + 1e-5);  // of what comes from above
  if (against == Against::itself) {
    add(model, "body", flat, body.kind, {0, speed / 2});
    add(model, "other", standing(turned(body.mesh, 1.1), tip), body.kind, {.1, -speed / 2});
    return model;
  }
  RigidBody wedge;
  wedge.name = "wedge";
  set_shape(wedge, Polygon({tip, tip + Vec2(.1, .15), tip + Vec2(-.1, .15)}), model);
  wedge.velocity = {0, -speed};
  model.bodies.push_back(wedge);
  add(model, "body", flat, body.kind, {0, 0});
  return model;
}

}  // namespace

TEST_CASE("thin bodies and single elements keep energy with order 2, and momenta", "[surface]") {
  for (const Named& body : thin_bodies()) {
    for (const Against against : {Against::floor, Against::itself, Against::wedge}) {
      // Soft contact: as deep as two thirds of the collar.
      const Model model = thin_model(body, against, .003, 15);
      const Result coarse = collide(model, .2, 2e-3), fine = collide(model, .1, 2e-3);
      CAPTURE(body.name, static_cast<int>(against), coarse.energy, fine.energy, coarse.momentum);
      CHECK(coarse.touched);
      CHECK(coarse.energy < 1e-4);
      CHECK(coarse.energy / fine.energy == Approx(4).epsilon(.1));
      CHECK(coarse.momentum < 1e-9);
    }
  }
}

TEST_CASE("a body deep inside another one at the start is refused", "[surface]") {
  for (const ContactSurface surface : {ContactSurface::body, ContactSurface::element}) {
    for (const bool rigid : {false, true}) {
      Model model = empty_model();
      model.contact.surface = surface;
      const Polygon small = samples::block(.45, .45, .55, .55);
      if (rigid) {
        RigidBody stone;
        stone.name = "stone";
        set_shape(stone, small, model);
        model.bodies.push_back(stone);
      }
      add(model, "block", rectangle_mesh({1, 1}, {10, 10}, {0, 0}, ElementShape::quadrilateral),
          ElementKind::quad4, {0, 0});
      if (!rigid) add(model, "stone", one_element(small.vertices()), ElementKind::quad4, {0, 0});
      TimeSettings time;
      time.end = 1;
      CHECK_THROWS_WITH(
          Simulation(model, time, 1, 1),
          Catch::Contains("\"stone\" is inside \"block\"") && Catch::Contains("move them apart"));
      // In a hole there is room.
      const Polygon frame = samples::block(0, 0, 1, 1), hole = samples::block(.3, .3, .7, .7);
      model.deformables[0].mesh = fill_mesh(frame, {hole}, .1, ElementShape::triangle);
      model.deformables[0].element = ElementKind::tri3;
      if (!rigid) model.deformables[1].first_node = int(model.deformables[0].mesh.nodes.size());
      CHECK_NOTHROW(Simulation(model, time, 1, 1));
    }
  }
}

TEST_CASE("thin bodies go on beyond their collars with order 2", "[surface][slow]") {
  for (const Named& body : thin_bodies()) {
    constexpr double kSpeed = 60;
    const Model model = thin_model(body, Against::floor, 3e-4, kSpeed);
    OutlineSurfaces outlines;
    outlines.add_mesh(body.mesh, boundary(body.mesh), 0);
    const double collar = outlines.bodies[0].depth;
    const double end = 1.8 * collar / kSpeed;  // before they go through the floor
    const Result coarse = collide(model, .1, end), fine = collide(model, .05, end);
    const double depth = coarse.penetration / collar;
    CAPTURE(body.name, coarse.energy, fine.energy, coarse.momentum, depth);
    CHECK(depth > 1.2);
    CHECK(coarse.energy < 1e-5);
    CHECK(coarse.energy / fine.energy == Approx(4).epsilon(.1));
    CHECK(coarse.momentum < 1e-9);
  }
}
