// The ways to the contact force of a pair that `apothem accuracy` compares, and how each is run and
// timed without its crashes harming anyone.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "apothem/geometry/integrals/edge_integral.hpp"

namespace apothem {

/// Two polygons with their potentials (distance, reference `roof`), made before any clock runs.
struct PreparedPair {
  PreparedPair(std::string pair_name, Polygon polygon_a, Polygon polygon_b);
  std::string name;
  Polygon a, b;
  Potential potential_a, potential_b;
  double size;  ///< X, extent of the larger polygon, m
  bool convex;  ///< both
};

struct AccuracyMethod {
  std::string_view name;
  std::string_view what;
};
/// The first one is what the others are compared with.
inline constexpr std::array kAccuracyMethods{
    AccuracyMethod{"exact", "exact overlap, 100 digits, potentials included: the reference"},
    AccuracyMethod{"edge", "edge integrals, as the step loop calls them"},
    AccuracyMethod{"overlap", "CGAL overlap, exact constructions, Eq. 8, energy included"},
    AccuracyMethod{"overlap-inexact", "CGAL overlap, inexact constructions, Eq. 8"},
    AccuracyMethod{"boost", "Boost.Geometry overlap, Eq. 8"},
    AccuracyMethod{"clip", "plain floating-point clipping, Eq. 8"},
};

/// One method on one pair; `failure` is empty if there is a result.
struct AccuracyOutcome {
  PairIntegral integral;
  PairVolume volume;  ///< of exact and overlap
  std::string failure;
};

struct AccuracyRun {
  std::vector<AccuracyOutcome> outcomes;  ///< one per pair
  double nanoseconds = 0;                 ///< per pair that has a result, fastest round; NaN: none
};

/// Runs a method on all pairs in a child process, again and again behind the pairs on which it
/// crashes or stays silent for 20 s (the reference: 10 min).
AccuracyRun run_method(std::string_view method, const std::vector<PreparedPair>& pairs);

}  // namespace apothem
