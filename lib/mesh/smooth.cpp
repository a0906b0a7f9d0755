#include "lib/mesh/smooth.hpp"

#include <algorithm>

#include "lib/mesh/edges.hpp"
#include "lib/mesh/measure.hpp"

namespace apothem {
namespace {

// One list of numbers for each node, stored one behind the other.
struct Lists {
  std::vector<int> first, items;
  [[nodiscard]] std::span<const int> of(int node) const {
    return {items.data() + first[node], items.data() + first[node + 1]};
  }
};

// Builds the lists; `for_each` calls its argument with each (node, item), the same ones each time.
template <class ForEach>
Lists lists(size_t nodes, const ForEach& for_each) {
  Lists result{std::vector<int>(nodes + 1, 0), {}};
  for_each([&](int node, int) { ++result.first[node + 1]; });
  for (size_t i = 0; i < nodes; ++i) result.first[i + 1] += result.first[i];
  result.items.resize(result.first.back());
  std::vector<int> next(result.first.begin(), result.first.end() - 1);
  for_each([&](int node, int item) { result.items[next[node]++] = item; });
  return result;
}

double smallest_sine_around(const Mesh& mesh, std::span<const int> elements) {
  double smallest = 1;
  for (const int e : elements) smallest = std::min(smallest, smallest_sine(mesh, mesh.element(e)));
  return smallest;
}

}  // namespace

void smooth_nodes(Mesh& mesh, int sweeps) {
  const std::vector<MeshEdge> edges = mesh_edges(mesh);
  std::vector<bool> movable(mesh.nodes.size(), true);
  for (const MeshEdge& edge : edges) {
    if (edge.on_boundary()) movable[edge.nodes[0]] = movable[edge.nodes[1]] = false;
  }
  const Lists neighbours = lists(mesh.nodes.size(), [&](const auto& add) {
    for (const MeshEdge& edge : edges) {
      add(edge.nodes[0], edge.nodes[1]);
      add(edge.nodes[1], edge.nodes[0]);
    }
  });
  const Lists elements = lists(mesh.nodes.size(), [&](const auto& add) {
    for (int e = 0; e < mesh.element_count(); ++e) {
      for (const int c : mesh.element(e)) add(c, e);
    }
  });
  bool moved = true;
  for (int sweep = 0; sweep < sweeps && moved; ++sweep) {
    moved = false;
    for (int node = 0; node < static_cast<int>(mesh.nodes.size()); ++node) {
      if (!movable[node] || neighbours.of(node).empty()) continue;
      const Vec2 before = mesh.nodes[node];
      Vec2 way = Vec2::Zero();
      for (const int other : neighbours.of(node)) way += mesh.nodes[other] - before;
      way /= static_cast<double>(neighbours.of(node).size());
      const double quality = smallest_sine_around(mesh, elements.of(node));
      bool better = false;
      for (const double step : {1., .5}) {
        mesh.nodes[node] = before + step * way;
        better = smallest_sine_around(mesh, elements.of(node)) > quality;
        if (better) break;
      }
      if (!better) mesh.nodes[node] = before;
      moved = moved || better;
    }
  }
}

}  // namespace apothem
