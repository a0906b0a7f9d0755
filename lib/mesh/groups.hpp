// Builds the named groups of generated meshes.
#pragma once

#include <string>
#include <vector>

#include "lib/mesh/boundary.hpp"

namespace apothem {

/// A group of edges, directed as in their elements, with all their nodes.
MeshGroup line_group(std::string name, std::vector<std::array<int, 2>> edges);

/// Adds one group of boundary edges for each name: group i holds the edges for which line_of(edge)
/// is i, in the order of boundary_edges. A name without any edge gets no group.
template <class LineOf>
void add_boundary_groups(Mesh& mesh, const std::vector<std::string>& names, const LineOf& line_of) {
  std::vector<std::vector<std::array<int, 2>>> lines(names.size());
  for (const MeshEdge& edge : boundary_edges(mesh)) lines.at(line_of(edge)).push_back(edge.nodes);
  for (size_t i = 0; i < names.size(); ++i) {
    if (!lines[i].empty()) mesh.groups.push_back(line_group(names[i], std::move(lines[i])));
  }
}

/// Adds the groups of a region with holes: `boundary` (all boundary edges), `edge-0`, `edge-1`, ...
/// (the element edges along each edge of the outline), and `hole-0`, ... (around each hole). Nodes
/// 0, 1, ... of the mesh must be the vertices of the outline, followed by those of the holes.
/// `edge_numbers` holds the numbers of the outline's edges in the order of its vertices,
/// `hole_sizes` the number of vertices of each hole.
void add_outline_groups(Mesh& mesh, const std::vector<int>& edge_numbers,
                        const std::vector<int>& hole_sizes);

}  // namespace apothem
