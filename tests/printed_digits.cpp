// The number of decimals in which Catch2 prints what a test compares: docs/check_numbers.py asks
// for many.
#include <catch2/catch.hpp>
#include <cstdlib>

namespace {

const bool set_decimals = [] {
  const char* decimals = std::getenv("APOTHEM_DIGITS");
  if (decimals != nullptr) Catch::StringMaker<double>::precision = std::atoi(decimals);
  return decimals != nullptr;
}();

}  // namespace
