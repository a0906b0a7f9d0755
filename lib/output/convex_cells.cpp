#include "lib/output/convex_cells.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "geometry/polygon/convex_parts.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/triangulation.hpp"

namespace apothem {
namespace {

constexpr double kStraight = -1e-9;  // sine of the largest turn to the right

bool is_convex(std::span<const Vec2> ring) {
  Vec2 in = ring.front() - ring.back();
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 out = after(ring, i) - ring[i];
    if (cross(in, out) < kStraight * in.norm() * out.norm()) return false;
    in = out;
  }
  return true;
}

}  // namespace

std::vector<std::vector<int>> convex_cells(std::span<const Vec2> ring) {
  std::vector<int> corners(ring.size());
  std::iota(corners.begin(), corners.end(), 0);
  if (is_convex(ring)) return {corners};
  const auto same = [&](int i, int j) { return ring[i] == ring[j]; };
  corners.erase(std::unique(corners.begin(), corners.end(), same), corners.end());
  if (corners.size() > 1 && same(corners.front(), corners.back())) corners.pop_back();
  std::vector<Vec2> places;
  places.reserve(corners.size());
  for (const int i : corners) places.push_back(ring[i]);
  try {
    std::vector<std::vector<int>> cells = convex_parts(Polygon(places));
    for (std::vector<int>& cell : cells) {
      for (int& corner : cell) corner = corners[corner];
    }
    return cells;
  } catch (const InvalidPolygon&) {
    return {corners};
  }
}

std::vector<std::vector<int>> convex_cells(const Rings& rings) {
  if (rings.size() == 1) return convex_cells(rings[0]);
  const PolygonWithHoles whole = polygon_of_rings(rings);
  std::vector<Vec2> corners;
  for (const std::vector<Vec2>& ring : rings) {
    corners.insert(corners.end(), ring.begin(), ring.end());
  }
  try {
    const Polygon polygon(whole);
    if (polygon.vertices() == corners) return convex_parts(polygon);
  } catch (const InvalidPolygon&) {
    // Rings that touch each other, like those of an offset.
  }
  std::vector<std::vector<int>> cells;
  for (const Triangle& t : triangulate(whole)) cells.emplace_back(t.begin(), t.end());
  return cells;
}

std::vector<std::vector<int>> rings_around(const std::vector<std::vector<int>>& cells) {
  if (cells.size() == 1) return cells;
  std::set<std::pair<int, int>> edges;
  for (const std::vector<int>& cell : cells) {
    for (size_t i = 0; i < cell.size(); ++i) {
      const int from = cell[i];
      const int to = after(cell, i);
      if (edges.erase({to, from}) == 0) edges.emplace(from, to);
    }
  }
  std::map<int, int> next(edges.begin(), edges.end());
  std::vector<std::vector<int>> rings;
  while (!next.empty()) {
    std::vector<int>& ring = rings.emplace_back();
    for (auto at = next.begin(); at != next.end(); at = next.find(ring.back())) {
      if (ring.empty()) ring.push_back(at->first);
      ring.push_back(at->second);
      next.erase(at);
    }
    if (ring.front() == ring.back()) ring.pop_back();
  }
  return rings;
}

std::vector<int> joined(const std::vector<std::vector<int>>& cells) {
  std::vector<int> longest;
  for (std::vector<int>& ring : rings_around(cells)) {
    if (ring.size() > longest.size()) longest = std::move(ring);
  }
  return longest;
}

}  // namespace apothem
