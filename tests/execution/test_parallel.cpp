// Loops on several threads: chunks, the same bits, and when threads are woken.
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <mutex>
#include <new>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "lib/execution/parallel.hpp"
#include "lib/execution/worker_lists.hpp"

using namespace apothem;

namespace {

constexpr double kLong = 1e9;  // ns: worth threads for a single item

struct Chunk {
  int first, end, worker;
};
std::vector<Chunk> chunks_of(const Threads& threads, int items, double each) {
  std::vector<Chunk> chunks;
  std::mutex guard;
  threads.chunks(items, each, [&](int first, int end, int worker) {
    const std::scoped_lock lock(guard);
    chunks.push_back({first, end, worker});
  });
  std::sort(chunks.begin(), chunks.end(),
            [](const Chunk& p, const Chunk& q) { return p.worker < q.worker; });
  return chunks;
}

}  // namespace

TEST_CASE("chunks cover every item exactly once, for any number of threads", "[parallel]") {
  for (int count = 1; count <= 5; ++count) {
    const Threads threads(count);
    for (const int items : {0, 1, 2, 3, 4, 5, 7, 64, 1000, 100003}) {
      CAPTURE(count, items);
      std::vector<std::atomic<int>> visits(static_cast<size_t>(items));
      threads.chunks(items, kLong, [&](int first, int end, int) {
        for (int i = first; i < end; ++i) ++visits[static_cast<size_t>(i)];
      });
      CHECK(std::all_of(visits.begin(), visits.end(), [](const auto& n) { return n == 1; }));
    }
  }
}

TEST_CASE("what a chunk throws is thrown when all have ended", "[parallel]") {
  for (int count = 1; count <= 4; ++count) {
    const Threads threads(count);
    for (int round = 0; round < 20; ++round) {
      std::atomic<int> ended = 0;
      const auto work = [&](int first, int, int) {
        ++ended;
        if (first == 0) throw std::bad_alloc();
      };
      CHECK_THROWS_AS(threads.chunks(1000, kLong, work), std::bad_alloc);
      CHECK(ended == count);
      ended = 0;
      threads.chunks(1000, kLong, [&](int, int, int) { ++ended; });
      CHECK(ended == count);
    }
  }
}

TEST_CASE("chunks are contiguous, in the order of their workers, and about equal", "[parallel]") {
  for (int count = 1; count <= 5; ++count) {
    for (const int items : {1, 3, 5, 1000, 100003}) {
      CAPTURE(count, items);
      const std::vector<Chunk> chunks = chunks_of(Threads(count), items, kLong);
      REQUIRE_FALSE(chunks.empty());
      REQUIRE(static_cast<int>(chunks.size()) <= count);
      int next = 0, longest = 0, shortest = items;
      std::set<int> workers;
      for (const auto& [first, end, worker] : chunks) {
        CHECK(first == next);
        CHECK(end >= first);
        CHECK(worker >= 0);
        CHECK(worker < count);
        workers.insert(worker);
        longest = std::max(longest, end - first);
        shortest = std::min(shortest, end - first);
        next = end;
      }
      CHECK(next == items);
      CHECK(workers.size() == chunks.size());
      CHECK(longest - shortest <= 1);
    }
  }
}

TEST_CASE("no item number overflows in the largest of loops", "[parallel]") {
  const int items = std::numeric_limits<int>::max();
  const std::vector<Chunk> chunks = chunks_of(Threads(5), items, kLong);
  CHECK(chunks.front().first == 0);
  CHECK(chunks.back().end == items);
  for (const Chunk& c : chunks) CHECK(c.end > c.first);
}

TEST_CASE("what is summed in the order of the items has the same bits for any number of threads",
          "[parallel]") {
  const int items = 20011;
  double before = 0;
  for (int count = 1; count <= 5; ++count) {
    const Threads threads(count);
    std::vector<double> values(items);
    threads.chunks(items, kLong, [&](int first, int end, int) {
      for (int i = first; i < end; ++i) values[i] = std::sin(1e3 * i) * std::pow(10., i % 17);
    });
    const double sum = std::accumulate(values.begin(), values.end(), 0.);
    if (count > 1) CHECK(sum == before);
    before = sum;
  }
  CHECK(before != 0);
}

TEST_CASE("workers that run at the same time have memory of their own", "[parallel]") {
  const Threads threads(4);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::vector<int>> found(threads.count());
    threads.chunks(10000, kLong, [&](int first, int end, int worker) {
      for (int i = first; i < end; ++i) found[worker].push_back(i);
    });
    std::vector<int> all;
    for (const std::vector<int>& some : found) all.insert(all.end(), some.begin(), some.end());
    std::vector<int> expected(10000);
    std::iota(expected.begin(), expected.end(), 0);
    REQUIRE(all == expected);
  }
}

TEST_CASE("lists of workers become one in the order of the items", "[parallel]") {
  WorkerLists<int> lists;
  std::vector<int> whole{-1};
  for (const int count : {4, 1, 7, 3}) {
    const Threads threads(count);
    for (const int items : {0, 1, 5, 10007}) {
      CAPTURE(count, items);
      // None, the later ones, the earlier ones, or two of three.
      for (int kind = 0; kind < 4; ++kind) {
        const auto wanted = [&](int i) {
          return kind == 1 ? i > items / 2 : kind == 2 ? i < items / 3 : kind == 3 && i % 3 != 0;
        };
        lists.begin(threads);
        threads.chunks(items, kLong, [&](int first, int end, int worker) {
          for (int i = first; i < end; ++i) {
            if (wanted(i)) lists.of(worker).push_back(i);
          }
        });
        std::vector<int> expected;
        for (int i = 0; i < items; ++i) {
          if (wanted(i)) expected.push_back(i);
        }
        CHECK(lists.size() == expected.size());
        lists.join(whole);
        REQUIRE(whole == expected);
        CHECK(lists.size() == 0);
      }
    }
  }
}

TEST_CASE("threads are woken for work that is worth it, and only then", "[parallel]") {
  const Threads two(2);
  const int items = 1000;
  const double each = kWorthThreads / items;
  CHECK(two.worth(items, each));
  CHECK(two.worth(items, 1.001 * each));
  CHECK_FALSE(two.worth(items, .999 * each));
  CHECK_FALSE(two.worth(items - 1, each));
  CHECK_FALSE(two.worth(0, kLong));
  CHECK_FALSE(Threads(1).worth(items, kLong));
  CHECK_FALSE(Threads().worth(items, kLong));

  // All of it in one chunk of the caller's own thread.
  for (const auto& [threads, cost] : {std::pair(Threads(4), .5 * each), {Threads(1), kLong}}) {
    int calls = 0;
    const std::thread::id caller = std::this_thread::get_id();
    threads.chunks(items, cost, [&](int first, int end, int worker) {
      ++calls;
      CHECK(first == 0);
      CHECK(end == items);
      CHECK(worker == 0);
      CHECK((std::this_thread::get_id() == caller));
    });
    CHECK(calls == 1);
  }
}

TEST_CASE("there is at least one thread", "[parallel]") {
  CHECK(Threads().count() == 1);
  CHECK(Threads(3).count() == 3);
  CHECK(Threads(0).count() == 1);
  CHECK(Threads(-2).count() == 1);
}
