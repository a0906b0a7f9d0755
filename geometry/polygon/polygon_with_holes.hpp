// A polygon with holes, as results of geometry have them: Boolean operations, repaired outlines.
#pragma once

#include <vector>

#include "geometry/polygon/ring_moments.hpp"

namespace apothem {

/// Closed lines. The first vertex of each of them is not repeated at the end.
using Rings = std::vector<std::vector<Vec2>>;

/// A connected set of the plane with a positive area. Its rings are simple. Where they touch each
/// other, both have a vertex.
struct PolygonWithHoles {
  std::vector<Vec2> outer;  ///< the outer boundary, counter-clockwise, m
  Rings holes;              ///< the boundaries of the holes, clockwise, m
};

/// The polygon of an outer ring and its holes, which follow it.
inline PolygonWithHoles polygon_of_rings(const Rings& rings) {
  return {rings.front(), {rings.begin() + 1, rings.end()}};
}

/// The outer ring and the holes.
inline Rings rings_of(const PolygonWithHoles& polygon) {
  Rings rings{polygon.outer};
  rings.insert(rings.end(), polygon.holes.begin(), polygon.holes.end());
  return rings;
}

/// The rings of all polygons.
inline Rings rings_of(const std::vector<PolygonWithHoles>& polygons) {
  Rings rings;
  for (const PolygonWithHoles& polygon : polygons) {
    const Rings own = rings_of(polygon);
    rings.insert(rings.end(), own.begin(), own.end());
  }
  return rings;
}

/// Area of the polygon without its holes, m^2.
inline double area_of(const PolygonWithHoles& polygon) {
  double area = ring_area(polygon.outer);
  for (const std::vector<Vec2>& hole : polygon.holes) area += ring_area(hole);
  return area;
}
inline double area_of(const std::vector<PolygonWithHoles>& polygons) {
  double area = 0;
  for (const PolygonWithHoles& polygon : polygons) area += area_of(polygon);
  return area;
}

}  // namespace apothem
