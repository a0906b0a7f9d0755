// Factors A = L D U of a sparse matrix of small dense blocks with a symmetric pattern: L and U have
// unit blocks on the diagonal. The blocks are those of bodies, B = 3, or of points, B = 2.
//
// Multifrontal method (I. Duff and J. Reid, ACM Trans. Math. Softw. 9 (1983) 302): columns of L
// with the same rows are eliminated together, in a dense matrix, the front. What the elimination
// leaves there of the rows below is added to the front of the next columns that it concerns. There
// is no pivoting but in the blocks of the diagonal. The order of all sums is fixed, so that the
// factors have the same bits on all processors.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "lib/solver/elimination.hpp"

namespace apothem {

template <int B>
class FrontalFactors {
 public:
  using Block = Eigen::Matrix<double, B, B, Eigen::DontAlign>;
  using Part = Eigen::Matrix<double, B, 1, Eigen::DontAlign>;

  /// Finds the order of elimination and the fronts.
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

 private:
  void assemble(const Front& front, bool symmetric);
  bool eliminate(const Front& front, bool symmetric);
  bool eliminate_block(const Front& front, int k, int end, bool symmetric);
  void take_left(const Front& front, bool symmetric);
  void keep_factors(const Front& front, bool symmetric);
  void gather(const Front& front, std::span<const double> y, std::span<double> here) const;
  void solve_down(const Front& front, std::span<double> y, std::span<double> here) const;
  void solve_up(const Front& front, std::span<double> y, std::span<double> here) const;

  static constexpr size_t kBlock = B * B;

  Elimination order_;
  // The matrix below the diagonal, column by column in that order, and across it.
  std::vector<Block> below_, above_, diagonal_;
  std::vector<double> lower_, upper_;  // columns of L, and rows of U as columns, of each front
  std::vector<Block> pivot_, inverse_;
  bool symmetric_ = true;
  // The front at hand, column by column; its rows of U, as columns; what fronts have left.
  std::vector<double> front_, across_, left_;
  size_t top_ = 0;          // end of what is left
  std::vector<int> local_;  // row in the front at hand of each row of the matrix
};

extern template class FrontalFactors<2>;
extern template class FrontalFactors<3>;

}  // namespace apothem
