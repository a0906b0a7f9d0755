// Checks whether a mesh is fit for computation.
#pragma once

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Options of check_mesh.
struct MeshRules {
  bool convex_quadrilaterals = true;  ///< all corners below 180 degrees, as bilinear elements need
};

/// Throws InvalidMesh, which names the element or node, unless all of these conditions hold:
/// - coordinates are finite and below 1e60 m;
/// - every element has three or more different corners and is a simple counter-clockwise polygon
///   (exact predicates) with an area above 1e-12 of its squared diagonal;
/// - every node belongs to an element, and no two nodes are closer than 1e-12 of the mesh's size
///   (so there are no cracks whose two faces coincide);
/// - every edge belongs to one element, or to two that run along it in opposite directions;
/// - no node lies on a boundary edge of which it is not an end, within 1e-9 of the edge's length
///   (hanging node), and boundary edges meet only in common nodes, two edges in each;
/// - the elements are connected by edges, and have one outer boundary;
/// - groups name existing nodes, in ascending order, and edges in the direction of an element.
/// Then the elements cover the region inside the boundary exactly once: the winding number of the
/// boundary about a point, which is at most 1, is the number of elements that contain the point.
/// The time is O(n log n) for n nodes.
void check_mesh(const Mesh& mesh, const MeshRules& rules = {});

}  // namespace apothem
