// Private header of `apothem accuracy`: the methods for the contact force that it compares, and how
// each is run and timed in a child process, so that a crash harms nothing else.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/integrals/edge_integral.hpp"

namespace apothem {

/// Two polygons with their distance potentials (reference `roof`), which are made before any timing
/// starts.
struct PreparedPair {
  PreparedPair(std::string pair_name, Polygon polygon_a, Polygon polygon_b);
  std::string name;
  Polygon a, b;
  Potential potential_a, potential_b;
  double size;  ///< extent X of the larger polygon, m
  bool convex;  ///< whether both polygons are convex
};

/// A method and its description.
struct AccuracyMethod {
  std::string_view name;
  std::string_view what;
};
/// All methods. The others are compared with the first one.
inline constexpr std::array kAccuracyMethods{
    AccuracyMethod{"exact", "exact overlap, 100 digits, potentials included: the reference"},
    AccuracyMethod{"edge", "edge integrals, as the step loop calls them"},
    AccuracyMethod{"overlap", "CGAL overlap, exact constructions, Eq. 8, energy included"},
    AccuracyMethod{"overlap-inexact", "CGAL overlap, inexact constructions, Eq. 8"},
    AccuracyMethod{"boost", "Boost.Geometry overlap, Eq. 8"},
    AccuracyMethod{"clip", "plain floating-point clipping, Eq. 8"},
};

/// The result of one method for one pair; `failure` says why there is none, or is empty.
struct AccuracyOutcome {
  PairIntegral integral;
  PairVolume volume;  ///< energy and overlap area, from the methods "exact" and "overlap" only
  std::string failure;
};

/// The results of one method for all pairs.
struct AccuracyRun {
  std::vector<AccuracyOutcome> outcomes;  ///< one per pair
  double seconds = 0;  ///< time of the first and only evaluation of all pairs with a result
};

/// Runs a method on all pairs in a child process. If the child crashes or is silent for 20 s (the
/// reference: 10 min), that pair fails and a new child continues with the next one.
AccuracyRun run_method(std::string_view method, const std::vector<PreparedPair>& pairs);

/// Time per pair with a result in `run`, in ns: in the fastest of several rounds, or in that run
/// itself if it took more than 0.3 s. NaN if there is no result.
double time_method(std::string_view method, const std::vector<PreparedPair>& pairs,
                   const AccuracyRun& run);

}  // namespace apothem
