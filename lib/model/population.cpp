#include "lib/model/population.hpp"

#include <algorithm>

#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_area.hpp"

namespace apothem {
namespace {

// Area of a ring within a convex one (I. E. Sutherland, G. W. Hodgman, Commun. ACM 17 (1974)
// 32-42). Edges that lie on the border twice, which they leave where the ring is not convex, add
// nothing to the area.
double area_within(std::vector<Vec2> ring, const std::vector<Vec2>& convex) {
  std::vector<Vec2> rest;
  for (size_t k = 0; k < convex.size() && !ring.empty(); ++k) {
    const Vec2& at = convex[k];
    const Vec2 along = convex[(k + 1) % convex.size()] - at;
    const auto height = [&](const Vec2& p) { return cross(along, Vec2(p - at)); };
    rest.clear();
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 &p = ring[i], &q = ring[(i + 1) % ring.size()];
      const double of_p = height(p), of_q = height(q);
      if (of_p >= 0) rest.push_back(p);
      if ((of_p >= 0) != (of_q >= 0)) rest.push_back(p + of_p / (of_p - of_q) * (q - p));
    }
    ring.swap(rest);
  }
  return ring_area(ring);
}

}  // namespace

bool Region::contains(const Vec2& point) const {
  return std::ranges::any_of(parts, [&](const std::vector<Vec2>& part) {
    for (size_t k = 0; k < part.size(); ++k) {
      if (orientation(part[k], part[(k + 1) % part.size()], point) < 0) return false;
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
