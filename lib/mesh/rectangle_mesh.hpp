// Structured mesh of a rectangle.
#pragma once

#include <array>

#include "mesh/mesh.hpp"

namespace apothem {

/// size[0] x size[1] m in cells[0] x cells[1] equal cells, of two triangles each for triangles
/// (diagonals alternate). Nodes and elements row by row from `origin`, the lower left corner.
/// Groups left, right, bottom, top. Throws std::invalid_argument unless sizes are positive, there
/// is a cell each way and at most 1e8 in all, and the cells can be told apart at that origin.
Mesh rectangle_mesh(const Vec2& size, const std::array<int, 2>& cells, const Vec2& origin,
                    ElementShape shape);

}  // namespace apothem
