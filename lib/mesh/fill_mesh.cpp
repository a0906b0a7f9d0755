#include "lib/mesh/fill_mesh.hpp"

#include "geometry/meshing/delaunay_mesh.hpp"
#include "lib/mesh/check.hpp"
#include "lib/mesh/groups.hpp"
#include "lib/mesh/smooth.hpp"
#include "lib/mesh/split.hpp"

namespace apothem {
namespace {

constexpr double kTriangleToCut = 2.2;  // edge length of the triangles to cut, over the wanted size
constexpr double kLeastSine = .6;       // least sine of the corners of two joined triangles
constexpr int kSweeps = 20;             // of smoothing

// Of the outer ring, as it was given.
std::vector<int> edge_numbers(const Polygon& outline) {
  std::vector<int> numbers;
  for (int e = 0; e < outline.ring_start(1); ++e) numbers.push_back(outline.input_edge(e));
  return numbers;
}

Mesh filled(const Polygon& outline, const std::vector<Polygon>& holes, double size,
            ElementShape shape, const std::vector<int>& edges) {
  const bool quadrilaterals = shape == ElementShape::quadrilateral;
  TriangleMesh triangles =
      delaunay_mesh(outline, holes, quadrilaterals ? kTriangleToCut * size : size);
  Mesh mesh;
  mesh.nodes = std::move(triangles.points);
  for (const Triangle& t : triangles.triangles) mesh.add_element(t);
  if (quadrilaterals) {
    mesh = into_quadrilaterals(join_triangles(mesh, kLeastSine));
    smooth_nodes(mesh, kSweeps);
  }
  std::vector<int> hole_sizes;
  for (const Polygon& hole : holes) hole_sizes.push_back(hole.size());
  add_outline_groups(mesh, edges, hole_sizes);
  check_mesh(mesh);
  return mesh;
}

}  // namespace

Mesh fill_mesh(const Polygon& outline, const std::vector<Polygon>& holes, double size,
               ElementShape shape) {
  return filled(outline, holes, size, shape, edge_numbers(outline));
}

Mesh fill_mesh(const Polygon& region, double size, ElementShape shape) {
  Rings rings = rings_of(region);
  std::vector<Polygon> holes;
  for (size_t i = 1; i < rings.size(); ++i) holes.emplace_back(std::move(rings[i]));
  return filled(Polygon(std::move(rings[0])), holes, size, shape, edge_numbers(region));
}

Mesh mesh_of_cells(const Polygon& region, const PolygonMesh& cells) {
  Mesh mesh;
  mesh.nodes = cells.points;
  for (const std::vector<int>& cell : cells.cells) mesh.add_element(cell);
  std::vector<int> hole_sizes;
  for (int ring = 1; ring < region.rings(); ++ring) {
    hole_sizes.push_back(region.ring_start(ring + 1) - region.ring_start(ring));
  }
  add_outline_groups(mesh, edge_numbers(region), hole_sizes);
  return mesh;
}

PolygonMesh cells_of_mesh(const Mesh& mesh) {
  PolygonMesh cells{mesh.nodes, {}};
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto corners = mesh.element(e);
    cells.cells.emplace_back(corners.begin(), corners.end());
  }
  return cells;
}

}  // namespace apothem
