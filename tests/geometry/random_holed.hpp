// Random polygons with holes.
#pragma once

#include <cmath>

#include "apps/cases/samples.hpp"

namespace apothem::samples {

/// A star-shaped polygon about the origin with random holes, star-shaped and regular ones. There
/// are fewer than `holes` where no more have been found to fit, but at least one.
inline Polygon random_holed(Random& random, int holes) {
  constexpr int kMostTries = 1000;
  const std::vector<Vec2> outer = random_star_shaped(random, random.integer(5, 24), .5).vertices();
  const double most = .5 / std::sqrt(holes);
  Rings rings;
  for (int i = 0; static_cast<int>(rings.size()) < holes && (i < kMostTries || rings.empty());
       ++i) {
    const int n = random.integer(3, 9);
    const Polygon shape =
        random.integer(0, 1) == 0 ? regular(n) : random_star_shaped(random, n + 1, .3);
    const Vec2 centre(random.uniform(-1, 1), random.uniform(-1, 1));
    rings.push_back(posed(scaled(shape, most * random.uniform(.1, 1)), centre,
                          random.uniform(0, 2 * std::acos(-1)))
                        .vertices());
    try {
      const Polygon valid(outer, rings);
    } catch (const InvalidPolygon&) {
      rings.pop_back();
    }
  }
  return Polygon(outer, rings);
}

}  // namespace apothem::samples
