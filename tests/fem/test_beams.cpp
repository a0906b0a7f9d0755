// Beams: deflections and frequencies against Timoshenko's theory, orders of convergence.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/fem/cantilever.hpp"
#include "tests/fem/meshes.hpp"
#include "tests/fem/other_polygons.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// Relative errors of what is computed on three meshes, each twice as fine as the one before.
double order(double coarse, double middle, double fine) {
  return std::log2((coarse - middle) / (middle - fine));
}

// Angular frequencies of Timoshenko's beam of unit density (shear factor 5/6), free at x = L, and
// free or clamped at 0, below `limit`; those of the rod along it are merged in. The first-order
// system for (w, psi, M, Q) goes by its matrix exponential from end to end.
std::vector<double> beam_frequencies(const Beam& beam, bool clamped, double limit) {
  const double bending = beam.material.young * beam.inertia();
  const double shear = 5. / 6 * beam.material.shear() * beam.height;
  const auto closing = [&](double omega) {
    Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
    a(0, 1) = 1, a(0, 3) = 1 / shear;                         // w' = psi + Q / kGA
    a(1, 2) = 1 / bending;                                    // psi' = M / EI
    a(2, 1) = -omega * omega * beam.inertia(), a(2, 3) = -1;  // M' = -w^2 rho I psi - Q
    a(3, 0) = -omega * omega * beam.height;                   // Q' = -w^2 rho A w
    const Eigen::Matrix4d across = Eigen::Matrix4d(a * beam.length).exp();
    return across.block<2, 2>(2, clamped ? 2 : 0).determinant();
  };
  std::vector<double> roots;
  const double step = limit / 2000;
  for (double low = step; low < limit; low += step) {
    if (closing(low) * closing(low + step) > 0) continue;
    double a = low, b = low + step;
    for (int k = 0; k < 60; ++k) {
      const double m = (a + b) / 2;
      (closing(a) * closing(m) <= 0 ? b : a) = m;
    }
    roots.push_back(a);
  }
  const double first = std::numbers::pi * std::sqrt(beam.material.young) / beam.length;
  for (double rod = clamped ? first / 2 : first; rod < limit; rod += first) roots.push_back(rod);
  std::sort(roots.begin(), roots.end());
  return roots;
}

template <class Kind>
std::vector<double> frequencies(const Beam& beam, Kind kind, const Mesh& mesh, bool clamped,
                                int count) {
  const Structure s(kind, mesh, beam.material);
  Supports supports(mesh);
  if (clamped) {
    for (const int node : beam_nodes_at(mesh, 0)) supports.fix(node);
  }
  const int rigid = clamped ? 0 : 3;
  std::vector<double> all =
      lowest_frequencies(s.stiffness(), s.mass(1), supports.fixed, count + rigid, .1);
  all.erase(all.begin(), all.begin() + rigid);
  return all;
}

// Stiffness of a rectangular Q4-full with sides a : b along and across in bending, over the exact
// one: beside E y^2 the stress of the strain across that cannot follow, factor 1/(1 - nu^2), and
// the parasitic shear G x^2. In plane stress
//   r = (1 + (1 - nu)/2 (a/b)^2) / (1 - nu^2);
// n of them through the height leave 1 + (r - 1)/n^2: only the linear part in each one locks.
double locking(double nu, double aspect, int n) {
  const double one = (1 + (1 - nu) / 2 * aspect * aspect) / (1 - nu * nu);
  return 1 + (one - 1) / (n * n);
}

}  // namespace

TEST_CASE("cantilever: tip deflection of Q4, Q4-full and T3", "[fem]") {
  const Beam beam;
  const double theory = beam.bending_deflection() + beam.shear_deflection();
  for (const int n : {2, 4, 8}) {
    const Mesh grid = quad_grid(10 * n, n, beam.length, beam.height);
    const double q4 = beam.clamped_deflection(ElementKind::quad4, grid);
    CHECK(q4 == Approx(theory).epsilon(.01));
    const double locked = beam.bending_deflection() / locking(.3, 1, n) + beam.shear_deflection();
    CHECK(beam.clamped_deflection(ElementKind::quad4_full, grid) == Approx(locked).epsilon(.01));
    const std::array meshes{
        std::pair{"squares", grid},
        std::pair{"parallelograms", leaning_grid(10 * n, n, beam.length, beam.height, .5, false)},
        std::pair{"trapezoids", leaning_grid(10 * n, n, beam.length, beam.height, .25, true)},
        std::pair{"random", distorted(grid, .25)}};
    for (const auto& [name, mesh] : meshes) {
      const double plain = beam.clamped_deflection(ElementKind::quad4, mesh);
      const double full = beam.clamped_deflection(ElementKind::quad4_full, mesh);
      const double triangle = beam.clamped_deflection(ElementKind::tri3, triangles(mesh));
      CHECK(plain == Approx(theory).epsilon(n == 2 ? .03 : n == 4 ? .015 : .01));
      CHECK(std::abs(plain / theory - 1) < std::abs(full / theory - 1));
      CHECK(std::abs(plain / theory - 1) < std::abs(triangle / theory - 1));
      if (long_run()) {
        WARN(fmt::format("n = {} {}: Q4 {:.4f} Q4-full {:.4f} T3 {:.4f}", n, name, plain / theory,
                         full / theory, triangle / theory));
      }
    }
  }
}

