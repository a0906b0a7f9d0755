// The class of polygons, with or without holes. A polygon is validated once, by exact predicates,
// when it is constructed; all other code relies on that.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/point.hpp"
#include "geometry/polygon/polygon_with_holes.hpp"
#include "geometry/polygon/rare.hpp"
#include "geometry/polygon/ring_links.hpp"

namespace apothem {

/// Thrown if rings of vertices are not a polygon that the called function can work with. The
/// message says what is wrong, without naming the polygon.
class InvalidPolygon : public std::invalid_argument {
 public:
  InvalidPolygon(const std::string& reason, int vertex, std::optional<int> hole = {})
      : std::invalid_argument(reason), vertex_(vertex), hole_(hole) {}
  /// The vertex at which the ring is wrong, as an index into the ring as it was given.
  [[nodiscard]] int vertex() const { return vertex_; }
  /// The hole that is wrong, or nothing if it is the outer ring.
  [[nodiscard]] std::optional<int> hole() const { return hole_; }

 private:
  int vertex_;
  std::optional<int> hole_;
};

/// A polygon: the inside of a simple ring of vertices, without the insides of any number of holes.
///
/// The list of its vertices has the outer ring first, counter-clockwise, and then the holes,
/// clockwise, so that the inside is on the left of every edge. The first vertex of a ring is not
/// repeated at the end. Edge i runs from vertex i to next(i), which is the next one of its ring.
/// Vertices with an interior angle of 180 degrees are allowed. Coordinates are in m.
class Polygon {
 public:
  /// A polygon without holes. Vertices that are equal to the one before, or at the end to the first
  /// one, are left out. Throws InvalidPolygon unless the others are three or more finite, distinct
  /// vertices, without a spike, and no two edges meet anywhere but at their common vertex.
  /// Coordinates beyond 1e60 and polygons smaller than 1e-60 are refused as well. A clockwise ring
  /// is reversed; its vertex 0 stays the first one.
  explicit Polygon(std::vector<Vec2> ring);

  /// A polygon with holes, each of them a ring in any sense. Throws InvalidPolygon if a ring is
  /// wrong by itself, or unless every hole lies inside the outer ring and outside of all others,
  /// without touching them.
  Polygon(const std::vector<Vec2>& outer, const Rings& holes);
  explicit Polygon(const PolygonWithHoles& polygon) : Polygon(polygon.outer, polygon.holes) {}

  /// Number of vertices, which is also the number of edges.
  [[nodiscard]] int size() const { return static_cast<int>(vertices_.size()); }
  /// The vertices of all rings.
  [[nodiscard]] const std::vector<Vec2>& vertices() const { return vertices_; }
  [[nodiscard]] const Vec2& operator[](int i) const { return vertices_[i]; }
  /// The vertex after vertex i in its ring, and the one before; also for edges.
  [[nodiscard]] int next(int i) const { return apothem::next(links(), i, size()); }
  [[nodiscard]] int previous(int i) const { return apothem::previous(links(), i, size()); }
  [[nodiscard]] const Vec2& after(int i) const { return vertices_[next(i)]; }
  [[nodiscard]] const Vec2& before(int i) const { return vertices_[previous(i)]; }

  /// Number of rings: one and the number of holes.
  [[nodiscard]] int rings() const { return rings_ ? rings_->links.rings() : 1; }
  [[nodiscard]] bool has_holes() const { return rings_.has_value(); }
  /// The number of the first vertex of a ring; of ring rings() it would be size().
  [[nodiscard]] int ring_start(int ring) const {
    return rings_ ? rings_->links.starts[ring] : ring == 0 ? 0 : size();
  }
  /// The vertices of a ring. Ring 0 is the outer one.
  [[nodiscard]] std::span<const Vec2> ring(int ring) const {
    return std::span(vertices_).subspan(ring_start(ring), ring_start(ring + 1) - ring_start(ring));
  }
  [[nodiscard]] std::span<const Vec2> outer_ring() const { return ring(0); }
  /// The neighbours of the vertices; null without holes, where they are those in one ring.
  [[nodiscard]] const RingLinks* links() const { return rings_ ? &rings_->links : nullptr; }

  /// Index of the first reflex vertex, that is, one with an interior angle above 180 degrees. There
  /// is none if the polygon is convex. The test is exact.
  [[nodiscard]] std::optional<int> first_reflex_vertex() const;
  [[nodiscard]] bool is_convex() const { return !first_reflex_vertex(); }

  /// The index that vertex i had in the rings as they were given, one after the other; the first
  /// one of equal neighbours.
  [[nodiscard]] int input_index(int i) const {
    if (rings_) return rings_->input[i].front();
    const int vertex = reversed_ && i > 0 ? size() - i : i;
    return merged_.empty() ? vertex : merged_[vertex].front();
  }
  /// The index that edge e, from vertex e to vertex next(e), had in the rings as they were given,
  /// where equal neighbours have an edge of no length between them.
  [[nodiscard]] int input_edge(int e) const {
    if (rings_) return rings_->input[e].back();
    const int edge = reversed_ ? size() - 1 - e : e;
    return merged_.empty() ? edge : merged_[edge].back();
  }

  /// Origin of the polygon's local coordinates, which is vertex 0. Local coordinates are
  /// differences of input coordinates, so they do not lose digits far from the origin of the world.
  [[nodiscard]] const Vec2& origin() const { return vertices_.front(); }
  /// The vertices relative to origin(), m.
  [[nodiscard]] std::vector<Vec2> local_vertices() const;

 private:
  // What only a polygon with holes has.
  struct RingTables {
    RingLinks links;
    std::vector<std::array<int, 2>> input;  // index of each vertex and of each edge as given
  };
  void add_hole(const Polygon& hole, int given);

  std::vector<Vec2> vertices_;
  /// The first and the last index that each vertex of the ring as it was given had there. Empty if
  /// no neighbours are equal.
  std::vector<std::array<int, 2>> merged_;
  Rare<RingTables> rings_;
  bool reversed_;
};

/// Returns +1 if a point lies inside the polygon, 0 if it lies on the boundary, and -1 if it lies
/// outside or in a hole. The test is exact.
int side_of(const Polygon& polygon, const Vec2& point);

/// The rings of a polygon, counter-clockwise outside and clockwise around holes.
Rings rings_of(const Polygon& polygon);

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
