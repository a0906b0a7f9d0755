#include "lib/mesh/edges.hpp"

#include <algorithm>

#include "geometry/polygon/cyclic.hpp"
#include "lib/mesh/invalid_mesh.hpp"

namespace apothem {
namespace {

// An edge as one element sees it, stored with the lower one of its nodes.
struct HalfEdge {
  int upper;
  int element;
  bool rising;  // the element runs from the lower to the upper node
  auto operator<=>(const HalfEdge&) const = default;
};

std::string edge_name(int a, int b) {
  return "the edge of nodes " + std::to_string(a) + " and " + std::to_string(b);
}

}  // namespace

std::vector<MeshEdge> mesh_edges(const Mesh& mesh) {
  const auto for_edges = [&](const auto& visit) {
    for (int e = 0; e < mesh.element_count(); ++e) {
      const auto corners = mesh.element(e);
      for (size_t i = 0; i < corners.size(); ++i) visit(e, corners[i], after(corners, i));
    }
  };
  std::vector<int> start(mesh.nodes.size() + 1, 0);
  for_edges([&](int, int a, int b) { ++start[std::min(a, b) + 1]; });
  for (size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
  std::vector<HalfEdge> halves(mesh.corners.size());
  std::vector<int> next(start.begin(), start.end() - 1);
  for_edges([&](int e, int a, int b) {
    halves[next[std::min(a, b)]++] = {std::max(a, b), e, a < b};
  });

  std::vector<MeshEdge> edges;
  edges.reserve(halves.size() / 2 + 2);
  for (int lower = 0; lower + 1 < static_cast<int>(start.size()); ++lower) {
    const auto begin = halves.begin() + start[lower];
    const auto end = halves.begin() + start[lower + 1];
    std::sort(begin, end);
    for (auto half = begin; half != end;) {
      const auto [upper, element, rising] = *half;
      MeshEdge edge{rising ? std::array{lower, upper} : std::array{upper, lower}, element};
      if (++half != end && half->upper == upper) {
        if (half->rising == rising) {
          throw InvalidMesh::at_element(half->element,
                                        "lies on the same side of " + edge_name(lower, upper) +
                                            " as element " + std::to_string(element));
        }
        edge.right = half->element;
        ++half;
      }
      if (half != end && half->upper == upper) {
        throw InvalidMesh::at_element(
            half->element, "shares " + edge_name(lower, upper) + " with two others, elements " +
                               std::to_string(edge.left) + " and " + std::to_string(edge.right));
      }
      edges.push_back(edge);
    }
  }
  return edges;
}

std::vector<MeshEdge> boundary_edges(const Mesh& mesh) {
  std::vector<MeshEdge> edges = mesh_edges(mesh);
  std::erase_if(edges, [](const MeshEdge& edge) { return !edge.on_boundary(); });
  return edges;
}

const MeshEdge* find_edge(const std::vector<MeshEdge>& edges, int a, int b) {
  const auto key = [](const MeshEdge& edge) {
    return std::pair<int, int>(std::minmax(edge.nodes[0], edge.nodes[1]));
  };
  const std::pair<int, int> wanted(std::minmax(a, b));
  const auto found = std::ranges::lower_bound(edges, wanted, {}, key);
  return found != edges.end() && key(*found) == wanted ? &*found : nullptr;
}

}  // namespace apothem