TEST_CASE("Q4 of parallelograms is the element with incompatible modes", "[fem]") {
  // R. Taylor, P. Beresford, E. Wilson, Int. J. Numer. Meth. Eng. 10 (1976): bilinear
  // displacements, 1 - xi^2 and 1 - eta^2 within, condensed.
  const Vec2 a(.7, .1), b(-.2, .5);
  Mesh one;
  for (const auto& [xi, eta] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    one.nodes.emplace_back(xi * a + eta * b);
  }
  one.add_element(std::array{0, 1, 2, 3});
  for (const Plane plane : {Plane::stress, Plane::strain}) {
    const Elastic material{ElasticLaw::st_venant_kirchhoff, plane, 3, .3};
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    c(0, 0) = c(1, 1) = material.constrained();
    c(0, 1) = c(1, 0) = material.coupled();
    c(2, 2) = material.shear();
    Eigen::Matrix2d jacobian;
    jacobian << a, b;
    const Eigen::Matrix2d inverse = jacobian.inverse();
    Eigen::Matrix<double, 12, 12> k = Eigen::Matrix<double, 12, 12>::Zero();
    for (const double xi : {-std::sqrt(1. / 3), std::sqrt(1. / 3)}) {
      for (const double eta : {-std::sqrt(1. / 3), std::sqrt(1. / 3)}) {
        Eigen::Matrix<double, 6, 2> slopes;
        slopes << -(1 - eta) / 4, -(1 - xi) / 4, (1 - eta) / 4, -(1 + xi) / 4, (1 + eta) / 4,
            (1 + xi) / 4, -(1 + eta) / 4, (1 - xi) / 4, -2 * xi, 0, 0, -2 * eta;
        slopes = (slopes * inverse).eval();
        Eigen::Matrix<double, 3, 12> strain = Eigen::Matrix<double, 3, 12>::Zero();
        for (int i = 0; i < 6; ++i) {
          strain(0, 2 * i) = strain(2, 2 * i + 1) = slopes(i, 0);
          strain(1, 2 * i + 1) = strain(2, 2 * i) = slopes(i, 1);
        }
        k += jacobian.determinant() * strain.transpose() * c * strain;
      }
    }
    const Eigen::Matrix<double, 8, 8> condensed =
        k.topLeftCorner<8, 8>() - k.topRightCorner<8, 4>() * k.bottomRightCorner<4, 4>().inverse() *
                                      k.bottomLeftCorner<4, 8>();
    const MatrixXd q4 = Structure(ElementKind::quad4, one, material).stiffness();
    CHECK((q4 - condensed).norm() < 1e-14 * q4.norm());
  }
}

TEST_CASE("beam frequencies of Q4, 100 x 10", "[fem]") {
  const Beam beam;
  const Mesh grid = quad_grid(100, 10, beam.length, beam.height);
  for (const bool clamped : {false, true}) {
    const std::vector<double> theory = beam_frequencies(beam, clamped, 32);
    REQUIRE(theory.size() >= 6);
    const std::vector<double> found = frequencies(beam, ElementKind::quad4, grid, clamped, 6);
    for (int i = 0; i < 6; ++i) {
      INFO((clamped ? "clamped " : "free ") << i);
      CHECK(found[i] == Approx(theory[i]).epsilon(.01));
      if (long_run()) {
        WARN(fmt::format("{} {}: {:.4f} theory {:.4f} ({:+.2f} %)", clamped ? "clamped" : "free", i,
                         found[i], theory[i], 100 * (found[i] / theory[i] - 1)));
      }
    }
  }
}

TEST_CASE("frequencies and deflections of Q4 converge with order 2", "[fem][slow]") {
  const Beam beam;
  std::vector<double> first, fifth, tip;
  for (const int n : {4, 8, 16}) {
    const Mesh grid = quad_grid(25 * n / 2, n, beam.length, beam.height);
    const auto all = frequencies(beam, ElementKind::quad4, grid, false, 5);
    first.push_back(all[0]);
    fifth.push_back(all[4]);
    tip.push_back(
        beam.smooth_deflection(ElementKind::quad4, grid) / beam.exact_smooth_deflection() - 1);
  }
  if (long_run()) {
    WARN(fmt::format("orders {:.3f} {:.3f} {:.3f}", order(first[0], first[1], first[2]),
                     order(fifth[0], fifth[1], fifth[2]), order(tip[0], tip[1], tip[2])));
  }
  CHECK(order(first[0], first[1], first[2]) == Approx(2).margin(.15));
  CHECK(order(fifth[0], fifth[1], fifth[2]) == Approx(2).margin(.15));
  CHECK(std::log2(tip[1] / tip[2]) == Approx(2).margin(.15));
}

