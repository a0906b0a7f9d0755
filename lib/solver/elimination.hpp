// In which order the blocks of a sparse matrix with a symmetric pattern are eliminated, and which
// of them together. The order is that of approximate minimum degree (P. Amestoy, T. Davis and I.
// Duff, SIAM J. Matrix Anal. Appl. 17 (1996) 886; Eigen), and each block comes after those below it
// in the tree of elimination.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace apothem {

/// A number that counts from 0, as that of a place in a vector.
constexpr size_t nth(int i) { return static_cast<size_t>(i); }

/// Columns that are eliminated together, because the same rows follow from all of them.
struct Front {
  int first = 0, count = 0;  ///< columns
  int parent = -1;           ///< the front that gets what is left; -1 if nothing is
  int child = -1;            ///< the last front whose parent this one is
  int sibling = -1;          ///< the one before this one that has the same parent
  size_t rows = 0;           ///< where its rows below begin, see Elimination::rows_of
  int below = 0;             ///< their number
  size_t factor = 0;         ///< blocks in the columns of the fronts before this one
  [[nodiscard]] int size() const { return count + below; }
};

class Elimination {
 public:
  /// Most numbers of blocks.
  struct Room {
    size_t factors = 0;  ///< in the columns of all fronts
    size_t height = 0;   ///< rows of a front
    size_t columns = 0;  ///< in the columns of a front
    size_t left = 0;     ///< left by fronts at a time
  };

  Elimination() = default;
  /// `pairs`: places (row, column) of blocks off the diagonal, those on one side of it; may repeat.
  /// `breadth`: rows of a block.
  Elimination(int size, std::vector<std::pair<int, int>> pairs, int breadth);

  [[nodiscard]] int size() const { return size_; }
  /// The place of a block in the order of elimination.
  [[nodiscard]] int place(int block) const { return place_[nth(block)]; }
  /// The number of blocks of the matrix below its diagonal, column by column in that order.
  [[nodiscard]] size_t entries() const { return row_.size(); }
  /// The rows of those of a column, ascending, and the number of the first of them.
  [[nodiscard]] std::span<const int> rows_of_column(size_t column) const {
    return {row_.data() + first_[column], nth(first_[column + 1] - first_[column])};
  }
  [[nodiscard]] size_t first_entry(size_t column) const { return nth(first_[column]); }
  /// Each front comes after its children.
  [[nodiscard]] std::span<const Front> fronts() const { return fronts_; }
  /// The rows below the columns of a front, ascending.
  [[nodiscard]] std::span<const int> rows_of(const Front& front) const {
    return {rows_.data() + front.rows, nth(front.below)};
  }
  [[nodiscard]] const Room& room() const { return room_; }

 private:
  void order(const std::vector<std::pair<int, int>>& pairs);
  void place_blocks(const std::vector<std::pair<int, int>>& pairs);
  [[nodiscard]] std::vector<int> find_parents() const;
  void find_fronts();
  void join_fronts(int breadth);
  void measure_fronts();

  int size_ = 0;
  std::vector<int> place_, first_, row_;
  std::vector<Front> fronts_;
  std::vector<int> rows_;
  Room room_;
};

}  // namespace apothem
