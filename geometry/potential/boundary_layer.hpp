// The boundary layer of a polygon that is not convex: the region near its boundary in which phi
// follows from single edges and vertices, without the straight skeleton and without a search for
// the nearest feature. (The collar of an outline, geometry/integrals/collar.hpp, is another
// region.)
//
// The cell of an edge lies in front of it, between two lines through its vertices. At a convex
// vertex the line is the bisector, where the heights over both edges are equal, and the cell has
// the points whose height over its own edge is smaller than over the next one. At a reflex vertex
// the line of a roof is the bisector as well, and the cell has the points with the larger height.
// The lines of a distance field at a reflex vertex are the perpendiculars to the two edges, and
// between these there is a sector of points that are nearest to the vertex. Cells and sectors do
// not overlap up to the height at which the front that moves inwards from the boundary meets
// itself; phi at that height is the depth of the cell.
#pragma once

#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/roof.hpp"

namespace apothem {

/// The number of entries after the last one that may be read; their values are not used.
inline constexpr int kReadBehind = 4;

/// The cells of the edges of a polygon with n vertices. Both arrays have kReadBehind more entries.
struct BoundaryLayer {
  /// For edge e: the depth of its cell, which is valid where phi is smaller; 0 if the cell must not
  /// be used.
  std::vector<double> depth;
  /// For vertex i: 1 if it is convex and -1 if it is reflex. Vertex n is vertex 0.
  std::vector<double> side;

  [[nodiscard]] bool reflex(int vertex) const { return side[vertex] < 0; }
};

/// The boundary layer of a polygon with a roof.
BoundaryLayer boundary_layer(const Polygon& polygon, const Roof& roof);

/// The boundary layer of a polygon with a distance field of the given slope, 1/m.
BoundaryLayer boundary_layer(const Polygon& polygon, double slope);

}  // namespace apothem
