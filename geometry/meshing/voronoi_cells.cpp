#include "geometry/meshing/voronoi_cells.hpp"

#include <CGAL/Arr_consolidated_curve_data_traits_2.h>
#include <CGAL/Arr_extended_dcel.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <stdexcept>

#include "geometry/meshing/polygon_mesh.hpp"

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
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<
    Exact,
    CGAL::Triangulation_data_structure_2<
        CGAL::Triangulation_vertex_base_with_info_2<int, Exact>,
        CGAL::Triangulation_face_base_with_info_2<
            int, Exact, CGAL::Constrained_triangulation_face_base_2<Exact>>>,
    CGAL::No_constraint_intersection_tag>;

// Rounds a point. The result has the same bits however the point was constructed; CGAL's own
// approximation of the point would not.
Vec2 rounded(const Exact::Point_2& p) {
  return {CGAL::to_double(CGAL::exact(p.x())), CGAL::to_double(CGAL::exact(p.y()))};
}

}  // namespace

struct VoronoiDiagram::Parts {
  struct Edge {
    int a, b;           // indices of the two sites
    int centre, other;  // its two ends, as indices of `centres`
  };

  std::vector<Vec2> sites;                  // with the four dummy sites at the end
  std::vector<Edge> edges;                  // edges of the diagram
  std::vector<std::vector<int>> cells;      // per site: its centres, counter-clockwise
  std::vector<std::array<int, 3>> triples;  // per centre: its three sites, ascending
  std::vector<Vec2> centres;                // vertices of the diagram, in double precision

  // A vertex of the diagram, exact.
  [[nodiscard]] Exact::Point_2 exact_centre(int c) const {
    const auto at = [&](int i) { return Exact::Point_2(sites[i].x(), sites[i].y()); };
    const auto& [i, j, k] = triples[c];
    return CGAL::circumcenter(at(i), at(j), at(k));
  }
};

