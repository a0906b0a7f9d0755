#include "apothem/geometry/meshing/voronoi.hpp"

#include <CGAL/Arr_consolidated_curve_data_traits_2.h>
#include <CGAL/Arr_extended_dcel.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <array>
#include <numeric>
#include <random>
#include <set>

#include "apothem/geometry/meshing/cell_pieces.hpp"
#include "apothem/geometry/polygon/predicates.hpp"
#include "apothem/geometry/polygon/triangulation.hpp"
#include "apothem/geometry/spatial/boxes.hpp"

namespace apothem {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Inexact = CGAL::Exact_predicates_inexact_constructions_kernel;
using Delaunay = CGAL::Delaunay_triangulation_2<
    Inexact,
    CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<int, Inexact>,
                                         CGAL::Triangulation_face_base_with_info_2<int, Inexact>>>;
using Segments = CGAL::Arr_segment_traits_2<Exact>;
using Traits = CGAL::Arr_consolidated_curve_data_traits_2<Segments, int>;
using Arrangement = CGAL::Arrangement_2<Traits, CGAL::Arr_extended_dcel<Traits, int, int, int>>;

constexpr double kEven = 1e-3;           // movement over the cell size that ends Lloyd's iteration
constexpr double kUnresolved = 0x1p-40;  // shorter edges over the region's size always collapse

// Rounds a point. The result has the same bits however the point was constructed; CGAL's own
// approximation of the point would not.
Vec2 rounded(const Exact::Point_2& p) {
  return {CGAL::to_double(CGAL::exact(p.x())), CGAL::to_double(CGAL::exact(p.y()))};
}

// The region in coordinates relative to its origin().
Polygon local_polygon(const Polygon& region) {
  try {
    return Polygon(region.local_vertices());
  } catch (const InvalidPolygon& error) {
    throw InvalidPolygon(
        std::string("has details that are lost relative to its vertex 0: ") + error.what(),
        error.vertex());
  }
}

double area(const Polygon& region) { return area_moments(region).area; }

// Area of a ring and its first moment of area about a given origin.
struct Moments {
  double area = 0;
  Vec2 first = Vec2::Zero();
};
Moments moments(const std::vector<Vec2>& ring, const Vec2& origin) {
  Moments m;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 p = ring[i] - origin;
    const Vec2 q = ring[i + 1 == ring.size() ? 0 : i + 1] - origin;
    m.area += cross(p, q) / 2;
    m.first += cross(p, q) * (p + q) / 6;
  }
  return m;
}

// The Voronoi diagram of the sites in the plane.
class Diagram {
 public:
  struct Edge {
    int a, b;           // indices of the two sites
    int centre, other;  // its two ends, as indices of `centres`
  };

