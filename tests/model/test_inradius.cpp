// The inradius of bodies of both kinds.
#include "lib/model/inradius.hpp"

#include <catch2/catch.hpp>

#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("a rigid body has the radius of its largest inscribed circle", "[inradius]") {
  Model model;
  model.materials = {rock()};
  RigidBody body;
  set_shape(body, samples::block(0, 0, 3, 1), model);
  model.bodies.push_back(body);
  CHECK(inradius_of(model, 0) == Approx(.5));
}

TEST_CASE("a mesh has it to the size of an element, holes count", "[inradius]") {
  const Model block_model = model_of(block({3, 1}, {12, 4}, ElementKind::quad4), rock());
  CHECK(inradius_of(block_model, 0) == Approx(.5));
  DeformableBody ring;  // a square with a hole: 8 of 3 x 3 elements
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) ring.mesh.nodes.emplace_back(i, j);
  }
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const int n = 4 * j + i;
      if (i != 1 || j != 1) ring.mesh.add_element(std::array{n, n + 1, n + 5, n + 4});
    }
  }
  CHECK(inradius_of(model_of(std::move(ring), rock()), 0) == Approx(.5));
}
