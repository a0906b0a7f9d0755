// The exception of a mesh that is refused.
#pragma once

#include <stdexcept>
#include <string>

namespace apothem {

/// What is wrong with a mesh, and at which element or node (-1 if at no particular one).
class InvalidMesh : public std::invalid_argument {
 public:
  InvalidMesh(const std::string& reason, int element, int node)
      : std::invalid_argument(reason), element_(element), node_(node) {}
  static InvalidMesh at_element(int element, const std::string& what) {
    return {"element " + std::to_string(element) + " " + what, element, -1};
  }
  static InvalidMesh at_node(int node, const std::string& what) {
    return {"node " + std::to_string(node) + " " + what, -1, node};
  }
  [[nodiscard]] int element() const { return element_; }
  [[nodiscard]] int node() const { return node_; }

 private:
  int element_;
  int node_;
};

}  // namespace apothem
