#include "apothem/geometry/polygon/loops.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/geometry/polygon/predicates.hpp"

namespace apothem {

double distance(const Loops& loops, const Vec2& point) {
  double least = HUGE_VAL;
  for (const std::vector<Vec2>& ring : loops.rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 edge = ring[(i + 1) % ring.size()] - ring[i];
      const double along = std::clamp((point - ring[i]).dot(edge) / edge.squaredNorm(), 0., 1.);
      least = std::min(least, (ring[i] + along * edge - point).norm());
    }
  }
  return least;
}

std::optional<Vec2> deep_vertex(const Loops& a, const Loops& b, double reach) {
  for (const std::vector<Vec2>& ring : a.rings) {
    for (const Vec2& p : ring) {
      if (apart({p.x(), p.y(), p.x(), p.y()}, b.box)) continue;
      bool inside = false;
      for (const std::vector<Vec2>& other : b.rings) inside ^= strictly_inside(other, p);
      if (inside && distance(b, p) > reach) return p;
    }
  }
  return {};
}

}  // namespace apothem
