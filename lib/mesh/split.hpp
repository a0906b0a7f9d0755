// Cutting elements into others.
#pragma once

#include <array>

#include "mesh/mesh.hpp"

namespace apothem {

/// Adds a convex quadrilateral as it is or as two triangles: cut by the diagonal that leaves the
/// larger smallest angle; where both are as good, by the one from its corner 0 or, if `odd`, from
/// corner 1 (alternating, so that no direction is preferred).
void add_quadrilateral(Mesh& mesh, const std::array<int, 4>& corners, ElementShape shape, bool odd);

/// Cuts every element of n corners into n quadrilaterals that meet at the mean of its corners and
/// at the middles of its edges. Nodes and elements: those of a corner stay with the element's
/// place; the old nodes keep their numbers and places. Without groups.
Mesh into_quadrilaterals(const Mesh& mesh);

/// Joins pairs of triangles into convex quadrilaterals, best first (by the smallest sine of a
/// corner, at least `least_sine`; equal ones in the order of mesh_edges); triangles that find no
/// partner stay. Without groups.
Mesh join_triangles(const Mesh& mesh, double least_sine);

}  // namespace apothem
