// Sizes and shapes of a mesh and its elements.
#pragma once

#include "mesh/mesh.hpp"

namespace apothem {

/// Positive if the corners go counter-clockwise, in m^2.
double element_area(const Mesh& mesh, int element);

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
