#include "lib/solver/symmetric_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {
namespace {

// Entries are sums of a few parts, each known to some units in its last place.
constexpr double kRounding = 256 * std::numeric_limits<double>::epsilon();
constexpr double kUseless = 1e-9;  // residual of a solution, over the size of what is summed up
constexpr double kAside = 1e-3;    // of a shift, to get away from an eigenvalue
constexpr int kMostTries = 8;

}  // namespace

SymmetricSystem::SymmetricSystem(const Tangent& tangent, const ModalSystem& system)
    : moves_(system.moves) {
  std::vector<int> place(moves_.size(), -1);
  for (size_t c = 0; c < moves_.size(); ++c) {
    if (moves_[c] == 0) continue;
    place[c] = static_cast<int>(coordinate_.size());
    coordinate_.push_back(c);
  }
  const auto n = static_cast<Eigen::Index>(coordinate_.size());
  mass_.resize(n);
  rounding_.setZero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    mass_[i] = system.mass[coordinate_[static_cast<size_t>(i)]];
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<size_t>(n) + tangent.entries().size());
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 0.);  // so that every pivot has a place
  for (const Tangent::Entry& e : tangent.entries()) {
    const int row = place[static_cast<size_t>(e.row)],
              column = place[static_cast<size_t>(e.column)];
    if (row < 0 || column < 0) continue;
    entries.emplace_back(row, column, e.value);
    rounding_[row] += kRounding * std::abs(e.value) / 2;
    rounding_[column] += kRounding * std::abs(e.value) / 2;
  }
  Eigen::SparseMatrix<double> whole(n, n);
  whole.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> across = whole.transpose();
  matrix_ = (whole + across) / 2;
  const double norm = whole.norm();
  skew_ = norm > 0 ? (whole - across).eval().norm() / (2 * norm) : 0;
  factors_->analyzePattern(matrix_);
}

double SymmetricSystem::bound() const {
  const Vector inverse_root = mass_.cwiseSqrt().cwiseInverse();
  Vector sums = Vector::Zero(size());
  for (int column = 0; column < matrix_.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, column); it; ++it) {
      sums[it.row()] += std::abs(it.value()) * inverse_root[it.row()] * inverse_root[column];
    }
  }
  return size() > 0 ? sums.maxCoeff() : 0;
}

double SymmetricSystem::least() const {
  const double least = size() > 0 ? rounding_.cwiseQuotient(mass_).maxCoeff() : 0;
  return least > 0 ? least : 1;  // of what has no stiffness at all, any number will do
}

bool SymmetricSystem::factorise(const Vector& diagonal) {
  shifted_ = matrix_;
  shifted_.diagonal() += diagonal;
  factors_->factorize(shifted_);
  if (factors_->info() != Eigen::Success) return false;
  // Coordinates are eliminated in a fixed order, which may meet a pivot that is nearly zero.
  Vector b(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    b[i] = mass_[i] * (1 + 0.37 * std::sin(1. + 7. * static_cast<double>(i)));
  }
  const Vector x = solve(b);
  const Vector sizes = shifted_.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
  return (shifted_ * x - b).norm() <= kUseless * sizes.norm();
}

double SymmetricSystem::shift(double by) {
  for (int tries = 0; tries < kMostTries; ++tries) {
    if (factorise(-by * mass_)) return by;
    by *= 1 + kAside;
  }
  throw NoModes("the stiffness matrix has no useful factors");
}

std::vector<double> SymmetricSystem::shape(const Vector& phi) const {
  Eigen::Index largest = 0;
  phi.cwiseAbs().maxCoeff(&largest);
  const double norm = std::sqrt(phi.cwiseProduct(mass_).dot(phi));
  const double scale = (phi[largest] < 0 ? -1 : 1) / norm;
  std::vector<double> all(moves_.size(), 0);
  for (size_t i = 0; i < coordinate_.size(); ++i) {
    all[coordinate_[i]] = scale * phi[static_cast<Eigen::Index>(i)];
  }
  return all;
}

}  // namespace apothem
