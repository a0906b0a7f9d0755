// Connected groups of things: the contact patches of meshes.
#pragma once

#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace apothem {

class Groups {
 public:
  explicit Groups(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  void join(int i, int j) { parent_[first(i)] = first(j); }

  /// The number of each thing's group. Groups are numbered by ascending keys, which their members
  /// have in common, then by their first members.
  [[nodiscard]] std::vector<int> numbers(const std::vector<std::pair<int, int>>& keys) {
    std::vector<int> oldest(parent_.size(), -1);
    std::map<std::pair<std::pair<int, int>, int>, int> order;
    for (int i = 0; i < static_cast<int>(parent_.size()); ++i) {
      if (oldest[first(i)] < 0) order[{keys[i], oldest[first(i)] = i}] = 0;
    }
    int next = 0;
    for (auto& [key, number] : order) number = next++;
    std::vector<int> result;
    for (int i = 0; i < static_cast<int>(parent_.size()); ++i) {
      result.push_back(order.at({keys[i], oldest[first(i)]}));
    }
    return result;
  }

 private:
  int first(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<int> parent_;
};

}  // namespace apothem
