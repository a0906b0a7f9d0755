// The collar of a polygon that is not convex: the part near its boundary in which phi follows from
// the edges alone, without the straight skeleton and without a search for what is nearest.
//
// The cell of an edge lies in front of it, between two lines through its vertices. At a convex
// vertex the line is the bisector, where the heights over both edges are equal, and the cell has
// the points that are less high over its own edge than over the next one. At a reflex vertex a roof
// has the bisector as well, but with the higher of the two. A distance field has there the
// perpendicular to each of the two edges, and between these a sector of points that are nearest to
// the vertex. Cells and sectors lie side by side up to a height at which the front that moves
// inwards from the boundary meets itself; phi at that height is the depth of the cell.
#pragma once

#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/roof.hpp"

namespace apothem {

/// How many numbers behind the last one may be read, and used for nothing.
inline constexpr int kReadBehind = 4;

/// The cells of the edges of a polygon with n vertices, and kReadBehind numbers behind.
struct CollarCells {
  /// Edge e: its cell is valid where phi is smaller than this; 0 if it is not to be used.
  std::vector<double> depth;
  /// Vertex i: 1 if it is convex and -1 if it is reflex. Vertex n is vertex 0.
  std::vector<double> side;

  [[nodiscard]] bool reflex(int vertex) const { return side[vertex] < 0; }
};

/// The cells of a polygon with a roof.
CollarCells collar_cells(const Polygon& polygon, const Roof& roof);

/// The cells of a polygon with a distance field of the given slope, 1/m.
CollarCells collar_cells(const Polygon& polygon, double slope);

}  // namespace apothem
