// A small run's results, written as a run writes them.
#pragma once

#include <string>
#include <vector>

#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/output/frames.hpp"
#include "tests/shapes.hpp"

namespace apothem::test {

/// A fixed L, a free square that is not there, a free square of another material and, if asked for,
/// a block of 2 x 2 elements of both materials; far from the origin. The area of the L is a region.
inline Model model_of_results(bool with_mesh) {
  Model model;
  model.origin = {1024, -512};
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::strain, 1e9, .25}},
                     {"ice", 900, {ElasticLaw::st_venant_kirchhoff, Plane::strain, 1e9, .25}}};
  const auto add = [&](const char* name, const Ring& ring, Motion motion, MaterialIndex material) {
    RigidBody body;
    body.name = name;
    body.motion = motion;
    body.material = material;
    set_shape(body, samples::shifted(Polygon(ring), model.origin), model);
    model.bodies.push_back(body);
  };
  add("floor", l_ring(), Motion::fixed, 0);
  add("gone", {{5, 0}, {6, 0}, {6, 1}, {5, 1}}, Motion::free, 0);
  add("block", {{3, 0}, {4, 0}, {4, 1}, {3, 1}}, Motion::free, 1);
  if (with_mesh) {
    DeformableBody beam;
    beam.name = "beam";
    beam.mesh = rectangle_mesh({2, 1}, {2, 2}, {0, 3}, ElementShape::quadrilateral);
    beam.element_material = {0, 1, 0, 1};
    model.deformables = {beam};
  }
  model.regions = {{"bin", {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}}, 16}};
  return model;
}

inline State state_of_results(const Model& model) {
  State state(Layout{3, model.node_count()});
  for (RigidIndex i = 0; i < 3; ++i) {
    state.pose(i) << model.bodies[i].position, model.bodies[i].angle;
  }
  state.absent.assign(3 + model.deformables.size(), 0);
  state.absent[1] = 1;
  return state;
}

/// Frames at 0, 1, 2 and so on s: the block moves by .25 m along x and turns by .1 rad in each
/// second; the beam is stretched by 1 % in each, and its element e has the stresses e + 1, -e, 2 e
/// and 10 Pa. There is one contact between the floor and the block.
inline void write_results(const std::string& folder, const Model& model, int frames,
                          FrameFormat format = FrameFormat::vtu) {
  State state = state_of_results(model);
  std::vector<CauchyStress> stresses;
  if (!model.deformables.empty()) {
    for (int e = 0; e < 4; ++e) stresses.push_back({e + 1., -1. * e, 2. * e, 10, 0});
  }
  std::vector<BodyForce> forces(state.absent.size());
  forces[2].friction = 3;
  std::vector<BodyStatistics> statistics(state.absent.size());
  statistics[2] = {4, {-3, -5, 1, 0, 0}};
  const std::vector<double> mass(static_cast<size_t>(model.node_count()), 2.);
  FrameWriter writer(folder, model, {}, 1, nullptr, format);
  for (int i = 0; i < frames; ++i) {
    state.time = i;
    state.pose(2) << model.bodies[2].position + Vec2(.25 * i, 0), .1 * i;
    state.pose_rate(2) << .25, 0, .1;
    state.f[6] = 5, state.f[7] = 6, state.f[8] = 7;
    for (NodeIndex n = 0; n < model.node_count(); ++n) {
      state.node(n) << .01 * i * model.deformables[0].mesh.nodes[n].x(), 0;
    }
    writer.write({.state = state,
                  .contacts = {{0, 2, {2.5, .25}, {10, 20}, {3, -4}, 1e-3, .01, {-2, -1}}},
                  .stresses = stresses,
                  .forces = forces,
                  .node_mass = mass,
                  .bodies = statistics});
  }
}

}  // namespace apothem::test
