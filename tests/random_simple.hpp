// Random polygons without any order in their vertices.
#pragma once

#include <algorithm>

#include "apps/cases/samples.hpp"

namespace apothem::samples {

/// A closed line through n random points of the unit square, changed until it does not cross
/// itself.
inline Polygon random_simple(Random& random, int n) {
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    const double x = random.uniform(0, 1);
    ring.emplace_back(x, random.uniform(0, 1));
  }
  // Reverse the part between two edges wherever that shortens the closed line. Since this is so for
  // any two edges that cross, the line does not cross itself in the end.
  for (bool again = true; again;) {
    again = false;
    for (int i = 0; i < n; ++i) {
      for (int j = i + 2; j < n; ++j) {
        const int k = (j + 1) % n;
        const double now = (ring[i + 1] - ring[i]).norm() + (ring[k] - ring[j]).norm();
        const double then = (ring[j] - ring[i]).norm() + (ring[k] - ring[i + 1]).norm();
        if (k == i || then > now - 1e-12) continue;
        std::reverse(ring.begin() + i + 1, ring.begin() + j + 1);
        again = true;
      }
    }
  }
  return Polygon(ring);
}

}  // namespace apothem::samples
