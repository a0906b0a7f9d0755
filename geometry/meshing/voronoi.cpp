#include "geometry/meshing/voronoi.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "geometry/meshing/cell_pieces.hpp"
#include "geometry/meshing/cell_shapes.hpp"
#include "geometry/meshing/voronoi_cells.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/random_numbers.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/polygon/triangulation.hpp"
#include "geometry/spatial/boxes.hpp"

namespace apothem {
namespace {

constexpr double kEven = 1e-3;           // movement over the cell size that ends Lloyd's iteration
constexpr double kSmallPart = .25;       // largest area of a part that joins, over that of a cell
constexpr double kUnresolved = 0x1p-40;  // shorter edges over the region's size always collapse

// The region in coordinates relative to its origin().
Polygon local_polygon(const Polygon& region) {
  Rings rings = rings_of(region);
  for (std::vector<Vec2>& ring : rings) {
    for (Vec2& v : ring) v -= region.origin();
  }
  try {
    return Polygon(polygon_of_rings(rings));
  } catch (const InvalidPolygon& error) {
    throw InvalidPolygon(
        std::string("has details that are lost relative to its vertex 0: ") + error.what(),
        error.vertex(), error.hole());
  }
}

constexpr int kNone = -1;     // no edge of the outline comes near a cell
constexpr int kSeveral = -2;  // more than one does

// Per site: the edge of the outline that meets the box of its cell, kNone or kSeveral.
std::vector<int> edges_near_cells(const VoronoiDiagram& diagram, int sites, const Polygon& region) {
  std::vector<Box> boxes;
  boxes.reserve(sites + region.size());
  for (int i = 0; i < sites; ++i) boxes.push_back(diagram.box_of(i));
  for (int k = 0; k < region.size(); ++k) boxes.push_back(box_of(region[k], region.after(k)));
  std::vector<BoxPair> pairs;
  BoxGrid().find_pairs(boxes, pairs);
  std::vector<int> near(sites, kNone);
  for (const BoxPair& pair : pairs) {
    if (pair.first >= sites || pair.second < sites || near[pair.first] == kSeveral) continue;
    const Box& box = boxes[pair.first];
    const int k = pair.second - sites;
    int left = 0, right = 0;
    for (const Vec2& corner :
         {Vec2(box.x0, box.y0), Vec2(box.x1, box.y0), Vec2(box.x1, box.y1), Vec2(box.x0, box.y1)}) {
      const int side = orientation(region[k], region.after(k), corner);
      left += side > 0;
      right += side < 0;
    }
    if (left < 4 && right < 4) near[pair.first] = near[pair.first] == kNone ? k : kSeveral;
  }
  return near;
}

// The part of a convex ring on the left of the line from p to q.
std::vector<Vec2> left_part(const std::vector<Vec2>& ring, const Vec2& p, const Vec2& q) {
  std::vector<Vec2> part;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2& a = ring[i];
    const Vec2& b = after(ring, i);
    const double at_a = cross(q - p, a - p);
    const double at_b = cross(q - p, b - p);
    if (at_a >= 0) part.push_back(a);
    if (at_a * at_b < 0) part.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return part;
}

// The new position of a site that moves towards `target` and must not leave the ring. It is the
// target itself, or half-way to the ring if the ring is in the way.
Vec2 walk(const Vec2& site, const Vec2& target, const std::vector<Vec2>& ring) {
  const Vec2 way = target - site;
  double exit = 2;  // part of the way up to the ring, 2 if it is not in the way; half is moved
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 p = ring[i] - site;
    const Vec2 edge = after(ring, i) - ring[i];
    const double slope = cross(way, edge);
    const double along = cross(p, way) / slope;
    const double t = cross(p, edge) / slope;
    if (along >= 0 && along <= 1 && t > 0 && t <= 1) exit = std::min(exit, t);
  }
  return site + exit / 2 * way;
}

// The sites after one step of Lloyd's iteration. The region is in local coordinates. Cells that
// meet at most one edge of the outline are cut in double precision, which suffices to move sites.
// The others are cut exactly, with their neighbours, which may get pieces of them.
std::vector<Vec2> sites_after_step(const Polygon& region, const std::vector<Vec2>& sites) {
  const int n = static_cast<int>(sites.size());
  const VoronoiDiagram diagram(sites, bounding_box(region));
  const std::vector<int> near = edges_near_cells(diagram, n, region);
  std::vector<bool> exact(n);
  for (int i = 0; i < n; ++i) exact[i] = near[i] == kSeveral;
  exact = diagram.with_neighbours(exact);
  std::vector<Vec2> moved = sites;
  const auto centroid = [](const std::vector<Vec2>& ring, const Vec2& site) -> Vec2 {
    const RingMoments m = ring_moments(ring, site);
    return site + m.first / m.area;
  };
  for (int i = 0; i < n; ++i) {
    if (exact[i]) continue;
    std::vector<Vec2> ring = diagram.whole_cell(i);
    if (near[i] != kNone) ring = left_part(ring, region[near[i]], region.after(near[i]));
    const Vec2 place = centroid(ring, sites[i]);
    if (!is_finite(place)) continue;
    if (near[i] == kNone || side_of(region, place) > 0) moved[i] = place;
  }
  if (std::ranges::find(exact, true) == exact.end()) return moved;
  Pieces pieces = diagram.cut(region, exact);
  join_pieces(pieces);
  for (const Piece& piece : pieces.list) {
    if (!piece.owned) continue;
    const Vec2& site = sites[piece.site];
    const std::vector<Vec2> ring = pieces.points(piece.ring);
    const Vec2 place = walk(site, centroid(ring, site), ring);
    if (side_of(region, place) > 0) moved[piece.site] = place;
  }
  return moved;
}

// Turns all pieces into cells and returns their number. Cell i has site i. Large parts of cells
// that went round a hole, and pieces that no neighbour can take, are cells of their own, which
// follow.
int make_cells(Pieces& pieces, int sites, double cell_area) {
  int cells = sites;
  const auto make_cell = [&](Piece& piece) {
    piece.owned = true;
    piece.site = cells++;
  };
  for (Piece& piece : pieces.list) {
    if (piece.owned || !piece.opened) continue;
    if (ring_area(pieces.points(piece.ring)) >= kSmallPart * cell_area) make_cell(piece);
  }
  join_pieces(pieces);
  for (Piece& piece : pieces.list) {
    if (!piece.owned) make_cell(piece);
  }
  return cells;
}

// The freedom of the nodes of a mesh, as in collapse_short_edges.
std::vector<int> freedom_of_nodes(const Polygon& region, const PolygonMesh& mesh) {
  std::vector<int> freedom(mesh.points.size(), kAnywhere);
  for (const std::vector<int>& ring : tiling_boundary(mesh, region.rings() - 1)) {
    int edge = 0;
    for (const int node : ring) {
      if (node < region.size()) edge = node;
      freedom[node] = node == edge ? kNowhere : edge;
    }
  }
  return freedom;
}

// Throws InvalidPolygon unless the cells tile the region.
void require_tiling(const PolygonMesh& mesh, const Polygon& region) {
  try {
    tiling_boundary(mesh, region.rings() - 1);
  } catch (const InvalidPolygon& error) {
    throw InvalidPolygon(
        std::string("has places thinner than double precision resolves: ") + error.what(), 0);
  }
}

double cell_area(const Polygon& region, size_t cells) {
  return area_moments(region).area / static_cast<double>(cells);
}

}  // namespace

