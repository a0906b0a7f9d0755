// Rings that the tests of skeletons, singular areas and pictures share.
#pragma once

#include <vector>

#include "apps/cases/samples.hpp"

namespace apothem::test {

using Ring = std::vector<Vec2>;

/// A unit square with four arms; five unit squares by default.
inline Ring cross_ring(double arm = 1) { return samples::cross_of_squares(arm).vertices(); }
inline Ring l_ring() { return samples::l_shape().vertices(); }
inline Ring star_ring(int points, double inner) { return samples::star(points, inner).vertices(); }
/// Bar from y = -1 to 0, teeth up to 3.
inline Ring comb_ring(int teeth) {
  return samples::shifted(samples::comb(teeth, 3), {0, -1}).vertices();
}
inline Ring spiral_ring(int turns) { return samples::spiral(turns, 12).vertices(); }
inline Ring regular_ring(int n) { return samples::regular(n).vertices(); }

inline Ring turned(Ring ring, double angle) {
  for (Vec2& v : ring) v = samples::turned(v, angle);
  return ring;
}

/// Outline around 0, more or less spiky; almost always in general position.
inline Polygon random_polygon(samples::Random& random, int n) {
  return samples::random_star_shaped(random, n, 1 - random.uniform(0, .9));
}

}  // namespace apothem::test
