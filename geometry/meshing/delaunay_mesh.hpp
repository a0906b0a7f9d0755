// Triangles of even size and shape in a polygon with holes.
//
// The edges of the outline and the holes, cut into pieces of the wanted size, are refined by
// Delaunay's criterion until no angle is below 20.7 degrees and no edge too long (J. Ruppert,
// J. Algorithms 18 (1995), and J. R. Shewchuk, Comput. Geom. 22 (2002), as in CGAL's Mesh_2). Then
// the inner points move to the centroids of their triangles' centres weighted with areas (Lloyd's
// iteration for the optimal Delaunay triangulation: L. Chen, Int. Meshing Roundtable (2004)), and
// the criterion of angles is enforced once more.
#pragma once

#include <vector>

#include "apothem/geometry/polygon/triangulation.hpp"

namespace apothem {

struct TriangleMesh {
  std::vector<Vec2> points;         ///< m
  std::vector<Triangle> triangles;  ///< counter-clockwise
};

/// Mean edge length about `size` (m), shorter where the polygon has finer detail. The first points
/// are the vertices of the outline and of the holes, bit for bit; the others on their edges lie
/// there up to the rounding of their coordinates. No angle is below 20 degrees but at corners of
/// the polygon below 60 degrees and, where these are near others, beside them. The same bits in
/// every run. Throws InvalidPolygon if the holes are not inside the outline and apart, or if edges
/// that are not neighbours come nearer to each other than 1e-9 of the outline's size, and
/// std::invalid_argument unless size is positive and detail leave at most 1e7 triangles.
TriangleMesh delaunay_mesh(const Polygon& outline, const std::vector<Polygon>& holes, double size);

}  // namespace apothem
