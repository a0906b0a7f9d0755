// Patch test: in any mesh, constant stress is exact.
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>
#include <cstring>
#include <numeric>

#include "lib/fem/finite_elements.hpp"
#include "lib/mesh/boundary.hpp"
#include "tests/fem/meshes.hpp"
#include "tests/fem/static_solution.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

struct Patch {
  ElementKind kind;
  Mesh mesh;
};

std::vector<Patch> patches() {
  const Mesh quads = distorted(quad_grid(4, 4, 1, 1), .35);
  const Mesh cells = voronoi_cells(60, 1, 1, 1);
  const Mesh dented = distorted(cells, .45), pairs = merged_cells(cells);
  CHECK(reflex_corners(dented) > 5);
  CHECK(reflex_corners(pairs) > 5);
  const Polygon drilled(
      {{0, -.5}, {1, -.5}, {1, .5}, {0, .5}},
      {{{.2, -.2}, {.5, -.3}, {.6, .1}, {.4, 0}}, {{.7, .2}, {.8, .2}, {.8, .4}}});
  const Mesh around = mesh_of_cells(
      drilled, in_world(drilled, voronoi_mesh(drilled, VoronoiOptions{.cells = 12}).mesh));
  CHECK(reflex_corners(around) > 5);
  return {{ElementKind::tri3, triangles(quads)}, {ElementKind::quad4, quads},
          {ElementKind::quad4_full, quads},      {ElementKind::polygon, quads},
          {ElementKind::polygon, cells},         {ElementKind::polygon, dented},
          {ElementKind::polygon, pairs},         {ElementKind::polygon, around}};
}

}  // namespace

TEST_CASE("patch test: constant stress, small and finite strain", "[fem]") {
  double worst = 0;
  for (const Patch& patch : patches()) {
    const int nodes = static_cast<int>(patch.mesh.nodes.size());
    const Boundary around = boundary(patch.mesh);
    std::vector<bool> outline(nodes, false);
    for (const BoundaryLoop& loop : around.loops) {
      for (const int node : loop.nodes) outline[node] = true;
    }
    CHECK_NOTHROW(tiling_boundary(cells_of_mesh(patch.mesh),
                                  static_cast<int>(boundary(patch.mesh).loops.size()) - 1));
    for (const ElasticLaw law : {ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean}) {
      for (const Plane plane : {Plane::stress, Plane::strain}) {
        for (const double size : {1e-6, 1.}) {
          const Elastic material{law, plane, 3, .3};
          const Tensor<double> h{.12 * size, .09 * size, -.02 * size, -.07 * size};
          const Structure structure(patch.kind, patch.mesh, material);
          Supports supports(patch.mesh);
          VectorXd guess = VectorXd::Zero(structure.size());
          for (int i = 0; i < nodes; ++i) {
            const Vec2 p = patch.mesh.nodes[i];
            const Point<double> u = h * Point<double>{p.x(), p.y()};
            if (outline[i]) supports.fix(i, {u.x, u.y});
            guess.segment<2>(2 * i) = Vec2(.8 * u.x, .8 * u.y);
          }
          const VectorXd u =
              solve_newton(structure, supports, VectorXd::Zero(structure.size()), guess);
          const ElementSet set{
              .kind = patch.kind, .mesh = &patch.mesh, .material = material, .density = 1};
          const FiniteElements fem(std::span(&set, 1), 1);
          const Mesh one{{{0, 0}, {1, 0}, {0, 1}}, {0, 1, 2}, {0, 3}, {}};
          const ElementSet single{
              .kind = ElementKind::tri3, .mesh = &one, .material = material, .density = 1};
          const CauchyStress exact = FiniteElements(std::span(&single, 1), 1)
                                         .stresses(std::array{0., 0., h.xx, h.yx, h.xy, h.yy})[0];
          const double scale = std::abs(exact.xx) + std::abs(exact.yy) + std::abs(exact.xy);
          const std::span<const double> displacements(u.data(), static_cast<size_t>(u.size()));
          int element = 0;
          for (const CauchyStress& s : fem.stresses(displacements)) {
            const CauchyStress alone = fem.stress(displacements, 0, element++);
            REQUIRE(std::memcmp(&alone, &s, sizeof s) == 0);
            const double error = std::max({std::abs(s.xx - exact.xx), std::abs(s.yy - exact.yy),
                                           std::abs(s.xy - exact.xy), std::abs(s.zz - exact.zz)});
            worst = std::max(worst, error / scale);
          }
        }
      }
    }
  }
  INFO("largest stress error " << worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("an element that is nowhere is the worst one", "[fem]") {
  const Mesh mesh = quad_grid(4, 4, 1, 1);
  const ElementSet set{.kind = ElementKind::quad4,
                       .mesh = &mesh,
                       .material = {ElasticLaw::st_venant_kirchhoff, Plane::stress, 3, .3},
                       .density = 1};
  const FiniteElements fem(std::span(&set, 1), 1);
  std::vector<double> u(2 * mesh.nodes.size());
  CHECK(fem.smallest_ratio(u).ratio == 1);
  u[2 * static_cast<size_t>(mesh.element(0)[0])] = std::nan("");
  const FiniteElements::Collapse worst = fem.smallest_ratio(u);
  CHECK(std::isnan(worst.ratio));
  CHECK(worst.element == 0);
}

TEST_CASE("only rigid motions have no energy", "[fem]") {
  const Elastic material{ElasticLaw::st_venant_kirchhoff, Plane::stress, 3, .3};
  const auto softest = [&](ElementKind kind, const std::vector<Vec2>& corners) {
    Mesh one;
    one.nodes = corners;
    std::vector<int> numbers(corners.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    one.add_element(numbers);
    const MatrixXd k = Structure(kind, one, material).stiffness();
    const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(k).eigenvalues();
    CHECK(values.head<3>().cwiseAbs().maxCoeff() < 1e-14 * material.young);
    return values[3] / material.young;
  };
  const std::vector<Vec2> quad{{0, 0}, {1.3, -.1}, {1.1, .8}, {-.2, 1.1}};
  CHECK(softest(ElementKind::quad4, quad) > .05);
  CHECK(softest(ElementKind::quad4_full, quad) > .05);
  CHECK(softest(ElementKind::tri3, {quad[0], quad[1], quad[3]}) > .05);
  for (const int n : {3, 4, 5, 6, 7, 12}) {
    CHECK(softest(ElementKind::polygon, samples::regular(n).vertices()) > .05);
  }
  CHECK(softest(ElementKind::polygon, samples::l_shape().vertices()) > .05);
  CHECK(softest(ElementKind::polygon, samples::star(5, .4).vertices()) > .05);
}
