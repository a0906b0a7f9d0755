// Loops on several threads.
//
// Items are divided into contiguous chunks, one for each thread, or taken one by one, and every
// item is worked on by one thread alone. What is summed over items is summed afterwards, in their
// order. So the result has the same bits for any number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace apothem {

/// Work, in nanoseconds on one thread, below which waking the others costs more than it gives.
inline constexpr double kWorthThreads = 4e4;

class Threads {
 public:
  explicit Threads(int count = 1) : count_(std::max(count, 1)) {}

  [[nodiscard]] int count() const { return count_; }

  /// True if work on so many items, each of which costs roughly `each` nanoseconds, is divided.
  [[nodiscard]] bool worth(int items, double each) const {
    return count_ > 1 && items * each >= kWorthThreads;
  }

  /// Where the chunk of a worker begins if work is divided; where the last one ends for count().
  [[nodiscard]] int first_of(int items, int worker) const {
    return static_cast<int>(std::int64_t{items} * worker / count_);
  }

  /// f(first, end, worker) for chunks of [0, items), with worker in [0, count()) different for
  /// chunks that run at the same time; see worth(). What f throws is thrown in the end.
  template <class F>
  void chunks(int items, double each, F&& f) const {
    if (!worth(items, each)) {
      f(0, items, 0);
      return;
    }
    using Function = std::remove_reference_t<F>;
    Task<Function> task{&f, this, items};
    run(
        [](void* data, int worker) {
          const auto& [function, threads, all] = *static_cast<Task<Function>*>(data);
          (*function)(threads->first_of(all, worker), threads->first_of(all, worker + 1), worker);
        },
        &task);
  }

  /// f(item) for each of the items, which may cost very different times: whoever is free takes the
  /// next one. See worth(). What f throws is thrown in the end, when others are done, too.
  template <class F>
  void each(int items, double cost, F&& f) const {
    std::atomic<int> taken{0};
    chunks(items, cost, [&](int, int, int) {
      for (int item = taken++; item < items; item = taken++) f(item);
    });
  }

 private:
  template <class F>
  struct Task {
    F* function;
    const Threads* threads;
    int items;
  };
  void run(void (*work)(void* task, int worker), void* task) const;

  int count_;
};

}  // namespace apothem
