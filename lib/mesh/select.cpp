#include "lib/mesh/select.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "lib/mesh/measure.hpp"

namespace apothem {
namespace {

constexpr double kTolerance = 1e-9;  // times the mesh's size

const MeshGroup& group_of(const Mesh& mesh, const std::string& name) {
  std::string known;
  for (const MeshGroup& group : mesh.groups) {
    if (group.name == name) return group;
    known += (known.empty() ? "" : ", ") + group.name;
  }
  throw std::invalid_argument("the mesh has no group \"" + name + "\"" +
                              (known.empty() ? "; it has none" : " (known: " + known + ")"));
}

}  // namespace

std::vector<int> nodes_where(const Mesh& mesh, const Place& place) {
  const double tolerance = kTolerance * mesh_size(mesh);
  const Box box = place.box.value_or(Box{}).grown(tolerance);
  const auto is_there = [&](const Vec2& p) {
    return (!place.x || std::abs(p.x() - *place.x) <= tolerance) &&
           (!place.y || std::abs(p.y() - *place.y) <= tolerance) &&
           (!place.box || !apart(box, {p.x(), p.y(), p.x(), p.y()}));
  };
  std::vector<int> nodes;
  const auto consider = [&](int node) {
    if (is_there(mesh.nodes[node])) nodes.push_back(node);
  };
  if (place.group) {
    for (const int node : group_of(mesh, *place.group).nodes) consider(node);
  } else {
    for (int node = 0; node < static_cast<int>(mesh.nodes.size()); ++node) consider(node);
  }
  if (place.nearest && !nodes.empty()) {
    nodes = {*std::ranges::min_element(nodes, [&](int a, int b) {
      return (mesh.nodes[a] - *place.nearest).squaredNorm() <
             (mesh.nodes[b] - *place.nearest).squaredNorm();
    })};
  }
  return nodes;
}

std::vector<MeshEdge> edges_where(const Mesh& mesh, const Place& place) {
  const std::vector<int> nodes = nodes_where(mesh, place);
  std::set<std::array<int, 2>> line;
  if (place.group) {
    const MeshGroup& group = group_of(mesh, *place.group);
    line.insert(group.edges.begin(), group.edges.end());
  }
  std::vector<MeshEdge> edges = boundary_edges(mesh);
  std::erase_if(edges, [&](const MeshEdge& edge) {
    const auto selected = [&](int node) { return std::ranges::binary_search(nodes, node); };
    return !selected(edge.nodes[0]) || !selected(edge.nodes[1]) ||
           (!line.empty() && line.count(edge.nodes) == 0);
  });
  return edges;
}

}  // namespace apothem
