// Static equilibrium and frequencies of a mesh, with exact tangents of the elements' own kernels
// by the complex step.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <complex>
#include <functional>
#include <stdexcept>
#include <vector>

#include "apothem/fem/element.hpp"
#include "apothem/fem/mass.hpp"
#include "apothem/mesh/mesh.hpp"
#include "cases/samples.hpp"

namespace apothem::test {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

/// Unknowns are x, y of each node.
struct Supports {
  std::vector<bool> fixed;
  VectorXd value;  ///< prescribed displacement, m
  explicit Supports(const Mesh& mesh)
      : fixed(2 * mesh.nodes.size(), false),
        value(VectorXd::Zero(static_cast<ptrdiff_t>(2 * mesh.nodes.size()))) {}
  void fix(int node, int axis, double u = 0) {
    fixed[2 * node + axis] = true;
    value[2 * node + axis] = u;
  }
  void fix(int node, const Vec2& u = Vec2::Zero()) {
    fix(node, 0, u.x());
    fix(node, 1, u.y());
  }
};

/// One body of elements of one kind. The mesh must outlive it.
class Structure {
 public:
  Structure(ElementKind kind, const Mesh& mesh, const Elastic& material, double thickness = 1)
      : mesh_(mesh), material_(material), thickness_(thickness) {
    with_element(kind, [&](auto element) { take(element); });
  }
  /// Any struct with the functions of the library's elements.
  template <class Element>
  Structure(Element element, const Mesh& mesh, const Elastic& material, double thickness = 1)
      : mesh_(mesh), material_(material), thickness_(thickness) {
    take(element);
  }
  Structure(const Structure&) = delete;
  Structure& operator=(const Structure&) = delete;

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] ptrdiff_t size() const { return static_cast<ptrdiff_t>(2 * mesh_.nodes.size()); }

  /// Internal forces, N.
  [[nodiscard]] VectorXd force(const VectorXd& u) const {
    VectorXd f = VectorXd::Zero(size());
    std::vector<Point<double>> local, out;
    for (int e = 0; e < mesh_.element_count(); ++e) {
      gather(e, u, local);
      out.resize(local.size());
      force_(e, local.data(), out.data());
      const auto c = mesh_.element(e);
      for (size_t i = 0; i < c.size(); ++i) f.segment<2>(2 * c[i]) += Vec2(out[i].x, out[i].y);
    }
    return f;
  }

  /// Derivatives of force, exact.
  [[nodiscard]] SparseMatrix stiffness(const VectorXd& u) const {
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<Point<Complex>> local, out;
    constexpr double kStep = 1e-40;
    for (int e = 0; e < mesh_.element_count(); ++e) {
      gather(e, u, local);
      out.resize(local.size());
      const auto c = mesh_.element(e);
      for (size_t j = 0; j < 2 * c.size(); ++j) {
        Complex& varied = j % 2 ? local[j / 2].y : local[j / 2].x;
        varied += Complex(0, kStep);
        complex_force_(e, local.data(), out.data());
        varied -= Complex(0, kStep);
        const int column = 2 * c[j / 2] + static_cast<int>(j % 2);
        for (size_t i = 0; i < c.size(); ++i) {
          entries.emplace_back(2 * c[i], column, out[i].x.imag() / kStep);
          entries.emplace_back(2 * c[i] + 1, column, out[i].y.imag() / kStep);
        }
      }
    }
    SparseMatrix k(size(), size());
    k.setFromTriplets(entries.begin(), entries.end());
    return k;
  }
  [[nodiscard]] SparseMatrix stiffness() const { return stiffness(VectorXd::Zero(size())); }

  /// Lumped mass of every unknown, kg.
  [[nodiscard]] VectorXd mass(double density) const {
    VectorXd m = VectorXd::Zero(size());
    for (int e = 0; e < mesh_.element_count(); ++e) {
      const std::vector<double> areas = corner_areas(places(e));
      const auto c = mesh_.element(e);
      for (size_t i = 0; i < c.size(); ++i) {
        m.segment<2>(2 * c[i]).array() += density * thickness_ * areas[i];
      }
    }
    return m;
  }

 private:
  template <class Element>
  void take(Element) {
    std::vector<size_t> start;
    for (int e = 0; e < mesh_.element_count(); ++e) {
      const std::vector<Vec2> x = places(e);
      start.push_back(data_.size());
      data_.resize(data_.size() +
                   static_cast<size_t>(kLanes * Element::stored(static_cast<int>(x.size()))));
      Element::prepare(x, material_, thickness_, &data_[start.back()]);
    }
    const auto kernel = [this, start]<class N>(int e, const Point<N>* u, Point<N>* f) {
      with_law(material_, [&]<class Law>(const Law& law) {
        const Response<Law, false> r(law, material_, 0, thickness_);
        N power(0.);
        Element::force(Stored<N>{&data_[start[e]]}, r, static_cast<int>(mesh_.element(e).size()), u,
                       u, f, power);
      });
    };
    force_ = kernel;
    complex_force_ = kernel;
  }
  [[nodiscard]] std::vector<Vec2> places(int e) const {
    std::vector<Vec2> x;
    for (const int node : mesh_.element(e)) x.push_back(mesh_.nodes[node]);
    return x;
  }
  template <class N>
  void gather(int e, const VectorXd& u, std::vector<Point<N>>& local) const {
    local.clear();
    for (const int node : mesh_.element(e)) local.push_back({N(u[2 * node]), N(u[2 * node + 1])});
  }

  const Mesh& mesh_;
  Elastic material_;
  double thickness_;
  std::vector<double> data_;
  std::function<void(int, const Point<double>*, Point<double>*)> force_;
  std::function<void(int, const Point<Complex>*, Point<Complex>*)> complex_force_;
};

