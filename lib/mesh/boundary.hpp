// The boundary loops of a mesh and the number of its connected parts.
#pragma once

#include <vector>

#include "lib/mesh/edges.hpp"

namespace apothem {

/// A closed loop of boundary edges with the mesh on its left: counter-clockwise along an outer
/// boundary, clockwise around a hole.
struct BoundaryLoop {
  std::vector<int> nodes;     ///< edge i leads from node i to i + 1; the lowest number is first
  std::vector<int> elements;  ///< element at edge i
  bool is_hole;
};

/// All boundary loops of a mesh.
struct Boundary {
  std::vector<BoundaryLoop> loops;  ///< outer loops, then holes, each sorted by first node
  int components;                   ///< number of parts of the mesh that no edge connects
};

/// The boundary of a mesh. Throws InvalidMesh if a boundary node has more than two boundary edges,
/// and where mesh_edges does.
Boundary boundary(const Mesh& mesh);
/// The same if the result of mesh_edges(mesh) is at hand.
Boundary boundary(const Mesh& mesh, const std::vector<MeshEdge>& edges);

/// The number of parts of the mesh that no common edge connects. `edges` is mesh_edges(mesh).
int component_count(const Mesh& mesh, const std::vector<MeshEdge>& edges);

/// Inradii of the elements at the edges of a line of the boundary, m.
std::vector<double> inradii(const Mesh& mesh, const BoundaryLoop& loop);
/// The smallest inradius of the elements at the boundary, m.
double boundary_inradius(const Mesh& mesh, const Boundary& boundary);
/// The inradius of the whole body to the fineness of its mesh and never more, m: the largest
/// distance from the boundary of a node or of the middle of an edge or element.
double mesh_inradius(const Mesh& mesh, const Boundary& boundary);

}  // namespace apothem
