// Voronoi meshes of a region: sites, Lloyd's iteration, and cells that tile the region exactly.
//
// The Voronoi edges of a Delaunay triangulation of the sites (dummy sites far around the region
// keep all cells bounded and change nothing inside it) and the outline of the region go as exact
// rational segments into one planar arrangement. Its faces inside the region are the cells, cut
// exactly; each of its vertices is rounded to double once, and all cells share it. What rounding
// can still spoil - edges of the order of the round-off - the collapse of short edges removes, and
// tiling_boundary proves the result. Lloyd's iteration runs on the same arrangement, of the cells
// at the outline only: cells that no edge of the outline comes near are whole.
//
// Where the region is not convex, its outline may cut a cell into several pieces. The one with the
// site is the cell; each of the others joins the neighbour with which it shares the longest
// boundary, so there are as many cells as sites. In Lloyd's iteration a site walks straight towards
// the centroid of its cell; if the outline bars the way, half-way to the outline.
//
// Q. Du, V. Faber, M. Gunzburger, Centroidal Voronoi tessellations, SIAM Review 41 (1999).
#pragma once

#include <cstdint>
#include <vector>

#include "apothem/geometry/meshing/polygon_mesh.hpp"

namespace apothem {

/// All coordinates are relative to region.origin(), in m.
struct VoronoiMesh {
  /// Point i < region.size() is vertex i of the region; the other points on its outline lie on
  /// their edge up to the rounding of their coordinates. Cell i belongs to site i.
  PolygonMesh mesh;
  std::vector<Vec2> sites;
  int lloyd_steps = 0;
  double last_movement = 0;  ///< largest move of a site in the last step of Lloyd's iteration
  int joined_pieces = 0;     ///< pieces of cells without their site
  ShortEdges short_edges;
};

struct VoronoiOptions {
  int cells = 1;
  std::uint64_t seed = 1;
  int lloyd = 50;             ///< steps at most; ends early once no site moves by 1e-3 cell sizes
  double shortest_edge = .1;  ///< in [0, 0.5], of the mean cell size sqrt(area / cells)
};

/// Distinct points, uniformly distributed over the region's inside, the same on every platform.
/// Throws InvalidPolygon if the region is too thin to find any.
std::vector<Vec2> random_sites(const Polygon& region, int count, std::uint64_t seed);

/// Lloyd's iteration: moves every site towards the centroid of its cell, at most `steps` times.
struct Relaxation {
  int steps;
  double movement;
};
Relaxation relax(const Polygon& region, std::vector<Vec2>& sites, int steps);

/// The cells of given sites: one or more, distinct, strictly inside the region (otherwise
/// std::invalid_argument). Edges shorter than shortest_edge * sqrt(area / cells), and at least
/// those of 1e-12 of the region's size, are collapsed where that is possible (see ShortEdges).
/// Throws InvalidPolygon if the region has places thinner than double precision resolves.
VoronoiMesh voronoi_mesh(const Polygon& region, const std::vector<Vec2>& sites,
                         double shortest_edge);

/// random_sites, relax, voronoi_mesh. Throws std::invalid_argument for options out of range.
VoronoiMesh voronoi_mesh(const Polygon& region, const VoronoiOptions& options);

/// The mesh in the world: the region's vertices are those of the region, bit for bit. Throws
/// InvalidPolygon if cells cannot be told apart in these coordinates, far from the origin.
PolygonMesh in_world(const Polygon& region, const PolygonMesh& mesh);

}  // namespace apothem
