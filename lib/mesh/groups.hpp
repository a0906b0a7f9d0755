// Groups of the generated meshes.
#pragma once

#include <string>
#include <vector>

#include "mesh/boundary.hpp"

namespace apothem {

/// A group of edges (directed as in their elements) and all their nodes.
MeshGroup line_group(std::string name, std::vector<std::array<int, 2>> edges);

/// Line i of `names` holds the boundary edges for which line_of(edge) is i; lines without any edge
/// get no group. Edges come in the order of boundary_edges.
template <class LineOf>
void add_boundary_groups(Mesh& mesh, const std::vector<std::string>& names, const LineOf& line_of) {
  std::vector<std::vector<std::array<int, 2>>> lines(names.size());
  for (const MeshEdge& edge : boundary_edges(mesh)) lines.at(line_of(edge)).push_back(edge.nodes);
  for (size_t i = 0; i < names.size(); ++i) {
    if (!lines[i].empty()) mesh.groups.push_back(line_group(names[i], std::move(lines[i])));
  }
}

/// For the mesh of a region whose outline's vertices are nodes 0, 1, ..., those of its holes behind
/// them: `boundary` (all edges), `edge-0`, `edge-1`, ... (along the edges of the outline) and
/// `hole-0`, ... (around each hole). `edge_numbers` holds the numbers of the outline's edges in the
/// order of its vertices, `hole_sizes` the number of vertices of each hole.
void add_outline_groups(Mesh& mesh, const std::vector<int>& edge_numbers,
                        const std::vector<int>& hole_sizes);

}  // namespace apothem
