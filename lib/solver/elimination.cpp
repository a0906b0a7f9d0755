#include "lib/solver/elimination.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace apothem {
namespace {

// Fronts are joined where that adds no more than these parts of zeros, by the number of columns (Y.
// Chen et al., ACM Trans. Math. Softw. 35 (2008) 22).
constexpr int kFew = 4, kSome = 16, kMany = 48;
constexpr double kOfSome = .8, kOfMany = .1, kOfMore = .05;

// Sorts pairs of numbers below `size`, which takes no longer than to read them a few times.
void sort_pairs(std::vector<std::pair<int, int>>& pairs, int size) {
  std::vector<std::pair<int, int>> sorted(pairs.size());
  for (int std::pair<int, int>::*const key :
       {&std::pair<int, int>::second, &std::pair<int, int>::first}) {
    std::vector<size_t> end(nth(size) + 1, 0);
    for (const auto& pair : pairs) ++end[nth(pair.*key) + 1];
    for (size_t k = 0; k < nth(size); ++k) end[k + 1] += end[k];
    for (const auto& pair : pairs) sorted[end[nth(pair.*key)]++] = pair;
    std::swap(pairs, sorted);
  }
}

// The nodes of a forest so that each comes after those below it.
std::vector<int> in_postorder(const std::vector<int>& parent) {
  const auto n = parent.size();
  std::vector<int> child(n, -1), next(n, -1), order, open;
  for (size_t i = n; i-- > 0;) {
    if (parent[i] < 0) continue;
    next[i] = std::exchange(child[nth(parent[i])], static_cast<int>(i));
  }
  for (size_t root = 0; root < n; ++root) {
    if (parent[root] >= 0) continue;
    open.push_back(static_cast<int>(root));
    while (!open.empty()) {
      const auto i = nth(open.back());
      const int below = std::exchange(child[i], -1);
      if (below < 0) {
        order.push_back(open.back());
        open.pop_back();
      } else {
        child[i] = next[nth(below)];
        open.push_back(below);
      }
    }
  }
  return order;
}

}  // namespace

Elimination::Elimination(int size, std::vector<std::pair<int, int>> pairs, int breadth)
    : size_(size) {
  for (auto& [row, column] : pairs) {
    if (row < column) std::swap(row, column);
  }
  sort_pairs(pairs, size);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  order(pairs);
  place_blocks(pairs);
  const std::vector<int> sorted = in_postorder(find_parents());
  std::vector<int> later(sorted.size());
  for (size_t k = 0; k < sorted.size(); ++k) later[nth(sorted[k])] = static_cast<int>(k);
  for (int& place : place_) place = later[nth(place)];
  place_blocks(pairs);
  find_fronts();
  join_fronts(breadth);
  measure_fronts();
}

void Elimination::order(const std::vector<std::pair<int, int>>& pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * pairs.size() + nth(size_));
  for (const auto& [row, column] : pairs) {
    entries.emplace_back(row, column, 1.);
    entries.emplace_back(column, row, 1.);
  }
  for (int i = 0; i < size_; ++i) entries.emplace_back(i, i, 1.);
  Eigen::SparseMatrix<double> pattern(size_, size_);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> eliminated;
  Eigen::AMDOrdering<int>()(pattern, eliminated);
  place_.resize(nth(size_));
  for (int k = 0; k < size_; ++k) place_[nth(eliminated.indices()[k])] = k;
}

// Sorts the blocks below the diagonal by columns, in the order of elimination.
void Elimination::place_blocks(const std::vector<std::pair<int, int>>& pairs) {
  std::vector<std::pair<int, int>> placed;  // column, row
  placed.reserve(pairs.size());
  for (const auto& [row, column] : pairs) {
    const int r = place_[nth(row)], c = place_[nth(column)];
    placed.emplace_back(std::min(r, c), std::max(r, c));
  }
  sort_pairs(placed, size_);
  const auto n = nth(size_);
  first_.assign(n + 1, 0);
  row_.clear();
  for (const auto& [column, row] : placed) {
    ++first_[nth(column) + 1];
    row_.push_back(row);
  }
  for (size_t k = 0; k < n; ++k) first_[k + 1] += first_[k];
}