TEST_CASE("Voronoi cantilever converges with order 2 and beats T3", "[fem][slow]") {
  const Beam beam;
  const double exact = beam.exact_smooth_deflection();
  const auto error = [&](auto kind, const Mesh& mesh) {
    return beam.smooth_deflection(kind, mesh) / exact - 1;
  };
  struct Row {
    const char* name;
    std::vector<double> errors;
  };
  std::vector<Row> rows{
      {"cells", {}}, {"moved nodes", {}}, {"pairs of cells", {}}, {"random sites", {}}};
  for (const int cells : {200, 800, 3200}) {
    const Mesh plain = voronoi_cells(cells, beam.length, beam.height);
    const std::array meshes{plain, distorted(plain, .4), merged_cells(plain),
                            voronoi_cells(cells, beam.length, beam.height, 0)};
    CHECK(reflex_corners(meshes[1]) > 0);
    CHECK(reflex_corners(meshes[2]) > cells / 2);
    for (size_t i = 0; i < meshes.size(); ++i) {
      const double here = error(ElementKind::polygon, meshes[i]);
      rows[i].errors.push_back(here);
      // As many nodes or more in triangles.
      const int n = static_cast<int>(
          std::ceil(std::sqrt(static_cast<double>(meshes[i].nodes.size()) / beam.length)));
      const Mesh grid = quad_grid(10 * n, n, beam.length, beam.height);
      const double triangle = error(ElementKind::tri3, triangles(grid));
      INFO(rows[i].name << " " << cells);
      CHECK(std::abs(here) < .5 * std::abs(triangle));
      if (long_run()) {
        WARN(fmt::format("{} {}: nodes {}, polygons {:+.3f} %, T3 on {} nodes {:+.3f} %",
                         rows[i].name, cells, meshes[i].nodes.size(), 100 * here, grid.nodes.size(),
                         100 * triangle));
        if (cells < 3200) {
          WARN(fmt::format("  penalty only {:+.3f} %, mean-value coordinates {:+.3f} %",
                           100 * error(PenaltyOnly{}, meshes[i]),
                           100 * error(MeanValue{}, meshes[i])));
        }
      }
    }
  }
  for (const Row& row : rows) {
    const double measured = std::log2(row.errors[0] / row.errors[2]) / 2;
    INFO(row.name);
    CHECK(measured > 1.8);
    if (long_run()) WARN(fmt::format("{}: order {:.2f}", row.name, measured));
  }
}

TEST_CASE("a beam bent to a full circle", "[fem]") {
  // The end is brought to where it begins, turned once; in between Newton's method finds the
  // circle. In theory the ends ask for the moment 2 pi EI / L and no force.
  Beam beam;
  beam.length = 40;
  const double radius = beam.length / (2 * std::numbers::pi);
  const double theory = beam.material.young * beam.inertia() / radius;
  const std::array cases{
      std::pair{ElementKind::quad4, quad_grid(40, 1, beam.length, beam.height)},
      std::pair{ElementKind::quad4, quad_grid(80, 2, beam.length, beam.height)},
      std::pair{ElementKind::polygon, voronoi_cells(160, beam.length, beam.height)}};
  for (const auto& [kind, mesh] : cases) {
    const Structure structure(kind, mesh, beam.material);
    Supports supports(mesh);
    for (const int node : beam_nodes_at(mesh, 0)) supports.fix(node);
    for (const int node : beam_nodes_at(mesh, beam.length)) supports.fix(node, {-beam.length, 0});
    VectorXd guess(structure.size());
    for (int i = 0; i < static_cast<int>(mesh.nodes.size()); ++i) {
      const Vec2& p = mesh.nodes[i];
      const double angle = p.x() / radius, r = radius - p.y();
      guess.segment<2>(2 * i) = Vec2(r * std::sin(angle), radius - r * std::cos(angle)) - p;
    }
    const VectorXd u = solve_newton(structure, supports, VectorXd::Zero(structure.size()), guess);
    const VectorXd reaction = structure.force(u);
    Vec2 force = Vec2::Zero();
    double moment = 0;
    for (const int node : beam_nodes_at(mesh, beam.length)) {
      const Vec2 f = reaction.segment<2>(2 * node);
      force += f;
      moment += cross(Vec2(mesh.nodes[node] + u.segment<2>(2 * node)), f);
    }
    if (long_run()) {
      WARN(fmt::format("{} elements: moment {:.4f}, force {:.1e} of theory", mesh.element_count(),
                       moment / theory, force.norm() * radius / theory));
    }
    CHECK(moment == Approx(theory).epsilon(.03));
    CHECK(force.norm() * radius < .03 * theory);
  }
}
