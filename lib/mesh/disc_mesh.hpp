// Structured mesh of a disc.
#pragma once

#include "mesh/mesh.hpp"

namespace apothem {

struct DiscCells {
  int quarter = 8;     ///< edges along a quarter of the circle, and across the square block inside
  double grading = 1;  ///< radial size of the innermost cells of the ring by that of the outermost
};

/// O-grid: a bulged square block of quarter x quarter cells, and a ring of 4 x quarter cells around
/// it in layers of about the same size. Boundary nodes lie on the circle, one at each multiple of
/// 90 degrees from 45 degrees and, for even `quarter`, from 0; the nodes of a disc about zero are
/// the same bit for bit after a quarter turn. Smallest scaled Jacobian of the quadrilaterals .8,
/// smallest angle of the triangles 24 degrees (for grading 1 and two cells or more). Group:
/// boundary. Throws std::invalid_argument unless the radius is positive, there are 1 to 5000 cells
/// and the grading is between .01 and 100.
Mesh disc_mesh(const Vec2& centre, double radius, const DiscCells& cells, ElementShape shape);

}  // namespace apothem
