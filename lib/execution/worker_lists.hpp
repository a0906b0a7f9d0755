// Lists that the workers of a loop fill, each its own, and that become one list in their order. A
// chunk holds items that follow each other, so the one list has the order of the items, for any
// number of threads.
#pragma once

#include <vector>

#include "lib/execution/parallel.hpp"

namespace apothem {

template <class T>
class WorkerLists {
 public:
  /// Empties the lists of all workers. Memory is kept.
  void begin(const Threads& threads) {
    const auto count = static_cast<size_t>(threads.count());
    if (lists_.size() < count) lists_.resize(count);
    for (std::vector<T>& list : lists_) list.clear();
  }
  [[nodiscard]] std::vector<T>& of(int worker) { return lists_[static_cast<size_t>(worker)]; }
  [[nodiscard]] const std::vector<std::vector<T>>& all() const { return lists_; }
  [[nodiscard]] size_t size() const {
    size_t sum = 0;
    for (const std::vector<T>& list : lists_) sum += list.size();
    return sum;
  }

  /// Replaces the content of `whole` by all that has been found, and empties the lists.
  void join(std::vector<T>& whole) {
    whole.clear();
    for (std::vector<T>& list : lists_) {
      if (whole.empty()) {
        whole.swap(list);
      } else {
        whole.insert(whole.end(), list.begin(), list.end());
      }
      list.clear();
    }
  }

 private:
  std::vector<std::vector<T>> lists_;
};

}  // namespace apothem
