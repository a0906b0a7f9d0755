// Factors A = L D U of a sparse matrix of blocks with a symmetric pattern: L and U have unit blocks
// on the diagonal. Rows are eliminated one after the other in a fixed order (the up-looking method,
// T. Davis 2006, Sec. 4.7), with no pivoting but in the blocks of the diagonal. The arithmetic is
// of small dense blocks: of the bodies, B = 3, or of points, B = 2.
#pragma once

#include <Eigen/Dense>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace apothem {

template <int B>
class BlockFactors {
 public:
  using Block = Eigen::Matrix<double, B, B, Eigen::DontAlign>;
  using Part = Eigen::Matrix<double, B, 1, Eigen::DontAlign>;

  /// Finds an order of elimination (approximate minimum degree) and the places of the factors.
  /// `pairs`: blocks (row, column) of the matrix off its diagonal, those on one side of it; may
  /// repeat.
  void analyse(int size, std::vector<std::pair<int, int>> pairs);
  /// The block of the matrix at a place that was in `analyse` on one side, or on the diagonal.
  Block& at(int row, int column);
  void set_zero();
  /// Whether entries across the diagonal differ by no more than that part of the largest entry.
  [[nodiscard]] bool is_symmetric(double tolerance) const;
  [[nodiscard]] bool is_finite() const;
  /// Factorises the sum of the blocks. Where the matrix is symmetric U is the transpose of L, and
  /// is not computed. Returns false if a block of the diagonal is singular or not finite.
  bool factorise(bool symmetric);
  /// Solves A x = b in place. The order is that of `analyse`'s blocks.
  void solve(std::span<double> x) const;
  /// Calls visit(D) for the symmetric parts of the blocks of the diagonal.
  template <class F>
  void each_pivot(const F& visit) const {
    for (const Block& d : pivot_) visit(d);
  }
  /// Blocks in L.
  [[nodiscard]] size_t fill() const { return rows_.size(); }

 private:
  void order(const std::vector<std::pair<int, int>>& pairs);
  void find_pattern();

  int size_ = 0;
  std::vector<int> place_;  // of each block in the order of elimination
  // The matrix above the diagonal, column by column: row, block there, and block across.
  std::vector<int> first_, row_;
  std::vector<Block> above_, below_, diagonal_;
  // Of each row of L: its columns, ascending. Of each column of L: its rows, ascending.
  std::vector<int> row_first_, columns_, column_first_, rows_;
  std::vector<Block> lower_, upper_, pivot_, inverse_;
  bool symmetric_ = true;
  std::vector<Block> work_above_, work_below_;  // a column, and a row, while they are eliminated
  std::vector<int> filled_;                     // end of each column so far
};

template <int B>
void BlockFactors<B>::analyse(int size, std::vector<std::pair<int, int>> pairs) {
  size_ = size;
  for (auto& [row, column] : pairs) {
    if (row > column) std::swap(row, column);
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  order(pairs);
  for (auto& [row, column] : pairs) {
    row = place_[static_cast<size_t>(row)], column = place_[static_cast<size_t>(column)];
    if (row > column) std::swap(row, column);
    std::swap(row, column);  // sorted by columns
  }
  std::ranges::sort(pairs);
  const auto n = static_cast<size_t>(size);
  first_.assign(n + 1, 0);
  row_.clear();
  for (const auto& [column, row] : pairs) {
    ++first_[static_cast<size_t>(column) + 1];
    row_.push_back(row);
  }
  for (size_t k = 0; k < n; ++k) first_[k + 1] += first_[k];
  above_.resize(row_.size());
  below_.resize(row_.size());
  diagonal_.resize(n);
  find_pattern();
}

template <int B>
void BlockFactors<B>::order(const std::vector<std::pair<int, int>>& pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * pairs.size() + static_cast<size_t>(size_));
  for (const auto& [row, column] : pairs) {
    entries.emplace_back(row, column, 1.);
    entries.emplace_back(column, row, 1.);
  }
  for (int i = 0; i < size_; ++i) entries.emplace_back(i, i, 1.);
  Eigen::SparseMatrix<double> pattern(size_, size_);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> eliminated;
  Eigen::AMDOrdering<int>()(pattern, eliminated);
  place_.resize(static_cast<size_t>(size_));
  for (int k = 0; k < size_; ++k) place_[static_cast<size_t>(eliminated.indices()[k])] = k;
}

// The pattern of a row of L: from the entries of the matrix up the tree of elimination.
template <int B>
void BlockFactors<B>::find_pattern() {
  const auto n = static_cast<size_t>(size_);
  std::vector<int> parent(n, -1), seen(n, -1);
  std::vector<int> count(n, 0);
  row_first_.assign(1, 0);
  columns_.clear();
  for (int k = 0; k < size_; ++k) {
    const auto at = static_cast<size_t>(k);
    seen[at] = k;
    for (int p = first_[at]; p < first_[at + 1]; ++p) {
      for (int i = row_[static_cast<size_t>(p)]; seen[static_cast<size_t>(i)] != k;
           i = parent[static_cast<size_t>(i)]) {
        if (parent[static_cast<size_t>(i)] < 0) parent[static_cast<size_t>(i)] = k;
        columns_.push_back(i);
        ++count[static_cast<size_t>(i)];
        seen[static_cast<size_t>(i)] = k;
      }
    }
    std::sort(columns_.begin() + row_first_.back(), columns_.end());
    row_first_.push_back(static_cast<int>(columns_.size()));
  }
  column_first_.assign(n + 1, 0);
  for (size_t i = 0; i < n; ++i) column_first_[i + 1] = column_first_[i] + count[i];
  rows_.resize(columns_.size());
  lower_.resize(columns_.size());
  pivot_.resize(n);
  inverse_.resize(n);
  work_above_.assign(n, Block::Zero());
  filled_.assign(n, 0);
  for (int k = 0; k < size_; ++k) {
    for (int p = row_first_[static_cast<size_t>(k)]; p < row_first_[static_cast<size_t>(k) + 1];
         ++p) {
      const auto i = static_cast<size_t>(columns_[static_cast<size_t>(p)]);
      rows_[static_cast<size_t>(column_first_[i] + filled_[i]++)] = k;
    }
  }
}

