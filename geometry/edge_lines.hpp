// Private to the skeleton and its laws: a polygon's edges as lines with a distance function.
#pragma once

#include <cmath>
#include <vector>

#include "geometry/polygon.hpp"

namespace apothem {

/// Line of an edge with its distance function.
struct EdgeLine {
  Vec2 start;
  Vec2 tangent;
  double length;
  [[nodiscard]] Vec2 normal() const { return {-tangent.y(), tangent.x()}; }  // inward
  [[nodiscard]] double along(const Vec2& x) const { return tangent.dot(x - start); }
  [[nodiscard]] double distance(const Vec2& x) const { return cross(tangent, x - start); }
};

/// Relative to polygon.origin(). Directions come from the given coordinates: local ones may have
/// lost an edge of one ulp.
inline std::vector<EdgeLine> edge_lines(const Polygon& polygon) {
  std::vector<EdgeLine> lines;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 edge = polygon.after(i) - polygon[i];
    const double length = std::hypot(edge.x(), edge.y());
    lines.push_back({polygon[i] - polygon.origin(), edge / length, length});
  }
  return lines;
}

}  // namespace apothem
