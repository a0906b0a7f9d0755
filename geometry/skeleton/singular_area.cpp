#include "geometry/skeleton/singular_area.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <map>
#include <stdexcept>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/disjoint_sets.hpp"
#include "geometry/polygon/ring_moments.hpp"

namespace apothem {
namespace {

// Tolerance for a height equal to the depth, as for inscribed circles: this share of the height
// plus this share of the polygon's size.
constexpr double kSameLevel = 1e-13;
constexpr double kNoise = 0x1p-48;
constexpr double kSamePlace = 1e-9;  // level ridges shorter than this times the depth are points
constexpr double kSameDirection = 1e-9;  // sine of the angle below which two ridges are in line

// The nodes above the depth, and the points where the arcs cross it.
class Level {
 public:
  Level(const Skeleton& skeleton, double depth)
      : skeleton_(skeleton), nodes_(skeleton.nodes), sides_(skeleton.nodes.size()) {
    if (!(depth > 0)) throw std::invalid_argument("the depth of a singular area is not positive");
    Box box;
    for (const Skeleton::Node& node : nodes_) box.include(node.point);
    const double noise = kNoise * box.extent();
    for (size_t i = 0; i < nodes_.size(); ++i) {
      double& height = nodes_[i].height;
      if (std::abs(height - depth) <= kSameLevel * height + noise) height = depth;
      sides_[i] = height > depth ? 1 : height == depth ? 0 : -1;
    }
    for (const Skeleton::Arc& arc : skeleton.arcs) {
      if (above(arc.start) == above(arc.end)) continue;
      const int low = above(arc.start) ? arc.end : arc.start;
      const int high = above(arc.start) ? arc.start : arc.end;
      if (side(low) == 0) {
        cuts_[{low, high}] = low;
        continue;
      }
      const Skeleton::Node &p = nodes_[low], &q = nodes_[high];
      const double w = (depth - p.height) / (q.height - p.height);
      cuts_[{low, high}] = static_cast<int>(nodes_.size());
      nodes_.push_back({p.point + w * (q.point - p.point), depth});
    }
  }

  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
  [[nodiscard]] const std::vector<Skeleton::Node>& nodes() const { return nodes_; }
  /// Returns 1 if the node is above the depth, 0 if it is at the depth, and -1 if it is below.
  [[nodiscard]] int side(int node) const { return sides_[node]; }
  [[nodiscard]] bool above(int node) const { return sides_[node] > 0; }

  /// The point where the arc between the nodes `a` and `b` passes the depth; exactly one of the two
  /// is above. A cut is identified by its arc, because several arcs may pass the depth at the same
  /// node.
  using Cut = std::map<std::pair<int, int>, int>::const_iterator;
  [[nodiscard]] Cut cut(int a, int b) const {
    return cuts_.find(above(a) ? std::pair(b, a) : std::pair(a, b));
  }
  [[nodiscard]] const std::map<std::pair<int, int>, int>& cuts() const { return cuts_; }

  /// Goes around face f and calls node(i) at each of its nodes, up(cut) where its border rises
  /// through the depth, and down(cut) where it falls through the depth.
  template <class Up, class OnNode, class Down>
  void walk(int f, Up up, OnNode node, Down down) const {
    const std::vector<int>& face = skeleton_.faces[f];
    for (size_t i = 0; i < face.size(); ++i) {
      const int a = face[i];
      const int b = after(face, i);
      node(a);
      if (above(a) == above(b)) continue;
      above(b) ? up(cut(a, b)) : down(cut(a, b));
    }
  }

