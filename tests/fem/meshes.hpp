// Meshes of the tests of elements: rectangles in quadrilaterals, triangles and Voronoi cells,
// regular and spoilt.
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "apps/cases/samples.hpp"
#include "geometry/meshing/voronoi.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/split.hpp"

namespace apothem::test {

/// [0, w] x [-h/2, h/2] in nx x ny quadrilaterals.
inline Mesh quad_grid(int nx, int ny, double w, double h) {
  return rectangle_mesh({w, h}, {nx, ny}, {0, -h / 2}, ElementShape::quadrilateral);
}

/// Each quadrilateral in two triangles.
inline Mesh triangles(const Mesh& quads) {
  Mesh mesh;
  mesh.nodes = quads.nodes;
  for (int e = 0; e < quads.element_count(); ++e) {
    const auto q = quads.element(e);
    add_quadrilateral(mesh, {q[0], q[1], q[2], q[3]}, ElementShape::triangle, e % 2 != 0);
  }
  return mesh;
}

/// On the outline of the rectangle that the nodes fill.
inline std::vector<bool> outline_nodes(const Mesh& mesh) {
  Box box;
  for (const Vec2& p : mesh.nodes) box.include(p.x(), p.y());
  const double near = 1e-12 * box.extent();
  std::vector<bool> on;
  for (const Vec2& p : mesh.nodes) {
    on.push_back(p.x() < box.x0 + near || p.x() > box.x1 - near || p.y() < box.y0 + near ||
                 p.y() > box.y1 - near);
  }
  return on;
}

/// Every node inside moves by up to `share` of its shortest edge along x and y.
inline Mesh distorted(Mesh mesh, double share, std::uint64_t seed = 1) {
  std::vector<double> shortest(mesh.nodes.size(), HUGE_VAL);
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto c = mesh.element(e);
    for (size_t i = 0; i < c.size(); ++i) {
      const int a = c[i], b = c[(i + 1) % c.size()];
      const double length = (mesh.nodes[b] - mesh.nodes[a]).norm();
      shortest[a] = std::min(shortest[a], length);
      shortest[b] = std::min(shortest[b], length);
    }
  }
  const std::vector<bool> fixed = outline_nodes(mesh);
  samples::Random random(seed);
  for (size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (fixed[i]) continue;
    const double reach = share * shortest[i];
    const double dx = random.uniform(-reach, reach), dy = random.uniform(-reach, reach);
    mesh.nodes[i] += Vec2(dx, dy);
  }
  return mesh;
}

/// A quad_grid with every other line along x moved by `share` of the elements' width, all to one
/// side (parallelograms) or its nodes in turn to both (trapezoids); the ends stay upright.
inline Mesh leaning_grid(int nx, int ny, double w, double h, double share, bool alternate) {
  Mesh mesh = quad_grid(nx, ny, w, h);
  for (int j = 1; j <= ny; j += 2) {
    for (int i = 1; i < nx; ++i) {
      const double move = share * w / nx;
      mesh.nodes[static_cast<size_t>(j) * (nx + 1) + i].x() += alternate && i % 2 ? -move : move;
    }
  }
  return mesh;
}

/// [0, w] x [-h/2, h/2] in Voronoi cells, short edges collapsed.
inline Mesh voronoi_cells(int cells, double w, double h, int lloyd = 50, std::uint64_t seed = 1) {
  const Polygon region = samples::block(0, -h / 2, w, h / 2);
  const VoronoiOptions options{.cells = cells, .seed = seed, .lloyd = lloyd};
  return mesh_of_cells(region, in_world(region, voronoi_mesh(region, options).mesh));
}

/// Cells joined in pairs across one edge: mostly not convex. Cells without a partner stay.
inline Mesh merged_cells(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> cell_of;  // by directed edge
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto c = mesh.element(e);
    for (size_t i = 0; i < c.size(); ++i) cell_of[{c[i], c[(i + 1) % c.size()]}] = e;
  }
  std::vector<bool> used(mesh.element_count(), false);
  Mesh result;
  result.nodes = mesh.nodes;
  for (int e = 0; e < mesh.element_count(); ++e) {
    if (used[e]) continue;
    used[e] = true;
    const auto c = mesh.element(e);
    std::vector<int> ring(c.begin(), c.end());
    for (size_t i = 0; i < c.size(); ++i) {
      const int a = c[i], b = c[(i + 1) % c.size()];
      const auto other = cell_of.find({b, a});
      if (other == cell_of.end() || used[other->second]) continue;
      const auto d = mesh.element(other->second);
      const auto shared = std::count_if(
          d.begin(), d.end(), [&](int n) { return std::find(c.begin(), c.end(), n) != c.end(); });
      if (shared != 2) continue;
      used[other->second] = true;
      std::rotate(ring.begin(), std::find(ring.begin(), ring.end(), b), ring.end());
      std::vector<int> rest(d.begin(), d.end());
      std::rotate(rest.begin(), std::find(rest.begin(), rest.end(), a), rest.end());
      ring.insert(ring.end(), rest.begin() + 1, rest.end() - 1);  // from a to b, without both
      break;
    }
    result.add_element(ring);
  }
  return result;
}

inline int reflex_corners(const Mesh& mesh) {
  int count = 0;
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto c = mesh.element(e);
    for (size_t i = 0; i < c.size(); ++i) {
      const Vec2 &a = mesh.nodes[c[i]], &b = mesh.nodes[c[(i + 1) % c.size()]],
                 &d = mesh.nodes[c[(i + 2) % c.size()]];
      if (cross(b - a, d - b) < 0) ++count;
    }
  }
  return count;
}

}  // namespace apothem::test
