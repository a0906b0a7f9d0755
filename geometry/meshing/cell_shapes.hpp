// Better shapes of the cells of a mesh: cuts at their reflex corners, and nodes that move to open
// small angles. Corners within 1e-9 rad of 180 degrees are straight, because nodes on a slanted
// line are rounded.
#pragma once

#include <vector>

#include "geometry/meshing/polygon_mesh.hpp"

namespace apothem {

/// Interior angle of the corner at which edges of a counter-clockwise cell end and begin, with the
/// directions `in` and `out`, from 0 to 2 pi.
double corner_angle(const Vec2& in, const Vec2& out);

/// True if an interior angle (rad) is above 180 degrees.
bool is_reflex(double angle);

/// Cuts all cells that are not convex along diagonals, until all are, and returns the number of
/// cuts. A cut begins at a reflex corner. It ends at that other corner of the cell with which the
/// smallest of the four angles beside it is largest, preferably at one that leaves no reflex corner
/// where the cut begins. No nodes are added. One part takes the number of the cell, and the other
/// is added at the end.
int cut_at_reflex_corners(PolygonMesh& mesh);

/// Moves nodes until no corner of a cell has an angle below `smallest` (rad), as far as that is
/// possible, and returns the number of moves. `freedom` has one entry per point, as in
/// collapse_short_edges: nodes on an edge of the outline move along it. A node moves by a part of
/// its shortest edge, along one of its edges or at right angles to it, if that opens the smallest
/// of the angles it changes, or leaves it and opens the next one, and makes no more corners reflex.
/// So the smallest angle of the mesh never gets smaller. No move makes an edge shorter than
/// `shortest` (m), unless it was and grows. Cells remain valid.
int open_small_angles(PolygonMesh& mesh, const std::vector<int>& freedom, double smallest,
                      double shortest);

}  // namespace apothem