std::vector<Vec2> random_sites(const Polygon& region, int count, std::uint64_t seed) {
  const Polygon local = local_polygon(region);
  const std::vector<Triangle> triangles = triangulate(local);
  std::vector<double> area_up_to;
  double sum = 0;
  for (const auto& [i, j, k] : triangles) {
    sum += std::abs(cross(local[j] - local[i], local[k] - local[i]));
    area_up_to.push_back(sum);
  }
  RandomNumbers random(seed);
  const auto uniform = [&] { return random.uniform(0, 1); };
  std::vector<Vec2> sites;
  std::set<std::pair<double, double>> taken;
  for (int failures = 0; static_cast<int>(sites.size()) < count;) {
    const size_t t = std::ranges::upper_bound(area_up_to, uniform() * sum) - area_up_to.begin();
    const auto& [i, j, k] = triangles[std::min(t, triangles.size() - 1)];
    double u = uniform();
    double v = uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec2 site = local[i] + u * (local[j] - local[i]) + v * (local[k] - local[i]);
    if (side_of(local, site) > 0 && taken.emplace(site.x(), site.y()).second) {
      sites.push_back(site);
    } else if (++failures > 1000 + 10 * count) {
      throw InvalidPolygon("is too thin for double precision to place sites in it", 0);
    }
  }
  return sites;
}

