// The part of a ring on one side of a line.
#pragma once

#include <vector>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/point.hpp"

namespace apothem {

/// The part of a ring where a linear function of points is not negative (I. E. Sutherland, G. W.
/// Hodgman, Commun. ACM 17 (1974) 32-42). Where the ring is not convex, edges may lie on the border
/// twice. `cuts` gets the points at which edges cross the border.
template <class Height>
std::vector<Vec2> part_above(const std::vector<Vec2>& ring, const Height& height,
                             std::vector<Vec2>* cuts = nullptr) {
  std::vector<Vec2> part;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 &p = ring[i], &q = after(ring, i);
    const double of_p = height(p), of_q = height(q);
    if (of_p >= 0) part.push_back(p);
    if ((of_p >= 0) == (of_q >= 0)) continue;
    part.push_back(p + of_p / (of_p - of_q) * (q - p));
    if (cuts) cuts->push_back(part.back());
  }
  return part;
}

}  // namespace apothem
