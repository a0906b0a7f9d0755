// The class of simple polygons. A polygon is validated once, by exact predicates, when it is
// constructed; all other code relies on that.
#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/point.hpp"

namespace apothem {

/// Thrown if a ring of vertices is not a polygon that the called function can work with. The
/// message says what is wrong, without naming the polygon.
class InvalidPolygon : public std::invalid_argument {
 public:
  InvalidPolygon(const std::string& reason, int vertex)
      : std::invalid_argument(reason), vertex_(vertex) {}
  /// The vertex at which the ring is wrong, as an index into the ring as it was given.
  [[nodiscard]] int vertex() const { return vertex_; }

 private:
  int vertex_;
};

/// A simple polygon. Its vertices are in counter-clockwise order and the first one is not repeated
/// at the end. Edge i runs from vertex i to the next one. Vertices with an interior angle of 180
/// degrees are allowed. Coordinates are in m.
class Polygon {
 public:
  /// Vertices that are equal to the one before, or at the end to the first one, are left out.
  /// Throws InvalidPolygon unless the others are three or more finite, distinct vertices, without a
  /// spike, and no two edges meet anywhere but at their common vertex. Coordinates beyond 1e60 and
  /// polygons smaller than 1e-60 are refused as well. A clockwise ring is reversed; its vertex 0
  /// stays the first one.
  explicit Polygon(std::vector<Vec2> ring);

  /// Number of vertices, which is also the number of edges.
  [[nodiscard]] int size() const { return static_cast<int>(vertices_.size()); }
  [[nodiscard]] const std::vector<Vec2>& vertices() const { return vertices_; }
  [[nodiscard]] const Vec2& operator[](int i) const { return vertices_[i]; }
  /// The vertex that follows vertex i; vertex 0 follows the last one.
  [[nodiscard]] const Vec2& after(int i) const { return vertices_[next(i, size())]; }

  /// Index of the first reflex vertex, that is, one with an interior angle above 180 degrees. There
  /// is none if the polygon is convex. The test is exact.
  [[nodiscard]] std::optional<int> first_reflex_vertex() const;
  [[nodiscard]] bool is_convex() const { return !first_reflex_vertex(); }

  /// The index that vertex i had in the ring as it was given; the first one of equal neighbours.
  [[nodiscard]] int input_index(int i) const {
    const int vertex = reversed_ && i > 0 ? size() - i : i;
    return merged_.empty() ? vertex : merged_[vertex].front();
  }
  /// The index that edge e, from vertex e to vertex e + 1, had in the ring as it was given, where
  /// equal neighbours have an edge of no length between them.
  [[nodiscard]] int input_edge(int e) const {
    const int edge = reversed_ ? size() - 1 - e : e;
    return merged_.empty() ? edge : merged_[edge].back();
  }

  /// Origin of the polygon's local coordinates, which is vertex 0. Local coordinates are
  /// differences of input coordinates, so they do not lose digits far from the origin of the world.
  [[nodiscard]] const Vec2& origin() const { return vertices_.front(); }
  /// The vertices relative to origin(), m.
  [[nodiscard]] std::vector<Vec2> local_vertices() const;

 private:
  std::vector<Vec2> vertices_;
  /// The first and the last index that each vertex of the ring as it was given had there. Empty if
  /// no neighbours are equal.
  std::vector<std::array<int, 2>> merged_;
  bool reversed_;
};

/// Area, centroid and polar second moment of area of a polygon.
struct AreaMoments {
  double area;    ///< area, m^2
  Vec2 centroid;  ///< centroid relative to the polygon's origin(), m
  double polar;   ///< integral of |x - centroid|^2 dA, m^4
};

/// The area moments of a polygon, in double precision.
AreaMoments area_moments(const Polygon& polygon);

/// The smallest axis-parallel box that contains the polygon, in the coordinates of its vertices.
Box bounding_box(const Polygon& polygon);

}  // namespace apothem
