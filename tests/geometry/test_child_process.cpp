// No crash, hang, exception or hunger for memory of the child reaches the parent.
#include "geometry/child_process.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <memory>
#include <numeric>
#include <stdexcept>

using namespace apothem;

TEST_CASE("a child's numbers arrive, many or none", "[child]") {
  for (const size_t count : {size_t{0}, size_t{1}, size_t{1'000'000}}) {
    const ChildAnswer answer = in_child_process(
        [&] {
          std::vector<double> numbers(count);
          std::iota(numbers.begin(), numbers.end(), .5);
          return numbers;
        },
        60);
    REQUIRE(answer.failure.empty());
    REQUIRE(answer.numbers.size() == count);
    if (count > 0) CHECK(answer.numbers.back() == static_cast<double>(count) - .5);
  }
}

TEST_CASE("a child that hangs is killed", "[child]") {
  const auto start = std::chrono::steady_clock::now();
  const ChildAnswer busy = in_child_process(
      []() -> std::vector<double> {
        std::vector<double> numbers{1};
        while (numbers[0] > 0) numbers[0] = std::fmod(numbers[0] * 1.5, 1) + 1;
        return numbers;
      },
      1);
  CHECK(busy.failure == "did not return within 1 s");
  const ChildAnswer asleep = in_child_process(
      []() -> std::vector<double> {
        while (true) sleep(1);
      },
      .1);
  CHECK(asleep.failure == "did not return within 1 s");
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(20));
}

TEST_CASE("a child that crashes is reported", "[child]") {
  const ChildAnswer killed = in_child_process(
      []() -> std::vector<double> {
        raise(SIGTERM);
        return {};
      },
      60);
  CHECK(killed.failure == "crashed with signal 15");
  const ChildAnswer aborted = in_child_process([]() -> std::vector<double> { std::abort(); }, 60);
  CHECK(!aborted.failure.empty());
}

TEST_CASE("an exception or too much memory of a child is reported", "[child]") {
  const ChildAnswer thrown = in_child_process(
      []() -> std::vector<double> { throw std::runtime_error("no such thing"); }, 60);
  CHECK(thrown.failure == "failed with an exception");
  const ChildAnswer greedy = in_child_process(
      [] {
        // Asked of the system in pieces that no allocator refuses by itself.
        std::vector<std::unique_ptr<std::vector<double>>> pieces;
        while (true) pieces.push_back(std::make_unique<std::vector<double>>(1 << 24));
        return std::vector<double>{};
      },
      60);
  CHECK(!greedy.failure.empty());
}
