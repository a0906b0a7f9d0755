// The triangles inside a moving front, which find its events. This header is private to the
// construction of the straight skeleton.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "geometry/polygon/triangulation.hpp"

namespace apothem {

/// A triangle inside the front. Side k is opposite to corner k. A side is the number of the
/// neighbouring triangle, or, where the front is, ~e with the polygon's edge e.
struct FrontTriangle {
  std::array<int, 3> corners{}, sides{};

  [[nodiscard]] int place_of(int corner) const {
    return corners[0] == corner ? 0 : corners[1] == corner ? 1 : 2;
  }
  [[nodiscard]] int side_to(int triangle) const {
    return sides[0] == triangle ? 0 : sides[1] == triangle ? 1 : 2;
  }
  [[nodiscard]] int front_sides() const {
    return static_cast<int>(std::count_if(sides.begin(), sides.end(), [](int s) { return s < 0; }));
  }
};

/// The triangles of a polygon with their neighbours; none if they do not fit together.
std::vector<FrontTriangle> front_triangles(const std::vector<Triangle>& corners,
                                           const Polygon& polygon);

/// Corner k of a triangle crosses the opposite side, which is not on the front: the diagonal of the
/// quadrilateral of the two triangles beside that side is exchanged.
void exchange_diagonal(std::vector<FrontTriangle>& triangles, int triangle, int k);

}  // namespace apothem
