#include "tests/fem/static_solution.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <stdexcept>

#include "apps/cases/samples.hpp"
#include "lib/fem/mass.hpp"

namespace apothem::test {
namespace {

template <class N>
void gather(std::span<const int> element, const VectorXd& u, std::vector<Point<N>>& local) {
  local.clear();
  for (const int node : element) local.push_back({N(u[2 * node]), N(u[2 * node + 1])});
}

}  // namespace

Structure::Structure(ElementKind kind, const Mesh& mesh, const Elastic& material, double thickness)
    : mesh_(mesh), material_(material), thickness_(thickness) {
  with_element(kind, [&](auto element) { take(element); });
}

VectorXd Structure::force(const VectorXd& u) const {
  VectorXd f = VectorXd::Zero(size());
  std::vector<Point<double>> local, out;
  for (int e = 0; e < mesh_.element_count(); ++e) {
    gather(mesh_.element(e), u, local);
    out.resize(local.size());
    force_(e, local.data(), out.data());
    const auto c = mesh_.element(e);
    for (size_t i = 0; i < c.size(); ++i) f.segment<2>(2 * c[i]) += Vec2(out[i].x, out[i].y);
  }
  return f;
}

SparseMatrix Structure::stiffness(const VectorXd& u) const {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<Point<Complex>> local, out;
  constexpr double kStep = 1e-40;
  for (int e = 0; e < mesh_.element_count(); ++e) {
    gather(mesh_.element(e), u, local);
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

VectorXd Structure::mass(double density) const {
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

std::vector<Vec2> Structure::places(int e) const {
  std::vector<Vec2> x;
  for (const int node : mesh_.element(e)) x.push_back(mesh_.nodes[node]);
  return x;
}

struct Factorised::Solver {
  std::vector<int> free;
  Eigen::SimplicialLDLT<SparseMatrix> ldlt;
};

Factorised::Factorised(const SparseMatrix& k, const std::vector<bool>& fixed)
    : solver_(std::make_unique<Solver>()) {
  std::vector<int> place(fixed.size(), -1);
  for (size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i]) continue;
    place[i] = static_cast<int>(solver_->free.size());
    solver_->free.push_back(static_cast<int>(i));
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < k.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator it(k, column); it; ++it) {
      const int i = place[it.row()], j = place[it.col()];
      if (i >= 0 && j >= 0) entries.emplace_back(i, j, it.value());
    }
  }
  SparseMatrix reduced(static_cast<int>(solver_->free.size()),
                       static_cast<int>(solver_->free.size()));
  reduced.setFromTriplets(entries.begin(), entries.end());
  solver_->ldlt.compute(reduced);
  if (solver_->ldlt.info() != Eigen::Success) throw std::runtime_error("singular stiffness");
}

Factorised::~Factorised() = default;

VectorXd Factorised::solve(const VectorXd& load) const {
  const VectorXd reduced = solver_->ldlt.solve(VectorXd(load(solver_->free)));
  VectorXd u = VectorXd::Zero(load.size());
  u(solver_->free) = reduced;
  return u;
}

const std::vector<int>& Factorised::free() const { return solver_->free; }

VectorXd solve_linear(const Structure& s, const Supports& supports, const VectorXd& load) {
  const SparseMatrix k = s.stiffness();
  return supports.value + Factorised(k, supports.fixed).solve(load - k * supports.value);
}

VectorXd solve_newton(const Structure& s, const Supports& supports, const VectorXd& load,
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

std::vector<double> lowest_frequencies(const SparseMatrix& k, const VectorXd& mass,
                                       const std::vector<bool>& fixed, int count, double shift) {
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

double highest_frequency(const SparseMatrix& k, const VectorXd& mass) {
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
