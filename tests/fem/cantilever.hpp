// The slender beam of the tests of elements: [0, L] x [-h/2, h/2], unit load down at its tip.
#pragma once

#include "tests/fem/static_solution.hpp"

namespace apothem::test {

/// Nodes on the line x = const.
inline std::vector<int> beam_nodes_at(const Mesh& mesh, double x) {
  std::vector<int> nodes;
  for (size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (std::abs(mesh.nodes[i].x() - x) < 1e-9) nodes.push_back(static_cast<int>(i));
  }
  std::sort(nodes.begin(), nodes.end(),
            [&](int a, int b) { return mesh.nodes[a].y() < mesh.nodes[b].y(); });
  return nodes;
}

struct Beam {
  double length = 10, height = 1;
  Elastic material{ElasticLaw::st_venant_kirchhoff, Plane::stress, 1000, .3};

  [[nodiscard]] double inertia() const { return height * height * height / 12; }
  [[nodiscard]] double bending_deflection() const {
    return length * length * length / (3 * material.young * inertia());
  }
  /// S. Timoshenko's shear factor 5/6.
  [[nodiscard]] double shear_deflection() const {
    return length / (5. / 6 * material.shear() * height);
  }

  /// Consistent nodal loads of the parabolic shear traction, sum 1 downwards, at the tip.
  [[nodiscard]] VectorXd tip_load(const Mesh& mesh) const {
    VectorXd load = VectorXd::Zero(static_cast<ptrdiff_t>(2 * mesh.nodes.size()));
    const std::vector<int> tip = beam_nodes_at(mesh, length);
    const double h = height;
    for (size_t i = 0; i + 1 < tip.size(); ++i) {
      const double a = mesh.nodes[tip[i]].y(), b = mesh.nodes[tip[i + 1]].y();
      // Simpson's rule with the linear shape functions: exact for cubics.
      const auto traction = [&](double y) { return 1.5 / h * (1 - 4 * y * y / (h * h)); };
      const double middle = traction((a + b) / 2);
      load[2 * tip[i] + 1] -= (b - a) / 6 * (traction(a) + 2 * middle);
      load[2 * tip[i + 1] + 1] -= (b - a) / 6 * (traction(b) + 2 * middle);
    }
    return load;
  }

  /// Deflection under the load, per unit: the work of the load. Clamped at x = 0.
  template <class Kind>
  [[nodiscard]] double clamped_deflection(Kind kind, const Mesh& mesh) const {
    const Structure structure(kind, mesh, material);
    Supports supports(mesh);
    for (const int node : beam_nodes_at(mesh, 0)) supports.fix(node);
    const VectorXd load = tip_load(mesh);
    return load.dot(solve_linear(structure, supports, load));
  }

  /// The same with the end x = 0 displaced as in the exact solution, whose linear stress and
  /// parabolic shear then hold everywhere (S. Timoshenko, J. Goodier, Theory of Elasticity, 1970,
  /// Art. 21): smooth, so that orders of convergence show. Plane stress.
  template <class Kind>
  [[nodiscard]] double smooth_deflection(Kind kind, const Mesh& mesh) const {
    const Structure structure(kind, mesh, material);
    Supports supports(mesh);
    for (const int node : beam_nodes_at(mesh, 0)) {
      supports.fix(node, exact_displacement(mesh.nodes[node]));
    }
    const VectorXd load = tip_load(mesh);
    return load.dot(solve_linear(structure, supports, load));
  }
  [[nodiscard]] double exact_smooth_deflection() const {
    return -exact_displacement({length, 0}).y();  // the same at every height
  }
  /// Under a unit load down at x = L.
  [[nodiscard]] Vec2 exact_displacement(const Vec2& p) const {
    const double nu = material.poisson, rigidity = material.young * inertia();
    const double x = p.x(), y = p.y(), l = length, h = height;
    return {y / (6 * rigidity) * ((6 * l - 3 * x) * x + (2 + nu) * (y * y - h * h / 4)),
            -1 / (6 * rigidity) *
                (3 * nu * y * y * (l - x) + (4 + 5 * nu) * h * h * x / 4 + (3 * l - x) * x * x)};
  }
};

}  // namespace apothem::test
