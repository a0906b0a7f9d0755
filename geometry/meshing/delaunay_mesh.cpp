#include "geometry/meshing/delaunay_mesh.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <list>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/spatial/boxes.hpp"
#include "geometry/spatial/hilbert.hpp"

namespace apothem {
namespace {

// Index of a point in the mesh; -1 for points that CGAL's mesher has added.
struct Number {
  int value = -1;
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using Face = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                               CGAL::Triangulation_data_structure_2<Vertex, Face>>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Triangulation>;
using Mesher = CGAL::Delaunay_mesher_2<Triangulation, Criteria>;

constexpr double kAngle = .125;      // square of the sine of the smallest angle, 20.7 degrees
constexpr double kLongest = 1.45;    // longest edge over the size, for a mean near the size
constexpr int kSteps = 30;           // largest number of steps of Lloyd's iteration
constexpr double kSettled = 1e-3;    // largest movement over the size at which the iteration ends
constexpr double kLeastHeight = .1;  // smallest height of a triangle after a move over that before
constexpr double kMost = 1e7;        // largest number of triangles
constexpr double kThinnest = 1e-9;   // smallest distance of edges over the size of the outline

[[noreturn]] void refuse_number() {
  throw std::invalid_argument(
      "takes more than 1e7 elements; give a larger size or a polygon with less fine detail");
}

// Distance of a point from a segment.
double distance(const Vec2& p, const std::array<Vec2, 2>& segment) {
  return std::sqrt(nearest_on_segment(p - segment[0], segment[1] - segment[0]).distance2);
}

// Distance of two segments that do not cross.
double distance(const std::array<Vec2, 2>& a, const std::array<Vec2, 2>& b) {
  return std::min({distance(a[0], b), distance(a[1], b), distance(b[0], a), distance(b[1], a)});
}

// Throws InvalidPolygon unless the holes lie inside the outline and apart from each other, and no
// place is too thin to be meshed.
void require_room(const Polygon& outline, const std::vector<Polygon>& holes) {
  struct Edge {
    std::array<Vec2, 2> ends;
    int ring, number;  // index of the hole, or -1 for the outline; index of the edge
  };
  const double thinnest = kThinnest * bounding_box(outline).extent();
  std::vector<Edge> edges;
  std::vector<Box> boxes;
  const auto add = [&](const Polygon& ring, int number) {
    for (int i = 0; i < ring.size(); ++i) {
      edges.push_back({{ring[i], ring.after(i)}, number, i});
      boxes.push_back(box_of(edges.back().ends).grown(thinnest / 2));
    }
  };
  add(outline, -1);
  for (size_t h = 0; h < holes.size(); ++h) add(holes[h], static_cast<int>(h));
  const auto size = [&](int ring) { return ring < 0 ? outline.size() : holes[ring].size(); };
  const auto name = [](int ring) {
    return ring < 0 ? std::string("the outline") : "hole " + std::to_string(ring);
  };
  std::vector<BoxPair> pairs;
  BoxGrid().find_pairs(boxes, pairs);
  for (const auto& [first, second] : pairs) {
    const Edge& i = edges[first];
    const Edge& j = edges[second];
    if (i.ring != j.ring) {
      if (segments_meet(i.ends[0], i.ends[1], j.ends[0], j.ends[1])) {
        throw InvalidPolygon(name(j.ring) + " meets " + name(i.ring), 0);
      }
    } else if (j.number - i.number == 1 || j.number - i.number == size(i.ring) - 1) {
      continue;
    }
    if (distance(i.ends, j.ends) < thinnest) {
      throw InvalidPolygon(name(i.ring) + " is, at its edge " + std::to_string(i.number) +
                               ", nearer than 1e-9 of the size to edge " +
                               std::to_string(j.number) + " of " + name(j.ring) +
                               "; simplify the polygon",
                           i.number);
    }
  }
  for (size_t h = 0; h < holes.size(); ++h) {
    if (!strictly_inside(outline.vertices(), holes[h][0])) {
      throw InvalidPolygon(name(static_cast<int>(h)) + " lies outside the outline", 0);
    }
    for (size_t k = 0; k < holes.size(); ++k) {
      if (k != h && strictly_inside(holes[k].vertices(), holes[h][0])) {
        throw InvalidPolygon(
            name(static_cast<int>(h)) + " lies inside " + name(static_cast<int>(k)), 0);
      }
    }
  }
}

// Does the work of delaunay_mesh in coordinates relative to the outline's origin().
class Mesh2 {
 public:
  Mesh2(const Polygon& outline, const std::vector<Polygon>& holes, double size)
      : origin_(outline.origin()), size_(size) {
    add_ring(outline);
    for (const Polygon& hole : holes) {
      add_ring(hole);
      seeds_.push_back(inner_point(hole));
    }
    cut_edges();
  }

