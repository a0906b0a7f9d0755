// The inradius of a whole body, from its mesh.
#include <catch2/catch.hpp>

#include "lib/mesh/boundary.hpp"
#include "lib/mesh/disc_mesh.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/shapes.hpp"

using namespace apothem;

namespace {

double inradius(const Mesh& mesh) { return mesh_inradius(mesh, boundary(mesh)); }

}  // namespace

TEST_CASE("the inradius of a mesh is that of its body", "[mesh]") {
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    for (const int across : {1, 2, 3, 8}) {
      CHECK(inradius(rectangle_mesh({10, 1}, {10 * across, across}, {3, 4}, shape)) ==
            Approx(.5).epsilon(1e-12));
    }
    CHECK(inradius(disc_mesh({1, 1}, 2, {8, 1}, shape)) == Approx(2).epsilon(.01));
  }
  // Two bars of width 1 in an L: the largest circle touches four sides' lines near the corner.
  const double exact = 2 - std::sqrt(2);
  const double found =
      inradius(fill_mesh(Polygon(test::l_ring()), {}, .05, ElementShape::triangle));
  CHECK(found <= exact + 1e-12);
  CHECK(found == Approx(exact).epsilon(.05));
}
