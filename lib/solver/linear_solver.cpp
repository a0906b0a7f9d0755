#include "lib/solver/linear_solver.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

namespace apothem {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

// Entries that differ from those across the diagonal by less are round-off of symmetric sums.
constexpr double kSkew = 1e-12;

}  // namespace

struct LinearSolver::Factors {
  // Of each coordinate its number in the system, or -1.
  std::vector<int> number;
  int size = 0;
  // Places of the entries, as they came, and of each the number of its sum in `matrix`, or -1.
  // After them those of the diagonal.
  std::vector<std::pair<std::int32_t, std::int32_t>> places;
  std::vector<int> sum_of;
  std::vector<int> diagonal_of;
  std::vector<int> across;  // of each sum that of the transposed place, or -1
  Matrix matrix;
  bool symmetric = true;
  bool analysed_ldlt = false, analysed_lu = false;
  Eigen::SimplicialLDLT<Matrix> ldlt;
  Eigen::SparseLU<Matrix> lu;
  Eigen::VectorXd right, left;

  void number_coordinates(std::span<const std::uint8_t> moves) {
    std::vector<int> now(moves.size(), -1);
    int next = 0;
    for (size_t c = 0; c < moves.size(); ++c) {
      if (moves[c]) now[c] = next++;
    }
    if (now == number) return;
    number = std::move(now);
    size = next;
    places.clear();
  }
  [[nodiscard]] bool same_places(std::span<const Tangent::Entry> entries) const {
    return entries.size() == places.size() &&
           std::equal(entries.begin(), entries.end(), places.begin(),
                      [](const Tangent::Entry& e, const auto& place) {
                        return e.row == place.first && e.column == place.second;
                      });
  }
  void find_places(std::span<const Tangent::Entry> entries) {
    places.clear();
    places.reserve(entries.size());
    std::vector<Eigen::Triplet<double>> all;
    all.reserve(entries.size() + static_cast<size_t>(size));
    for (const Tangent::Entry& e : entries) {
      places.emplace_back(e.row, e.column);
      const int row = number[static_cast<size_t>(e.row)];
      const int column = number[static_cast<size_t>(e.column)];
      if (row >= 0 && column >= 0) all.emplace_back(row, column, 0.);
    }
    for (int i = 0; i < size; ++i) all.emplace_back(i, i, 0.);
    matrix.resize(size, size);
    matrix.setFromTriplets(all.begin(), all.end());
    matrix.makeCompressed();
    const auto sum_at = [&](int row, int column) {
      const int* const first = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column];
      const int* const last = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column + 1];
      return static_cast<int>(std::lower_bound(first, last, row) - matrix.innerIndexPtr());
    };
    sum_of.clear();
    sum_of.reserve(entries.size());
    for (const Tangent::Entry& e : entries) {
      const int row = number[static_cast<size_t>(e.row)];
      const int column = number[static_cast<size_t>(e.column)];
      sum_of.push_back(row >= 0 && column >= 0 ? sum_at(row, column) : -1);
    }
    diagonal_of.clear();
    for (int i = 0; i < size; ++i) diagonal_of.push_back(sum_at(i, i));
    across.clear();
    for (int column = 0; column < size; ++column) {
      for (int k = matrix.outerIndexPtr()[column]; k < matrix.outerIndexPtr()[column + 1]; ++k) {
        const int row = matrix.innerIndexPtr()[k], found = sum_at(column, row);
        const bool there =
            found < matrix.outerIndexPtr()[row + 1] && matrix.innerIndexPtr()[found] == column;
        across.push_back(there ? found : -1);
      }
    }
    analysed_ldlt = analysed_lu = false;
  }
  [[nodiscard]] bool is_symmetric() const {
    const double* const sums = matrix.valuePtr();
    double largest = 0, skew = 0;
    for (size_t k = 0; k < across.size(); ++k) {
      largest = std::max(largest, std::abs(sums[k]));
      skew = std::max(skew, std::abs(sums[k] - (across[k] < 0 ? 0 : sums[across[k]])));
    }
    return skew <= kSkew * largest;
  }
};

LinearSolver::LinearSolver() : factors_(std::make_unique<Factors>()) {}
LinearSolver::~LinearSolver() = default;

bool LinearSolver::factorise(const Tangent& tangent, std::span<const std::uint8_t> moves,
                             std::span<const double> diagonal) {
  Factors& f = *factors_;
  f.number_coordinates(moves);
  if (f.places.empty() || !f.same_places(tangent.entries())) f.find_places(tangent.entries());
  if (f.size == 0) return true;
  double* const sums = f.matrix.valuePtr();
  std::fill_n(sums, f.matrix.nonZeros(), 0.);
  for (size_t i = 0; i < f.sum_of.size(); ++i) {
    if (f.sum_of[i] >= 0) sums[f.sum_of[i]] += tangent.entries()[i].value;
  }
  for (size_t c = 0; c < f.number.size(); ++c) {
    if (f.number[c] >= 0) sums[f.diagonal_of[static_cast<size_t>(f.number[c])]] += diagonal[c];
  }
  if (!std::all_of(sums, sums + f.matrix.nonZeros(), [](double k) { return std::isfinite(k); })) {
    return false;
  }
  f.symmetric = f.is_symmetric();
  if (f.symmetric) {
    if (!f.analysed_ldlt) f.ldlt.analyzePattern(f.matrix);
    f.analysed_ldlt = true;
    f.ldlt.factorize(f.matrix);
    return f.ldlt.info() == Eigen::Success;
  }
  if (!f.analysed_lu) f.lu.analyzePattern(f.matrix);
  f.analysed_lu = true;
  f.lu.factorize(f.matrix);
  return f.lu.info() == Eigen::Success;
}

void LinearSolver::solve(std::span<const double> b, std::span<double> x) const {
  Factors& f = *factors_;
  f.right.resize(f.size);
  for (size_t c = 0; c < f.number.size(); ++c) {
    if (f.number[c] >= 0) f.right[f.number[c]] = b[c];
  }
  if (f.size > 0 && f.symmetric) {
    f.left = f.ldlt.solve(f.right);
  } else if (f.size > 0) {
    f.left = f.lu.solve(f.right);
  }
  for (size_t c = 0; c < f.number.size(); ++c) x[c] = f.number[c] >= 0 ? f.left[f.number[c]] : 0;
}

int LinearSolver::negative_pivots(double noise) const {
  const Factors& f = *factors_;
  if (!f.symmetric) return -1;
  if (f.size == 0) return 0;
  const Eigen::ArrayXd pivots = f.ldlt.vectorD().array();
  return static_cast<int>((pivots < -noise * pivots.abs().maxCoeff()).count());
}

}  // namespace apothem
