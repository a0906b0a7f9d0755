#include "lib/fem/polygon_element.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "lib/fem/quad4.hpp"

namespace apothem {
namespace {

// kappa over modulus and thickness. With smaller values cells yield too much to single nodal
// forces, with larger ones they bend less accurately (docs/verification.md).
constexpr double kRest = 0.1;

// Four linear functionals of the displacements: one row each, columns x and y of each corner.
using Functionals = Eigen::Matrix<double, 4, Eigen::Dynamic>;

// A stress in the plane, and its traction on a normal.
struct Stress {
  double xx, yy, xy;
  [[nodiscard]] Vec2 on(const Vec2& normal) const {
    return {xx * normal.x() + xy * normal.y(), xy * normal.x() + yy * normal.y()};
  }
};

// The equilibrated stress fields that are linear in the coordinates, from Airy's cubic functions.
std::array<Stress, 4> linear_stresses(const Vec2& p) {
  return {Stress{p.y(), 0, 0}, Stress{0, p.x(), 0}, Stress{p.x(), 0, -p.y()},
          Stress{0, p.y(), -p.x()}};
}

// Twice the mixed complementary energy density of two stresses, a : C^-1 : b.
double complementary(const Elastic& e, const Stress& a, const Stress& b) {
  const double c = e.constrained(), d = e.coupled(), det = c * c - d * d;
  return (a.xx * (c * b.xx - d * b.yy) + a.yy * (c * b.yy - d * b.xx)) / det +
         a.xy * b.xy / e.shear();
}

// The functionals of Quad4: sqrt(stiffness) A.q and B.q, where q is the hourglass part of the
// displacements that the mean gradient leaves over.
Functionals of_quadrilateral(std::span<const Vec2> x, const Elastic& e, double thickness) {
  const auto [a, b, q] = quad::Reference(x);
  const double det = cross(a, b);
  const double bending = std::sqrt(4. / 3 * e.uniaxial() * thickness * det);
  const double q_xi = cross(q, b) / det, q_eta = cross(a, q) / det;
  constexpr int kXi[] = {-1, 1, 1, -1}, kEta[] = {-1, -1, 1, 1};
  Functionals f = Functionals::Zero(4, 8);
  for (int i = 0; i < 4; ++i) {
    const double part = (kXi[i] * kEta[i] - q_xi * kXi[i] - q_eta * kEta[i]) / 4;
    f.block<1, 2>(0, 2 * i) = bending / a.squaredNorm() * part * a;
    f.block<1, 2>(1, 2 * i) = bending / b.squaredNorm() * part * b;
  }
  return f;
}

// The work of the four stress fields, made orthonormal in complementary energy, on the
// displacements of the boundary.
Functionals of_linear_stresses(std::span<const Vec2> x, const Vec2& centroid, const Elastic& e,
                               double thickness) {
  const int n = static_cast<int>(x.size());
  // Complementary energies. Each triangle between an edge and the centroid is integrated by its
  // edge midpoints, which is exact for products of linear fields.
  Eigen::Matrix4d energy = Eigen::Matrix4d::Zero();
  // INT N_i (s n) ds over the two edges at each corner.
  Functionals work = Functionals::Zero(4, 2 * n);
  for (int i = 0; i < n; ++i) {
    const int j = next(i, n);
    const Vec2 p = x[i] - centroid, q = x[j] - centroid;
    for (const Vec2& middle : {Vec2(p / 2), Vec2(q / 2), Vec2((p + q) / 2)}) {
      const std::array<Stress, 4> s = linear_stresses(middle);
      for (int k = 0; k < 4; ++k) {
        for (int l = 0; l < 4; ++l) {
          energy(k, l) += thickness * cross(p, q) / 6 * complementary(e, s[k], s[l]);
        }
      }
    }
    const Vec2 normal(q.y() - p.y(), p.x() - q.x());  // outward normal times the length of the edge
    const std::array<Stress, 4> at_p = linear_stresses(p), at_q = linear_stresses(q);
    for (int k = 0; k < 4; ++k) {
      const Vec2 tp = thickness / 6 * at_p[k].on(normal), tq = thickness / 6 * at_q[k].on(normal);
      work.block<1, 2>(k, 2 * i) += 2 * tp + tq;
      work.block<1, 2>(k, 2 * j) += tp + 2 * tq;
    }
  }
  return energy.llt().matrixL().solve(work);
}

// The same energy in functionals that are orthogonal on the corners, with the share of the kappa
// energy subtracted from each (see the head of polygon_element.hpp).
Functionals without_penalty(const Functionals& f, double kappa) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> modes(f * f.transpose());
  Functionals g = modes.eigenvectors().transpose() * f;
  for (int k = 0; k < 4; ++k) {
    const double stiffness = modes.eigenvalues()[k];
    g.row(k) *= stiffness > kappa ? std::sqrt(1 - kappa / stiffness) : 0;
  }
  return g;
}

}  // namespace

void PolygonElement::prepare(std::span<const Vec2> x, const Elastic& e, double thickness,
                             double* out) {
  const int n = static_cast<int>(x.size());
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : x) mean += p / n;
  double area = 0;
  Vec2 centroid = Vec2::Zero();  // relative to the mean of the corners, until the division below
  for (int i = 0; i < n; ++i) {
    const Vec2 p = x[i] - mean, q = x[next(i, n)] - mean;
    area += cross(p, q) / 2;
    centroid += cross(p, q) / 6 * (p + q);
  }
  centroid = mean + centroid / area;

  const double kappa = n > 4 ? kRest * e.uniaxial() * thickness : 0;
  Functionals bending = Functionals::Zero(4, 2 * n);
  if (n == 4) bending = of_quadrilateral(x, e, thickness);
  if (n > 4) bending = without_penalty(of_linear_stresses(x, centroid, e, thickness), kappa);
  out[0] = area * thickness;
  out[kLanes] = kappa;
  for (int i = 0; i < n; ++i) {
    double* corner = out + static_cast<ptrdiff_t>(2 + kPerCorner * i) * kLanes;
    const Vec2 across = x[next(i, n)] - x[previous(i, n)];
    const Vec2 place = x[i] - mean;
    const double values[] = {across.y() / (2 * area), -across.x() / (2 * area), place.x(),
                             place.y()};
    for (int k = 0; k < 4; ++k) {
      corner[k * kLanes] = values[k];
      corner[(4 + 2 * k) * kLanes] = bending(k, 2 * i);
      corner[(5 + 2 * k) * kLanes] = bending(k, 2 * i + 1);
    }
  }
}

}  // namespace apothem