  Diagram(const std::vector<Vec2>& sites, const Box& box) : cells_(sites.size()) {
    // The dummy sites are so far away that every point of the region is nearer to any site.
    const double far = 4 * box.extent();
    const Inexact::Point_2 middle((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
    std::vector<std::pair<Inexact::Point_2, int>> points;
    for (const double x : {-far, far}) {
      for (const double y : {-far, far}) points.push_back({middle + Inexact::Vector_2(x, y), -1});
    }
    for (size_t i = 0; i < sites.size(); ++i) {
      points.push_back({{sites[i].x(), sites[i].y()}, static_cast<int>(i)});
    }
    Delaunay delaunay(points.begin(), points.end());
    if (delaunay.number_of_vertices() != points.size()) {
      throw std::invalid_argument("two sites are the same point");
    }
    const CGAL::Cartesian_converter<Inexact, Exact> exact;
    for (const auto face : delaunay.finite_face_handles()) {
      face->info() = static_cast<int>(centres.size());
      std::array<int, 3>& triple = triples_.emplace_back();
      for (int k = 0; k < 3; ++k) triple[k] = face->vertex(k)->info();
      std::sort(triple.begin(), triple.end());
      centres.push_back(CGAL::circumcenter(exact(face->vertex(0)->point()),
                                           exact(face->vertex(1)->point()),
                                           exact(face->vertex(2)->point())));
    }
    for (const auto vertex : delaunay.finite_vertex_handles()) {
      if (vertex->info() < 0) continue;
      const auto start = delaunay.incident_faces(vertex);
      auto face = start;
      do {
        cells_[vertex->info()].push_back(face->info());
      } while (++face != start);
    }
    for (const auto& [face, k] : delaunay.finite_edges()) {
      const int a = face->vertex(Delaunay::cw(k))->info();
      const int b = face->vertex(Delaunay::ccw(k))->info();
      if (a >= 0 && b >= 0) edges.push_back({a, b, face->info(), face->neighbor(k)->info()});
    }
  }

  // A box that contains the cell of a site.
  [[nodiscard]] Box box_of(int site) const {
    Box box;
    for (const int c : cells_[site]) {
      const CGAL::Bbox_2 b = centres[c].bbox();
      box.include(b.xmin(), b.ymin());
      box.include(b.xmax(), b.ymax());
    }
    return box;
  }

  // The cell of a site without the outline, in double precision, which suffices to move sites.
  [[nodiscard]] std::vector<Vec2> whole_cell(int site, const std::vector<Vec2>& sites) const {
    std::vector<Vec2> ring;
    for (const int c : cells_[site]) {
      const auto& [i, j, k] = triples_[c];
      const Vec2 p = sites[j] - sites[i];
      const Vec2 q = sites[k] - sites[i];
      const Vec2 r = q.squaredNorm() * p - p.squaredNorm() * q;
      ring.push_back(sites[i] + Vec2(-r.y(), r.x()) / (2 * cross(p, q)));
    }
    return ring;
  }

  std::vector<Exact::Point_2> centres;  // vertices of the diagram
  std::vector<Edge> edges;              // edges of the diagram

 private:
  std::vector<std::vector<int>> cells_;      // per site: its centres, counter-clockwise
  std::vector<std::array<int, 3>> triples_;  // per centre: its three sites, ascending
};

// Cuts Voronoi cells by the outline of a region, in coordinates relative to the region's origin().
class Cutter {
 public:
  explicit Cutter(const Polygon& region)
      : region_(local_polygon(region)), box_(bounding_box(region_)) {
    for (const Vec2& v : region_.vertices()) outline_.emplace_back(v.x(), v.y());
  }

  [[nodiscard]] const Polygon& region() const { return region_; }
  [[nodiscard]] const Box& box() const { return box_; }

  // Per site: whether an edge of the outline may come near its cell. The test uses the cell's box.
  [[nodiscard]] std::vector<bool> cells_at_outline(const Diagram& diagram, int sites) const {
    std::vector<Box> boxes;
    for (int i = 0; i < sites; ++i) boxes.push_back(diagram.box_of(i));
    for (int k = 0; k < region_.size(); ++k) {
      Box& box = boxes.emplace_back();
      box.include(region_[k].x(), region_[k].y());
      box.include(region_.after(k).x(), region_.after(k).y());
    }
    std::vector<BoxPair> pairs;
    BoxGrid().find_pairs(boxes, pairs);
    std::vector<bool> at_outline(sites, false);
    for (const BoxPair& pair : pairs) {
      if (pair.first >= sites || pair.second < sites || at_outline[pair.first]) continue;
      const Box& box = boxes[pair.first];
      const int k = pair.second - sites;
      int left = 0, right = 0;
      for (const Vec2& corner : {Vec2(box.x0, box.y0), Vec2(box.x1, box.y0), Vec2(box.x1, box.y1),
                                 Vec2(box.x0, box.y1)}) {
        const int side = orientation(region_[k], region_.after(k), corner);
        left += side > 0;
        right += side < 0;
      }
      at_outline[pair.first] = left < 4 && right < 4;
    }
    return at_outline;
  }

  // The pieces into which the outline cuts the cells of the sites that are `wanted`. All edges of
  // these cells are in the arrangement, so the pieces are complete.
  [[nodiscard]] Pieces cut(const Diagram& diagram, const std::vector<Vec2>& sites,
                           const std::vector<bool>& wanted) const {
    const int n = region_.size();
    std::vector<Traits::Curve_2> curves;
    for (int k = 0; k < n; ++k) {
      curves.emplace_back(Segments::Curve_2(outline_[k], outline_[k + 1 == n ? 0 : k + 1]), k);
    }
    for (size_t e = 0; e < diagram.edges.size(); ++e) {
      const Diagram::Edge& edge = diagram.edges[e];
      if (!wanted[edge.a] && !wanted[edge.b]) continue;
      const Exact::Point_2& p = diagram.centres[edge.centre];
      const Exact::Point_2& q = diagram.centres[edge.other];
      if (p != q) curves.emplace_back(Segments::Curve_2(p, q), n + static_cast<int>(e));
    }
    Arrangement arrangement;
    CGAL::insert(arrangement, curves.begin(), curves.end());
    mark_faces_inside(arrangement);

    Pieces pieces;
    pieces.nodes = region_.vertices();
    pieces.freedom.assign(n, kNowhere);
    for (const auto vertex : arrangement.vertex_handles()) vertex->set_data(-1);
    for (const auto face : arrangement.face_handles()) {
      if (face->data() != kInside) continue;
      const int site = site_of(face, diagram, sites);
      if (!wanted[site]) continue;
      Piece& piece = pieces.list.emplace_back(Piece{site, {}, false});
      const auto start = face->outer_ccb();
      auto edge = start;
      do {
        piece.ring.push_back(node_at(edge->target(), pieces));
      } while (++edge != start);
    }
    put_in_order(pieces, n);
    find_owned(pieces, sites);
    return pieces;
  }

 private:
  static constexpr int kUnknown = -1;
  static constexpr int kOutside = 0;
  static constexpr int kInside = 1;

  // Index of the edge of the outline that a halfedge lies on, or -1.
  template <class Halfedge>
  [[nodiscard]] int outline_edge(const Halfedge& halfedge) const {
    for (const int data : halfedge->curve().data()) {
      if (data < region_.size()) return data;
    }
    return -1;
  }

  // Marks all faces as inside or outside, beginning with the unbounded face. The mark changes where
  // the outline is crossed.
  void mark_faces_inside(Arrangement& arrangement) const {
    for (const auto face : arrangement.face_handles()) face->set_data(kUnknown);
    std::vector<Arrangement::Face_handle> todo{arrangement.unbounded_face()};
    todo.back()->set_data(kOutside);
    while (!todo.empty()) {
      const auto face = todo.back();
      todo.pop_back();
      const auto visit = [&](Arrangement::Ccb_halfedge_circulator start) {
        auto edge = start;
        do {
          const auto next = edge->twin()->face();
          if (next->data() != kUnknown) continue;
          next->set_data(outline_edge(edge) < 0 ? face->data() : kInside + kOutside - face->data());
          todo.push_back(next);
        } while (++edge != start);
      };
      if (face->has_outer_ccb()) visit(face->outer_ccb());
      for (auto hole = face->holes_begin(); hole != face->holes_end(); ++hole) visit(*hole);
    }
  }

  // The site to whose cell a face belongs. Any Voronoi edge on its boundary determines it; if there
  // is no such edge, there is only one site.
  int site_of(Arrangement::Face_handle face, const Diagram& diagram,
              const std::vector<Vec2>& sites) const {
    const auto start = face->outer_ccb();
    auto edge = start;
    do {
      for (const int data : edge->curve().data()) {
        if (data < region_.size()) continue;
        const Diagram::Edge& voronoi = diagram.edges[data - region_.size()];
        const Vec2& a = sites[voronoi.a];
        const bool a_is_left = CGAL::orientation(edge->source()->point(), edge->target()->point(),
                                                 Exact::Point_2(a.x(), a.y())) == CGAL::LEFT_TURN;
        return a_is_left ? voronoi.a : voronoi.b;
      }
    } while (++edge != start);
    return 0;
  }

  // Index of the node at a vertex of the arrangement; adds the node if it is new.
  int node_at(Arrangement::Vertex_handle vertex, Pieces& pieces) const {
    if (vertex->data() >= 0) return vertex->data();
    int freedom = kAnywhere;
    const auto start = vertex->incident_halfedges();
    auto edge = start;
    do {
      const int k = outline_edge(edge);
      if (k < 0) continue;
      freedom = k;
      for (const int i : {k, k + 1 == region_.size() ? 0 : k + 1}) {
        if (vertex->point() == outline_[i]) {
          vertex->set_data(i);
          return i;
        }
      }
    } while (++edge != start);
    vertex->set_data(static_cast<int>(pieces.nodes.size()));
    pieces.nodes.push_back(rounded(vertex->point()));
    pieces.freedom.push_back(freedom);
    return vertex->data();
  }

  // Marks one piece of each site as owned: the one that contains the site, or the largest one if no
  // piece contains it because of rounding.
  void find_owned(Pieces& pieces, const std::vector<Vec2>& sites) const {
    std::vector<std::vector<int>> of_site(sites.size());
    for (size_t i = 0; i < pieces.list.size(); ++i) {
      of_site[pieces.list[i].site].push_back(static_cast<int>(i));
    }
    for (size_t site = 0; site < sites.size(); ++site) {
      const std::vector<int>& list = of_site[site];
      if (list.empty()) continue;
      int best = list[0];
      double largest = -1;
      for (const int i : list) {
        if (list.size() == 1) break;
        const std::vector<Vec2> ring = pieces.points(pieces.list[i].ring);
        if (strictly_inside(ring, sites[site])) {
          best = i;
          break;
        }
        if (const double size = moments(ring, sites[site]).area; size > largest) {
          largest = size;
          best = i;
        }
      }
      pieces.list[best].owned = true;
    }
  }

  Polygon region_;
  Box box_;
  std::vector<Exact::Point_2> outline_;
};

// The new position of a site that moves towards `target` and must not leave the ring. It is the
// target itself, or half-way to the ring if the ring is in the way.
Vec2 walk(const Vec2& site, const Vec2& target, const std::vector<Vec2>& ring) {
  const Vec2 way = target - site;
  double exit = 2;  // part of the way up to the ring, 2 if it is not in the way; half is moved
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 p = ring[i] - site;
    const Vec2 edge = ring[i + 1 == ring.size() ? 0 : i + 1] - ring[i];
    const double slope = cross(way, edge);
    const double along = cross(p, way) / slope;
    const double t = cross(p, edge) / slope;
    if (along >= 0 && along <= 1 && t > 0 && t <= 1) exit = std::min(exit, t);
  }
  return site + exit / 2 * way;
}

// The sites after one step of Lloyd's iteration.
std::vector<Vec2> sites_after_step(const Cutter& cutter, const std::vector<Vec2>& sites) {
  const int n = static_cast<int>(sites.size());
  const Diagram diagram(sites, cutter.box());
  const std::vector<bool> at_outline = cutter.cells_at_outline(diagram, n);
  std::vector<Vec2> moved = sites;
  const auto centroid = [](const std::vector<Vec2>& ring, const Vec2& site) -> Vec2 {
    const Moments m = moments(ring, site);
    return site + m.first / m.area;
  };
  for (int i = 0; i < n; ++i) {
    if (!at_outline[i]) moved[i] = centroid(diagram.whole_cell(i, sites), sites[i]);
  }
  Pieces pieces = cutter.cut(diagram, sites, at_outline);
  join_pieces(pieces);
  for (const Piece& piece : pieces.list) {
    if (!piece.owned) continue;
    const Vec2& site = sites[piece.site];
    const std::vector<Vec2> ring = pieces.points(piece.ring);
    const Vec2 place = walk(site, centroid(ring, site), ring);
    if (strictly_inside(cutter.region().vertices(), place)) moved[piece.site] = place;
  }
  return moved;
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
  std::mt19937_64 engine(seed);
  const auto uniform = [&] { return std::ldexp(engine() >> 11, -53); };
  std::vector<Vec2> sites;
  std::set<std::pair<double, double>> taken;
  for (int failures = 0; static_cast<int>(sites.size()) < count;) {
    const size_t t = std::upper_bound(area_up_to.begin(), area_up_to.end(), uniform() * sum) -
                     area_up_to.begin();
    const auto& [i, j, k] = triangles[std::min(t, triangles.size() - 1)];
    double u = uniform();
    double v = uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec2 site = local[i] + u * (local[j] - local[i]) + v * (local[k] - local[i]);
    if (strictly_inside(local.vertices(), site) && taken.emplace(site.x(), site.y()).second) {
      sites.push_back(site);
    } else if (++failures > 1000 + 10 * count) {
      throw InvalidPolygon("is too thin for double precision to place sites in it", 0);
    }
  }
  return sites;
}

Relaxation relax(const Polygon& region, std::vector<Vec2>& sites, int steps) {
  const Cutter cutter(region);
  const double size = std::sqrt(area(region) / static_cast<double>(sites.size()));
  Relaxation result{0, 0};
  while (result.steps < steps) {
    const std::vector<Vec2> moved = sites_after_step(cutter, sites);
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
  const Cutter cutter(region);
  if (sites.empty()) throw std::invalid_argument("there must be at least one site");
  for (const Vec2& site : sites) {
    if (!is_finite(site) || !strictly_inside(cutter.region().vertices(), site)) {
      throw std::invalid_argument("every site must lie inside the region");
    }
  }
  const Diagram diagram(sites, cutter.box());
  Pieces pieces = cutter.cut(diagram, sites, std::vector<bool>(sites.size(), true));
  VoronoiMesh result;
  result.sites = sites;
  result.joined_pieces = static_cast<int>(pieces.list.size() - sites.size());
  if (!join_pieces(pieces)) {
    throw InvalidPolygon(
        "cuts pieces off its cells that no other cell can take; change the seed or the number of "
        "cells",
        0);
  }
  result.mesh.points = std::move(pieces.nodes);
  result.mesh.cells.resize(sites.size());
  for (Piece& piece : pieces.list) result.mesh.cells[piece.site] = std::move(piece.ring);
  const double size = std::sqrt(area(region) / static_cast<double>(sites.size()));
  result.short_edges =
      collapse_short_edges(result.mesh, std::move(pieces.freedom),
                           std::max(shortest_edge * size, kUnresolved * cutter.box().extent()));
  try {
    tiling_boundary(result.mesh);
  } catch (const InvalidPolygon& error) {
    throw InvalidPolygon(
        std::string("has places thinner than double precision resolves: ") + error.what(), 0);
  }
  return result;
}

VoronoiMesh voronoi_mesh(const Polygon& region, const VoronoiOptions& options) {
  if (options.cells < 1) throw std::invalid_argument("the number of cells must be at least 1");
  if (options.lloyd < 0)
    throw std::invalid_argument("Lloyd's iteration cannot have negative steps");
  if (!(options.shortest_edge >= 0 && options.shortest_edge <= .5)) {
    throw std::invalid_argument("the shortest edge must be between 0 and 0.5 cell sizes");
  }
  std::vector<Vec2> sites = random_sites(region, options.cells, options.seed);
  const Relaxation relaxation = relax(region, sites, options.lloyd);
  VoronoiMesh result = voronoi_mesh(region, sites, options.shortest_edge);
  result.lloyd_steps = relaxation.steps;
  result.last_movement = relaxation.movement;
  return result;
}

PolygonMesh in_world(const Polygon& region, const PolygonMesh& mesh) {
  PolygonMesh world = mesh;
  for (int i = 0; i < static_cast<int>(mesh.points.size()); ++i) {
    world.points[i] = i < region.size() ? region[i] : region.origin() + mesh.points[i];
  }
  try {
    tiling_boundary(world);
  } catch (const InvalidPolygon& error) {
    throw InvalidPolygon(std::string("has cells that cannot be told apart this far from the "
                                     "origin; move it closer or ask for fewer cells: ") +
                             error.what(),
                         0);
  }
  return world;
}

}  // namespace apothem
