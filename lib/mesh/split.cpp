#include "lib/mesh/split.hpp"

#include <algorithm>

#include "geometry/polygon/cyclic.hpp"
#include "lib/mesh/edges.hpp"
#include "lib/mesh/measure.hpp"

namespace apothem {
namespace {

// Largest cosine of the angles of a triangle, that of its smallest angle.
double largest_cosine(const Vec2& a, const Vec2& b, const Vec2& c) {
  const auto cosine = [](const Vec2& u, const Vec2& v) {
    return u.dot(v) / std::sqrt(u.squaredNorm() * v.squaredNorm());
  };
  return std::max({cosine(b - a, c - a), cosine(a - b, c - b), cosine(a - c, b - c)});
}

}  // namespace

void add_quadrilateral(Mesh& mesh, const std::array<int, 4>& corners, ElementShape shape,
                       bool odd) {
  if (shape == ElementShape::quadrilateral) return mesh.add_element(corners);
  std::array<Vec2, 4> p;
  for (int i = 0; i < 4; ++i) p[i] = mesh.nodes[corners[i]];
  const double from_0 =
      std::max(largest_cosine(p[0], p[1], p[2]), largest_cosine(p[0], p[2], p[3]));
  const double from_1 =
      std::max(largest_cosine(p[1], p[2], p[3]), largest_cosine(p[1], p[3], p[0]));
  constexpr double kSame = 1e-9;
  const int k = from_1 < from_0 - kSame || (odd && from_1 < from_0 + kSame) ? 1 : 0;
  mesh.add_element(std::array{corners[k], corners[k + 1], corners[k + 2]});
  mesh.add_element(std::array{corners[k], corners[k + 2], corners[(k + 3) % 4]});
}

Mesh into_quadrilaterals(const Mesh& mesh) {
  const std::vector<MeshEdge> edges = mesh_edges(mesh);
  Mesh result;
  result.nodes = mesh.nodes;
  for (const MeshEdge& edge : edges) {
    result.nodes.emplace_back((mesh.nodes[edge.nodes[0]] + mesh.nodes[edge.nodes[1]]) / 2);
  }
  const auto middle = [&](int a, int b) {
    return static_cast<int>(mesh.nodes.size() + (find_edge(edges, a, b) - edges.data()));
  };
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto corners = mesh.element(e);
    Vec2 mean = Vec2::Zero();
    for (const int c : corners) mean += mesh.nodes[c] - mesh.nodes[corners[0]];
    const int centre = static_cast<int>(result.nodes.size());
    result.nodes.emplace_back(mesh.nodes[corners[0]] + mean / static_cast<double>(corners.size()));
    int before = middle(corners.back(), corners.front());
    for (size_t i = 0; i < corners.size(); ++i) {
      const int behind = middle(corners[i], after(corners, i));
      result.add_element(std::array{corners[i], behind, centre, before});
      before = behind;
    }
  }
  return result;
}

Mesh join_triangles(const Mesh& mesh, double least_sine) {
  struct Join {
    double quality;
    int left, right;
    std::array<int, 4> corners;
  };
  const auto opposite = [&](int element, const MeshEdge& edge) {
    const auto corners = mesh.element(element);
    return *std::ranges::find_if(corners,
                                 [&](int c) { return c != edge.nodes[0] && c != edge.nodes[1]; });
  };
  std::vector<Join> joins;
  for (const MeshEdge& edge : mesh_edges(mesh)) {
    if (edge.on_boundary()) continue;
    const auto [a, b] = edge.nodes;
    const std::array corners{a, opposite(edge.right, edge), b, opposite(edge.left, edge)};
    const double quality = smallest_sine(mesh, corners);
    if (quality >= least_sine) joins.push_back({quality, edge.left, edge.right, corners});
  }
  std::ranges::stable_sort(joins,
                           [](const Join& a, const Join& b) { return a.quality > b.quality; });
  std::vector<const Join*> join_of(mesh.element_count(), nullptr);
  for (const Join& join : joins) {
    if (join_of[join.left] != nullptr || join_of[join.right] != nullptr) continue;
    join_of[join.left] = join_of[join.right] = &join;
  }
  Mesh result;
  result.nodes = mesh.nodes;
  for (int e = 0; e < mesh.element_count(); ++e) {
    if (join_of[e] == nullptr) {
      result.add_element(mesh.element(e));
    } else if (e == std::min(join_of[e]->left, join_of[e]->right)) {
      result.add_element(join_of[e]->corners);
    }
  }
  return result;
}

}  // namespace apothem
