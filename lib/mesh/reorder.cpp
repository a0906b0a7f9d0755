#include "lib/mesh/reorder.hpp"

#include <algorithm>

#include "geometry/spatial/hilbert.hpp"

namespace apothem {

Reordering reorder_along_curve(Mesh& mesh) {
  std::vector<Vec2> centres;
  centres.reserve(mesh.element_count());
  for (int e = 0; e < mesh.element_count(); ++e) {
    Vec2 sum = Vec2::Zero();
    for (const int c : mesh.element(e)) sum += mesh.nodes[c];
    centres.emplace_back(sum / static_cast<double>(mesh.element(e).size()));
  }
  Reordering old{{}, hilbert_order(centres)};
  old.nodes.reserve(mesh.nodes.size());
  std::vector<int> number(mesh.nodes.size(), -1);
  const auto renumber = [&](int node) {
    if (number[node] < 0) {
      number[node] = static_cast<int>(old.nodes.size());
      old.nodes.push_back(node);
    }
  };
  Mesh result;
  result.corners.reserve(mesh.corners.size());
  result.first.reserve(mesh.first.size());
  for (const int e : old.elements) {
    const size_t start = result.corners.size();
    result.add_element(mesh.element(e));
    for (size_t i = start; i < result.corners.size(); ++i) {
      renumber(result.corners[i]);
      result.corners[i] = number[result.corners[i]];
    }
  }
  for (int node = 0; node < static_cast<int>(mesh.nodes.size()); ++node) renumber(node);
  result.nodes.reserve(mesh.nodes.size());
  for (const int node : old.nodes) result.nodes.push_back(mesh.nodes[node]);
  std::vector<int> place(old.elements.size());
  for (size_t e = 0; e < old.elements.size(); ++e) place[old.elements[e]] = static_cast<int>(e);
  result.groups = std::move(mesh.groups);
  for (MeshGroup& group : result.groups) {
    for (int& node : group.nodes) node = number[node];
    std::ranges::sort(group.nodes);
    for (auto& edge : group.edges) edge = {number[edge[0]], number[edge[1]]};
    for (int& e : group.elements) e = place[e];
    std::ranges::sort(group.elements);
  }
  mesh = std::move(result);
  return old;
}

}  // namespace apothem
