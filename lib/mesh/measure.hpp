// Sizes and shapes of a mesh and its elements.
#pragma once

#include "mesh/mesh.hpp"

namespace apothem {

/// Of a ring of nodes; positive if they go counter-clockwise, in m^2.
double ring_area(const Mesh& mesh, std::span<const int> ring);
inline double element_area(const Mesh& mesh, int element) {
  return ring_area(mesh, mesh.element(element));
}

/// Of the angles at the nodes of a counter-clockwise ring; negative beyond 180 degrees.
double smallest_sine(const Mesh& mesh, std::span<const int> ring);

/// Of the area, m.
Vec2 mesh_centroid(const Mesh& mesh);

/// Longer side of the box around the nodes, m.
double mesh_size(const Mesh& mesh);

struct MeshQuality {
  int triangles = 0;
  int quadrilaterals = 0;
  int polygons = 0;  ///< elements with five or more corners
  double area;       ///< of all elements, m^2
  double smallest_area, largest_area;
  double shortest_edge, longest_edge;    ///< m
  double smallest_angle, largest_angle;  ///< at a corner of an element, rad
  /// Of triangles and quadrilaterals: 1 for equilateral triangles and rectangles, 0 or less for
  /// elements that are none (P. Knupp, Algebraic mesh quality metrics, SIAM J. Sci. Comput. 23
  /// (2001)): the smallest sine of a corner; for triangles by that of 60 degrees. 1 if there are
  /// polygons only.
  double smallest_scaled_jacobian;
};
MeshQuality mesh_quality(const Mesh& mesh);

}  // namespace apothem
