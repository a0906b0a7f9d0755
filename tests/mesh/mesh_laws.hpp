// What holds for every mesh of a known region.
#pragma once

#include <catch2/catch.hpp>
#include <set>

#include "lib/mesh/boundary.hpp"
#include "lib/mesh/check.hpp"
#include "lib/mesh/measure.hpp"

namespace apothem::test {

inline const MeshGroup& group(const Mesh& mesh, const std::string& name) {
  const auto found = std::find_if(mesh.groups.begin(), mesh.groups.end(),
                                  [&](const MeshGroup& g) { return g.name == name; });
  REQUIRE(found != mesh.groups.end());
  return *found;
}

/// A mesh with `holes` holes in a region of that area: valid, whole, and of the right topology.
inline void check_laws(const Mesh& mesh, double area, int holes = 0, double tolerance = 1e-13) {
  REQUIRE_NOTHROW(check_mesh(mesh));
  CHECK(mesh_quality(mesh).area == Approx(area).epsilon(tolerance));
  const std::vector<MeshEdge> edges = mesh_edges(mesh);
  const int euler =
      static_cast<int>(mesh.nodes.size()) - static_cast<int>(edges.size()) + mesh.element_count();
  CHECK(euler == 1 - holes);
  const Boundary outline = boundary(mesh, edges);
  CHECK(outline.components == 1);
  REQUIRE(static_cast<int>(outline.loops.size()) == 1 + holes);
  size_t boundary_nodes = 0;
  for (size_t i = 0; i < outline.loops.size(); ++i) {
    const BoundaryLoop& loop = outline.loops[i];
    CHECK(loop.is_hole == (i > 0));
    CHECK(loop.nodes.front() == *std::min_element(loop.nodes.begin(), loop.nodes.end()));
    boundary_nodes += loop.nodes.size();
  }
  CHECK(boundary_nodes == boundary_edges(mesh).size());
}

/// Groups that share out the boundary.
inline void check_share_boundary(const Mesh& mesh, const std::vector<std::string>& names) {
  std::set<std::array<int, 2>> edges;
  size_t count = 0;
  for (const std::string& name : names) {
    const MeshGroup& part = group(mesh, name);
    edges.insert(part.edges.begin(), part.edges.end());
    count += part.edges.size();
  }
  CHECK(edges.size() == count);
  std::set<std::array<int, 2>> all;
  for (const MeshEdge& edge : boundary_edges(mesh)) all.insert(edge.nodes);
  CHECK(edges == all);
}

}  // namespace apothem::test
