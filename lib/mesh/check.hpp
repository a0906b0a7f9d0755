// What makes a mesh one that can be computed with.
#pragma once

#include "mesh/mesh.hpp"

namespace apothem {

struct MeshRules {
  bool convex_quadrilaterals = true;  ///< every corner below 180 degrees, as bilinear elements need
};

/// Throws InvalidMesh unless
/// - coordinates are finite and below 1e60;
/// - every element has three or more different corners and is a simple counter-clockwise polygon
///   (exact predicates) with an area above 1e-12 of its squared diagonal;
/// - every node belongs to an element and no two are nearer than 1e-12 of the mesh's size (so there
///   are no cracks with two lips in one place);
/// - every edge belongs to one element, or to two in opposite senses;
/// - no node lies on a boundary edge of others, to 1e-9 of its length (hanging node), and boundary
///   edges meet in their common node only, two in each;
/// - the elements are connected by edges, and have one outer boundary;
/// - the groups name nodes of the mesh, ascending, and edges in the sense of an element.
/// Then the elements tile the inside of the boundary: the boundary's winding number about a point,
/// at most 1, is the number of elements around it.
/// Takes O(n log n).
void check_mesh(const Mesh& mesh, const MeshRules& rules = {});

}  // namespace apothem
