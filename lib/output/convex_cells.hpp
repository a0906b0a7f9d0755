// Private header of the VTK writers: polygons as cells that every viewer fills rightly. Many fill a
// VTK_POLYGON as a fan of triangles around its first corner, which is right for convex ones only.
#pragma once

#include <span>
#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"

namespace apothem {

/// The cells that fill a counter-clockwise ring, as lists of its corners: the ring itself if it is
/// convex to a billionth, otherwise convex parts of it. A ring that is no simple polygon, like that
/// of an element turned inside out, stays whole.
std::vector<std::vector<int>> convex_cells(std::span<const Vec2> ring);

/// The same of a polygon, whose rings are the outer one and holes, clockwise. Corners are numbered
/// from ring to ring.
std::vector<std::vector<int>> convex_cells(const Rings& rings);

/// The rings around cells like these, as numbers of points, with the cells on their left.
std::vector<std::vector<int>> rings_around(const std::vector<std::vector<int>>& cells);
/// The ring that cells like these were made of, or the longest of several.
std::vector<int> joined(const std::vector<std::vector<int>>& cells);

}  // namespace apothem
