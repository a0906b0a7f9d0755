#include "lib/contact/surface/element_surfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {

void ElementSurfaces::add(const Mesh& mesh, const Boundary& boundary, NodeIndex first_node,
                          BodyIndex body, const PotentialChoice& choice, PlacedShapes& shapes) {
  std::vector<ElementIndex> outermost;
  std::set<std::pair<int, int>> edges;
  std::vector<double> tributary(mesh.nodes.size());
  for (const BoundaryLoop& loop : boundary.loops) {
    outermost.insert(outermost.end(), loop.elements.begin(), loop.elements.end());
    for (size_t i = 0; i < loop.nodes.size(); ++i) {
      const int p = loop.nodes[i], q = after(loop.nodes, i);
      const double half = (mesh.nodes[q] - mesh.nodes[p]).norm() / 2;
      tributary[p] += half, tributary[q] += half;
      edges.emplace(p, q);
    }
  }
  for (int n = 0; n < static_cast<int>(tributary.size()); ++n) {
    if (tributary[n] > 0) tributary_lengths_.push_back({first_node + n, body, tributary[n]});
  }
  std::sort(outermost.begin(), outermost.end());
  outermost.erase(std::unique(outermost.begin(), outermost.end()), outermost.end());
  for (const ElementIndex element : outermost) {
    const size_t first = nodes_.size();
    const std::span<const int> ring = mesh.element(element);
    for (size_t k = 0; k < ring.size(); ++k) {
      nodes_.push_back(first_node + ring[k]);
      start_.push_back(mesh.nodes[ring[k]]);
      outer_.push_back(edges.contains({ring[k], after(ring, k)}));
    }
    const Polygon polygon({start_.begin() + static_cast<ptrdiff_t>(first), start_.end()});
    if (!polygon.is_convex()) {
      throw InvalidPolygon(
          fmt::format("the element at ({:.6g}, {:.6g}) m on its boundary is not convex",
                      polygon[0].x(), polygon[0].y()),
          *polygon.first_reflex_vertex());
    }
    shapes.add_deforming(make_potential(polygon, choice));
    elements_.push_back({body, first, ring.size()});
    ring_.resize(std::max(ring_.size(), ring.size()));
  }
}

void ElementSurfaces::place(const Kinematics& now, SurfaceIndex first, PlacedShapes& shapes,
                            std::span<std::array<double, 3>> pose) {
  for (int e = 0; e < size(); ++e) {
    Element& element = elements_[e];
    const auto moved = [&](size_t corner) -> Vec2 {
      const double* u = &now.displacement[2 * static_cast<size_t>(nodes_[corner])];
      return {u[0], u[1]};
    };
    // Differences are taken before sums, so that no digit is lost far from the origin.
    const Vec2& origin = start_[element.corners];
    const Vec2 carried = moved(element.corners);
    const double x = origin.x() + carried.x(), y = origin.y() + carried.y();
    pose[e] = {x, y, 0};
    double all = 0 * x + 0 * y;  // NaN if a place is not finite
    for (size_t k = 0; k < element.count; ++k) {
      const size_t c = element.corners + k;
      ring_[k] = (start_[c] - origin) + (moved(c) - carried);
      all += 0 * ring_[k].x() + 0 * ring_[k].y();
    }
    if (all != 0) throw NotFinite(element.body);
    element.convex = shapes.deform(first + e, x, y, {ring_.data(), element.count});
  }
}

}  // namespace apothem