 private:
  const Skeleton& skeleton_;
  // The skeleton's nodes, then the cuts. A height within the tolerance of the depth has been set to
  // the depth.
  std::vector<Skeleton::Node> nodes_;
  std::vector<int> sides_;                   // see side()
  std::map<std::pair<int, int>, int> cuts_;  // from the lower and upper node of an arc to its cut
};

// Appends a node unless it is the last one already.
void append(std::vector<int>& ring, int node) {
  if (ring.empty() || ring.back() != node) ring.push_back(node);
}
// Removes nodes at the end that are equal to the first one.
void close(std::vector<int>& ring) {
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
}

// ------------------------------------------------------------------------------------------------

// A closed level line, as nodes, and a node above the depth beside it.
struct Loop {
  std::vector<int> nodes;
  int inner;
};

// The loops of level lines, with {t >= depth} on their left.
std::vector<Loop> level_loops(const Level& level) {
  using Ends = std::pair<int, int>;
  std::map<Ends, Ends> next;  // from the arc of a cut to that of the next cut, counter-clockwise
  const int n = static_cast<int>(level.skeleton().faces.size());
  for (int f = 0; f < n; ++f) {
    Ends rising;
    level.walk(
        f, [&](Level::Cut c) { rising = c->first; }, [](int) {},
        [&](Level::Cut c) { next[c->first] = rising; });
  }
  assert(next.size() == level.cuts().size());
  std::vector<Loop> loops;
  while (!next.empty()) {
    Loop loop{{}, next.begin()->first.second};
    for (auto at = next.begin(); at != next.end();) {
      append(loop.nodes, level.cuts().at(at->first));
      const Ends following = at->second;
      next.erase(at);
      at = next.find(following);
    }
    close(loop.nodes);
    loops.push_back(std::move(loop));
  }
  return loops;
}

// Without equal neighbours.
std::vector<Vec2> places(const Level& level, const std::vector<int>& nodes) {
  std::vector<Vec2> ring;
  for (const int i : nodes) {
    const Vec2& point = level.nodes()[i].point;
    if (ring.empty() || ring.back() != point) ring.push_back(point);
  }
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  return ring;
}

// The simple loops of which a loop consists that passes a node several times, where the part below
// the depth around a hole of the polygon touches another one.
std::vector<std::vector<int>> simple_loops(const std::vector<int>& loop) {
  std::vector<std::vector<int>> result;
  std::vector<int> path;
  std::map<int, size_t> place_of;  // of the nodes in the path
  for (const int node : loop) {
    const auto known = place_of.find(node);
    if (known != place_of.end()) {
      const auto first = path.begin() + static_cast<std::ptrdiff_t>(known->second);
      result.emplace_back(first, path.end());
      for (const int passed : result.back()) place_of.erase(passed);
      path.erase(first, path.end());
    }
    place_of[node] = path.size();
    path.push_back(node);
  }
  result.push_back(std::move(path));
  return result;
}

// Adds the polygons of a skeleton with cycles: the loops around each connected set of nodes above
// the depth, of which the one of the largest area is the outer one.
void add_polygons_with_holes(const Level& level, const std::vector<Loop>& loops,
                             SingularArea& result) {
  DisjointSets above(level.skeleton().nodes.size());
  for (const Skeleton::Arc& arc : level.skeleton().arcs) {
    if (level.above(arc.start) && level.above(arc.end)) above.join(arc.start, arc.end);
  }
  std::map<int, Rings> components;
  for (const Loop& loop : loops) {
    Rings& rings = components[above.find(loop.inner)];
    for (const std::vector<int>& nodes : simple_loops(loop.nodes)) {
      std::vector<Vec2> ring = places(level, nodes);
      if (ring.size() > 2) rings.push_back(std::move(ring));
    }
  }
  for (auto& [node, rings] : components) {
    if (rings.empty()) continue;  // flattened by round-off
    const auto outer =
        std::max_element(rings.begin(), rings.end(),
                         [](const auto& p, const auto& q) { return ring_area(p) < ring_area(q); });
    std::swap(*outer, rings.front());
    result.polygons.push_back(polygon_of_rings(rings));
  }
}

// Adds one loop of level lines around each connected set of nodes above the depth.
void add_polygons(const Level& level, SingularArea& result) {
  const std::vector<Loop> loops = level_loops(level);
  const Skeleton& skeleton = level.skeleton();
  const bool tree = skeleton.arcs.size() + 1 == skeleton.nodes.size() + skeleton.faces.size();
  if (!tree) return add_polygons_with_holes(level, loops, result);
  for (const Loop& loop : loops) {
    std::vector<Vec2> ring = places(level, loop.nodes);
    // A loop that round-off has flattened is reported as the segment or the point that is left.
    if (ring.size() == 2) result.segments.push_back({ring[0], ring[1]});
    if (ring.size() == 1) result.points.push_back(ring[0]);
    if (ring.size() > 2) result.polygons.push_back({std::move(ring), {}});
  }
}

// The level ridges and the isolated maxima of the roof that are as high as the depth.
class Crest {
 public:
  explicit Crest(const Level& level, double depth)
      : level_(level), groups_(level.skeleton().nodes.size()) {
    for (const Skeleton::Arc& arc : level.skeleton().arcs) {
      if (arc.right >= 0 && length(arc) <= kSamePlace * depth) unite(arc.start, arc.end);
    }
    for (const Skeleton::Arc& arc : level.skeleton().arcs) {
      if (arc.right < 0 || !is_level(arc) || groups_.find(arc.start) == groups_.find(arc.end))
        continue;
      ridges_.push_back({groups_.find(arc.start), groups_.find(arc.end)});
    }
  }

