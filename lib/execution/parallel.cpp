#include "lib/execution/parallel.hpp"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace apothem {
namespace {

using Work = void (*)(void* task, int worker);

// Loops of a step follow each other closely: a thread that is done looks for the next one for this
// long before it sleeps. It lets others have its core meanwhile.
constexpr int kLooks = 1000, kYields = 10000;
constexpr int kMostThreads = 4096;

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

// Threads that wait for work, for all loops of the program. The parts of a loop are taken by
// whoever is free, so that nobody waits for a thread that the system has not woken yet.
class Pool {
 public:
  void run(Work work, void* task, int workers) {
    const std::unique_lock busy(busy_, std::try_to_lock);
    if (!busy || !start(workers)) {  // a loop within a loop, or the system gives no threads
      for (int worker = 0; worker < workers; ++worker) work(task, worker);
      return;
    }
    const Ticket next{ticket_.load().round + 1, static_cast<std::uint16_t>(workers), 0};
    work_ = work;
    task_ = task;
    left_ = workers;
    {
      const std::scoped_lock lock(mutex_);
      ticket_ = next;
    }
    wake_.notify_all();
    work_on(next.round);
    const auto done = [&] { return left_ == 0; };
    if (!look_for(done)) {
      std::unique_lock lock(mutex_);
      done_.wait(lock, done);
    }
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  struct alignas(8) Ticket {
    std::uint32_t round = 0;                // loops so far
    std::uint16_t workers = 0, worker = 0;  // parts of the loop, and the next one to be taken
  };

  bool start(int workers) {
    if (workers > kMostThreads) return false;
    try {
      while (static_cast<int>(threads_.size()) + 1 < workers) {
        threads_.emplace_back([this] { serve(); });
      }
    } catch (const std::system_error&) {
      return false;
    }
    return true;
  }

  void serve() {
    for (std::uint32_t round = 0;;) {
      const auto called = [&] { return ticket_.load().round != round; };
      if (!look_for(called)) {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, called);
      }
      round = ticket_.load().round;
      work_on(round);
    }
  }

  // Takes parts of a loop as long as there are any.
  void work_on(std::uint32_t round) {
    for (Ticket ticket = ticket_.load(); ticket.round == round && ticket.worker < ticket.workers;) {
      Ticket next = ticket;
      ++next.worker;
      if (!ticket_.compare_exchange_weak(ticket, next)) continue;
      try {
        work_(task_, ticket.worker);
      } catch (...) {  // out of memory
        const std::scoped_lock lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
      }
      if (left_.fetch_sub(1) == 1) {
        const std::scoped_lock lock(mutex_);
        done_.notify_one();
      }
      ticket = ticket_.load();
    }
  }

  std::vector<std::thread> threads_;
  std::mutex busy_;   // held while a loop runs
  std::mutex mutex_;  // guards sleeping
  std::condition_variable wake_, done_;
  std::atomic<Ticket> ticket_;
  std::atomic<int> left_{0};    // parts of the loop that are not done
  std::exception_ptr failure_;  // the first of the loop; guarded while it runs
  Work work_ = nullptr;
  void* task_ = nullptr;
};

}  // namespace

void Threads::run(Work work, void* task) const {
  // Never destroyed: a process forked from this one has none of its threads to wait for.
  static Pool& pool = *new Pool;
  pool.run(work, task, count_);
}

}  // namespace apothem
