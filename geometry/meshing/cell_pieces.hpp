// The pieces into which the outline of a region cuts its Voronoi cells. This header is private to
// voronoi.cpp and voronoi_cells.cpp.
#pragma once

#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// A piece of a Voronoi cell. Once others have joined it, it is a whole cell.
struct Piece {
  int site;               ///< index of the site whose cell the piece belongs to
  std::vector<int> ring;  ///< node indices, counter-clockwise
  bool owned = false;     ///< whether the piece is a cell, as the one in which the site lies
  bool opened = false;    ///< whether it is a part of a cell that went round a hole and was cut
};

/// All pieces of a region with their shared nodes.
struct Pieces {
  std::vector<Vec2> nodes;   ///< nodes, m; the first ones are the region's vertices, in their order
  std::vector<int> freedom;  ///< per node: freedom as in collapse_short_edges
  std::vector<Piece> list;   ///< the pieces

  /// The coordinates of the nodes of a ring, m.
  [[nodiscard]] std::vector<Vec2> points(const std::vector<int>& ring) const {
    std::vector<Vec2> result;
    for (const int i : ring) result.push_back(nodes[i]);
    return result;
  }
};

/// Sorts nodes and pieces into an order that does not depend on how they were found. The first
/// `outline_size` nodes, which are the region's vertices, stay first; the others follow from left
/// to right. Each ring starts at its smallest node index. Pieces are sorted by their site, then by
/// their ring.
void put_in_order(Pieces& pieces, int outline_size);

/// Marks one piece of each site as owned: the one that contains the site, or the largest one if no
/// piece contains it because of rounding.
void mark_owned(Pieces& pieces, const std::vector<Vec2>& sites);

/// Joins the triangles of a cell that goes round a hole, which are the opened pieces of its site,
/// to as few parts as their rings allow: in turn, the smallest part to the one with which it has
/// the longest boundary in common, among those whose union with it is bounded by a simple ring.
void join_triangles(Pieces& pieces);

/// Joins every piece that is not owned to a neighbour that is: the one that shares the longest
/// boundary with it, among those whose union with it is bounded by a simple ring. Pieces that no
/// neighbour can take are left as they are.
void join_pieces(Pieces& pieces);

}  // namespace apothem
