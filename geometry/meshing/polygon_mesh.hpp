// Meshes of polygonal cells with shared nodes, the test that such a mesh is a tiling, and the
// removal of its short edges.
#pragma once

#include <vector>

#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// A mesh of polygonal cells. Neighbours share all nodes of their common boundary, so there are no
/// hanging nodes.
struct PolygonMesh {
  std::vector<Vec2> points;             ///< coordinates of the nodes, m
  std::vector<std::vector<int>> cells;  ///< node indices of each cell, counter-clockwise
};

/// The coordinates of a cell's nodes in the order of the cell, m.
std::vector<Vec2> cell_ring(const PolygonMesh& mesh, const std::vector<int>& cell);

/// True if a ring is a simple counter-clockwise polygon, by exact predicates.
bool is_valid_cell(const std::vector<Vec2>& ring);

/// Returns the nodes on the boundary of a mesh of a region with so many holes, ring by ring: the
/// outer one, counter-clockwise, and then those around the holes, clockwise. Each begins at its
/// smallest node index, and the holes are in the order of these. Throws InvalidPolygon, whose
/// message names the cell where there is one, unless the cells tile the polygon of these rings
/// exactly. The test has no tolerance. Its conditions are:
/// - Every cell is a simple counter-clockwise polygon, by exact predicates.
/// - Every edge belongs to one cell, or to two cells in opposite senses.
/// - The edges that belong to one cell only form as many rings as there are holes and one more, in
///   which no node appears twice. One of them is a counter-clockwise polygon, and the others are
///   valid holes of it, clockwise.
/// These conditions are sufficient: the winding number of the rings about a point is the sum of the
/// winding numbers of the cells. So every point inside that is on no edge lies in exactly one cell,
/// and no cell reaches outside or into a hole.
std::vector<std::vector<int>> tiling_boundary(const PolygonMesh& mesh, int holes = 0);

/// The freedom of a node that can move anywhere when an edge collapses. A node with an index of a
/// straight edge of the outline as its freedom lies on that edge.
constexpr int kAnywhere = -1;
/// The freedom of a node that cannot move, because it is a vertex of the outline.
constexpr int kNowhere = -2;

/// The result of collapse_short_edges.
struct ShortEdges {
  int collapsed = 0;  ///< number of edges that have been collapsed
  /// Number of edges that are still short. Edges between two vertices of the outline belong to the
  /// outline and do not count. An edge cannot be collapsed if it crosses the inside between two
  /// nodes on the outline, if it belongs to a triangle (which would vanish), or if every new
  /// position of its nodes makes a cell invalid, for instance because a vertex of the outline is in
  /// the way.
  int left = 0;
};

/// Collapses edges shorter than `shortest` (m), the shortest first. Two free nodes meet half-way,
/// or at one of the two if a cell would become invalid; a free node moves to a node on the outline;
/// two nodes on a straight edge of the outline meet at one of them; vertices of the outline do not
/// move. A valid cell remains valid, so the mesh remains a tiling; an invalid cell may become
/// valid. `freedom` has one entry per point. Nodes that no cell uses are removed, and the others
/// keep their order. Each cell starts at its smallest node index.
ShortEdges collapse_short_edges(PolygonMesh& mesh, std::vector<int> freedom, double shortest);

}  // namespace apothem
