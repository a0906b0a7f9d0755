#include "geometry/potential/boundary_layer.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/spatial/boxes.hpp"

namespace apothem {
namespace {

constexpr double kSafe = .99;  // depth of a cell over the height at which the front meets itself
// At a vertex with a smaller turn (sine), round-off moves the bisector too much. At an edge shorter
// than this fraction of the polygon's extent, round-off may exchange the two bisectors.
constexpr double kLeastTurn = 1e-4;
constexpr double kShortest = 1e-6;

// The layer whose cells reach up to the given heights (phi) over their edges.
BoundaryLayer layer_of(const Polygon& polygon, const std::vector<double>& heights) {
  const int n = polygon.size();
  const double shortest = kShortest * bounding_box(polygon).extent();
  BoundaryLayer layer;
  layer.depth.assign(static_cast<size_t>(n) + kReadBehind, 0);
  layer.side.assign(layer.depth.size() + 1, 1);
  // Cells end at phi = 1, because phi is limited to 1.
  for (int e = 0; e < n; ++e) layer.depth[e] = kSafe * std::min(heights[e], 1.);
  for (int e = 0; e < n; ++e) {
    const int before = previous(e, n);
    const Vec2 incoming = polygon[e] - polygon[before], outgoing = polygon.after(e) - polygon[e];
    const double turn = cross(incoming, outgoing) / (incoming.norm() * outgoing.norm());
    layer.side[e] = turn < 0 ? -1 : 1;
    if (!(std::abs(turn) > kLeastTurn)) layer.depth[before] = layer.depth[e] = 0;
    if (!(outgoing.norm() > shortest)) {
      layer.depth[before] = layer.depth[e] = layer.depth[next(e, n)] = 0;
    }
  }
  layer.side[n] = layer.side[0];
  return layer;
}

double distance(const Vec2& point, const Vec2& from, const Vec2& along) {
  return std::sqrt(nearest_on_segment(point - from, along).distance2);
}

// The distance of two edges that do not cross, m.
double distance(const Polygon& polygon, int e, int k) {
  const Vec2 &a = polygon[e], &b = polygon.after(e), &c = polygon[k], &d = polygon.after(k);
  return std::min(
      {distance(a, c, d - c), distance(b, c, d - c), distance(c, a, b - a), distance(d, a, b - a)});
}

}  // namespace

BoundaryLayer boundary_layer(const Polygon& polygon, const Roof& roof) {
  const int n = polygon.size();
  std::vector<double> heights(static_cast<size_t>(n), HUGE_VAL);
  for (int e = 0; e < n; ++e) {
    for (const int node : roof.faces[e]) {
      if (node >= n) heights[e] = std::min(heights[e], roof.values[node]);
    }
  }
  return layer_of(polygon, heights);
}

// A point in front of an edge at the height h is nearer than h to another feature only if that is
// nearer than 2 h to the edge. For neighbours the cells themselves decide. Heights end at 1/slope,
// where phi = 1, and at a multiple of the edge's length, so that few edges have to be looked at.
BoundaryLayer boundary_layer(const Polygon& polygon, double slope) {
  constexpr double kHighest = 8;  // largest height of a cell over the length of its edge
  const int n = polygon.size();
  std::vector<double> heights(static_cast<size_t>(n));  // m
  std::vector<Box> boxes(heights.size());
  for (int e = 0; e < n; ++e) {
    heights[e] = std::min(1 / slope, kHighest * (polygon.after(e) - polygon[e]).norm());
    boxes[e] = box_of(polygon[e], polygon.after(e)).grown(2 * heights[e]);
  }
  std::vector<BoxPair> near;
  BoxGrid().find_pairs(boxes, near);
  for (const auto& [e, k] : near) {
    if (k == e + 1 || (e == 0 && k + 1 == n)) continue;  // neighbours
    const double height = distance(polygon, e, k) / 2;
    heights[e] = std::min(heights[e], height);
    heights[k] = std::min(heights[k], height);
  }
  for (double& height : heights) height *= slope;
  return layer_of(polygon, heights);
}

}  // namespace apothem
