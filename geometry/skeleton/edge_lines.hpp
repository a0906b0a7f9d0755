// The edges of a polygon as straight lines with a signed distance. This header is private to the
// construction of the straight skeleton and to the check of its laws.
#pragma once

#include <cmath>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

/// The straight line through an edge.
struct EdgeLine {
  Vec2 start;     ///< start point of the edge, m
  Vec2 tangent;   ///< unit vector along the edge
  double length;  ///< length of the edge, m
  /// Unit normal that points into the polygon.
  [[nodiscard]] Vec2 normal() const { return {-tangent.y(), tangent.x()}; }
  /// Position of x along the edge, measured from its start, m.
  [[nodiscard]] double along(const Vec2& x) const { return tangent.dot(x - start); }
  /// Signed distance of x from the line, positive on the inner side of the edge, m.
  [[nodiscard]] double distance(const Vec2& x) const { return cross(tangent, x - start); }
};

/// The lines of all edges, relative to polygon.origin(). Their directions are computed from the
/// coordinates as given, because in local coordinates an edge of one ulp may have length zero.
inline std::vector<EdgeLine> edge_lines(const Polygon& polygon) {
  std::vector<EdgeLine> lines;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 edge = polygon.after(i) - polygon[i];
    const double length = hypotenuse(edge.x(), edge.y());
    lines.push_back({polygon[i] - polygon.origin(), edge / length, length});
  }
  return lines;
}

}  // namespace apothem
