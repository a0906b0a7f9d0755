// Cook's membrane: R. Cook, J. Struct. Div. ASCE 100 (1974). A tapered panel, clamped on its left
// side and sheared on its right one: bending, shear and distorted elements at once.
#include <catch2/catch.hpp>

#include "tests/fem/meshes.hpp"
#include "tests/fem/static_solution.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// From the square [0, 1] x [-1/2, 1/2] to the panel.
Vec2 to_panel(const Vec2& p) {
  const double x = 48 * p.x(), s = p.y() + .5;
  return {x, x * 44 / 48 + s * (44 + (16. - 44) * p.x())};
}

// Vertical displacement of the middle of the right side; load 1, E = 1, nu = 1/3, plane stress.
double middle_displacement(ElementKind kind, Mesh mesh) {
  std::vector<int> left, right;
  for (int i = 0; i < static_cast<int>(mesh.nodes.size()); ++i) {
    if (mesh.nodes[i].x() < 1e-9) left.push_back(i);
    if (mesh.nodes[i].x() > 1 - 1e-9) right.push_back(i);
  }
  std::sort(right.begin(), right.end(),
            [&](int a, int b) { return mesh.nodes[a].y() < mesh.nodes[b].y(); });
  for (Vec2& p : mesh.nodes) p = to_panel(p);
  const Structure panel(kind, mesh, {ElasticLaw::st_venant_kirchhoff, Plane::stress, 1, 1. / 3});
  Supports supports(mesh);
  for (const int node : left) supports.fix(node);
  VectorXd load = VectorXd::Zero(panel.size());
  for (size_t i = 0; i + 1 < right.size(); ++i) {
    const double half = (mesh.nodes[right[i + 1]].y() - mesh.nodes[right[i]].y()) / 32;
    load[2 * right[i] + 1] += half;
    load[2 * right[i + 1] + 1] += half;
  }
  const VectorXd u = solve_linear(panel, supports, load);
  for (size_t i = 0; i + 1 < right.size(); ++i) {
    const double a = mesh.nodes[right[i]].y(), b = mesh.nodes[right[i + 1]].y();
    if (b < 52) continue;
    const double s = (52 - a) / (b - a);
    return (1 - s) * u[2 * right[i] + 1] + s * u[2 * right[i + 1] + 1];
  }
  return 0;
}

}  // namespace

TEST_CASE("Cook's membrane", "[fem][slow]") {
  // R. Cook, D. Malkus, M. Plesha, Concepts and Applications of Finite Element Analysis, 1989.
  constexpr double kKnown = 23.96;
  std::map<ElementKind, double> last;
  for (const int n : {2, 4, 8, 16, 32}) {
    if (n == 32 && !long_run()) break;
    const Mesh quads = quad_grid(n, n, 1, 1);
    std::string line = "n = " + std::to_string(n);
    for (const ElementName& element : kElements) {
      const Mesh mesh = element.kind == ElementKind::tri3      ? triangles(quads)
                        : element.kind == ElementKind::polygon ? voronoi_cells(n * n, 1, 1)
                                                               : quads;
      const double value = middle_displacement(element.kind, mesh);
      last[element.kind] = value / kKnown - 1;
      line += "  " + std::string(element.name) + " " + std::to_string(value);
    }
    if (long_run()) WARN(line);
    if (n == 2) {
      // What tables in the literature give for Pian and Sumihara's element ...
      CHECK(middle_displacement(ElementKind::quad4, quads) == Approx(21.13).margin(.01));
      // ... and for two by two points.
      CHECK(middle_displacement(ElementKind::quad4_full, quads) == Approx(11.85).margin(.01));
    }
  }
  CHECK(std::abs(last[ElementKind::quad4]) < .004);
  CHECK(std::abs(last[ElementKind::polygon]) < .004);
  CHECK(last[ElementKind::tri3] < -.005);
  CHECK(last[ElementKind::quad4_full] < -.005);
}