// The tree of elimination: the first row of each column of L (J. Liu, SIAM J. Matrix Anal. Appl. 11
// (1990) 134).
std::vector<int> Elimination::find_parents() const {
  const auto n = nth(size_);
  std::vector<int> parent(n, -1), ancestor(n, -1);
  std::vector<std::vector<int>> columns(n);  // of the entries of each row
  for (size_t k = 0; k < n; ++k) {
    for (int p = first_[k]; p < first_[k + 1]; ++p) {
      columns[nth(row_[nth(p)])].push_back(static_cast<int>(k));
    }
  }
  for (size_t row = 0; row < n; ++row) {
    for (int i : columns[row]) {
      while (i >= 0 && i < static_cast<int>(row)) {
        const int next = std::exchange(ancestor[nth(i)], static_cast<int>(row));
        if (next < 0) parent[nth(i)] = static_cast<int>(row);
        i = next;
      }
    }
  }
  return parent;
}

// One front for each run of columns of which each has the rows of the next one, and that.
void Elimination::find_fronts() {
  const auto n = nth(size_);
  std::vector<std::vector<int>> rows(n), children(n);  // of each column
  std::vector<int> seen(n, -1);
  fronts_.clear();
  rows_.clear();
  for (size_t k = 0; k < n; ++k) {
    const int column = static_cast<int>(k);
    std::vector<int>& here = rows[k];
    seen[k] = column;
    const auto add = [&](int row) {
      if (std::exchange(seen[nth(row)], column) != column) here.push_back(row);
    };
    for (const int child : children[k]) {
      for (const int row : rows[nth(child)]) add(row);
    }
    for (int p = first_[k]; p < first_[k + 1]; ++p) add(row_[nth(p)]);
    if (!std::ranges::is_sorted(here)) std::ranges::sort(here);
    if (!here.empty()) children[nth(here[0])].push_back(column);
    const bool joins = children[k].size() == 1 && children[k][0] == column - 1 &&
                       rows[k - 1].size() == here.size() + 1;
    if (!joins) fronts_.push_back({.first = column});
    ++fronts_.back().count;
  }
  for (Front& front : fronts_) {
    const std::vector<int>& last = rows[nth(front.first + front.count - 1)];
    front.rows = rows_.size();
    front.below = static_cast<int>(last.size());
    rows_.insert(rows_.end(), last.begin(), last.end());
  }
}

// Joins fronts with those above them whose columns follow at once. A few zeros are cheaper than
// many small fronts.
void Elimination::join_fronts(int breadth) {
  std::vector<Front> joined;
  std::vector<double> zeros;  // blocks, in each of these
  for (Front front : fronts_) {
    double added = 0;
    while (!joined.empty()) {
      const Front& last = joined.back();
      const bool follows = last.first + last.count == front.first && last.below > 0 &&
                           rows_[last.rows] < front.first + front.count;
      if (!follows) break;
      const double more =
          added + zeros.back() + last.count * static_cast<double>(front.size() - last.below);
      const double columns = last.count + front.count;
      const double all = columns * (columns + 1) / 2 + columns * front.below;
      const double part = more / all;
      const int wide = breadth * (last.count + front.count);
      const bool good = wide <= kFew || part < (wide <= kSome   ? kOfSome
                                                : wide <= kMany ? kOfMany
                                                                : kOfMore);
      if (!good) break;
      front.first = last.first;
      front.count += last.count;
      added = more;
      joined.pop_back();
      zeros.pop_back();
    }
    joined.push_back(front);
    zeros.push_back(added);
  }
  fronts_ = std::move(joined);
  std::vector<int> of_column(nth(size_));
  for (size_t f = 0; f < fronts_.size(); ++f) {
    for (int c = 0; c < fronts_[f].count; ++c)
      of_column[nth(fronts_[f].first + c)] = static_cast<int>(f);
  }
  for (size_t f = 0; f < fronts_.size(); ++f) {
    if (fronts_[f].below == 0) continue;
    const auto parent = nth(of_column[nth(rows_[fronts_[f].rows])]);
    fronts_[f].parent = static_cast<int>(parent);
    fronts_[f].sibling = std::exchange(fronts_[parent].child, static_cast<int>(f));
  }
}

// The places of the factors, and how much is needed at a time.
void Elimination::measure_fronts() {
  size_t left = 0;
  std::vector<size_t> of_children(fronts_.size(), 0);  // what they leave
  for (size_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    const size_t height = nth(front.size()), below = nth(front.below);
    front.factor = room_.factors;
    room_.factors += height * nth(front.count);
    room_.height = std::max(room_.height, height);
    room_.columns = std::max(room_.columns, height * nth(front.count));
    left = left - of_children[f] + below * below;
    room_.left = std::max(room_.left, left);
    if (front.parent >= 0) of_children[nth(front.parent)] += below * below;
  }
}

}  // namespace apothem
