// Things that are joined to sets, by union-find with path halving.
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace apothem {

/// The numbers from 0 to `count` - 1, each at first in a set of its own.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count = 0) : parent_(count) { reset(count); }
  /// Begins anew in the same memory, which grows by doubling.
  void reset(size_t count) {
    if (parent_.size() < count) parent_.resize(2 * count);
    std::iota(parent_.begin(), parent_.begin() + static_cast<std::ptrdiff_t>(count), 0);
  }
  /// The number that stands for the set of i.
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Joins the set of i to that of j, whose number stands for both. False if it was the same set.
  bool join(int i, int j) {
    const int a = find(i), b = find(j);
    parent_[a] = b;
    return a != b;
  }

 private:
  std::vector<int> parent_;
};

}  // namespace apothem
