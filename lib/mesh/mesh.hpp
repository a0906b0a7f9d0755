// The finite-element mesh of one body: nodes, elements with any number of corners, named groups.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// A named part of a mesh to which supports, loads and outputs refer.
struct MeshGroup {
  std::string name;        ///< unique in its mesh
  std::vector<int> nodes;  ///< all nodes of the part, in ascending order
  /// If the part is a line: its edges, directed as in their elements.
  std::vector<std::array<int, 2>> edges;
  /// If the part is an area: its elements, in ascending order.
  std::vector<int> elements = {};
};

/// The shape of the elements that the mesh generators produce.
enum class ElementShape { quadrilateral, triangle };

/// A mesh of elements with straight edges. Neighbours share the nodes of their common edge.
struct Mesh {
  std::vector<Vec2> nodes;        ///< positions, m
  std::vector<int> corners;       ///< node numbers of all elements, each counter-clockwise
  std::vector<int> first{0};      ///< element e has the corners first[e] ... first[e + 1] - 1
  std::vector<MeshGroup> groups;  ///< named parts

  /// Number of elements.
  [[nodiscard]] int element_count() const { return static_cast<int>(first.size()) - 1; }
  /// Node numbers of element `e`.
  [[nodiscard]] std::span<const int> element(int e) const {
    return {corners.data() + first[e], corners.data() + first[e + 1]};
  }
  /// Positions of nodes, as of an element or a loop, m.
  [[nodiscard]] std::vector<Vec2> places(std::span<const int> of_nodes) const {
    std::vector<Vec2> result;
    result.reserve(of_nodes.size());
    for (const int node : of_nodes) result.push_back(nodes[node]);
    return result;
  }
  /// Appends an element with these nodes, which must run counter-clockwise.
  void add_element(std::span<const int> nodes_of_element) {
    corners.insert(corners.end(), nodes_of_element.begin(), nodes_of_element.end());
    first.push_back(static_cast<int>(corners.size()));
  }
};

}  // namespace apothem
