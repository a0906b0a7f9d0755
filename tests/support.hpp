// Shared by the tests: the methods in one call, and where the project's files are.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "apps/cases/samples.hpp"
#include "geometry/integrals/edge_integral.hpp"
#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"
#include "tests/this_build.hpp"

namespace apothem::test {

inline const std::string kSource = APOTHEM_SOURCE;  // the project's folder
inline const std::string kProgram = program();      // the program under test

inline const bool kSanitized = is_sanitized();

/// APOTHEM_LONG in the environment asks for the full number of random cases where CI has a share.
inline bool long_run() { return std::getenv("APOTHEM_LONG") != nullptr; }

/// The number of random cases that a run takes out of `cases`.
inline int scaled(int cases) {
  const int divisor = kSanitized ? 50 : long_run() ? 1 : 4;
  return std::max(1, cases / divisor);
}

/// How many of the random cases a test asks to be of the kind that it is about. Under the
/// sanitizers, which take too few cases for a share of them to say anything, no number fails.
inline int least(int cases) { return kSanitized ? -1 : cases; }

/// APOTHEM_SEED in the environment, a whole number, chooses other random cases: 0 without it.
inline std::uint64_t chosen_seed() {
  const char* const text = std::getenv("APOTHEM_SEED");
  return text ? std::strtoull(text, nullptr, 10) : 0;
}

/// Random numbers of a test, which are others for every chosen seed.
struct SeededRandom : samples::Random {
  explicit SeededRandom(std::uint64_t own) : samples::Random(own + 1'000'003 * chosen_seed()) {}
};

/// Whether a run takes case i of a list that is not random: each second one, others for other
/// chosen seeds, or all of them if asked for the full number.
inline bool is_taken(std::uint64_t i) { return long_run() || (i + chosen_seed()) % 2 == 0; }

inline PairResult edge(const Polygon& a, const Polygon& b, const PotentialChoice& choice = {}) {
  return edge_method(a, make_potential(a, choice), b, make_potential(b, choice));
}

inline PotentialChoice area_choice() { return {.kind = PotentialChoice::Kind::area}; }
inline PotentialChoice length_choice(double length) {
  return {.reference = PotentialChoice::Reference::length, .length = length};
}

/// The polygons of the benchmarks.
inline Polygon quad_q() { return Polygon({{0, 0}, {1.2, .1}, {1, .8}, {.2, 1}}); }
inline Polygon triangle_t() { return Polygon({{0, 0}, {1, 0}, {.3, .9}}); }

}  // namespace apothem::test
