#include "geometry/skeleton/near_ties.hpp"

#include <algorithm>

#include "geometry/polygon/segment.hpp"
#include "geometry/skeleton/edge_lines.hpp"
#include "geometry/spatial/point_tree.hpp"

namespace apothem {
namespace {

constexpr double kNear = 1e-8;      // largest, as a share of the polygon's size
constexpr double kAmply = 100;      // times the movement of a node
constexpr double kStraight = 1e-8;  // sine of an angle

// For each inner node of three faces: how far it may be from another one that is the same, as a
// share of the polygon's size. A node is where the planes of its faces meet, and moves with them by
// about the inverse of their determinant.
std::vector<double> reaches(const Skeleton& skeleton, const std::vector<EdgeLine>& lines,
                            double movement) {
  const size_t n = lines.size();
  std::vector<std::vector<int>> faces_at(skeleton.nodes.size());
  for (size_t f = 0; f < n; ++f) {
    for (const int node : skeleton.faces[f]) faces_at[node].push_back(static_cast<int>(f));
  }
  std::vector<double> reach(skeleton.nodes.size(), kNear);
  std::fill_n(reach.begin(), n, 0.);  // vertices stay
  for (size_t i = n; i < reach.size(); ++i) {
    const std::vector<int>& faces = faces_at[i];
    if (faces.size() != 3) continue;
    const Vec2 first = lines[faces[0]].tangent;
    const double determinant =
        cross(Vec2(lines[faces[1]].tangent - first), Vec2(lines[faces[2]].tangent - first));
    reach[i] = std::min(kNear, kAmply * movement / std::abs(determinant));
  }
  return reach;
}

}  // namespace

bool has_near_ties(const Skeleton& skeleton, const Polygon& polygon, double movement) {
  const std::vector<Skeleton::Node>& nodes = skeleton.nodes;
  const auto n = static_cast<size_t>(polygon.size());
  const double extent = bounding_box(polygon).extent();
  const std::vector<EdgeLine> lines = edge_lines(polygon);
  const std::vector<double> reach = reaches(skeleton, lines, movement);
  std::vector<int> arcs_at(nodes.size());
  for (const Skeleton::Arc& arc : skeleton.arcs) ++arcs_at[arc.start], ++arcs_at[arc.end];
  for (size_t i = n; i < nodes.size(); ++i) {
    if (arcs_at[i] != 3) return true;
  }
  std::vector<Vec2> inner;
  for (size_t i = n; i < nodes.size(); ++i) inner.push_back(nodes[i].point);
  const PointTree tree(std::move(inner));
  for (size_t k = n; k < skeleton.arcs.size(); ++k) {
    const Skeleton::Arc& arc = skeleton.arcs[k];
    const Vec2 &a = nodes[arc.start].point, &b = nodes[arc.end].point;
    const Vec2 &left = lines[arc.left].tangent, &right = lines[arc.right].tangent;
    if (std::abs(cross(left, right)) < kStraight && left.dot(right) > 0) return true;
    const double own = extent * std::max(reach[arc.start], reach[arc.end]);
    if ((b - a).norm() <= own) return true;
    const bool near = tree.any_near(a, b, kNear * extent, [&](int inner_node) {
      const int i = inner_node + static_cast<int>(n);
      if (i == arc.start || i == arc.end) return false;
      const double apart = std::max(own, extent * reach[i]);
      return nearest_on_segment(nodes[i].point - a, b - a).distance2 <= apart * apart;
    });
    if (near) return true;
  }
  return false;
}

}  // namespace apothem
