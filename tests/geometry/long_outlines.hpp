// Outlines with many edges near each other, for searches by trees.
#pragma once

#include "tests/geometry/random_holed.hpp"

namespace apothem::test {

/// A long arc closed by its chord, which has an inner corner.
inline Polygon half_disc(int n) {
  std::vector<Vec2> ring{{0, .05}};
  for (int i = 0; i < n; ++i) {
    const double angle = M_PI * i / (n - 1);
    ring.emplace_back(std::cos(angle), std::sin(angle));
  }
  return Polygon(ring);
}

inline constexpr int kOutlineKinds = 9;

/// An outline of one of these kinds with 40 to 240 edges, or some with holes, and with an extent of
/// 1.
inline Polygon long_outline(samples::Random& random, int kind) {
  const int n = random.integer(40, 240);
  const auto shape = [&]() -> Polygon {
    switch (kind) {
      case 0:
        return samples::gear(n / 4);
      case 1:
        return samples::star(n / 2, random.uniform(.3, .9));
      case 2:
        return samples::comb(n / 4, random.uniform(.2, 9));
      case 3:
        return samples::coastline(random, n);
      case 4:
        return samples::spiral(random.uniform(1, 4), n / 8, random.uniform(.1, .6));
      case 5:
        return half_disc(n);
      case 6:
        return samples::staircase(n / 4);
      case 7:
        return samples::random_holed(random, 12);
      default:
        return samples::random_star_shaped(random, n, random.uniform(.1, 1));
    }
  };
  const Polygon polygon = shape();
  return samples::scaled(polygon, 1 / bounding_box(polygon).extent());
}

}  // namespace apothem::test
