// Polygons that are copies of each other: translated, rotated, reflected and scaled.
//
// The coordinates of copies are rounded, so their vertices agree with those of the original only to
// the round-off of the coordinates as given. Polygons that differ by more than that are not
// similar. It does not matter in which order a polygon has its holes. Which polygon of a list is an
// original depends on the order of the list alone.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// The similarity that maps a polygon onto a copy of it, in the local coordinates of both, which
/// are relative to origin().
struct Similarity {
  int vertices;   ///< number of vertices of each polygon
  int outer;      ///< number of those of the outer ring
  int first;      ///< vertex of the original whose image is vertex 0 of the copy
  bool mirrored;  ///< whether the copy is reflected
  Vec2 turn;      ///< image of the vector (1, 0); its length is the scale
  Vec2 shift;     ///< image of the point (0, 0), m
  /// The images of the vertices of holes, and of their edges, from the first one on.
  std::vector<int> hole_vertices = {}, hole_edges = {};

  /// Ratio of lengths in the copy to those in the original.
  [[nodiscard]] double scale() const { return turn.norm(); }
  /// The image of a point.
  [[nodiscard]] Vec2 operator()(const Vec2& p) const {
    const double y = mirrored ? -p.y() : p.y();
    return {shift.x() + turn.x() * p.x() - turn.y() * y,
            shift.y() + turn.y() * p.x() + turn.x() * y};
  }
  /// The vertex of the copy that is the image of a vertex of the original.
  [[nodiscard]] int vertex(int of_original) const {
    if (of_original >= outer) return hole_vertices[of_original - outer];
    const int steps = mirrored ? first - of_original : of_original - first;
    return steps < 0 ? steps + outer : steps;
  }
  /// The edge of the copy that is the image of an edge of the original. If the copy is reflected,
  /// the image of the end of an edge is the start of its image.
  [[nodiscard]] int edge(int of_original) const {
    if (of_original >= outer) return hole_edges[of_original - outer];
    if (!mirrored) return vertex(of_original);
    return vertex(next(of_original, outer));
  }
};

/// Finds the original of each of many polygons.
class SimilarShapes {
 public:
  /// A polygon of which another one is a copy.
  struct Original {
    int index;       ///< number of that polygon, in the order of the calls of add
    Similarity map;  ///< from that polygon to its copy
  };

  /// Adds a polygon. Returns the first polygon among those added before and not themselves copies
  /// of which it is a copy, or nothing if it is an original.
  std::optional<Original> add(const Polygon& polygon);

 private:
  // What is compared of an original.
  struct Shape {
    int index;
    std::vector<Vec2> arms;       // from the mean of the outer ring's vertices to them, m
    Vec2 mean;                    // of these vertices, relative to the polygon's origin, m
    double size;                  // root of the sum of the squares of the arms, m
    double perimeter;             // of all rings, m
    double extent;                // m
    double noise;                 // round-off of the coordinates as given, m
    std::vector<Vec2> hole_arms;  // from the same mean to the vertices of holes, m
    std::vector<int> hole_next;   // of each of these the one after it
  };
  static Shape shape_of(const Polygon& polygon);
  static std::optional<Similarity> similarity(const Shape& from, const Shape& to);
  static std::optional<Similarity> aligned(const Shape& from, const Shape& to, int first,
                                           bool mirrored, double tolerance);
  static bool align_holes(const Shape& from, const Shape& to, double tolerance, Similarity& map);

  int count_ = 0;
  std::vector<Shape> originals_;
  // Originals by the number of their vertices and the interval of a number that no similarity
  // changes.
  std::map<std::pair<int, std::int64_t>, std::vector<int>> by_kind_;
};

}  // namespace apothem
