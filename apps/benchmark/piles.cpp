#include "apps/benchmark/piles.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cases/samples.hpp"
#include "geometry/packing/arrange.hpp"
#include "geometry/packing/block_shapes.hpp"
#include "geometry/spatial/hilbert.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/reorder.hpp"

namespace apothem {
namespace {

constexpr double kThickness = .05;  // of walls and floors, m
constexpr double kHighWall = 6;     // m

void add_trough(Model& model, double left, double width, double wall) {
  add_wall(model, left, -kThickness, left + width, 0);
  add_wall(model, left - kThickness, -kThickness, left, wall);
}

// Comes to rest in a trough. Everything is slowed down while it settles, not only what touches.
Pile settled(Model model, double width, double seconds) {
  const size_t walls = 3;
  add_trough(model, 0, width, kHighWall);
  add_wall(model, width, -kThickness, width + kThickness, kHighWall);
  std::rotate(model.bodies.begin(), model.bodies.end() - walls, model.bodies.end());
  model.contact.mass_damping = 10;
  int first = 0;
  for (DeformableBody& body : model.deformables) {
    body.first_node = first;
    first += static_cast<int>(body.mesh.nodes.size());
  }
  Simulation simulation(model, time_of_piles(), 1, 1);
  const State& state = simulation.state();
  while (state.time < seconds) simulation.step();

  Pile pile;
  pile.width = width;
  const auto reach = [&](double y) { pile.height = std::max(pile.height, y); };
  for (size_t i = walls; i < model.bodies.size(); ++i) {
    RigidBody body = model.bodies[i];
    const auto pose = state.pose(static_cast<int>(i));
    body.position = pose.head<2>();
    body.angle = pose.z();
    reach(body.position.y() + body.reach());
    pile.bodies.push_back(std::move(body));
  }
  for (DeformableBody body : model.deformables) {
    for (size_t k = 0; k < body.mesh.nodes.size(); ++k) {
      const Vec2 moved = state.node(body.first_node + static_cast<int>(k));
      body.displacement.insert(body.displacement.end(), {moved.x(), moved.y()});
      reach(body.mesh.nodes[k].y() + moved.y());
    }
    body.node_velocity.assign(body.displacement.size(), 0);
    pile.deformables.push_back(std::move(body));
  }
  return pile;
}

// Blocks of equal area that fill a part of a trough as densely as they get.
template <class Shape>
Model dense(int count, double width, double solid_fraction, const Shape& shape) {
  const double height = count * kBlockArea / solid_fraction / width;
  PackingSpace space(samples::block(1e-3, 1e-3, width - 1e-3, height), {}, 0,
                     std::sqrt(kBlockArea));
  RandomNumbers random(1);
  std::vector<Block> blocks;
  blocks.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    blocks.push_back({shape(random), std::sqrt(kBlockArea), random.uniform(0, 2 * M_PI)});
  }
  Model model = empty_model();
  for (const std::vector<Vec2>& ring : grow(space, random, blocks, true).rings) {
    RigidBody& body = model.bodies.emplace_back();
    body.name = "block";
    set_shape(body, Polygon(ring), model);
  }
  return model;
}

}  // namespace

Model empty_model() {
  Model model;
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::strain, 2e7, .2}}};
  model.contact.normal_stiffness = 2e7;
  model.contact.friction = {.5};
  model.contact.damping = {.normal = .5, .tangential = .5};
  model.gravity = {0, -9.81};
  return model;
}

void add_wall(Model& model, double x0, double y0, double x1, double y1) {
  RigidBody body;
  body.name = "wall";
  set_shape(body, samples::block(x0, y0, x1, y1), model);
  body.motion = Motion::fixed;
  model.bodies.push_back(std::move(body));
}

TimeSettings time_of_piles() { return {.end = 1e3, .accuracy = .1, .onsets = false}; }

const Pile& pile_of_quadrilaterals() {
  static const Pile pile = [] {
    const double width = 1.6, solid_fraction = .7;
    return settled(dense(300, width, solid_fraction,
                         [](RandomNumbers& r) { return random_quadrilateral(r, 0, M_PI); }),
                   width, .6);
  }();
  return pile;
}

const Pile& pile_of_crosses() {
  static const Pile pile = [] {
    const double width = 1.5, solid_fraction = .45;
    return settled(dense(100, width, solid_fraction, [](RandomNumbers&) { return cross_shape(1); }),
                   width, .6);
  }();
  return pile;
}

const Pile& pile_of_meshes() {
  static const Pile pile = [] {
    constexpr int kColumns = 6, kRows = 5, kCells = 5;
    const double side = std::sqrt(kBlockArea), pitch = 1.2 * side, tilt = .15;
    Model model = empty_model();
    samples::Random random(1);
    for (int i = 0; i < kColumns * kRows; ++i) {
      const int column = i % kColumns, row = i / kColumns;
      const Vec2 centre(pitch * (column + .5), pitch * (row + .5));
      DeformableBody body;
      body.name = "block";
      body.mesh = rectangle_mesh({side, side}, {kCells, kCells}, {-side / 2, -side / 2},
                                 ElementShape::quadrilateral);
      reorder_along_curve(body.mesh);
      const double angle = random.uniform(-tilt, tilt);
      for (Vec2& node : body.mesh.nodes) node = centre + samples::turned(node, angle);
      model.deformables.push_back(std::move(body));
    }
    return settled(std::move(model), kColumns * pitch, .6);
  }();
  return pile;
}

Model troughs(const Pile& pile, int copies, double wall) {
  Model model = empty_model();
  for (int c = 0; c < copies; ++c) {
    const double left = c * (pile.width + kThickness);
    add_trough(model, left, pile.width, wall);
    for (RigidBody body : pile.bodies) {
      body.position.x() += left;
      model.bodies.push_back(std::move(body));
    }
    for (DeformableBody body : pile.deformables) {
      for (Vec2& node : body.mesh.nodes) node.x() += left;
      model.deformables.push_back(std::move(body));
    }
  }
  const double right = copies * (pile.width + kThickness) - kThickness;
  add_wall(model, right, -kThickness, right + kThickness, wall);
  const auto number = [](auto& bodies, const auto& place) {
    std::vector<Vec2> places;
    for (const auto& body : bodies) places.push_back(place(body));
    auto before = std::move(bodies);
    bodies.clear();
    for (const int i : hilbert_order(places)) bodies.push_back(std::move(before[i]));
  };
  number(model.bodies, [](const RigidBody& body) { return body.position; });
  number(model.deformables, [](const DeformableBody& body) { return body.mesh.nodes.front(); });
  int first = 0;
  for (DeformableBody& body : model.deformables) {
    body.first_node = first;
    first += static_cast<int>(body.mesh.nodes.size());
  }
  return model;
}

}  // namespace apothem
