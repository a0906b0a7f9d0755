// Deformable bodies on their way into contact.
#pragma once

#include "geometry/meshing/voronoi.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/reorder.hpp"
#include "tests/support.hpp"

namespace apothem::test {

enum class Shape { quads, triangles, voronoi };

inline Mesh disc(const Vec2& centre, Shape shape) {
  if (shape == Shape::voronoi) {
    std::vector<Vec2> ring;
    for (int i = 0; i < 24; ++i) {
      ring.emplace_back(.5 * std::cos(2 * M_PI * i / 24), .5 * std::sin(2 * M_PI * i / 24));
    }
    const Polygon region(samples::shifted(Polygon(ring), centre));
    VoronoiOptions options;
    options.cells = 80;
    Mesh mesh = mesh_of_cells(region, in_world(region, voronoi_mesh(region, options).mesh));
    reorder_along_curve(mesh);
    return mesh;
  }
  Mesh mesh =
      disc_mesh(centre, .5, {.quarter = 6},
                shape == Shape::quads ? ElementShape::quadrilateral : ElementShape::triangle);
  reorder_along_curve(mesh);
  return mesh;
}

inline ElementKind element_of(Shape shape) {
  return shape == Shape::quads       ? ElementKind::quad4
         : shape == Shape::triangles ? ElementKind::tri3
                                     : ElementKind::polygon;
}

inline Model empty_model() {
  Model model;
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::stress, 20e9, .2}}};
  model.contact.normal_stiffness = 20e9;
  return model;
}

inline void add(Model& model, const char* name, Mesh mesh, ElementKind kind, const Vec2& velocity,
                double spin = 0) {
  DeformableBody body;
  body.name = name;
  body.element = kind;
  body.mesh = std::move(mesh);
  body.velocity = velocity;
  body.spin = spin;
  body.first_node = model.node_count();
  model.deformables.push_back(std::move(body));
}

inline void add_floor(Model& model) {
  RigidBody floor;
  floor.name = "floor";
  floor.motion = Motion::fixed;
  set_shape(floor, Polygon({{-3, -1}, {3, -1}, {3, 0}, {-3, 0}}), model);
  model.bodies.push_back(floor);
}

/// A rigid body, whose name is its number.
inline RigidBody& add_body(Model& model, const Polygon& polygon, Motion motion = Motion::free) {
  RigidBody body;
  body.name = std::to_string(model.bodies.size());
  body.motion = motion;
  set_shape(body, polygon, model);
  model.bodies.push_back(body);
  return model.bodies.back();
}

struct Result {
  double energy = 0;    // largest error over the initial kinetic energy
  double momentum = 0;  // largest error over the first body's momentum
  bool touched = false;
  double penetration = 0;  // largest, m
  Energies last;
};

inline Result collide(const Model& model, double safety, double end, int threads = 1) {
  TimeSettings time;
  time.end = end;
  time.element_safety = time.safety = safety;
  Simulation simulation(model, time, 1, threads);
  const double kinetic = simulation.energies().kinetic;
  Result result;
  while (simulation.state().time < end) {
    simulation.step();
    if (simulation.state().step % 5 != 0) continue;
    result.last = simulation.energies();
    const Momenta p = simulation.momenta();
    result.energy = std::max(result.energy, std::abs(result.last.total_error) / kinetic);
    for (const double error : {p.x_error, p.y_error, p.angular_error}) {
      result.momentum = std::max(result.momentum, std::abs(error));
    }
    result.touched = result.touched || result.last.contact > 0;
  }
  result.penetration = simulation.extremes().penetration.value;
  return result;
}

}  // namespace apothem::test
