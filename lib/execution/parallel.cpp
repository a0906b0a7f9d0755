#include "apothem/execution/parallel.hpp"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace apothem {
namespace {

using Work = void (*)(void* task, int worker, int workers);

// Loops of a step follow each other closely: a thread that is done looks for the next one for this
// long before it sleeps. It lets others have its core meanwhile.
constexpr int kLooks = 1000, kYields = 1000;

template <class Ready>
bool look_for(const Ready& ready) {
  for (int i = 0; i < kLooks; ++i) {
    if (ready()) return true;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  for (int i = 0; i < kYields; ++i) {
    if (ready()) return true;
    std::this_thread::yield();
  }
  return false;
}

// Threads that wait for work, for all loops of the program.
class Pool {
 public:
  void run(Work work, void* task, int workers) {
    const std::unique_lock busy(busy_, std::try_to_lock);
    if (!busy || !start(workers)) {  // a loop within a loop, or the system gives no threads
      for (int worker = 0; worker < workers; ++worker) work(task, worker, workers);
      return;
    }
    {
      const std::scoped_lock lock(mutex_);
      work_ = work;
      task_ = task;
      workers_ = workers;
      left_.store(static_cast<int>(threads_.size()));
      round_.fetch_add(1);
    }
    wake_.notify_all();
    work(task, 0, workers);
    const auto done = [&] { return left_.load() == 0; };
    if (look_for(done)) return;
    std::unique_lock lock(mutex_);
    done_.wait(lock, done);
  }

 private:
  bool start(int workers) {
    try {
      while (static_cast<int>(threads_.size()) + 1 < workers) {
        const int worker = static_cast<int>(threads_.size()) + 1;
        threads_.emplace_back([this, worker, round = round_.load()] { serve(worker, round); });
      }
    } catch (const std::system_error&) {
      return false;
    }
    return true;
  }

  void serve(int worker, unsigned round) {
    for (;;) {
      const auto called = [&] { return round_.load() != round; };
      if (!look_for(called)) {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, called);
      }
      ++round;
      if (worker < workers_) work_(task_, worker, workers_);
      if (left_.fetch_sub(1) == 1) {
        const std::scoped_lock lock(mutex_);
        done_.notify_one();
      }
    }
  }

  std::vector<std::thread> threads_;
  std::mutex busy_;   // held while a loop runs
  std::mutex mutex_;  // guards sleeping
  std::condition_variable wake_, done_;
  std::atomic<unsigned> round_{0};
  std::atomic<int> left_{0};
  Work work_ = nullptr;
  void* task_ = nullptr;
  int workers_ = 0;
};

}  // namespace

void Threads::run(Work work, void* task) const {
  // Never destroyed: a process forked from this one has none of its threads to wait for.
  static Pool& pool = *new Pool;
  pool.run(work, task, count_);
}

}  // namespace apothem
