// Nodes and boundary edges of a mesh by their place or name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh/edges.hpp"

namespace apothem {

/// All conditions that are given must hold; without any, everything is selected. Lengths in m,
/// compared to 1e-9 of the mesh's size.
struct Place {
  std::optional<double> x = {};
  std::optional<double> y = {};
  std::optional<Box> box = {};
  std::optional<std::string> group = {};
  std::optional<Vec2> nearest = {};  ///< of the nodes that meet the others, the one nearest to this
};

/// Ascending. Throws std::invalid_argument for a group that the mesh does not have.
std::vector<int> nodes_where(const Mesh& mesh, const Place& place);

/// The boundary edges both of whose nodes are selected and, if the group is a line, that belong to
/// it. In the order of boundary_edges.
std::vector<MeshEdge> edges_where(const Mesh& mesh, const Place& place);

}  // namespace apothem
