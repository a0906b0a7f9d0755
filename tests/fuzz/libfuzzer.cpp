// Entry point of libFuzzer (docs/extending.md says how to run it).
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    apothem::test::fuzz_pair(data, size);
  } catch (const std::logic_error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::abort();
  }
  return 0;
}
