// The straight skeleton of a polygon, with or without holes. It consists of the paths of the
// vertices while the mitred boundary moves inwards. The roof over a point is the time at which the
// boundary passes it. Every face of the skeleton belongs to one edge of the polygon, and in it the
// roof is the distance to the line of that edge.
//
// Every construction may fail: CGAL's sometimes returns nothing, never returns, crashes or returns
// a wrong skeleton. Therefore CGAL runs in a helper program with a time limit, every result is
// corrected with the lines of the polygon's edges, and it has to pass the laws that broken_law
// lists. Otherwise the construction is repeated with the vertices moved by 1e-13 to 1e-9 of the
// polygon's size. Polygons with more than 64 vertices are given to the trace of a wavefront
// (wavefront.hpp) first, because CGAL's construction needs n^2 steps and n^2 memory.
//
// Neither tells what happens where events coincide. So where they may have, the skeleton is
// constructed once more with joined events (exact_front.hpp). It then follows from the polygon
// alone: not from how vertices are numbered, nor from mirrors, quarter turns and powers of two.
#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/progress.hpp"

namespace apothem {

/// Thrown if no skeleton that passes the laws was found. The message says what was tried and what
/// may help.
class SkeletonFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The straight skeleton of a polygon with n vertices.
struct Skeleton {
  /// A node of the skeleton.
  struct Node {
    Vec2 point;     ///< position relative to polygon.origin(), m; see also node_places.hpp
    double height;  ///< distance to the lines of all edges whose faces meet here, m
  };
  /// A straight arc between two nodes.
  struct Arc {
    int start, end;   ///< indices of its nodes
    int left, right;  ///< faces on its two sides, seen from start to end; -1 means outside
  };
  std::vector<Node> nodes;  ///< the first n nodes are the polygon's vertices, of height 0
  std::vector<Arc> arcs;    ///< the first n arcs are the polygon's edges
  /// Node indices of the face of each edge e, counter-clockwise, beginning with the ends of the
  /// edge: e and polygon.next(e).
  std::vector<std::vector<int>> faces;
  double roof_height = 0;  ///< largest height of a node, m
  int attempts = 1;        ///< number of constructions until one passed the laws
  bool exact = false;      ///< true if made with exact decisions about events
};

/// The largest number of vertices of a polygon whose skeleton is constructed.
inline constexpr int kMostVertices = 100000;

/// Throws InvalidPolygon if a polygon with so many vertices is too large for a skeleton.
void require_few_vertices(std::size_t vertices);

/// Constructs the straight skeleton. Throws InvalidPolygon if the polygon has more than
/// kMostVertices vertices, and SkeletonFailure if no attempt passes the laws.
Skeleton straight_skeleton(const Polygon& polygon, const Progress& progress = {});

/// Returns a description of the first law that the skeleton of this polygon breaks, or nothing if
/// it obeys all of them. The laws, with a tolerance of 1e-9 of the polygon's size, are:
/// - All indices are in range and all numbers are finite. The first nodes and arcs are the vertices
///   and edges of the polygon.
/// - Each face starts with its own edge. Each inner arc lies between two faces that pass it in
///   opposite senses. The inner arcs are connected, reach every node and have as many independent
///   cycles as the polygon has holes; without holes they form a tree. Hence the faces form a disc
///   with so many holes.
/// - Every node lies inside the polygon, outside of its holes. Its height is its distance to the
///   line of every edge whose face meets there.
/// - Every face is simple, is monotone along its edge and has a positive area, and the areas sum to
///   the area of the polygon. Hence the faces tile the polygon.
/// - Water runs off the roof: every valley starts at a reflex vertex or continues a lower valley.
std::optional<std::string> broken_law(const Skeleton& skeleton, const Polygon& polygon);

}  // namespace apothem
