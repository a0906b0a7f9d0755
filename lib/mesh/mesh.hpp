// A finite-element mesh of one body: nodes, elements with any number of corners, named groups.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "geometry/point.hpp"

namespace apothem {

/// A named part of a mesh, for supports and loads.
struct MeshGroup {
  std::string name;
  std::vector<int> nodes;                 ///< all nodes of the part, ascending
  std::vector<std::array<int, 2>> edges;  ///< of a part that is a line; directed as in its element
};

/// What the generators of meshes fill a region with.
enum class ElementShape { quadrilateral, triangle };

/// Straight-edged elements; neighbours share the nodes of their common edge.
struct Mesh {
  std::vector<Vec2> nodes;    ///< m
  std::vector<int> corners;   ///< node numbers of all elements, counter-clockwise
  std::vector<int> first{0};  ///< element e has the corners first[e] ... first[e + 1] - 1
  std::vector<MeshGroup> groups;

  [[nodiscard]] int element_count() const { return static_cast<int>(first.size()) - 1; }
  [[nodiscard]] std::span<const int> element(int e) const {
    return {corners.data() + first[e], corners.data() + first[e + 1]};
  }
  void add_element(std::span<const int> nodes_of_element) {
    corners.insert(corners.end(), nodes_of_element.begin(), nodes_of_element.end());
    first.push_back(static_cast<int>(corners.size()));
  }
};

}  // namespace apothem