  void add_to(SingularArea& result) {
    const int count = static_cast<int>(level_.skeleton().nodes.size());
    std::vector<bool> isolated(count, false);
    for (int i = 0; i < count; ++i) isolated[groups_.find(i)] = level_.side(groups_.find(i)) == 0;
    for (const Skeleton::Arc& arc : level_.skeleton().arcs) {
      if (level_.above(arc.start)) isolated[groups_.find(arc.end)] = false;
      if (level_.above(arc.end)) isolated[groups_.find(arc.start)] = false;
    }
    for (const Ridge& ridge : ridges_) isolated[ridge[0]] = isolated[ridge[1]] = false;
    for (int i = 0; i < count; ++i) {
      if (isolated[i]) result.points.push_back(point(i));
    }
    join();
    for (const Ridge& r : ridges_) result.segments.push_back({point(r[0]), point(r[1])});
  }

 private:
  using Ridge = std::array<int, 2>;

  // Joins two groups of nodes that are at the same place. Where many short edges meet at a maximum,
  // as in a regular polygon with many vertices, round-off separates nodes that should be one. A
  // node at the depth, if there is one, represents its group.
  void unite(int i, int j) {
    i = groups_.find(i), j = groups_.find(j);
    if (level_.side(j) != 0) std::swap(i, j);
    groups_.join(i, j);
  }
  [[nodiscard]] const Vec2& point(int node) const { return level_.nodes()[node].point; }
  [[nodiscard]] bool is_level(const Skeleton::Arc& arc) const {
    return level_.side(arc.start) == 0 && level_.side(arc.end) == 0;
  }
  [[nodiscard]] double length(const Skeleton::Arc& arc) const {
    return (point(arc.end) - point(arc.start)).norm();
  }

  // Joins two ridges in line to one segment. A vertex with an angle of 180 degrees on an edge of
  // the polygon divides a ridge.
  void join() {
    std::map<int, std::vector<size_t>> at;
    for (size_t i = 0; i < ridges_.size(); ++i) {
      for (const int end : ridges_[i]) at[end].push_back(i);
    }
    std::vector<bool> gone(ridges_.size(), false);
    for (const auto& [node, ridges] : at) {
      if (ridges.size() != 2 || ridges[0] == ridges[1]) continue;
      Ridge& kept = ridges_[ridges[0]];
      const Ridge& other = ridges_[ridges[1]];
      const int p = kept[0] == node ? kept[1] : kept[0];
      const int q = other[0] == node ? other[1] : other[0];
      const Vec2 before = point(node) - point(p);
      const Vec2 after = point(q) - point(node);
      if (!(before.dot(after) > 0) ||
          !(std::abs(cross(before, after)) <= kSameDirection * before.norm() * after.norm())) {
        continue;
      }
      kept = {p, q};
      gone[ridges[1]] = true;
      std::replace(at[q].begin(), at[q].end(), ridges[1], ridges[0]);
    }
    size_t left = 0;
    for (size_t i = 0; i < ridges_.size(); ++i) {
      if (!gone[i]) ridges_[left++] = ridges_[i];
    }
    ridges_.resize(left);
  }

  const Level& level_;
  DisjointSets groups_;  // of nodes that are at the same place
  std::vector<Ridge> ridges_;
};

}  // namespace

SingularArea::Kind SingularArea::kind() const {
  return !polygons.empty()   ? Kind::polygons
         : !segments.empty() ? Kind::segment
         : !points.empty()   ? Kind::point
                             : Kind::none;
}

const char* kind_name(SingularArea::Kind kind) {
  static constexpr const char* names[]{"none", "point", "segment", "polygons"};
  return names[static_cast<int>(kind)];
}

double SingularArea::area() const { return area_of(polygons); }

SingularArea singular_area(const Skeleton& skeleton, double depth) {
  const Level level(skeleton, depth);
  SingularArea result;
  add_polygons(level, result);
  Crest(level, depth).add_to(result);
  return result;
}

CutFaces cut_faces(const Skeleton& skeleton, double depth) {
  const Level level(skeleton, depth);
  CutFaces result{level.nodes(), {}};
  const auto add = [&](int edge, bool above, std::vector<int> nodes) {
    close(nodes);
    if (nodes.size() > 2) result.parts.push_back({edge, above, std::move(nodes)});
  };
  const int n = static_cast<int>(skeleton.faces.size());
  for (int f = 0; f < n; ++f) {
    std::vector<int> below;
    std::vector<int> top;
    level.walk(
        f,
        [&](Level::Cut c) {
          append(below, c->second);
          top = {c->second};
        },
        [&](int node) { append(level.above(node) ? top : below, node); },
        [&](Level::Cut c) {
          append(below, c->second);
          append(top, c->second);
          add(f, true, std::move(top));
          top.clear();
        });
    add(f, false, std::move(below));
  }
  return result;
}

}  // namespace apothem
