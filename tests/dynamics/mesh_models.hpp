// Single bodies of finite elements, for the tests of what acts on their nodes.
#pragma once

#include "lib/dynamics/simulation.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/select.hpp"
#include "tests/support.hpp"

namespace apothem::test {

inline Material rock() {
  return {"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::stress, 20e9, .2}, 0, 0};
}

inline Model model_of(DeformableBody body, const Material& material) {
  Model model;
  model.materials = {material};
  body.name = "beam";
  model.deformables = {std::move(body)};
  return model;
}

inline DeformableBody block(const Vec2& size, std::array<int, 2> cells, ElementKind kind) {
  DeformableBody body;
  body.element = kind;
  body.mesh = rectangle_mesh(
      size, cells, {0, 0},
      kind == ElementKind::tri3 ? ElementShape::triangle : ElementShape::quadrilateral);
  return body;
}

inline std::vector<int> nodes_at(const Mesh& mesh, double x) { return nodes_where(mesh, {.x = x}); }

}  // namespace apothem::test
