#include "apothem/model/inradius.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/mesh/boundary.hpp"

namespace apothem {
namespace {

struct Segment {
  Vec2 from, way;
  double square;  // of the length, m^2

  [[nodiscard]] double square_distance(const Vec2& p) const {
    const Vec2 to = p - from;
    return (to - std::clamp(to.dot(way) / square, 0., 1.) * way).squaredNorm();
  }
};

double inradius(const Mesh& mesh) {
  std::vector<Segment> edges;
  for (const BoundaryLoop& loop : boundary(mesh).loops) {
    for (size_t i = 0; i < loop.nodes.size(); ++i) {
      const Vec2& from = mesh.nodes[loop.nodes[i]];
      const Vec2 way = mesh.nodes[loop.nodes[(i + 1) % loop.nodes.size()]] - from;
      edges.push_back({from, way, way.squaredNorm()});
    }
  }
  double largest = 0;
  const auto try_point = [&](const Vec2& p) {
    double nearest = HUGE_VAL;
    for (const Segment& edge : edges) {
      nearest = std::min(nearest, edge.square_distance(p));
      if (nearest <= largest) return;
    }
    largest = nearest;
  };
  for (const Vec2& p : mesh.nodes) try_point(p);
  for (int e = 0; e < mesh.element_count(); ++e) {
    Vec2 centre = Vec2::Zero();
    const std::span<const int> nodes = mesh.element(e);
    for (const int node : nodes) centre += mesh.nodes[node] / static_cast<double>(nodes.size());
    try_point(centre);
  }
  return std::sqrt(largest);
}

}  // namespace

double inradius_of(const Model& model, BodyIndex body) {
  const auto rigid = static_cast<BodyIndex>(model.bodies.size());
  return body < rigid ? model.bodies[body].inradius
                      : inradius(model.deformables[body - rigid].mesh);
}

}  // namespace apothem
