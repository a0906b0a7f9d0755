// Static equilibrium and frequencies of a mesh, with exact tangents of the elements' own kernels
// by the complex step.
#pragma once

#include <Eigen/SparseCore>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "lib/fem/element.hpp"
#include "lib/mesh/mesh.hpp"

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
  Structure(ElementKind kind, const Mesh& mesh, const Elastic& material, double thickness = 1);
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
  [[nodiscard]] VectorXd force(const VectorXd& u) const;
  /// Derivatives of force, exact.
  [[nodiscard]] SparseMatrix stiffness(const VectorXd& u) const;
  [[nodiscard]] SparseMatrix stiffness() const { return stiffness(VectorXd::Zero(size())); }
  /// Lumped mass of every unknown, kg.
  [[nodiscard]] VectorXd mass(double density) const;

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
  [[nodiscard]] std::vector<Vec2> places(int e) const;

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
  Factorised(const SparseMatrix& k, const std::vector<bool>& fixed);
  ~Factorised();
  /// Zero at the fixed unknowns.
  [[nodiscard]] VectorXd solve(const VectorXd& load) const;
  [[nodiscard]] const std::vector<int>& free() const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

/// Small displacements under nodal loads, N.
VectorXd solve_linear(const Structure& s, const Supports& supports, const VectorXd& load);

/// Large displacements by Newton's method from a guess, to round-off: until the residual has
/// stopped to fall below 1e-9 of the internal forces. Throws when 40 steps are not enough.
VectorXd solve_newton(const Structure& s, const Supports& supports, const VectorXd& load,
                      VectorXd u);

/// The lowest angular frequencies, rad/s, by subspace iteration on K + shift M; a small positive
/// shift admits rigid motions, whose frequencies come out as zero.
std::vector<double> lowest_frequencies(const SparseMatrix& k, const VectorXd& mass,
                                       const std::vector<bool>& fixed, int count, double shift);

/// The highest angular frequency, rad/s, of the free body by Lanczos' method; from below.
double highest_frequency(const SparseMatrix& k, const VectorXd& mass);

}  // namespace apothem::test
