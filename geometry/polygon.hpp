// A simple polygon: validated once by exact predicates, then trusted everywhere.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/point.hpp"

namespace apothem {

/// What is wrong with a ring, and at which vertex (index into the ring as it was given).
class InvalidPolygon : public std::invalid_argument {
 public:
  InvalidPolygon(const std::string& reason, int vertex)
      : std::invalid_argument(reason), vertex_(vertex) {}
  [[nodiscard]] int vertex() const { return vertex_; }

 private:
  int vertex_;
};

/// Simple polygon, counter-clockwise, without a repeated closing vertex.
/// Vertices on a straight edge (180 degrees) are allowed.
class Polygon {
 public:
  /// Throws InvalidPolygon unless the ring has three or more finite, distinct vertices, no spike
  /// and no two edges that meet outside their common vertex. A clockwise ring is reversed about
  /// vertex 0, which stays first.
  explicit Polygon(std::vector<Vec2> ring);

  [[nodiscard]] int size() const { return static_cast<int>(vertices_.size()); }
  [[nodiscard]] const std::vector<Vec2>& vertices() const { return vertices_; }
  [[nodiscard]] const Vec2& operator[](int i) const { return vertices_[i]; }
  /// Vertex i + 1, cyclically.
  [[nodiscard]] const Vec2& after(int i) const { return vertices_[i + 1 == size() ? 0 : i + 1]; }

  /// First vertex with an interior angle above 180 degrees; none if the polygon is convex.
  [[nodiscard]] std::optional<int> first_reflex_vertex() const;
  [[nodiscard]] bool is_convex() const { return !first_reflex_vertex(); }

  /// Index of vertex i in the ring as it was given.
  [[nodiscard]] int input_index(int i) const { return reversed_ && i > 0 ? size() - i : i; }
  /// Index of edge e (from vertex e to e + 1) in the ring as it was given.
  [[nodiscard]] int input_edge(int e) const { return reversed_ ? size() - 1 - e : e; }

  /// Where the polygon's local coordinates start: vertex 0. Local coordinates are differences of
  /// input coordinates, so they do not lose digits far from the world's origin.
  [[nodiscard]] const Vec2& origin() const { return vertices_.front(); }
  [[nodiscard]] std::vector<Vec2> local_vertices() const;

 private:
  std::vector<Vec2> vertices_;
  bool reversed_;
};

/// Area, centroid and second moment of a polygon of unit density.
struct AreaMoments {
  double area;    ///< m^2
  Vec2 centroid;  ///< m, relative to the polygon's origin()
  double polar;   ///< integral of |x - centroid|^2 dA, m^4
};
AreaMoments area_moments(const Polygon& polygon);

Box bounding_box(const Polygon& polygon);

}  // namespace apothem
