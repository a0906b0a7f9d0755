#include "lib/mesh/groups.hpp"

#include <algorithm>

#include "geometry/polygon/cyclic.hpp"
#include "lib/mesh/boundary.hpp"

namespace apothem {

MeshGroup line_group(std::string name, std::vector<std::array<int, 2>> edges) {
  MeshGroup group{std::move(name), {}, std::move(edges)};
  for (const auto& [a, b] : group.edges) group.nodes.insert(group.nodes.end(), {a, b});
  std::ranges::sort(group.nodes);
  group.nodes.erase(std::unique(group.nodes.begin(), group.nodes.end()), group.nodes.end());
  return group;
}

void add_outline_groups(Mesh& mesh, const std::vector<int>& edge_numbers,
                        const std::vector<int>& hole_sizes) {
  const int corners = static_cast<int>(edge_numbers.size());
  std::vector<int> hole_of;  // hole of each vertex that follows those of the outline
  for (size_t hole = 0; hole < hole_sizes.size(); ++hole) {
    hole_of.insert(hole_of.end(), hole_sizes[hole], static_cast<int>(hole));
  }
  std::vector<std::array<int, 2>> all;
  std::vector<std::vector<std::array<int, 2>>> edges(corners), holes(hole_sizes.size());
  // Loops start at their lowest node, which is a vertex of the outline or of a hole.
  for (const BoundaryLoop& loop : boundary(mesh).loops) {
    const int first = loop.nodes.front();
    int last_corner = first;
    for (size_t i = 0; i < loop.nodes.size(); ++i) {
      const int node = loop.nodes[i];
      const std::array edge{node, after(loop.nodes, i)};
      all.push_back(edge);
      if (first >= corners) {
        holes.at(hole_of.at(first - corners)).push_back(edge);
        continue;
      }
      if (node < corners) last_corner = node;
      edges[edge_numbers[last_corner]].push_back(edge);
    }
  }
  mesh.groups.push_back(line_group("boundary", std::move(all)));
  for (int i = 0; i < corners; ++i) {
    mesh.groups.push_back(line_group("edge-" + std::to_string(i), std::move(edges[i])));
  }
  for (size_t i = 0; i < holes.size(); ++i) {
    mesh.groups.push_back(line_group("hole-" + std::to_string(i), std::move(holes[i])));
  }
}

}  // namespace apothem
