// The order of what is kept for pairs in slots, when it is put into the order of the pairs again.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace apothem {

class SlotOrder {
 public:
  /// Slots have the numbers 0 to `count` - 1 so far.
  void begin(size_t count) {
    before_.clear();
    is_used_.assign(count, false);
  }
  /// The next slot is to be the one that had this number. Returns the new number.
  int add(int slot) {
    is_used_[static_cast<size_t>(slot)] = true;
    before_.push_back(static_cast<size_t>(slot));
    return static_cast<int>(before_.size()) - 1;
  }
  /// Slots that have not been added come to the end, where they are dropped.
  void end() {
    used_ = before_.size();
    for (size_t slot = 0; slot < is_used_.size(); ++slot) {
      if (!is_used_[slot]) before_.push_back(slot);
    }
  }

  /// Puts what the slots hold into this order. A list that is too short has nothing for the last
  /// slots yet.
  template <class T>
  void apply(std::vector<T>& list) {
    list.resize(before_.size());
    is_used_.assign(before_.size(), false);
    // Along the cycles of the permutation, so that no second list is needed.
    for (size_t first = 0; first < before_.size(); ++first) {
      if (is_used_[first]) continue;
      T kept = std::move(list[first]);
      size_t to = first;
      for (size_t from = before_[to]; from != first; from = before_[to]) {
        is_used_[to] = true;
        list[to] = std::move(list[from]);
        to = from;
      }
      is_used_[to] = true;
      list[to] = std::move(kept);
    }
    list.resize(used_);
  }

 private:
  std::vector<size_t> before_;  // of each slot
  std::vector<bool> is_used_;
  size_t used_ = 0;
};

}  // namespace apothem
