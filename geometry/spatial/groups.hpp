// Connected groups of things: the contact patches of meshes.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "geometry/polygon/disjoint_sets.hpp"

namespace apothem {

class Groups {
 public:
  explicit Groups(size_t count) : sets_(count) {}

  void join(int i, int j) { sets_.join(i, j); }

  /// The number of each thing's group. Groups are numbered by ascending keys, which their members
  /// have in common, then by their first members.
  [[nodiscard]] std::vector<int> numbers(const std::vector<std::pair<int, int>>& keys) {
    std::vector<int> oldest(keys.size(), -1);  // member of each set
    std::map<std::pair<std::pair<int, int>, int>, int> order;
    for (int i = 0; i < static_cast<int>(keys.size()); ++i) {
      int& first = oldest[sets_.find(i)];
      if (first < 0) order[{keys[i], first = i}] = 0;
    }
    int next = 0;
    for (auto& [key, number] : order) number = next++;
    std::vector<int> result;
    for (int i = 0; i < static_cast<int>(keys.size()); ++i) {
      result.push_back(order.at({keys[i], oldest[sets_.find(i)]}));
    }
    return result;
  }

 private:
  DisjointSets sets_;
};

}  // namespace apothem