/// A matrix without the rows and columns of fixed unknowns, factorised.
class Factorised {
 public:
  Factorised(const SparseMatrix& k, const std::vector<bool>& fixed) : place_(fixed.size(), -1) {
    for (size_t i = 0; i < fixed.size(); ++i) {
      if (fixed[i]) continue;
      place_[i] = static_cast<int>(free_.size());
      free_.push_back(static_cast<int>(i));
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < k.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator it(k, column); it; ++it) {
        const int i = place_[it.row()], j = place_[it.col()];
        if (i >= 0 && j >= 0) entries.emplace_back(i, j, it.value());
      }
    }
    SparseMatrix reduced(static_cast<int>(free_.size()), static_cast<int>(free_.size()));
    reduced.setFromTriplets(entries.begin(), entries.end());
    ldlt_.compute(reduced);
    if (ldlt_.info() != Eigen::Success) throw std::runtime_error("singular stiffness");
  }
  /// Zero at the fixed unknowns.
  [[nodiscard]] VectorXd solve(const VectorXd& load) const {
    const VectorXd reduced = ldlt_.solve(VectorXd(load(free_)));
    VectorXd u = VectorXd::Zero(load.size());
    u(free_) = reduced;
    return u;
  }
  [[nodiscard]] const std::vector<int>& free() const { return free_; }

 private:
  std::vector<int> place_, free_;
  Eigen::SimplicialLDLT<SparseMatrix> ldlt_;
};

/// Small displacements under nodal loads, N.
inline VectorXd solve_linear(const Structure& s, const Supports& supports, const VectorXd& load) {
  const SparseMatrix k = s.stiffness();
  return supports.value + Factorised(k, supports.fixed).solve(load - k * supports.value);
}

/// Large displacements by Newton's method from a guess, to round-off: until the residual has
/// stopped to fall below 1e-9 of the internal forces. Throws when 40 steps are not enough.
inline VectorXd solve_newton(const Structure& s, const Supports& supports, const VectorXd& load,
                             VectorXd u) {
  double last = HUGE_VAL;
  for (size_t i = 0; i < supports.fixed.size(); ++i) {
    if (supports.fixed[i]) u[static_cast<ptrdiff_t>(i)] = supports.value[static_cast<ptrdiff_t>(i)];
  }
  for (int step = 0; step < 40; ++step) {
    const VectorXd inside = s.force(u), rest = load - inside;
    const Factorised tangent(s.stiffness(u), supports.fixed);
    const double size = VectorXd(rest(tangent.free())).norm();
    if (size < 1e-9 * inside.norm() && size >= .5 * last) return u;
    last = size;
    u += tangent.solve(rest);
  }
  throw std::runtime_error("Newton does not converge");
}

/// The lowest angular frequencies, rad/s, by subspace iteration on K + shift M; a small positive
/// shift admits rigid motions, whose frequencies come out as zero.
inline std::vector<double> lowest_frequencies(const SparseMatrix& k, const VectorXd& mass,
                                              const std::vector<bool>& fixed, int count,
                                              double shift) {
  const SparseMatrix shifted = k + shift * SparseMatrix(mass.asDiagonal());
  const Factorised factorised(shifted, fixed);
  const int size = 2 * count + 8;
  samples::Random random(1);
  MatrixXd x(k.rows(), size);
  for (ptrdiff_t i = 0; i < x.size(); ++i) x.data()[i] = random.uniform(-1, 1);
  VectorXd values = VectorXd::Constant(size, HUGE_VAL);
  for (int step = 0; step < 100; ++step) {
    MatrixXd y(k.rows(), size);
    for (int j = 0; j < size; ++j) y.col(j) = factorised.solve(mass.cwiseProduct(x.col(j)));
    const MatrixXd ky = shifted * y, my = mass.asDiagonal() * y;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> ritz(y.transpose() * ky,
                                                                  y.transpose() * my);
    x = y * ritz.eigenvectors();
    const double change =
        (ritz.eigenvalues() - values).head(count).cwiseAbs().maxCoeff() / ritz.eigenvalues()[count];
    values = ritz.eigenvalues();
    if (change < 1e-12) {
      std::vector<double> frequencies;
      for (int i = 0; i < count; ++i) {
        frequencies.push_back(std::sqrt(std::max(0., values[i] - shift)));
      }
      return frequencies;
    }
  }
  throw std::runtime_error("subspace iteration does not converge");
}

/// The highest angular frequency, rad/s, of the free body by Lanczos' method; from below.
inline double highest_frequency(const SparseMatrix& k, const VectorXd& mass) {
  const int steps = std::min<int>(120, static_cast<int>(mass.size()));
  const VectorXd scale = mass.cwiseSqrt().cwiseInverse();
  samples::Random random(2);
  MatrixXd q(mass.size(), steps);
  VectorXd next(mass.size());
  for (double& value : next) value = random.uniform(-1, 1);
  MatrixXd t = MatrixXd::Zero(steps, steps);
  for (int j = 0; j < steps; ++j) {
    q.col(j) = next.normalized();
    next = scale.cwiseProduct(k * scale.cwiseProduct(q.col(j)));
    t(j, j) = q.col(j).dot(next);
    for (int twice = 0; twice < 2; ++twice) {
      next -= q.leftCols(j + 1) * (q.leftCols(j + 1).transpose() * next);
    }
    if (j + 1 < steps) t(j, j + 1) = t(j + 1, j) = next.norm();
  }
  return std::sqrt(Eigen::SelfAdjointEigenSolver<MatrixXd>(t).eigenvalues().maxCoeff());
}

}  // namespace apothem::test
