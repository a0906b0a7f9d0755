// Sizes and quality of a mesh and of its elements.
#pragma once

#include <span>

#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Area of a cyclic list of nodes, m^2; positive if they run counter-clockwise.
double ring_area(const Mesh& mesh, std::span<const int> ring);
/// Area of an element, m^2.
inline double element_area(const Mesh& mesh, int element) {
  return ring_area(mesh, mesh.element(element));
}

/// Smallest sine of the angles at the nodes of a counter-clockwise cyclic list; negative if an
/// angle exceeds 180 degrees.
double smallest_sine(const Mesh& mesh, std::span<const int> ring);

/// Centroid of the mesh's area, m.
Vec2 mesh_centroid(const Mesh& mesh);

/// Longer side of the bounding box of all nodes, m.
double mesh_size(const Mesh& mesh);

/// Numbers, sizes and shapes of the elements of a mesh.
struct MeshQuality {
  int triangles = 0;
  int quadrilaterals = 0;
  int polygons = 0;                      ///< number of elements with five or more corners
  double area;                           ///< total area of all elements, m^2
  double smallest_area, largest_area;    ///< of an element, m^2
  double shortest_edge, longest_edge;    ///< length, m
  double smallest_angle, largest_angle;  ///< at a corner of an element, rad
  int not_convex = 0;  ///< number of elements with an angle above 180 degrees by more than 1e-9 rad
  /// Smallest scaled Jacobian of triangles and quadrilaterals: the smallest sine of a corner, for
  /// triangles divided by the sine of 60 degrees. It is 1 for equilateral triangles and rectangles,
  /// 0 or less for degenerate or inverted elements (P. Knupp, Algebraic mesh quality metrics, SIAM
  /// J. Sci. Comput. 23 (2001)), and 1 if all elements have five or more corners.
  double smallest_scaled_jacobian;
};
/// Measures all elements.
MeshQuality mesh_quality(const Mesh& mesh);
/// The smallest ratio of the shortest edge of an element to its apothem, which is the radius of its
/// largest inscribed circle. It is 3.46 for an equilateral triangle, 2 for a square and 1.15 for a
/// regular hexagon.
double smallest_edge_ratio(const Mesh& mesh);

/// The rigid motion that a deformed and moving mesh is nearest to.
struct MeanMotion {
  Vec2 place = Vec2::Zero();     ///< of the mass centre, m
  double angle = 0;              ///< of the rotation that fits the displacements best, rad
  Vec2 velocity = Vec2::Zero();  ///< of the mass centre, m/s
  double spin = 0;               ///< angular momentum over the present moment of inertia, rad/s
};

/// Displacement (m) and velocity (m/s) hold x and y of each node; `mass` of each node in kg.
MeanMotion mean_motion(const Mesh& mesh, std::span<const double> displacement,
                       std::span<const double> velocity, std::span<const double> mass);

}  // namespace apothem
