// Straight skeleton of a simple polygon: what the inward-moving mitred boundary sweeps over. Every
// face belongs to one edge; in it the roof is the distance to that edge's line.
//
// CGAL's skeleton fails on ordinary input now and then: it returns nothing, never returns, crashes
// or is wrong. Hence nothing is believed here: CGAL works in a child process with a time limit, its
// result is polished with the polygon's own edge lines and has to pass the laws of broken_law;
// otherwise the construction is repeated with vertices moved by less than anyone can notice.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/polygon.hpp"

namespace apothem {

/// No skeleton that passes the laws was found; the message says what was tried and what helps.
class SkeletonFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Skeleton {
  struct Node {
    Vec2 point;     ///< relative to polygon.origin(), m
    double height;  ///< distance to the lines of the edges whose faces meet here, m
  };
  struct Arc {
    int start, end;   ///< nodes
    int left, right;  ///< faces on either side, seen from start to end; -1 is outside
  };
  std::vector<Node> nodes;              ///< the first n are the polygon's vertices, height 0
  std::vector<Arc> arcs;                ///< the first n are the polygon's edges
  std::vector<std::vector<int>> faces;  ///< of edge e: nodes counter-clockwise from e, e + 1
  double roof_height = 0;               ///< largest height of a node, m
  int attempts = 1;                     ///< 1: the first construction passed
  bool exact = false;                   ///< made with exact constructions
};

/// Node i in the coordinates of the polygon's vertices; vertices come back to the last bit.
inline Vec2 world_point(const Polygon& polygon, const std::vector<Skeleton::Node>& nodes, int i) {
  return i < polygon.size() ? polygon[i] : Vec2(polygon.origin() + nodes[i].point);
}

/// Throws SkeletonFailure when no attempt passes the laws. Convex polygons need no child process.
Skeleton straight_skeleton(const Polygon& polygon);

/// The first law that a skeleton of this polygon breaks, if any:
/// - all indices are in range, all numbers finite, the first nodes and arcs those of the polygon;
/// - each face starts with its own edge, each arc lies between two faces that pass it in opposite
///   senses, and the inner arcs form one tree that reaches every node: the faces form a disc;
/// - every node is inside; its height is its distance to the line of every face that meets there;
/// - every face is simple, monotone along its edge and has a positive area, and the areas sum to
///   the polygon's: the faces tile it;
/// - water runs off: every valley of the roof starts at a reflex vertex or continues a lower one.
/// Tolerance: 1e-9 of the polygon's size.
std::optional<std::string> broken_law(const Skeleton& skeleton, const Polygon& polygon);

}  // namespace apothem
