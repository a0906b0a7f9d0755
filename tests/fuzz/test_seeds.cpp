// Inputs that the fuzzer found worth keeping: each covers something that no other one does.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/support.hpp"

using namespace apothem;

TEST_CASE("the fuzzer's seeds", "[fuzz]") {
  int seeds = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::kSource + "/data/fuzz")) {
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    INFO(entry.path());
    ++seeds;
    CHECK_NOTHROW(
        test::fuzz_pair(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
  }
  CHECK(seeds > 10);
}