Relaxation relax(const Polygon& region, std::vector<Vec2>& sites, int steps) {
  const Polygon local = local_polygon(region);
  const double size = std::sqrt(cell_area(region, sites.size()));
  Relaxation result{0, 0};
  while (result.steps < steps) {
    const std::vector<Vec2> moved = sites_after_step(local, sites);
    result.movement = 0;
    for (size_t i = 0; i < sites.size(); ++i) {
      result.movement = std::max(result.movement, (moved[i] - sites[i]).norm());
    }
    sites = moved;
    ++result.steps;
    if (result.movement < kEven * size) break;
  }
  return result;
}

VoronoiMesh voronoi_mesh(const Polygon& region, const std::vector<Vec2>& sites,
                         double shortest_edge) {
  const Polygon local = local_polygon(region);
  if (sites.empty()) throw std::invalid_argument("there must be at least one site");
  for (const Vec2& site : sites) {
    if (!is_finite(site) || side_of(local, site) <= 0) {
      throw std::invalid_argument("every site must lie inside the region");
    }
  }
  const Box box = bounding_box(local);
  const VoronoiDiagram diagram(sites, box);
  Pieces pieces = diagram.cut(local, std::vector<bool>(sites.size(), true));
  VoronoiMesh result;
  result.sites = sites;
  const int found = static_cast<int>(pieces.list.size());
  const double area = cell_area(region, sites.size());
  const int cells = make_cells(pieces, static_cast<int>(sites.size()), area);
  result.joined_pieces = found - cells;
  result.mesh.points = std::move(pieces.nodes);
  result.mesh.cells.resize(cells);
  for (Piece& piece : pieces.list) result.mesh.cells[piece.site] = std::move(piece.ring);
  result.short_edges =
      collapse_short_edges(result.mesh, std::move(pieces.freedom),
                           std::max(shortest_edge * std::sqrt(area), kUnresolved * box.extent()));
  require_tiling(result.mesh, region);
  return result;
}

VoronoiMesh voronoi_mesh(const Polygon& region, const VoronoiOptions& options) {
  if (options.cells < 1) throw std::invalid_argument("the number of cells must be at least 1");
  if (options.lloyd < 0)
    throw std::invalid_argument("Lloyd's iteration cannot have negative steps");
  if (!(options.shortest_edge >= 0 && options.shortest_edge <= .5)) {
    throw std::invalid_argument("the shortest edge must be between 0 and 0.5 cell sizes");
  }
  if (!(options.smallest_angle >= 0 && options.smallest_angle <= std::numbers::pi / 3)) {
    throw std::invalid_argument("the smallest angle must be between 0 and pi/3");
  }
  std::vector<Vec2> sites = random_sites(region, options.cells, options.seed);
  const Relaxation relaxation = relax(region, sites, options.lloyd);
  VoronoiMesh result = voronoi_mesh(region, sites, options.shortest_edge);
  result.lloyd_steps = relaxation.steps;
  result.last_movement = relaxation.movement;
  if (options.convex) result.cuts = cut_at_reflex_corners(result.mesh);
  if (options.smallest_angle > 0) {
    open_small_angles(result.mesh, freedom_of_nodes(region, result.mesh), options.smallest_angle,
                      options.shortest_edge * std::sqrt(cell_area(region, sites.size())));
  }
  require_tiling(result.mesh, region);
  return result;
}

PolygonMesh in_world(const Polygon& region, const PolygonMesh& mesh) {
  PolygonMesh world = mesh;
  for (int i = 0; i < static_cast<int>(mesh.points.size()); ++i) {
    world.points[i] = i < region.size() ? region[i] : region.origin() + mesh.points[i];
  }
  try {
    tiling_boundary(world, region.rings() - 1);
  } catch (const InvalidPolygon& error) {
    throw InvalidPolygon(std::string("has cells that cannot be told apart this far from the "
                                     "origin; move it closer or ask for fewer cells: ") +
                             error.what(),
                         0);
  }
  return world;
}

}  // namespace apothem
