// Generates a structured mesh of half a disc, refined at the point of contact.
#pragma once

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Numbers of cells of a half-disc mesh.
struct HalfDiscCells {
  double fine;          ///< half-width of the block of equal cells at the pole, over the radius
  int cells;            ///< number of cells along that half-width
  double growth = 1.1;  ///< ratio of the sizes of successive layers around the block
};

/// The lower half of a disc of `radius` (m). `pole` is its lowest point; its straight side lies a
/// radius above. A block of 2 n x n cells at the pole, n = cells, is surrounded by layers up to the
/// straight side. The mesh is symmetric about the vertical axis through the pole, except for the
/// diagonals of triangles. Cells near the pole are well shaped; the worst one, far from it, has a
/// scaled Jacobian of 0.02 (for fine = 0.03 and 18 cells). Groups: "arc", "straight". Throws
/// std::invalid_argument unless the radius is positive, fine is 0.001 to 0.5, there are 1 to 1000
/// cells and the growth is 1.01 to 2.
Mesh half_disc_mesh(const Vec2& pole, double radius, const HalfDiscCells& cells,
                    ElementShape shape);

}  // namespace apothem
