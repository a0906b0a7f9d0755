#include "geometry/potential/point_values.hpp"

#include <cmath>

#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/segment.hpp"

namespace apothem {

const char* side_name(Side side) {
  return side == Side::inside ? "inside" : side == Side::outside ? "outside" : "boundary";
}

PointEvaluator::PointEvaluator(const Polygon& polygon, const Potential& potential)
    : polygon_(polygon), potential_(potential) {
  if (!potential.roof) return;
  for (const std::vector<int>& nodes : potential.roof->faces) {
    faces_.emplace_back();
    for (const int node : nodes) faces_.back().push_back(potential.roof->points[node]);
  }
}

PointValues PointEvaluator::operator()(const Vec2& point) const {
  const int side = side_of(polygon_, point);
  const Nearest near = nearest(point);
  PointValues values{};
  values.side = side > 0 ? Side::inside : side < 0 ? Side::outside : Side::boundary;
  values.gradient = Vec2::Zero();
  values.nearest_edge = polygon_.input_edge(near.edge);
  values.signed_distance = side == 0 ? 0 : -side * near.distance;
  if (side < 0) return values;
  if (potential_.distance) {
    set_distance(point, near, values);
  } else {
    set_linear(point, edge_below(point, near), values);
  }
  if (side == 0) values.phi = 0;
  return values;
}

PointEvaluator::Nearest PointEvaluator::nearest(const Vec2& point) const {
  Nearest best{0, 0, HUGE_VAL};
  const auto number = [&](int edge) { return polygon_.input_edge(edge); };
  for (int i = 0; i < polygon_.size(); ++i) {
    const Vec2 along = polygon_.after(i) - polygon_[i];
    const NearestOnSegment found = nearest_on_segment(point - polygon_[i], along);
    // An edge that the point lies on is the nearest one, whatever round-off says.
    const bool on = found.distance2 < 1e-20 * along.squaredNorm() &&
                    segments_meet(polygon_[i], polygon_.after(i), point, point);
    const double distance = on ? 0 : std::sqrt(found.distance2);
    if (distance > best.distance) continue;
    if (distance == best.distance && number(i) > number(best.edge)) continue;
    best = {i, found.share, distance};
  }
  return best;
}

// The edge whose linear function is the potential at a point: the lowest one in a convex polygon,
// otherwise that of the face of the roof.
int PointEvaluator::edge_below(const Vec2& point, const Nearest& nearest) const {
  const Vec2 local = point - polygon_.origin();
  if (faces_.empty()) {
    int lowest = 0;
    const auto value = [&](int i) {
      return potential_.gradients[i].dot(local - potential_.vertices[i]);
    };
    for (int i = 1; i < potential_.size(); ++i) {
      if (value(i) < value(lowest)) lowest = i;
    }
    return lowest;
  }
  for (size_t e = 0; e < faces_.size(); ++e) {
    if (side_of_ring(faces_[e], local) >= 0) return static_cast<int>(e);
  }
  return nearest.edge;  // so near the boundary that the difference from the origin lies outside
}

void PointEvaluator::set_linear(const Vec2& point, int edge, PointValues& values) const {
  values.gradient = potential_.gradients[edge] + Vec2(0, 0);  // without negative zeros
  values.phi = std::max(0.0, values.gradient.dot(point - polygon_[edge]));
  if (!(potential_.capped() && values.phi >= 1)) return;
  values.phi = 1;
  values.gradient = Vec2::Zero();
}

void PointEvaluator::set_distance(const Vec2& point, const Nearest& nearest,
                                  PointValues& values) const {
  const double slope = potential_.distance->slope;
  values.phi = slope * nearest.distance;
  if (potential_.capped() && values.phi >= 1) {
    values.phi = 1;
    return;
  }
  const int e = nearest.edge;
  // At an edge the direction is its normal. At a vertex it is that of the way to the point.
  const bool at_vertex = nearest.share <= 0 || nearest.share >= 1;
  const Vec2 way = point - (nearest.share >= 1 ? polygon_.after(e) : polygon_[e]);
  values.gradient =
      at_vertex && way.norm() > 0 ? Vec2(slope * way.normalized()) : potential_.gradients[e];
}

}  // namespace apothem
