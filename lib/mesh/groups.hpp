// Builds the named groups of generated meshes.
#pragma once

#include <string>
#include <vector>

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// A group of edges, directed as in their elements, with all their nodes.
MeshGroup line_group(std::string name, std::vector<std::array<int, 2>> edges);

/// Adds the groups of a region with holes: `boundary` (all boundary edges), `edge-0`, `edge-1`, ...
/// (the element edges along each edge of the outline), and `hole-0`, ... (around each hole). Nodes
/// 0, 1, ... of the mesh must be the vertices of the outline, followed by those of the holes.
/// `edge_numbers` holds the numbers of the outline's edges in the order of its vertices,
/// `hole_sizes` the number of vertices of each hole.
void add_outline_groups(Mesh& mesh, const std::vector<int>& edge_numbers,
                        const std::vector<int>& hole_sizes);

}  // namespace apothem
