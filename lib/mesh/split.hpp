// Cuts elements into smaller ones and joins triangles.
#pragma once

#include <array>

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Adds a convex quadrilateral to the mesh, as one element or as two triangles. The triangles are
/// cut along the diagonal that leaves the larger smallest angle. Where both diagonals are equally
/// good, the one from corner 0 is taken or, if `odd`, the one from corner 1; callers alternate
/// `odd` so that no direction is preferred.
void add_quadrilateral(Mesh& mesh, const std::array<int, 4>& corners, ElementShape shape, bool odd);

/// Cuts every element of n corners into n quadrilaterals that meet at the mean of its corners and
/// at the midpoints of its edges. The quadrilaterals of an element follow one another, in the order
/// of its corners. Old nodes keep their numbers and positions. The result has no groups.
Mesh into_quadrilaterals(const Mesh& mesh);

/// Joins pairs of adjacent triangles into convex quadrilaterals. The best pairs come first: those
/// with the largest smallest sine of a corner, which must be at least `least_sine`; equal ones in
/// the order of mesh_edges. Triangles without a partner remain. The result has no groups.
Mesh join_triangles(const Mesh& mesh, double least_sine);

}  // namespace apothem
