// Meshes of triangles of even size and shape in a polygon with holes.
//
// The edges of the outline and of the holes are cut into pieces of the given size. Delaunay
// refinement adds points until no angle is below 20.7 degrees and no edge is too long: J. Ruppert,
// J. Algorithms 18 (1995), and J. R. Shewchuk, Comput. Geom. 22 (2002), as in CGAL's Mesh_2. Then
// each inner point moves to the mean of its triangles' circumcentres, weighted with their areas.
// This is Lloyd's iteration for the optimal Delaunay triangulation: L. Chen, Int. Meshing
// Roundtable (2004). Finally the criterion of angles is enforced once more.
#pragma once

#include <vector>

#include "geometry/polygon/triangulation.hpp"

namespace apothem {

/// A mesh of triangles.
struct TriangleMesh {
  std::vector<Vec2> points;         ///< coordinates of the points, m
  std::vector<Triangle> triangles;  ///< point indices of each triangle, counter-clockwise
};

/// Meshes the outline without the holes. The mean edge length is about `size` (m), less where the
/// polygon has finer details. The first points are the vertices of the outline and then those of
/// the holes, bit for bit; the other points on their edges lie there up to the rounding of their
/// coordinates. No angle is below 20 degrees, except at corners of the polygon below 60 degrees and
/// next to such corners if they are near others. Every run gives the same bits. Throws
/// InvalidPolygon if a hole is not inside the outline, if two holes are not apart, or if edges that
/// are not neighbours come nearer to each other than 1e-9 of the outline's size. Throws
/// std::invalid_argument if `size` is not positive, or if more than 1e7 triangles would be needed.
TriangleMesh delaunay_mesh(const Polygon& outline, const std::vector<Polygon>& holes, double size);

}  // namespace apothem