namespace {

// The centre of the circle through three points.
Vec2 circumcentre(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 p = b - a;
  const Vec2 q = c - a;
  const Vec2 r = q.squaredNorm() * p - p.squaredNorm() * q;
  return a + Vec2(-r.y(), r.x()) / (2 * cross(p, q));
}

VoronoiDiagram::Parts voronoi_parts(const std::vector<Vec2>& sites, const Box& box) {
  VoronoiDiagram::Parts parts;
  const int n = static_cast<int>(sites.size());
  parts.sites = sites;
  parts.cells.resize(sites.size());
  // The dummy sites are so far away that every point of the region is nearer to any site.
  const double far = 4 * box.extent();
  const Vec2 middle((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
  for (const double x : {-far, far}) {
    for (const double y : {-far, far}) parts.sites.push_back(middle + Vec2(x, y));
  }
  std::vector<std::pair<Inexact::Point_2, int>> points;
  points.reserve(parts.sites.size());
  for (const Vec2& site : parts.sites) {
    points.push_back({{site.x(), site.y()}, static_cast<int>(points.size())});
  }
  Delaunay delaunay(points.begin(), points.end());
  if (delaunay.number_of_vertices() != points.size()) {
    throw std::invalid_argument("two sites are the same point");
  }
  for (const auto face : delaunay.finite_face_handles()) {
    face->info() = static_cast<int>(parts.centres.size());
    std::array<int, 3>& triple = parts.triples.emplace_back();
    for (int k = 0; k < 3; ++k) triple[k] = face->vertex(k)->info();
    std::ranges::sort(triple);
    const auto& [i, j, k] = triple;
    parts.centres.push_back(circumcentre(parts.sites[i], parts.sites[j], parts.sites[k]));
  }
  for (const auto vertex : delaunay.finite_vertex_handles()) {
    if (vertex->info() >= n) continue;
    const auto start = delaunay.incident_faces(vertex);
    auto face = start;
    do {
      parts.cells[vertex->info()].push_back(face->info());
    } while (++face != start);
  }
  for (const auto& [face, k] : delaunay.finite_edges()) {
    const int a = face->vertex(Delaunay::cw(k))->info();
    const int b = face->vertex(Delaunay::ccw(k))->info();
    if (a < n && b < n) parts.edges.push_back({a, b, face->info(), face->neighbor(k)->info()});
  }
  return parts;
}

// Cuts Voronoi cells by the outline of a region, which is in the coordinates of the sites.
class Cutter {
 public:
  Cutter(const VoronoiDiagram::Parts& diagram, const Polygon& region)
      : diagram_(diagram), region_(region) {
    for (const Vec2& v : region_.vertices()) outline_.emplace_back(v.x(), v.y());
  }

  // The pieces into which the outline cuts the cells of the sites that are `wanted`. All edges of
  // these cells are in the arrangement, so the pieces are complete.
  [[nodiscard]] Pieces cut(const std::vector<bool>& wanted) const {
    const int n = region_.size();
    std::vector<Traits::Curve_2> curves;
    curves.reserve(n + diagram_.edges.size());
    for (int k = 0; k < n; ++k) {
      curves.emplace_back(Segments::Curve_2(outline_[k], outline_[region_.next(k)]), k);
    }
    std::vector<std::optional<Exact::Point_2>> centres(diagram_.centres.size());
    const auto centre = [&](int c) -> const Exact::Point_2& {
      if (!centres[c]) centres[c] = diagram_.exact_centre(c);
      return *centres[c];
    };
    for (size_t e = 0; e < diagram_.edges.size(); ++e) {
      const VoronoiDiagram::Parts::Edge& edge = diagram_.edges[e];
      if (!wanted[edge.a] && !wanted[edge.b]) continue;
      const Exact::Point_2& p = centre(edge.centre);
      const Exact::Point_2& q = centre(edge.other);
      if (p != q) curves.emplace_back(Segments::Curve_2(p, q), n + static_cast<int>(e));
    }
    Arrangement arrangement;
    CGAL::insert(arrangement, curves.begin(), curves.end());
    mark_faces_inside(arrangement);
    const std::set<Arrangement::Face_handle> closed = closed_faces(arrangement);

    Pieces pieces;
    pieces.nodes = region_.vertices();
    pieces.freedom.assign(n, kNowhere);
    for (const auto vertex : arrangement.vertex_handles()) vertex->set_data(-1);
    for (const auto face : arrangement.face_handles()) {
      if (face->data() != kInside) continue;
      const int site = site_of(face);
      if (!wanted[site]) continue;
      if (closed.count(face)) {
        add_triangles(face, site, pieces);
        continue;
      }
      Piece& piece = pieces.list.emplace_back(Piece{site, {}});
      for_boundary(
          face, [&](const auto& edge) { piece.ring.push_back(node_at(edge->target(), pieces)); });
    }
    put_in_order(pieces, n);
    if (!closed.empty()) join_triangles(pieces);
    mark_owned(pieces, diagram_.sites);
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
      for_boundary(face, [&](const auto& edge) {
        const auto next = edge->twin()->face();
        if (next->data() != kUnknown) return;
        next->set_data(outline_edge(edge) < 0 ? face->data() : kInside + kOutside - face->data());
        todo.push_back(next);
      });
    }
  }

  // Calls visit(edge) for every halfedge around a face, beginning with its outer boundary.
  template <class Visit>
  static void for_boundary(Arrangement::Face_handle face, const Visit& visit) {
    const auto walk = [&](Arrangement::Ccb_halfedge_circulator start) {
      auto edge = start;
      do visit(edge);
      while (++edge != start);
    };
    if (face->has_outer_ccb()) walk(face->outer_ccb());
    for (auto hole = face->holes_begin(); hole != face->holes_end(); ++hole) walk(*hole);
  }

  // The faces that go round a hole: all edges of the hole have the same face on their other side.
  // Where a vertex of the hole lies on the outer boundary of such a face, its boundary is one line,
  // which is not simple.
  [[nodiscard]] std::set<Arrangement::Face_handle> closed_faces(Arrangement& arrangement) const {
    std::set<Arrangement::Face_handle> closed;
    if (!region_.has_holes()) return closed;
    std::vector<std::set<Arrangement::Face_handle>> at(region_.size());  // per edge: faces inside
    for (const auto face : arrangement.face_handles()) {
      if (face->data() != kInside) continue;
      for_boundary(face, [&](const auto& edge) {
        if (const int k = outline_edge(edge); k >= 0) at[k].insert(face);
      });
    }
    for (int ring = 1; ring < region_.rings(); ++ring) {
      std::set<Arrangement::Face_handle> around;
      for (int k = region_.ring_start(ring); k < region_.ring_start(ring + 1); ++k) {
        around.merge(at[k]);
      }
      if (around.size() == 1) closed.insert(*around.begin());
    }
    return closed;
  }

  // Adds the triangles of the constrained Delaunay triangulation of a face as pieces.
  void add_triangles(Arrangement::Face_handle face, int site, Pieces& pieces) const {
    Triangulation triangulation;
    std::vector<std::array<Triangulation::Vertex_handle, 2>> sides;  // with the face on their left
    for_boundary(face, [&](const auto& edge) {
      const auto vertex = [&](Arrangement::Vertex_handle end) {
        const auto result = triangulation.insert(end->point());
        result->info() = node_at(end, pieces);
        return result;
      };
      sides.push_back({vertex(edge->source()), vertex(edge->target())});
      triangulation.insert_constraint(sides.back()[0], sides.back()[1]);
    });
    // From the triangles at the sides, all others in the face are reached across other edges.
    for (const auto triangle : triangulation.all_face_handles()) triangle->info() = kOutside;
    std::vector<Triangulation::Face_handle> todo;
    const auto add = [&](Triangulation::Face_handle triangle) {
      if (triangle->info() == kInside) return;
      triangle->info() = kInside;
      Piece& piece = pieces.list.emplace_back(Piece{site, {}, false, true});
      for (int k = 0; k < 3; ++k) piece.ring.push_back(triangle->vertex(k)->info());
      todo.push_back(triangle);
    };
    for (const auto& [source, target] : sides) {
      Triangulation::Face_handle triangle;
      int k = 0;
      triangulation.is_edge(source, target, triangle, k);
      const bool is_left = triangle->vertex(Triangulation::ccw(k)) == source;
      add(is_left ? triangle : triangle->neighbor(k));
    }
    while (!todo.empty()) {
      const auto triangle = todo.back();
      todo.pop_back();
      for (int k = 0; k < 3; ++k) {
        if (!triangle->is_constrained(k)) add(triangle->neighbor(k));
      }
    }
  }

  // The site to whose cell a face belongs. Any Voronoi edge on its boundary determines it; if there
  // is no such edge, there is only one site.
  int site_of(Arrangement::Face_handle face) const {
    int site = -1;
    for_boundary(face, [&](const auto& edge) {
      for (const int data : edge->curve().data()) {
        if (site >= 0 || data < region_.size()) continue;
        const VoronoiDiagram::Parts::Edge& voronoi = diagram_.edges[data - region_.size()];
        const Vec2& a = diagram_.sites[voronoi.a];
        const bool a_is_left = CGAL::orientation(edge->source()->point(), edge->target()->point(),
                                                 Exact::Point_2(a.x(), a.y())) == CGAL::LEFT_TURN;
        site = a_is_left ? voronoi.a : voronoi.b;
      }
    });
    return std::max(site, 0);
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
      for (const int i : {k, region_.next(k)}) {
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

  const VoronoiDiagram::Parts& diagram_;
  const Polygon& region_;
  std::vector<Exact::Point_2> outline_;
};

}  // namespace

VoronoiDiagram::VoronoiDiagram(const std::vector<Vec2>& sites, const Box& box)
    : parts_(std::make_unique<const Parts>(voronoi_parts(sites, box))) {}

VoronoiDiagram::~VoronoiDiagram() = default;

Box VoronoiDiagram::box_of(int site) const {
  Box box;
  for (const int c : parts_->cells[site]) box.include(parts_->centres[c]);
  return box;
}

std::vector<Vec2> VoronoiDiagram::whole_cell(int site) const {
  std::vector<Vec2> ring;
  for (const int c : parts_->cells[site]) ring.push_back(parts_->centres[c]);
  return ring;
}

std::vector<bool> VoronoiDiagram::with_neighbours(const std::vector<bool>& marked) const {
  std::vector<bool> result = marked;
  for (const Parts::Edge& edge : parts_->edges) {
    if (marked[edge.a]) result[edge.b] = true;
    if (marked[edge.b]) result[edge.a] = true;
  }
  return result;
}

Pieces VoronoiDiagram::cut(const Polygon& region, const std::vector<bool>& wanted) const {
  return Cutter(*parts_, region).cut(wanted);
}

}  // namespace apothem
