// Selects nodes and boundary edges of a mesh by position or group.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/mesh/edges.hpp"

namespace apothem {

/// A selection of nodes. All conditions that are given must hold; without any, every node is
/// selected. Positions in m are compared with a tolerance of 1e-9 of the mesh's size.
struct Place {
  std::optional<double> x = {};           ///< position in x, m
  std::optional<double> y = {};           ///< position in y, m
  std::optional<Box> box = {};            ///< box that contains the node, boundary included
  std::optional<std::string> group = {};  ///< name of a group that contains the node
  /// Select only the node nearest to this point, m, among those that meet the other conditions.
  std::optional<Vec2> nearest = {};
};

/// The selected nodes, in ascending order. Throws std::invalid_argument if the mesh does not have
/// the group.
std::vector<int> nodes_where(const Mesh& mesh, const Place& place);

/// The boundary edges whose two nodes are selected and, if the group is a line, that belong to it,
/// in the order of boundary_edges. Throws as nodes_where does.
std::vector<MeshEdge> edges_where(const Mesh& mesh, const Place& place);

}  // namespace apothem
