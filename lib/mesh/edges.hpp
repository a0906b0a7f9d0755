// The edges of a mesh, and the elements on both sides of each.
#pragma once

#include <array>
#include <vector>

#include "mesh/mesh.hpp"

namespace apothem {

struct MeshEdge {
  std::array<int, 2> nodes;  ///< in the sense of element `left`
  int left;
  int right = -1;  ///< -1: the edge is on the boundary

  [[nodiscard]] bool on_boundary() const { return right < 0; }
};

/// Every edge once, ordered by its lower, then its upper node; inside, `left` is the element with
/// the lower number. Linear in the size of the mesh if no node has very many edges. Throws
/// InvalidMesh if more than two elements share an edge, or two in the same sense.
std::vector<MeshEdge> mesh_edges(const Mesh& mesh);

/// Those of mesh_edges with one element only.
std::vector<MeshEdge> boundary_edges(const Mesh& mesh);

/// The edge between two nodes; null if there is none. `edges` as mesh_edges gives them.
const MeshEdge* find_edge(const std::vector<MeshEdge>& edges, int a, int b);

/// Node i + 1 of an element (or another ring), cyclically.
template <class Ring>
auto after(const Ring& ring, size_t i) {
  return ring[i + 1 == ring.size() ? 0 : i + 1];
}

}  // namespace apothem
