#include "lib/mesh/measure.hpp"

#include <cmath>

#include "geometry/meshing/cell_shapes.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

double ring_area(const Mesh& mesh, std::span<const int> ring) {
  return ring_area(mesh.places(ring));
}

Vec2 mesh_centroid(const Mesh& mesh) {
  double area = 0;
  Vec2 moment = Vec2::Zero();
  const Vec2& base = mesh.nodes.front();
  for (int e = 0; e < mesh.element_count(); ++e) {
    const std::span<const int> ring = mesh.element(e);
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 p = mesh.nodes[ring[i]] - base, q = mesh.nodes[after(ring, i)] - base;
      area += cross(p, q) / 2;
      moment += cross(p, q) / 6 * (p + q);
    }
  }
  return base + moment / area;
}

double smallest_sine(const Mesh& mesh, std::span<const int> ring) {
  double smallest = 1;
  Vec2 in = mesh.nodes[ring.front()] - mesh.nodes[ring.back()];
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 out = mesh.nodes[after(ring, i)] - mesh.nodes[ring[i]];
    smallest = std::min(smallest, cross(in, out) / std::sqrt(in.squaredNorm() * out.squaredNorm()));
    in = out;
  }
  return smallest;
}

double mesh_size(const Mesh& mesh) { return box_of(mesh.nodes).extent(); }

MeshQuality mesh_quality(const Mesh& mesh) {
  MeshQuality q{};
  q.smallest_area = q.shortest_edge = q.smallest_angle = HUGE_VAL;
  q.smallest_scaled_jacobian = 1;
  for (int e = 0; e < mesh.element_count(); ++e) {
    const auto corners = mesh.element(e);
    ++(corners.size() == 3 ? q.triangles : corners.size() == 4 ? q.quadrilaterals : q.polygons);
    const double area = element_area(mesh, e);
    q.area += area;
    q.smallest_area = std::min(q.smallest_area, area);
    q.largest_area = std::max(q.largest_area, area);
    bool convex = true;
    Vec2 in = mesh.nodes[corners.front()] - mesh.nodes[corners.back()];
    for (size_t i = 0; i < corners.size(); ++i) {
      const Vec2 out = mesh.nodes[after(corners, i)] - mesh.nodes[corners[i]];
      const double angle = corner_angle(in, out);
      convex = convex && !is_reflex(angle);
      q.smallest_angle = std::min(q.smallest_angle, angle);
      q.largest_angle = std::max(q.largest_angle, angle);
      q.shortest_edge = std::min(q.shortest_edge, out.norm());
      q.longest_edge = std::max(q.longest_edge, out.norm());
      in = out;
    }
    if (!convex) ++q.not_convex;
    if (corners.size() <= 4) {
      const double best = corners.size() == 3 ? std::sqrt(3.) / 2 : 1;
      q.smallest_scaled_jacobian =
          std::min(q.smallest_scaled_jacobian, smallest_sine(mesh, corners) / best);
    }
  }
  return q;
}

double smallest_edge_ratio(const Mesh& mesh) {
  double smallest = HUGE_VAL;
  for (int e = 0; e < mesh.element_count(); ++e) {
    const Polygon element(mesh.places(mesh.element(e)));
    double shortest = HUGE_VAL;
    for (int i = 0; i < element.size(); ++i) {
      shortest = std::min(shortest, (element.after(i) - element[i]).norm());
    }
    smallest = std::min(smallest, shortest / largest_inscribed_circle(element).radius);
  }
  return smallest;
}

MeanMotion mean_motion(const Mesh& mesh, std::span<const double> displacement,
                       std::span<const double> velocity, std::span<const double> mass) {
  const auto at = [](std::span<const double> v, size_t i) { return Vec2(v[2 * i], v[2 * i + 1]); };
  MeanMotion mean;
  Vec2 reference = Vec2::Zero();
  double whole = 0;
  const size_t n = mesh.nodes.size();
  for (size_t i = 0; i < n; ++i) {
    whole += mass[i];
    reference += mass[i] * mesh.nodes[i];
    mean.place += mass[i] * at(displacement, i);
    mean.velocity += mass[i] * at(velocity, i);
  }
  reference /= whole;
  mean.place = mean.place / whole + reference;
  mean.velocity /= whole;
  double turned = 0, straight = 0, angular = 0, inertia = 0;
  for (size_t i = 0; i < n; ++i) {
    const double m = mass[i];
    const Vec2 before = mesh.nodes[i] - reference;
    const Vec2 now = mesh.nodes[i] + at(displacement, i) - mean.place;
    turned += m * cross(before, now);
    straight += m * before.dot(now);
    angular += m * cross(now, Vec2(at(velocity, i) - mean.velocity));
    inertia += m * now.squaredNorm();
  }
  mean.angle = arc_tangent(turned, straight);
  mean.spin = angular / inertia;
  return mean;
}

}  // namespace apothem
