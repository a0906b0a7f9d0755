#include "lib/model/population.hpp"

#include <algorithm>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/half_plane.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"

namespace apothem {
namespace {

// Area of a ring within a convex one. Edges that lie on the border twice add nothing to it.
double area_within(std::vector<Vec2> ring, const std::vector<Vec2>& convex) {
  for (size_t k = 0; k < convex.size() && !ring.empty(); ++k) {
    const Vec2& at = convex[k];
    const Vec2 along = after(convex, k) - at;
    ring = part_above(ring, [&](const Vec2& p) { return cross(along, Vec2(p - at)); });
  }
  return ring_area(ring);
}

}  // namespace

bool Region::contains(const Vec2& point) const {
  return std::ranges::any_of(parts, [&](const std::vector<Vec2>& part) {
    for (size_t k = 0; k < part.size(); ++k) {
      if (orientation(part[k], after(part, k), point) < 0) return false;
    }
    return true;
  });
}

double Region::overlap(const std::vector<Vec2>& ring) const {
  double sum = 0;
  for (const std::vector<Vec2>& part : parts) sum += area_within(ring, part);
  return sum;
}

}  // namespace apothem
