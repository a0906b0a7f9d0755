// A queue of the next events of a moving front, one per triangle. This header is private to the
// construction of the straight skeleton.
#pragma once

#include <utility>
#include <vector>

namespace apothem {

/// A binary heap of items 0 to n - 1 by time. Simultaneous items are ordered by their numbers.
template <class Time>
class EventQueue {
 public:
  explicit EventQueue(int items) : times_(items), places_(items, kAbsent) {}

  [[nodiscard]] bool empty() const { return heap_.empty(); }
  /// The first item and its time.
  [[nodiscard]] int first() const { return heap_.front(); }
  [[nodiscard]] const Time& first_time() const { return times_[heap_.front()]; }

  /// Adds an item, or changes its time.
  void set(int item, const Time& time) {
    times_[item] = time;
    if (places_[item] == kAbsent) {
      places_[item] = static_cast<int>(heap_.size());
      heap_.push_back(item);
    }
    settle(places_[item]);
  }

  /// Removes an item if it is there.
  void remove(int item) {
    const int place = places_[item];
    if (place == kAbsent) return;
    const int last = heap_.back();
    heap_.pop_back();
    places_[item] = kAbsent;
    if (last == item) return;
    heap_[place] = last;
    places_[last] = place;
    settle(place);
  }

 private:
  static constexpr int kAbsent = -1;

  [[nodiscard]] bool before(int a, int b) const {
    return times_[a] < times_[b] || (times_[a] == times_[b] && a < b);
  }
  void exchange(int p, int q) {
    std::swap(heap_[p], heap_[q]);
    places_[heap_[p]] = p;
    places_[heap_[q]] = q;
  }
  // Moves the item at a place of the heap up or down to where it belongs.
  void settle(int place) {
    for (int up = (place - 1) / 2; place > 0 && before(heap_[place], heap_[up]);
         place = up, up = (place - 1) / 2) {
      exchange(place, up);
    }
    const int size = static_cast<int>(heap_.size());
    for (int down = 2 * place + 1; down < size; down = 2 * place + 1) {
      if (down + 1 < size && before(heap_[down + 1], heap_[down])) ++down;
      if (!before(heap_[down], heap_[place])) break;
      exchange(place, down);
      place = down;
    }
  }

  std::vector<Time> times_;  // per item
  std::vector<int> places_;  // per item: its place in the heap
  std::vector<int> heap_;
};

}  // namespace apothem
