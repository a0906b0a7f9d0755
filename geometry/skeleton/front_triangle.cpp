#include "geometry/skeleton/front_triangle.hpp"

#include <utility>

namespace apothem {

std::vector<FrontTriangle> front_triangles(const std::vector<Triangle>& corners,
                                           const Polygon& polygon) {
  const int count = polygon.size() - 2 + 2 * (polygon.rings() - 1);
  if (static_cast<int>(corners.size()) != count) return {};
  struct Side {
    int low, high, triangle, place;
  };
  std::vector<FrontTriangle> triangles(corners.size());
  std::vector<Side> sides;
  for (int t = 0; t < count; ++t) {
    triangles[t].corners = corners[t];
    for (int k = 0; k < 3; ++k) {
      const int a = corners[t][(k + 1) % 3];
      const int b = corners[t][(k + 2) % 3];
      if (polygon.next(a) == b) {
        triangles[t].sides[k] = ~a;
      } else {
        sides.push_back({std::min(a, b), std::max(a, b), t, k});
      }
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& p, const Side& q) {
    return std::pair(p.low, p.high) < std::pair(q.low, q.high);
  });
  if (sides.size() % 2 != 0) return {};
  for (size_t i = 0; i < sides.size(); i += 2) {
    const Side &p = sides[i], &q = sides[i + 1];
    if (p.low != q.low || p.high != q.high) return {};
    triangles[p.triangle].sides[p.place] = q.triangle;
    triangles[q.triangle].sides[q.place] = p.triangle;
  }
  return triangles;
}

void exchange_diagonal(std::vector<FrontTriangle>& triangles, int triangle, int k) {
  FrontTriangle& t = triangles[triangle];
  const int other = t.sides[k];
  FrontTriangle& n = triangles[other];
  const int m = n.side_to(triangle);
  const int w = t.corners[k];
  const int u = t.corners[(k + 1) % 3];
  const int v = t.corners[(k + 2) % 3];
  const int d = n.corners[m];
  const int beside_u = t.sides[(k + 2) % 3];  // side w u
  const int beside_v = t.sides[(k + 1) % 3];  // side v w
  const int n_u = n.sides[(m + 1) % 3];       // side u d
  const int n_v = n.sides[(m + 2) % 3];       // side d v
  t = {{w, u, d}, {n_u, other, beside_u}};
  n = {{w, d, v}, {n_v, beside_v, triangle}};
  if (n_u >= 0) triangles[n_u].sides[triangles[n_u].side_to(other)] = triangle;
  if (beside_v >= 0) triangles[beside_v].sides[triangles[beside_v].side_to(triangle)] = other;
}

}  // namespace apothem
