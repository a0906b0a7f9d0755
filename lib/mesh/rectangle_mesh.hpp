// Generates a structured mesh of a rectangle.
#pragma once

#include <array>

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// A rectangle of `size` (width, height; m) in cells[0] x cells[1] equal cells, each of which is a
/// quadrilateral or two triangles with alternating diagonals. Nodes and elements are numbered row
/// by row from `origin`, the lower left corner. Groups: "left", "right", "bottom", "top". Throws
/// std::invalid_argument unless the sizes are positive, there is at least one cell in each
/// direction and at most 1e8 in all, and the cells are large enough to be resolved in double
/// precision at that origin.
Mesh rectangle_mesh(const Vec2& size, const std::array<int, 2>& cells, const Vec2& origin,
                    ElementShape shape);

}  // namespace apothem