template <int B>
typename BlockFactors<B>::Block& BlockFactors<B>::at(int row, int column) {
  const int r = place_[static_cast<size_t>(row)], c = place_[static_cast<size_t>(column)];
  if (r == c) return diagonal_[static_cast<size_t>(r)];
  const auto k = static_cast<size_t>(std::max(r, c));
  const auto found =
      std::lower_bound(row_.begin() + first_[k], row_.begin() + first_[k + 1], std::min(r, c));
  const auto i = static_cast<size_t>(found - row_.begin());
  return r < c ? above_[i] : below_[i];
}

template <int B>
void BlockFactors<B>::set_zero() {
  for (std::vector<Block>* blocks : {&above_, &below_, &diagonal_}) {
    std::ranges::fill(*blocks, Block::Zero());
  }
}

template <int B>
bool BlockFactors<B>::is_symmetric(double tolerance) const {
  double largest = 0, skew = 0;
  const auto compare = [&](const Block& a, const Block& b) {
    largest = std::max({largest, a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()});
    skew = std::max(skew, (a - b.transpose()).cwiseAbs().maxCoeff());
  };
  for (const Block& d : diagonal_) compare(d, d);
  for (size_t p = 0; p < above_.size(); ++p) compare(above_[p], below_[p]);
  return skew <= tolerance * largest;
}

template <int B>
bool BlockFactors<B>::is_finite() const {
  const auto finite = [](const Block& block) { return block.allFinite(); };
  return std::ranges::all_of(diagonal_, finite) && std::ranges::all_of(above_, finite) &&
         std::ranges::all_of(below_, finite);
}

template <int B>
bool BlockFactors<B>::factorise(bool symmetric) {
  symmetric_ = symmetric;
  if (!symmetric) {
    upper_.resize(lower_.size());
    work_below_.assign(work_above_.size(), Block::Zero());
  }
  std::ranges::fill(filled_, 0);
  for (size_t k = 0; k < static_cast<size_t>(size_); ++k) {
    for (auto p = static_cast<size_t>(first_[k]); p < static_cast<size_t>(first_[k + 1]); ++p) {
      work_above_[static_cast<size_t>(row_[p])] = above_[p];
      if (!symmetric) work_below_[static_cast<size_t>(row_[p])] = below_[p];
    }
    Block pivot = diagonal_[k];
    for (auto q = static_cast<size_t>(row_first_[k]); q < static_cast<size_t>(row_first_[k + 1]);
         ++q) {
      const auto i = static_cast<size_t>(columns_[q]);
      const Block above = work_above_[i];
      work_above_[i].setZero();
      const auto begin = static_cast<size_t>(column_first_[i]);
      const size_t end = begin + static_cast<size_t>(filled_[i]++);
      for (size_t p = begin; p < end; ++p) {
        work_above_[static_cast<size_t>(rows_[p])].noalias() -= lower_[p] * above;
      }
      Block lower;
      if (symmetric) {
        lower.noalias() = above.transpose() * inverse_[i];
      } else {
        lower.noalias() = work_below_[i] * inverse_[i];
        work_below_[i].setZero();
        for (size_t p = begin; p < end; ++p) {
          work_below_[static_cast<size_t>(rows_[p])].noalias() -= lower * upper_[p];
        }
        upper_[end] = above;
      }
      pivot.noalias() -= lower * above;
      lower_[end] = lower;
    }
    pivot_[k] = pivot;
    inverse_[k] = pivot.inverse();
    if (!inverse_[k].allFinite()) return false;
  }
  return true;
}

template <int B>
void BlockFactors<B>::solve(std::span<double> x) const {
  const auto n = static_cast<size_t>(size_);
  std::vector<Part> y(n);
  for (size_t i = 0; i < n; ++i)
    y[static_cast<size_t>(place_[i])] = Eigen::Map<const Part>(&x[B * i]);
  for (size_t i = 0; i < n; ++i) {
    for (auto p = static_cast<size_t>(column_first_[i]);
         p < static_cast<size_t>(column_first_[i + 1]); ++p) {
      y[static_cast<size_t>(rows_[p])].noalias() -= lower_[p] * y[i];
    }
  }
  for (size_t i = n; i-- > 0;) {
    Part sum = symmetric_ ? Part(Part::Zero()) : y[i];
    for (auto p = static_cast<size_t>(column_first_[i]);
         p < static_cast<size_t>(column_first_[i + 1]); ++p) {
      const Part& below = y[static_cast<size_t>(rows_[p])];
      if (symmetric_) {
        sum.noalias() -= lower_[p].transpose() * below;
      } else {
        sum.noalias() -= upper_[p] * below;
      }
    }
    y[i] = symmetric_ ? Part(inverse_[i] * y[i] + sum) : Part(inverse_[i] * sum);
  }
  for (size_t i = 0; i < n; ++i) {
    Eigen::Map<Part> part(&x[B * i]);
    part = y[static_cast<size_t>(place_[i])];
  }
}

}  // namespace apothem
