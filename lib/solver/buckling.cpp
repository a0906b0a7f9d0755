// Linear buckling: K_s phi = mu K_0 phi with K_s = K_1 - K_0 and mu = -1/f. The smallest positive
// factors f are the lowest mu.
#include <Spectra/SymGEigsSolver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lib/solver/symmetric_system.hpp"

namespace apothem {
namespace {

using Vector = SymmetricSystem::Vector;
using Sparse = Eigen::SparseMatrix<double>;

constexpr Eigen::Index kDenseBuckling = 120;  // coordinates up to which dense matrices are faster
constexpr double kRitz = 1e-11;               // tolerance of Ritz values, relative
constexpr int kMostRestarts = 1000, kMostRounds = 20;
constexpr double kAbove = 1e-6;  // of a factor: nearer ones count as multiple

struct Buckle {
  double mu;
  Vector shape;  // of the norm 1 in K_0
};

// K_s without the pairs that are known.
class Change {
 public:
  using Scalar = double;
  Change(const Sparse& change, const Sparse& base, const std::vector<Buckle>& known)
      : change_(change) {
    for (const Buckle& b : known) known_.push_back({b.mu, base * b.shape});
  }
  [[nodiscard]] Eigen::Index rows() const { return change_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return change_.cols(); }
  void perform_op(const double* in, double* out) const {
    const Vector x = Eigen::Map<const Vector>(in, rows());
    Vector y = change_ * x;
    for (const Buckle& b : known_) y -= b.mu * b.shape.dot(x) * b.shape;
    Eigen::Map<Vector>(out, rows()) = y;
  }

 private:
  const Sparse& change_;
  std::vector<Buckle> known_;  // with K_0 phi
};

// K_0, factorised.
class Base {
 public:
  using Scalar = double;
  explicit Base(const SymmetricSystem& system) : system_(system) {}
  [[nodiscard]] Eigen::Index rows() const { return system_.size(); }
  [[nodiscard]] Eigen::Index cols() const { return system_.size(); }
  void solve(const double* in, double* out) const {
    Eigen::Map<Vector>(out, rows()) = system_.solve(Eigen::Map<const Vector>(in, rows()));
  }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Vector>(out, rows()) = system_.matrix() * Eigen::Map<const Vector>(in, rows());
  }

 private:
  const SymmetricSystem& system_;
};

void refuse_soft(SymmetricSystem& system) {
  if (!system.factorise(-system.rounding())) {
    throw NoModes("the stiffness matrix without the loads has no useful factors");
  }
  if (system.negative() > 0) {
    throw NoModes(
        "where the loads begin, there are motions that nothing resists: support what can move "
        "freely");
  }
}

std::vector<Buckle> dense_buckles(const Sparse& change, const Sparse& base) {
  const Eigen::MatrixXd left = change, right = base;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> all(left, right);
  std::vector<Buckle> found;
  for (Eigen::Index i = 0; i < left.rows(); ++i) {
    found.push_back({all.eigenvalues()[i], all.eigenvectors().col(i)});
  }
  return found;
}

// The number of factors between 0 and f: of negative eigenvalues of K_0 + f (K_1 - K_0).
int factors_below(double f, const Tangent& unloaded, const Tangent& loaded, const ModalSystem& of) {
  Tangent sum;
  const auto add = [&](const Tangent& part, double times) {
    for (const Tangent::Entry& e : part.entries()) {
      sum.add(static_cast<size_t>(e.row), static_cast<size_t>(e.column), times * e.value);
    }
  };
  add(unloaded, 1 - f);
  add(loaded, f);
  SymmetricSystem system(sum, of);
  return system.factorise(Vector::Zero(system.size())) ? system.negative() : 0;
}

// The lowest ones, which may be multiple: what is found is taken out and looked for again, until
// the number of factors says that none is missing.
std::vector<Buckle> lowest_buckles(SymmetricSystem& base, const Tangent& unloaded,
                                   const Tangent& loaded, const ModalSystem& of, int count) {
  const Sparse change = SymmetricSystem(loaded, of).matrix() - base.matrix();
  std::vector<Buckle> found;
  int wanted = count;
  for (int round = 0; round < kMostRounds && wanted > 0; ++round) {
    if (!base.factorise(Vector::Zero(base.size()))) break;
    Change without(change, base.matrix(), found);
    Base inverse(base);
    const Eigen::Index most = std::min<Eigen::Index>(wanted, base.size() - 1);
    Spectra::SymGEigsSolver<Change, Base, Spectra::GEigsMode::RegularInverse> lanczos(
        without, inverse, most, std::min(base.size(), std::max(2 * most + 1, most + 20)));
    lanczos.init();
    lanczos.compute(Spectra::SortRule::SmallestAlge, kMostRestarts, kRitz);
    const Vector values = lanczos.eigenvalues();
    const Eigen::MatrixXd vectors = lanczos.eigenvectors();
    const size_t before = found.size();
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (!(values[i] < 0)) continue;
      const Vector shape = vectors.col(i);
      found.push_back({values[i], shape / std::sqrt(shape.dot(base.matrix() * shape))});
    }
    std::ranges::stable_sort(found, {}, &Buckle::mu);
    if (found.size() == before) break;
    const size_t last = std::min(found.size(), static_cast<size_t>(count)) - 1;
    const double factor = -1 / found[last].mu * (1 + kAbove);
    const auto below =
        std::ranges::count_if(found, [&](const Buckle& b) { return -1 / b.mu <= factor; });
    wanted = factors_below(factor, unloaded, loaded, of) - static_cast<int>(below);
  }
  return found;
}

}  // namespace

std::vector<Mode> buckling_modes(const Tangent& unloaded, const Tangent& loaded,
                                 const ModalSystem& of, int count) {
  SymmetricSystem base(unloaded, of);
  if (base.size() == 0) return {};
  refuse_soft(base);
  const SymmetricSystem end(loaded, of);
  const Sparse change = end.matrix() - base.matrix();
  std::vector<Buckle> found =
      base.size() <= kDenseBuckling || 3 * static_cast<Eigen::Index>(count) >= base.size()
          ? dense_buckles(change, base.matrix())
          : lowest_buckles(base, unloaded, loaded, of, count);
  // A change of the stiffness that rounding may have made says nothing.
  const Vector rounding = base.rounding() + end.rounding();
  std::vector<Mode> modes;
  for (const Buckle& b : found) {
    const double known = b.shape.cwiseProduct(rounding).dot(b.shape);
    const double norm = b.shape.dot(base.matrix() * b.shape);
    if (!(b.mu * norm < -known) || static_cast<int>(modes.size()) == count) continue;
    modes.push_back({-1 / b.mu, base.shape(b.shape)});
  }
  return modes;
}

}  // namespace apothem
