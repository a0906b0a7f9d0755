// The edges of a mesh, with the elements on both sides of each.
#pragma once

#include <array>
#include <vector>

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// An edge of a mesh.
struct MeshEdge {
  std::array<int, 2> nodes;  ///< in the direction in which the element `left` runs along it
  int left;                  ///< element on the left
  int right = -1;            ///< element on the right; -1 if the edge is on the boundary

  [[nodiscard]] bool on_boundary() const { return right < 0; }
};

/// Every edge of the mesh once, ordered by its lower and then its upper node number. `left` is the
/// element with the lower number if there are two. The time is linear in the size of the mesh if no
/// node has very many edges. Throws InvalidMesh if more than two elements share an edge, or if two
/// run along it in the same direction.
std::vector<MeshEdge> mesh_edges(const Mesh& mesh);

/// The edges of mesh_edges that belong to only one element.
std::vector<MeshEdge> boundary_edges(const Mesh& mesh);

/// The edge between the nodes `a` and `b`, or null if there is none. `edges` must be in the order
/// of mesh_edges.
const MeshEdge* find_edge(const std::vector<MeshEdge>& edges, int a, int b);

}  // namespace apothem
