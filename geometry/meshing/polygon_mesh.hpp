// Meshes of polygonal cells with shared nodes: what makes one a tiling, and its short edges.
#pragma once

#include <vector>

#include "apothem/geometry/polygon/polygon.hpp"

namespace apothem {

/// Cells are counter-clockwise lists of indices into points. Neighbours share all nodes of their
/// common boundary: there are no hanging nodes.
struct PolygonMesh {
  std::vector<Vec2> points;  ///< m
  std::vector<std::vector<int>> cells;
};

/// The cell's vertices, in its order.
std::vector<Vec2> cell_ring(const PolygonMesh& mesh, const std::vector<int>& cell);

/// The nodes around the mesh, counter-clockwise from the one with the smallest index. Throws
/// InvalidPolygon, which names the cell, unless the cells tile the polygon of these nodes exactly,
/// without any tolerance:
/// - every cell is a simple counter-clockwise polygon (exact predicates);
/// - every edge belongs to one cell, or to two in opposite senses;
/// - those of one cell only form one ring, and that is a simple counter-clockwise polygon.
/// That is enough: the winding number of the ring about a point is the sum of those of the cells,
/// so every point inside that is on no edge lies in exactly one cell, and no cell reaches outside.
std::vector<int> tiling_boundary(const PolygonMesh& mesh);

/// Where a node may go when an edge collapses: kAnywhere, kNowhere (a vertex of the outline), or
/// the index of the straight piece of the outline that it lies on.
constexpr int kAnywhere = -1;
constexpr int kNowhere = -2;

struct ShortEdges {
  int collapsed = 0;
  /// Still short; edges between two fixed nodes of the outline are the outline's own and do not
  /// count. They stay where both ends lie on the outline and the edge crosses the inside, where a
  /// cell is a triangle (it would vanish), and where every new place makes a cell invalid, say
  /// because a vertex of the outline bars the way.
  int left = 0;
};

/// Collapses edges shorter than `shortest` (m), the shortest first: two free nodes meet half-way, a
/// free node moves to one on the outline, nodes on the outline stay where they are. The mesh
/// remains a tiling; a cell that was not valid before may become so. `freedom` has one entry per
/// point. Nodes that no cell uses are dropped, the others keep their order; each cell starts at its
/// smallest node.
ShortEdges collapse_short_edges(PolygonMesh& mesh, std::vector<int> freedom, double shortest);

}  // namespace apothem
