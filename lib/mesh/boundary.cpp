#include "lib/mesh/boundary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "geometry/integrals/penetration.hpp"
#include "geometry/polygon/disjoint_sets.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "lib/mesh/invalid_mesh.hpp"
#include "lib/mesh/measure.hpp"

namespace apothem {

int component_count(const Mesh& mesh, const std::vector<MeshEdge>& edges) {
  DisjointSets sets(static_cast<size_t>(mesh.element_count()));
  int count = mesh.element_count();
  for (const MeshEdge& edge : edges) {
    if (!edge.on_boundary() && sets.join(edge.left, edge.right)) --count;
  }
  return count;
}

Boundary boundary(const Mesh& mesh, const std::vector<MeshEdge>& edges) {
  struct Step {
    int to = -1;
    int element = -1;
  };
  std::vector<Step> next(mesh.nodes.size());
  for (const MeshEdge& edge : edges) {
    if (!edge.on_boundary()) continue;
    Step& step = next[edge.nodes[0]];
    if (step.to >= 0) {
      throw InvalidMesh::at_node(
          edge.nodes[0],
          fmt::format(
              "is a pinch: elements {} and {} meet there and in no edge; join or separate them",
              step.element, edge.left));
    }
    step = {edge.nodes[1], edge.left};
  }
  Boundary result;
  result.components = component_count(mesh, edges);
  for (int first = 0; first < static_cast<int>(next.size()); ++first) {
    if (next[first].to < 0) continue;
    BoundaryLoop loop;
    for (int node = first; next[node].to >= 0;) {
      const Step step = next[node];
      next[node].to = -1;
      loop.nodes.push_back(node);
      loop.elements.push_back(step.element);
      node = step.to;
    }
    loop.is_hole = ring_area(mesh, loop.nodes) < 0;
    result.loops.push_back(std::move(loop));
  }
  std::stable_partition(result.loops.begin(), result.loops.end(),
                        [](const BoundaryLoop& loop) { return !loop.is_hole; });
  return result;
}

Boundary boundary(const Mesh& mesh) { return boundary(mesh, mesh_edges(mesh)); }

std::vector<double> inradii(const Mesh& mesh, const BoundaryLoop& loop) {
  std::vector<double> radii;
  for (const int element : loop.elements) {
    const Polygon polygon(mesh.places(mesh.element(element)));
    radii.push_back(polygon.is_convex() ? inscribed_circle(polygon).radius
                                        : largest_inscribed_circle(polygon).radius);
  }
  return radii;
}

double boundary_inradius(const Mesh& mesh, const Boundary& boundary) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const BoundaryLoop& loop : boundary.loops) {
    for (const double r : inradii(mesh, loop)) smallest = std::min(smallest, r);
  }
  return smallest;
}

double mesh_inradius(const Mesh& mesh, const Boundary& boundary) {
  BoundaryDistance distance;
  for (const BoundaryLoop& loop : boundary.loops) {
    for (size_t i = 0; i < loop.nodes.size(); ++i) {
      distance.add(mesh.nodes[loop.nodes[i]], mesh.nodes[after(loop.nodes, i)]);
    }
  }
  double largest = 0;
  Vec2 last = mesh.nodes.front();
  double of_last = std::numeric_limits<double>::infinity();
  const auto look = [&](const Vec2& p) {
    // No point is farther from the boundary than one beside it by more than their distance.
    if (of_last + (p - last).norm() <= largest) return;
    last = p, of_last = distance.at(p);
    largest = std::max(largest, of_last);
  };
  for (int e = 0; e < mesh.element_count(); ++e) {
    const std::span<const int> corners = mesh.element(e);
    Vec2 middle = Vec2::Zero();
    for (size_t i = 0; i < corners.size(); ++i) {
      const Vec2& corner = mesh.nodes[corners[i]];
      middle += corner / static_cast<double>(corners.size());
      look(corner);
      look((corner + mesh.nodes[after(corners, i)]) / 2);
    }
    look(middle);
  }
  return largest;
}

}  // namespace apothem
