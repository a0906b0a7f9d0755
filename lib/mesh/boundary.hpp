// The outline of a mesh.
#pragma once

#include <vector>

#include "mesh/edges.hpp"

namespace apothem {

/// A closed line of boundary edges with the mesh on its left: counter-clockwise around the outside,
/// clockwise around a hole.
struct BoundaryLoop {
  std::vector<int> nodes;     ///< edge i leads from node i to node i + 1; the lowest node is first
  std::vector<int> elements;  ///< of edge i
  bool is_hole;
};

struct Boundary {
  std::vector<BoundaryLoop> loops;  ///< the outer ones, then the holes; each by the first node
  int components;                   ///< parts of the mesh that no edge connects
};

/// Throws InvalidMesh if the boundary meets itself in a node, and what mesh_edges does.
Boundary boundary(const Mesh& mesh);
Boundary boundary(const Mesh& mesh, const std::vector<MeshEdge>& edges);  ///< of that mesh

/// The number of parts of the mesh that no edge connects.
int component_count(const Mesh& mesh, const std::vector<MeshEdge>& edges);

}  // namespace apothem
