#include "lib/dynamics/touching.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "geometry/polygon/segment.hpp"
#include "geometry/spatial/boxes.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/model/inradius.hpp"
#include "lib/model/rotation.hpp"

namespace apothem {
namespace {

// An edge of the outline of a body.
struct OutlineEdge {
  BodyIndex body;
  Vec2 a, b;
};

double distance(const Vec2& point, const OutlineEdge& edge) {
  return std::sqrt(nearest_on_segment(point - edge.a, edge.b - edge.a).distance2);
}

void add_ring(BodyIndex body, const std::vector<Vec2>& ring, std::vector<OutlineEdge>& edges) {
  for (size_t i = 0; i < ring.size(); ++i) edges.push_back({body, ring[i], after(ring, i)});
}

std::vector<OutlineEdge> outline_edges(const Model& model, const State& state) {
  std::vector<OutlineEdge> edges;
  const auto rigid = static_cast<BodyIndex>(model.bodies.size());
  for (BodyIndex i = 0; i < rigid; ++i) {
    if (state.is_absent(i)) continue;
    for (std::vector<Vec2> ring : model.bodies[i].rings()) {
      for (Vec2& p : ring) p = state.pose(i).head<2>() + turned(p, state.pose(i)[2]);
      add_ring(i, ring, edges);
    }
  }
  for (size_t d = 0; d < model.deformables.size(); ++d) {
    const DeformableBody& body = model.deformables[d];
    const BodyIndex number = rigid + static_cast<BodyIndex>(d);
    if (state.is_absent(number)) continue;
    for (const BoundaryLoop& loop : boundary(body.mesh).loops) {
      std::vector<Vec2> ring;
      for (const int node : loop.nodes) {
        ring.push_back(body.mesh.nodes[node] + state.node(body.first_node + node));
      }
      add_ring(number, ring, edges);
    }
  }
  return edges;
}

}  // namespace

std::vector<TouchingBodies> touching_bodies(const Model& model, const State& state) {
  const std::vector<OutlineEdge> edges = outline_edges(model, state);
  const size_t bodies = model.bodies.size() + model.deformables.size();
  std::vector<double> gap(bodies);
  for (size_t b = 0; b < bodies; ++b) {
    gap[b] = kTouching * inradius_of(model, static_cast<BodyIndex>(b));
  }
  std::vector<Box> boxes;
  boxes.reserve(edges.size());
  for (const OutlineEdge& e : edges) boxes.push_back(box_of(e.a, e.b).grown(gap[e.body]));
  std::vector<BoxPair> near;
  BoxGrid().find_pairs(boxes, near);
  const auto fixed = [&](BodyIndex b) {
    return b < static_cast<BodyIndex>(model.bodies.size()) && !model.bodies[b].can_move();
  };
  std::set<std::pair<BodyIndex, BodyIndex>> found;
  for (const BoxPair& pair : near) {
    const OutlineEdge &one = edges[pair.first], &other = edges[pair.second];
    if (one.body == other.body || (fixed(one.body) && fixed(other.body))) continue;
    const double least = std::min({distance(one.a, other), distance(one.b, other),
                                   distance(other.a, one), distance(other.b, one)});
    if (least > std::min(gap[one.body], gap[other.body])) continue;
    found.emplace(std::min(one.body, other.body), std::max(one.body, other.body));
  }
  std::vector<TouchingBodies> pairs;
  pairs.reserve(found.size());
  for (const auto& [a, b] : found) pairs.push_back({a, b});
  return pairs;
}

}  // namespace apothem
