// The pieces into which the outline of a region cuts its Voronoi cells; private to voronoi.cpp.
#pragma once

#include <vector>

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// A piece of a cell, later a whole cell.
struct Piece {
  int site;
  std::vector<int> ring;  ///< nodes, counter-clockwise
  bool owned;             ///< has a site in it
};

struct Pieces {
  std::vector<Vec2> nodes;   ///< first the vertices of the region, in order
  std::vector<int> freedom;  ///< as in collapse_short_edges
  std::vector<Piece> list;

  [[nodiscard]] std::vector<Vec2> points(const std::vector<int>& ring) const {
    std::vector<Vec2> result;
    for (const int i : ring) result.push_back(nodes[i]);
    return result;
  }
};

/// Into an order that does not depend on how the pieces were found: the nodes of the region first,
/// then the others from left to right; rings from their smallest node on; pieces by their site,
/// then by their ring.
void put_in_order(Pieces& pieces, int outline_size);

/// Joins every piece without a site to the neighbour with a site with which it shares the longest
/// boundary, as long as their union is bounded by a simple ring. Returns false if pieces are left
/// that no neighbour can take.
bool join_pieces(Pieces& pieces);

}  // namespace apothem
