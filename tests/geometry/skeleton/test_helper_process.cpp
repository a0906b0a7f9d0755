#include "geometry/skeleton/helper_process.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "geometry/skeleton/skeleton.hpp"
#include "geometry/skeleton/skeleton_program.hpp"
#include "tests/folder.hpp"
#include "tests/geometry/nonconvex_pairs.hpp"
#include "tests/geometry/skeleton/faults.hpp"
#include "tests/shapes.hpp"

using namespace apothem;
using test::Fault;
using End = HelperAnswer::End;

namespace {

using Numbers = std::vector<double>;

Numbers request(Fault fault, const Numbers& numbers) {
  Numbers all{static_cast<double>(fault)};
  all.insert(all.end(), numbers.begin(), numbers.end());
  return all;
}

HelperAnswer ask(Fault fault, const Numbers& numbers, double seconds = 1,
                 const std::function<void()>& meanwhile = {}, double patience = kHelperPatience) {
  return run_helpers(test::faulty_helper(), {request(fault, numbers)}, seconds, meanwhile, patience)
      .front();
}

// Sets an environment variable for a while.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

}  // namespace

TEST_CASE("a helper program hands over its numbers", "[helper]") {
  Numbers many(100002, 3);
  many[1] = 2;
  const HelperAnswer answer = ask(Fault::none, many, 10);
  CHECK(answer.end == End::finished);
  CHECK(answer.numbers == many);
  CHECK(answer.failure().empty());
}

TEST_CASE("what goes wrong in a helper program stays there", "[helper]") {
  const HelperAnswer crashed = ask(Fault::crash, {1});
  CHECK(crashed.end == End::crashed);
  CHECK(crashed.signal == SIGABRT);
  CHECK(crashed.is_certain());
  CHECK(crashed.numbers == Numbers{1});
  const HelperAnswer endless = ask(Fault::loop, {1}, 1, {}, .2);  // it works, so it may go on
  CHECK(endless.end == End::overran);
  CHECK(endless.numbers == Numbers{1});
  CHECK(endless.is_certain());
  const HelperAnswer greedy = ask(Fault::greed, {});
  CHECK(greedy.end != End::finished);
  CHECK(!greedy.failure().empty());
  const HelperAnswer failed = ask(Fault::exception, {1});
  CHECK(failed.end == End::failed);
  CHECK(failed.numbers == Numbers{1});
}

TEST_CASE("what comes from outside says nothing about the request", "[helper]") {
  const HelperAnswer killed = ask(Fault::kill, {1});
  CHECK(killed.end == End::prevented);
  CHECK(killed.signal == SIGKILL);
  CHECK(killed.numbers == Numbers{1});
  CHECK_FALSE(killed.is_certain());
  const HelperAnswer asleep = ask(Fault::sleep, {}, 100, {}, .5);
  CHECK(asleep.end == End::stalled);
  CHECK_FALSE(asleep.is_certain());
}

namespace {

// A helper that is killed in its first calls, and is then the right one.
std::string killed_at_first(const test::Folder& folder, int calls) {
  const std::string count = folder / "count";
  const std::string script =
      folder.write("helper.sh", "#!/bin/sh\necho >> " + count + "\n[ $(wc -l < " + count +
                                    ") -gt " + std::to_string(calls) + " ] || kill -9 $$\nexec " +
                                    skeleton_program() + " \"$@\"\n");
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  return script;
}

}  // namespace

TEST_CASE("a helper that was kept from its work is asked the same again", "[helper]") {
  const Skeleton expected = straight_skeleton(test::cross_shape());
  const test::Folder folder;
  {
    const Variable variable("APOTHEM_SKELETON_PROGRAM", killed_at_first(folder, 2).c_str());
    const Skeleton found = straight_skeleton(test::cross_shape());
    CHECK(found.attempts == expected.attempts);
    REQUIRE(found.nodes.size() == expected.nodes.size());
    for (size_t i = 0; i < found.nodes.size(); ++i) {
      CHECK((found.nodes[i].point == expected.nodes[i].point));
      CHECK(found.nodes[i].height == expected.nodes[i].height);
    }
  }
  const Variable variable("APOTHEM_SKELETON_PROGRAM", killed_at_first(folder, 1000).c_str());
  CHECK_THROWS_WITH(straight_skeleton(test::cross_shape()),
                    Catch::Contains("was killed by signal 9, 3 times for the same polygon"));
}

TEST_CASE("several helpers work at the same time, and each fails for itself", "[helper]") {
  const std::vector<HelperAnswer> answers =
      run_helpers(test::faulty_helper(),
                  {request(Fault::none, Numbers(100001, 2)), request(Fault::crash, {3}),
                   request(Fault::none, {4}), request(Fault::loop, {})},
                  1);
  REQUIRE(answers.size() == 4);
  CHECK(answers[0].end == End::finished);
  CHECK(answers[0].numbers.size() == 100001);
  CHECK(answers[1].end == End::crashed);
  CHECK(answers[1].numbers == Numbers{3});
  CHECK(answers[2].end == End::finished);
  CHECK(answers[2].numbers == Numbers{4});
  CHECK(answers[3].end == End::overran);
}

TEST_CASE("a program may lose patience with its helper", "[helper]") {
  struct Enough {};
  int calls = 0;
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(ask(Fault::sleep, {}, 60,
                      [&] {
                        if (++calls == 3) throw Enough();
                      }),
                  Enough);
  CHECK(calls == 3);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  CHECK(waitpid(-1, nullptr, WNOHANG) == -1);  // no process is left
}

TEST_CASE("a helper has no signals, files or terminal of the program", "[helper]") {
  const int leaked = fcntl(open("/dev/null", O_RDONLY), F_DUPFD, 3);  // without O_CLOEXEC
  const auto before = std::signal(SIGINT, SIG_IGN);
  const HelperAnswer answer = ask(Fault::report, {});
  std::signal(SIGINT, before);
  close(leaked);
  REQUIRE(answer.numbers.size() == 3);
  CHECK(answer.numbers[0] != getpgrp());
  CHECK(answer.numbers[1] == 0);
  CHECK(answer.numbers[2] == 0);
}

TEST_CASE("a helper program that cannot be started is an error of the system", "[helper]") {
  CHECK_THROWS_AS(run_helpers("/nowhere/apothem-skeleton", {{}}, 1), std::system_error);
  const Variable variable("APOTHEM_SKELETON_PROGRAM", "/nowhere/apothem-skeleton");
  CHECK(skeleton_program() == "/nowhere/apothem-skeleton");
  CHECK_THROWS_WITH(straight_skeleton(test::cross_shape()),
                    Catch::Contains("/nowhere/apothem-skeleton"));
}

TEST_CASE("a helper of another version is no source of skeletons", "[helper]") {
  const Variable variable("APOTHEM_SKELETON_PROGRAM", test::faulty_helper());
  CHECK_THROWS_AS(straight_skeleton(test::cross_shape()), SkeletonFailure);
}
