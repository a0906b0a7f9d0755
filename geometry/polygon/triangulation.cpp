#include "geometry/polygon/triangulation.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/property_map.h>

#include <algorithm>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
// The info of a face is the number of rings around it, or -1 as long as it is not known.
using Face =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                               CGAL::Triangulation_data_structure_2<Vertex, Face>,
                                               CGAL::No_constraint_intersection_tag>;

// Vertices of larger rings are inserted along a curve through the plane, because along a ring such
// as a narrow band, all triangles between its borders may change with every vertex.
constexpr size_t kLarge = 1000;

// The order in which the vertices of a ring are inserted.
std::vector<size_t> insertion_order(std::span<const Vec2> ring) {
  using Place = std::pair<Kernel::Point_2, size_t>;
  std::vector<Place> places;
  for (size_t i = 0; i < ring.size(); ++i) places.push_back({{ring[i].x(), ring[i].y()}, i});
  if (ring.size() > kLarge) {
    CGAL::hilbert_sort(
        places.begin(), places.end(),
        CGAL::Spatial_sort_traits_adapter_2<Kernel, CGAL::First_of_pair_property_map<Place>>());
  }
  std::vector<size_t> order;
  for (const auto& [point, i] : places) order.push_back(i);
  return order;
}

// Inserts a ring whose vertices have the numbers `first`, `first` + 1 and so on.
void insert(Triangulation& triangulation, std::span<const Vec2> ring, int first) {
  std::vector<Triangulation::Vertex_handle> vertices(ring.size());
  Triangulation::Face_handle near;
  for (const size_t i : insertion_order(ring)) {
    const size_t before = triangulation.number_of_vertices();
    vertices[i] = triangulation.insert({ring[i].x(), ring[i].y()}, near);
    near = vertices[i]->face();
    const int number = first + static_cast<int>(i);
    const bool is_new = triangulation.number_of_vertices() > before;
    vertices[i]->info() = is_new ? number : std::min(number, vertices[i]->info());
  }
  for (size_t i = 0; i < ring.size(); ++i) {
    triangulation.insert_constraint(vertices[i], after(vertices, i));
  }
}

// Counts the rings around every face: those between it and the infinite face.
void count_rings(Triangulation& triangulation) {
  for (const auto face : triangulation.all_face_handles()) face->info() = -1;
  std::vector<Triangulation::Face_handle> open{triangulation.infinite_face()};
  open.back()->info() = 0;
  // Faces behind a ring wait until all faces in front of it are known.
  std::vector<Triangulation::Face_handle> behind;
  while (!open.empty()) {
    const auto face = open.back();
    open.pop_back();
    for (int k = 0; k < 3; ++k) {
      const auto next = face->neighbor(k);
      if (next->info() >= 0) continue;
      if (face->is_constrained(k)) {
        behind.push_back(face);
      } else {
        next->info() = face->info();
        open.push_back(next);
      }
    }
    if (!open.empty()) continue;
    for (const auto& known : behind) {
      for (int k = 0; k < 3; ++k) {
        const auto next = known->neighbor(k);
        if (next->info() >= 0) continue;
        next->info() = known->info() + 1;
        open.push_back(next);
      }
    }
    behind.clear();
  }
}

std::vector<Triangle> triangles_of(Triangulation& triangulation) {
  count_rings(triangulation);
  std::vector<Triangle> triangles;
  for (const auto face : triangulation.finite_face_handles()) {
    if (face->info() % 2 == 0) continue;
    triangles.push_back(
        {face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  }
  return triangles;
}

}  // namespace

std::vector<Triangle> triangulate(const Polygon& polygon) {
  Triangulation triangulation;
  for (int k = 0; k < polygon.rings(); ++k) {
    insert(triangulation, polygon.ring(k), polygon.ring_start(k));
  }
  return triangles_of(triangulation);
}

std::vector<Triangle> triangulate(const PolygonWithHoles& polygon) {
  Triangulation triangulation;
  int first = 0;
  for (const std::vector<Vec2>& ring : rings_of(polygon)) {
    insert(triangulation, ring, first);
    first += static_cast<int>(ring.size());
  }
  return triangles_of(triangulation);
}

}  // namespace apothem