  TriangleMesh run() {
    refine(Criteria(kAngle, kLongest * size_));
    const std::vector<bool> movable = inner_points();
    for (int step = 0; step < kSteps; ++step) {
      triangulate_points();
      if (smooth(movable) < kSettled * size_) break;
    }
    refine(Criteria(kAngle));
    for (Vec2& p : points_) p += origin_;
    return {std::move(points_), std::move(triangles_)};
  }

 private:
  void add_ring(const Polygon& ring) {
    const int first = static_cast<int>(points_.size());
    for (int i = 0; i < ring.size(); ++i) {
      points_.emplace_back(ring[i] - origin_);
      edges_.push_back({first + i, first + next(i, ring.size())});
    }
  }

  // A point inside a hole: the centroid of the largest of its triangles.
  [[nodiscard]] Kernel::Point_2 inner_point(const Polygon& hole) const {
    double largest = -1;
    Vec2 best = Vec2::Zero();
    for (const auto& [i, j, k] : triangulate(hole)) {
      const double area = cross(hole[j] - hole[i], hole[k] - hole[i]);
      if (area <= largest) continue;
      largest = area;
      best = hole[i] - origin_ + ((hole[j] - hole[i]) + (hole[k] - hole[i])) / 3;
    }
    return {best.x(), best.y()};
  }

  // Cuts the edges into pieces no longer than the size.
  void cut_edges() {
    std::vector<std::array<int, 2>> pieces;
    for (const auto& [a, b] : edges_) {
      const Vec2 start = points_[a];
      const Vec2 way = points_[b] - start;
      const int n = std::max(1, static_cast<int>(std::ceil(way.norm() / size_ * (1 - 1e-9))));
      int last = a;
      for (int i = 1; i < n; ++i) {
        const int next = static_cast<int>(points_.size());
        points_.emplace_back(start + way * (static_cast<double>(i) / n));
        pieces.push_back({last, next});
        last = next;
      }
      pieces.push_back({last, b});
    }
    edges_ = std::move(pieces);
  }

  // The constrained Delaunay triangulation of the present points and edges.
  Triangulation triangulation() const {
    Triangulation result;
    std::vector<Triangulation::Vertex_handle> vertices(points_.size());
    Triangulation::Face_handle near;
    for (const int i : hilbert_order(points_)) {
      vertices[i] = result.insert({points_[i].x(), points_[i].y()}, near);
      vertices[i]->info().value = i;
      near = vertices[i]->face();
    }
    for (const auto& [a, b] : edges_) result.insert_constraint(vertices[a], vertices[b]);
    return result;
  }

  // Stores the triangles of a triangulation that are inside the domain.
  void take_triangles(const Triangulation& from) {
    triangles_.clear();
    for (const auto face : from.finite_face_handles()) {
      if (!face->is_in_domain()) continue;
      Triangle& t = triangles_.emplace_back();
      for (int k = 0; k < 3; ++k) t[k] = face->vertex(k)->info().value;
    }
  }

  void triangulate_points() {
    Triangulation t = triangulation();
    Mesher::mark_facets(t, seeds_.begin(), seeds_.end());
    take_triangles(t);
  }

