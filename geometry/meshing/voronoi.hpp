// Voronoi meshes of a region, which may have holes: random sites, Lloyd's iteration, and cells that
// tile the region exactly.
//
// The Voronoi edges come from a Delaunay triangulation of the sites. Four dummy sites far away from
// the region keep all cells bounded and change nothing inside it. The Voronoi edges and the outline
// of the region are inserted as exact rational segments into one planar arrangement. Its faces
// inside the region are the cells, cut exactly. Each vertex of the arrangement is rounded to double
// once, and all cells share it. Rounding can still spoil edges whose length is of the order of the
// round-off; the collapse of short edges removes them, and tiling_boundary proves that the result
// is a tiling. Lloyd's iteration uses the same arrangement, but only for the cells at the outline,
// because a cell that no edge of the outline comes near is not cut.
//
// If the region is not convex, its outline may cut a cell into several pieces. The piece with the
// site is the cell. Each of the others is joined to the neighbour with which it shares the longest
// boundary, so there are as many cells as sites. A cell that goes round a hole is divided into its
// Delaunay triangles, and these are joined again, in turn the smallest part to the one with which
// it shares the longest boundary, as long as no part goes round a hole. The part with the site is
// the cell. Each of the others is a cell of its own if it has a quarter of the mean area of a cell
// or more, and joins a neighbour otherwise. In Lloyd's iteration all of them join neighbours, so
// that the boundaries of cells move towards holes. There a site moves straight towards the centroid
// of its cell; if the outline is in the way, it moves half-way to the outline.
//
// Source: Q. Du, V. Faber, M. Gunzburger, Centroidal Voronoi tessellations, SIAM Review 41 (1999).
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/meshing/polygon_mesh.hpp"

namespace apothem {

/// A Voronoi mesh of a region. All coordinates are relative to region.origin(), in m.
struct VoronoiMesh {
  /// Cell i belongs to site i. Cells without a site, which are the parts of cells that would go
  /// round a hole, pieces that no neighbour can take and what cuts separate, follow. Point i <
  /// region.size() is vertex i of the region. The other points on the outline lie on their edge up
  /// to the rounding of their coordinates.
  PolygonMesh mesh;
  std::vector<Vec2> sites;   ///< sites, m
  int lloyd_steps = 0;       ///< number of steps of Lloyd's iteration that were made
  double last_movement = 0;  ///< largest movement of a site in the last of these steps, m
  int joined_pieces = 0;     ///< number of pieces that were joined to neighbours
  int cuts = 0;              ///< number of cuts through cells that were not convex
  ShortEdges short_edges;    ///< result of the collapse of short edges
};

/// The options of a Voronoi mesh. The size of a cell is sqrt(area / cells).
struct VoronoiOptions {
  int cells = 1;           ///< number of cells
  std::uint64_t seed = 1;  ///< seed of the random sites
  /// Largest number of steps of Lloyd's iteration. It ends earlier when no site moves by 1e-3 cell
  /// sizes.
  int lloyd = 50;
  double shortest_edge = .1;  ///< length below which edges collapse, in cell sizes, 0 to 0.5
  bool convex = false;        ///< cells that are not convex are cut at their reflex corners
  /// Angle up to which nodes move to open the corners of cells, as far as the region lets them,
  /// rad, 0 to pi/3.
  double smallest_angle = 0;
};

/// Returns `count` distinct random points, uniformly distributed over the inside of the region,
/// relative to region.origin(), m. They are the same on every platform. Throws InvalidPolygon if
/// the region is too thin for them.
std::vector<Vec2> random_sites(const Polygon& region, int count, std::uint64_t seed);

/// The result of Lloyd's iteration.
struct Relaxation {
  int steps;        ///< number of steps that were made
  double movement;  ///< largest movement of a site in the last step, m
};

/// Lloyd's iteration: moves every site towards the centroid of its cell, at most `steps` times. It
/// ends earlier when no site moves by 1e-3 cell sizes.
Relaxation relax(const Polygon& region, std::vector<Vec2>& sites, int steps);

/// Makes the mesh of given sites. Edges shorter than shortest_edge * sqrt(area / cells), and in any
/// case those shorter than 1e-12 of the region's size, are collapsed where that is possible; see
/// ShortEdges. Throws std::invalid_argument unless there is at least one site and all sites are
/// distinct and strictly inside the region. Throws InvalidPolygon if the region has places thinner
/// than double precision resolves.
VoronoiMesh voronoi_mesh(const Polygon& region, const std::vector<Vec2>& sites,
                         double shortest_edge);

/// Makes a mesh with random_sites, relax and the function above, and improves the shapes of its
/// cells as the options ask for, see cell_shapes.hpp. Throws as these functions do, and
/// std::invalid_argument if an option is out of range.
VoronoiMesh voronoi_mesh(const Polygon& region, const VoronoiOptions& options);

/// Moves a mesh from coordinates relative to region.origin() to those of the region. The vertices
/// of the region are then the same bit for bit. Throws InvalidPolygon if the cells do not form a
/// tiling in these coordinates, because the region is too far from the origin of the world.
PolygonMesh in_world(const Polygon& region, const PolygonMesh& mesh);

}  // namespace apothem
