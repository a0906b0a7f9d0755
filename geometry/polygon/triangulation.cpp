#include "geometry/polygon/triangulation.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {

std::vector<Triangle> triangulate(const Polygon& polygon) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Vertex = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
  using Face = CGAL::Triangulation_face_base_with_info_2<
      bool, Kernel, CGAL::Constrained_triangulation_face_base_2<Kernel>>;
  using Triangulation =
      CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                                 CGAL::Triangulation_data_structure_2<Vertex, Face>,
                                                 CGAL::No_constraint_intersection_tag>;
  Triangulation triangulation;
  std::vector<Triangulation::Vertex_handle> vertices;
  for (int i = 0; i < polygon.size(); ++i) {
    const auto near = i == 0 ? Triangulation::Face_handle() : vertices.back()->face();
    vertices.push_back(triangulation.insert({polygon[i].x(), polygon[i].y()}, near));
    vertices.back()->info() = i;
  }
  for (int i = 0; i < polygon.size(); ++i) {
    triangulation.insert_constraint(vertices[i], vertices[next(i, polygon.size())]);
  }

  // A face lies outside if it can be reached from the infinite face without crossing an edge of the
  // polygon. The info of these faces is set to false.
  for (const auto face : triangulation.all_face_handles()) face->info() = true;
  std::vector<Triangulation::Face_handle> outside{triangulation.infinite_face()};
  outside.back()->info() = false;
  while (!outside.empty()) {
    const auto face = outside.back();
    outside.pop_back();
    for (int k = 0; k < 3; ++k) {
      const auto next = face->neighbor(k);
      if (!next->info() || face->is_constrained(k)) continue;
      next->info() = false;
      outside.push_back(next);
    }
  }
  std::vector<Triangle> triangles;
  for (const auto face : triangulation.finite_face_handles()) {
    if (!face->info()) continue;
    triangles.push_back(
        {face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  }
  return triangles;
}

}  // namespace apothem
