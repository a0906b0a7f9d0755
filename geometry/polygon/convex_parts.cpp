#include "geometry/polygon/convex_parts.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "geometry/polygon/disjoint_sets.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/triangulation.hpp"

namespace apothem {
namespace {

using Ring = std::vector<int>;

// Joins parts across diagonals as long as they stay convex (Hertel and Mehlhorn).
class Joiner {
 public:
  Joiner(const Polygon& polygon, const std::vector<Triangle>& triangles)
      : polygon_(polygon), sets_(triangles.size()) {
    for (const Triangle& t : triangles) {
      const auto part = static_cast<int>(parts_.size());
      for (int k = 0; k < 3; ++k) part_at_[{t[k], t[(k + 1) % 3]}] = part;
      parts_.emplace_back(t.begin(), t.end());
    }
  }

  std::vector<Ring> join() {
    for (const auto& [edge, part] : part_at_) {
      const auto [i, j] = edge;
      const auto across = part_at_.find({j, i});
      if (i < j && across != part_at_.end())
        join(i, j, sets_.find(part), sets_.find(across->second));
    }
    std::vector<Ring> left;
    for (Ring& ring : parts_) {
      if (!ring.empty()) left.push_back(std::move(ring));
    }
    return left;
  }

 private:
  // Part p has the edge from i to j, part q the one from j to i.
  void join(int i, int j, int p, int q) {
    Ring& of_p = parts_[p];
    Ring& of_q = parts_[q];
    std::rotate(of_p.begin(), std::find(of_p.begin(), of_p.end(), j), of_p.end());  // j ... i
    std::rotate(of_q.begin(), std::find(of_q.begin(), of_q.end(), i), of_q.end());  // i ... j
    const auto convex = [&](int before, int at, int next) {
      return orientation(polygon_[before], polygon_[at], polygon_[next]) >= 0;
    };
    if (!convex(of_p[of_p.size() - 2], i, of_q[1])) return;
    if (!convex(of_q[of_q.size() - 2], j, of_p[1])) return;
    of_p.insert(of_p.end(), of_q.begin() + 1, of_q.end() - 1);
    of_q.clear();
    sets_.join(q, p);
  }

  const Polygon& polygon_;
  std::vector<Ring> parts_;
  DisjointSets sets_;                           // of triangles, each with the number of its part
  std::map<std::pair<int, int>, int> part_at_;  // triangle on the left of each edge
};

}  // namespace

std::vector<Ring> convex_parts(const Polygon& polygon) {
  if (!polygon.is_convex()) return Joiner(polygon, triangulate(polygon)).join();
  Ring whole(static_cast<size_t>(polygon.size()));
  std::iota(whole.begin(), whole.end(), 0);
  return {whole};
}

}  // namespace apothem
