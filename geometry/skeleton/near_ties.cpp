#include "geometry/skeleton/near_ties.hpp"

#include <algorithm>

#include "geometry/polygon/segment.hpp"
#include "geometry/skeleton/edge_lines.hpp"

namespace apothem {
namespace {

constexpr double kNear = 1e-8;      // as a share of the polygon's size
constexpr double kStraight = 1e-8;  // sine of an angle

}  // namespace

bool has_near_ties(const Skeleton& skeleton, const Polygon& polygon) {
  const std::vector<Skeleton::Node>& nodes = skeleton.nodes;
  const auto n = static_cast<size_t>(polygon.size());
  const double near = kNear * bounding_box(polygon).extent();
  const std::vector<EdgeLine> lines = edge_lines(polygon);
  std::vector<int> arcs_at(nodes.size());
  for (const Skeleton::Arc& arc : skeleton.arcs) ++arcs_at[arc.start], ++arcs_at[arc.end];
  for (size_t i = n; i < nodes.size(); ++i) {
    if (arcs_at[i] != 3) return true;
  }
  std::vector<int> order;  // of the inner nodes, from left to right
  for (size_t i = n; i < nodes.size(); ++i) order.push_back(static_cast<int>(i));
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return nodes[i].point.x() < nodes[j].point.x(); });
  for (size_t k = n; k < skeleton.arcs.size(); ++k) {
    const Skeleton::Arc& arc = skeleton.arcs[k];
    const Vec2 &a = nodes[arc.start].point, &b = nodes[arc.end].point;
    const Vec2 &left = lines[arc.left].tangent, &right = lines[arc.right].tangent;
    if (std::abs(cross(left, right)) < kStraight && left.dot(right) > 0) return true;
    if ((b - a).norm() <= near) return true;
    const double low = std::min(a.x(), b.x()) - near, high = std::max(a.x(), b.x()) + near;
    for (auto i = std::partition_point(order.begin(), order.end(),
                                       [&](int j) { return nodes[j].point.x() < low; });
         i != order.end() && nodes[*i].point.x() <= high; ++i) {
      if (*i == arc.start || *i == arc.end) continue;
      if (nearest_on_segment(nodes[*i].point - a, b - a).distance2 <= near * near) return true;
    }
  }
  return false;
}

}  // namespace apothem
