// The places of what is computed from a polygon, such as the nodes of its skeleton and the centres
// of its inscribed circles, in the coordinates of its vertices.
//
// They are multiples of 2^-52 of the polygon's size, rounded up to a power of two. The positions
// relative to the polygon's origin, which is a vertex, are differences of such a multiple and of
// that vertex, rounded to double precision. Vertices with finer coordinates, which lie near the
// axes, make these differences round in another way for each vertex. The multiple can be told from
// any of them.
#pragma once

#include <cmath>

#include "geometry/polygon/polygon.hpp"

namespace apothem {

class PlaceGrid {
 public:
  static constexpr int kDigits = 52;

  explicit PlaceGrid(const Polygon& polygon)
      : origin_(polygon.origin()), size_(std::ilogb(bounding_box(polygon).extent()) + 1) {}

  /// The multiple of 2^-digits of the polygon's size that is nearest to a point; of two of these
  /// the one farther from zero.
  [[nodiscard]] Vec2 rounded(Vec2 p, int digits = kDigits) const {
    for (double& c : p) c = std::ldexp(std::round(std::ldexp(c, digits - size_)), size_ - digits);
    return p;
  }

  /// The place in the coordinates of the vertices of a point that is such a multiple relative to
  /// the polygon's origin, rounded to double precision. Neither rounding is as large as half of the
  /// spacing: where the sum is rounded coarsely, the vertices are multiples themselves.
  [[nodiscard]] Vec2 world(const Vec2& local) const { return rounded(origin_ + local); }

  /// The multiple that is nearest to the polygon's origin.
  [[nodiscard]] Vec2 anchor() const { return rounded(origin_); }

 private:
  Vec2 origin_;
  int size_;  // exponent
};

}  // namespace apothem
