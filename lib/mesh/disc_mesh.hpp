// Generates a structured mesh of a disc.
#pragma once

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Numbers of cells of a disc mesh.
struct DiscCells {
  int quarter = 8;  ///< edges along a quarter of the circle, and along a side of the inner block
  /// Radial size of the innermost cells of the ring over that of the outermost.
  double grading = 1;
};

/// O-grid of a disc: a square block with curved sides of quarter x quarter cells, and around it a
/// ring of 4 x quarter cells per layer, in layers of about the same size. `centre` and `radius` in
/// m. Boundary nodes lie on the circle, one at each of the angles 45, 135, 225 and 315 degrees and,
/// for even `quarter`, at 0, 90, 180 and 270 degrees. A quarter turn maps the nodes of a disc about
/// the origin to each other bit for bit. For grading 1 and two cells or more, the smallest scaled
/// Jacobian of the quadrilaterals is 0.8 and the smallest angle of the triangles 24 degrees. The
/// only group is "boundary". Throws std::invalid_argument unless the radius is positive, `quarter`
/// is 1 to 5000 and the grading 0.01 to 100.
Mesh disc_mesh(const Vec2& centre, double radius, const DiscCells& cells, ElementShape shape);

}  // namespace apothem
