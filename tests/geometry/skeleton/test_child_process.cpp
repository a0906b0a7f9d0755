#include "apothem/geometry/skeleton/child_process.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <memory>
#include <stdexcept>

using namespace apothem;
using End = ChildAnswer::End;

TEST_CASE("a child process hands over its numbers", "[child]") {
  const ChildAnswer answer = run_in_child(
      [](const SendNumbers& send) {
        send({1, 2});
        send(std::vector<double>(100000, 3));
      },
      10);
  CHECK(answer.end == End::finished);
  REQUIRE(answer.numbers.size() == 100002);
  CHECK(answer.numbers[1] == 2);
  CHECK(answer.numbers.back() == 3);
}

TEST_CASE("what goes wrong in a child process stays there", "[child]") {
  const auto after_one_number = [](const auto& fault) {
    return run_in_child(
        [&](const SendNumbers& send) {
          send({1});
          fault();
        },
        1);
  };
  const ChildAnswer crashed = after_one_number([] { std::raise(SIGKILL); });
  CHECK(crashed.end == End::crashed);
  CHECK(crashed.signal == SIGKILL);
  CHECK(crashed.numbers == std::vector<double>{1});
  const ChildAnswer silent = after_one_number([] {
    volatile bool forever = true;
    while (forever) {
    }
  });
  CHECK(silent.end == End::silent);
  CHECK(silent.numbers == std::vector<double>{1});
  const ChildAnswer asleep = after_one_number([] {
    while (true) sleep(1);
  });
  CHECK(asleep.end == End::silent);
  // Asked for in pieces that no allocator refuses by itself.
  const ChildAnswer greedy = after_one_number([] {
    std::vector<std::unique_ptr<std::vector<double>>> pieces;
    while (true) pieces.push_back(std::make_unique<std::vector<double>>(1 << 24));
  });
  CHECK(greedy.end != End::finished);
  CHECK(!greedy.failure().empty());
  const ChildAnswer failed = after_one_number([] { throw std::runtime_error("no"); });
  CHECK(failed.end == End::failed);
  CHECK(failed.numbers == std::vector<double>{1});
}

TEST_CASE("the parent may lose patience with its child", "[child]") {
  struct Enough {};
  int calls = 0;
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(run_in_child(
                      [](const SendNumbers&) {
                        while (true) sleep(1);
                      },
                      60,
                      [&] {
                        if (++calls == 3) throw Enough();
                      }),
                  Enough);
  CHECK(calls == 3);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  CHECK(waitpid(-1, nullptr, WNOHANG) == -1);  // no child is left
}