  // Adds points by Delaunay refinement until the criteria are met.
  void refine(const Criteria& criteria) {
    Triangulation t = triangulation();
    Mesher mesher(t, criteria);
    mesher.set_seeds(seeds_.begin(), seeds_.end());
    mesher.init();
    while (mesher.step_by_step_refine_mesh()) {
      if (static_cast<double>(t.number_of_vertices()) > kMost / 2) refuse_number();
    }
    for (const auto vertex : t.finite_vertex_handles()) {
      if (vertex->info().value >= 0) continue;
      vertex->info().value = static_cast<int>(points_.size());
      points_.emplace_back(vertex->point().x(), vertex->point().y());
    }
    take_triangles(t);
    edges_.clear();
    for (const auto& [face, k] : t.finite_edges()) {
      if (!face->is_constrained(k)) continue;
      edges_.push_back({face->vertex(Triangulation::cw(k))->info().value,
                        face->vertex(Triangulation::ccw(k))->info().value});
    }
  }

  [[nodiscard]] std::vector<bool> inner_points() const {
    std::vector<bool> inner(points_.size(), true);
    for (const auto& edge : edges_) {
      for (const int node : edge) inner[node] = false;
    }
    return inner;
  }

  // Makes one step of Lloyd's iteration and returns the largest movement, m.
  double smooth(const std::vector<bool>& movable) {
    std::vector<Vec2> moment(points_.size(), Vec2::Zero());
    std::vector<double> weight(points_.size(), 0);
    for (const auto& t : triangles_) {
      const Vec2 u = points_[t[1]] - points_[t[0]];
      const Vec2 v = points_[t[2]] - points_[t[0]];
      const double twice = cross(u, v);
      const Vec2 centre = points_[t[0]] + middle(u, v, twice, movable, t);
      for (const int i : t) {
        moment[i] += twice * centre;
        weight[i] += twice;
      }
    }
    std::vector<Vec2> target = points_;
    for (size_t i = 0; i < target.size(); ++i) {
      if (movable[i] && weight[i] > 0) target[i] = moment[i] / weight[i];
    }
    // A point is not moved if one of its triangles would lose most of its height or turn over.
    std::vector<bool> barred(points_.size(), false);
    for (const auto& t : triangles_) {
      for (int k = 0; k < 3; ++k) {
        const Vec2& a = points_[t[(k + 1) % 3]];
        const Vec2& b = points_[t[(k + 2) % 3]];
        if (cross(b - a, target[t[k]] - a) < kLeastHeight * cross(b - a, points_[t[k]] - a)) {
          barred[t[k]] = true;
        }
      }
    }
    double largest = 0;
    for (size_t i = 0; i < target.size(); ++i) {
      if (barred[i]) continue;
      largest = std::max(largest, (target[i] - points_[i]).norm());
      points_[i] = target[i];
    }
    return largest;
  }

  // The circumcentre of a triangle relative to its point 0. At the boundary, where the circumcentre
  // may lie outside, it is the centroid instead.
  static Vec2 middle(const Vec2& u, const Vec2& v, double twice, const std::vector<bool>& movable,
                     const Triangle& t) {
    if (!movable[t[0]] || !movable[t[1]] || !movable[t[2]]) return (u + v) / 3;
    const Vec2 w = u.squaredNorm() * v - v.squaredNorm() * u;
    return Vec2(w.y(), -w.x()) / (2 * twice);
  }

  Vec2 origin_;
  double size_;
  std::vector<Vec2> points_;               // relative to origin_, m
  std::vector<std::array<int, 2>> edges_;  // edges of the outline and the holes
  std::list<Kernel::Point_2> seeds_;       // one point inside every hole
  std::vector<Triangle> triangles_;
};

}  // namespace

TriangleMesh delaunay_mesh(const Polygon& outline, const std::vector<Polygon>& holes, double size) {
  if (!(size > 0)) throw std::invalid_argument("the size of the elements must be positive");
  require_room(outline, holes);
  double around = 0;
  const auto measure = [&](const Polygon& ring) {
    for (int i = 0; i < ring.size(); ++i) around += (ring.after(i) - ring[i]).norm();
  };
  measure(outline);
  for (const Polygon& hole : holes) measure(hole);
  if (!(area_moments(outline).area / (size * size) < kMost / 2.3 && around / size < kMost)) {
    refuse_number();
  }
  TriangleMesh mesh = Mesh2(outline, holes, size).run();
  int i = 0;
  for (const Vec2& p : outline.vertices()) mesh.points[i++] = p;
  for (const Polygon& hole : holes) {
    for (const Vec2& p : hole.vertices()) mesh.points[i++] = p;
  }
  return mesh;
}

}  // namespace apothem
