// Structured mesh of half a disc that is fine where it touches.
#pragma once

#include "mesh/mesh.hpp"

namespace apothem {

struct HalfDiscCells {
  double fine;          ///< half-width of the block of equal cells at the pole, of the radius
  int cells;            ///< of that half-width
  double growth = 1.1;  ///< of the cells' sizes from layer to layer around the block, at least
};

/// The lower half of a disc: its pole, the lowest point, at `pole`, its straight side a radius
/// above. A block of 2 n x n cells at the pole, n = cells, and layers around it up to the straight
/// side; symmetric about the axis through the pole (triangles: but for their diagonals). Good cells
/// near the pole; the worst one far from it has a scaled Jacobian of .02 (fine .03, 18 cells).
/// Groups: arc, straight. Throws std::invalid_argument unless the radius is positive, fine is
/// between .001 and .5, there are 1 to 1000 cells and the growth is between 1.01 and 2.
Mesh half_disc_mesh(const Vec2& pole, double radius, const HalfDiscCells& cells,
                    ElementShape shape);

}  // namespace apothem
