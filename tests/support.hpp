// Shared by the tests: the methods in one call, and where the project's files are.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>

#include "apps/cases/samples.hpp"
#include "geometry/integrals/edge_integral.hpp"
#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"

namespace apothem::test {

inline const std::string kSource = APOTHEM_SOURCE;    // the project's folder
inline const std::string kProgram = APOTHEM_PROGRAM;  // the program under test

/// Whether the sanitizers are at work, which make everything 20 times slower.
inline constexpr bool kSanitized = APOTHEM_TEST_DIVISOR > 1;

/// Fewer random cases under the sanitizers, which are 20 times slower.
inline int scaled(int cases) { return std::max(1, cases / APOTHEM_TEST_DIVISOR); }

/// APOTHEM_LONG in the environment asks for the full number of random cases where CI has a share.
inline bool long_run() { return std::getenv("APOTHEM_LONG") != nullptr; }

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
