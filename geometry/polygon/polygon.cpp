#include "geometry/polygon/polygon.hpp"

#include <cmath>
#include <numeric>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"

namespace apothem {
namespace {

// Limits of the coordinates, m. Within them, squares and fourth powers stay far from overflow and
// from the subnormal range.
constexpr double kLargest = 1e60;
constexpr double kSmallestSize = 1e-60;

// Rings with more vertices than this are first tested as a whole, in about n log n steps.
constexpr size_t kMany = 256;

using Merged = std::vector<std::array<int, 2>>;

void require_usable_coordinates(const std::vector<Vec2>& ring) {
  for (size_t i = 0; i < ring.size(); ++i) {
    const std::string name = "vertex " + std::to_string(i);
    const int vertex = static_cast<int>(i);
    if (!is_finite(ring[i])) throw InvalidPolygon(name + " is not finite", vertex);
    if (!(ring[i].cwiseAbs().maxCoeff() < kLargest)) {
      throw InvalidPolygon(name + " has a coordinate beyond 1e60", vertex);
    }
  }
}

// Leaves out vertices that are equal to the one before. Returns the indices that the others had, or
// nothing if there are no such vertices.
Merged merge_equal_neighbours(std::vector<Vec2>& ring) {
  Merged merged;
  std::vector<Vec2> different;
  for (size_t i = 0; i < ring.size(); ++i) {
    const int vertex = static_cast<int>(i);
    if (!different.empty() && ring[i] == different.back()) {
      merged.back().back() = vertex;
    } else {
      different.push_back(ring[i]);
      merged.push_back({vertex, vertex});
    }
  }
  while (different.size() > 1 && different.back() == different.front()) {
    different.pop_back();
    merged.pop_back();
  }
  if (different.size() == ring.size()) return {};
  ring = std::move(different);
  return merged;
}

// The tests of a ring without equal neighbours. Errors name vertices and edges as they were given.
class RingCheck {
 public:
  RingCheck(const std::vector<Vec2>& ring, const Merged& merged)
      : ring_(ring), merged_(merged), n_(static_cast<int>(ring.size())) {}

  void require_extent() const {
    if (n_ < 3) {
      throw InvalidPolygon("has " + std::to_string(n_) + (merged_.empty() ? "" : " different") +
                               " vertices; a polygon needs at least 3",
                           n_ > 0 ? vertex(n_ - 1) : 0);
    }
    if (box_of(ring_).extent() < kSmallestSize) {
      throw InvalidPolygon("is smaller than 1e-60: all vertices agree", 0);
    }
  }

  void require_distinct_vertices() const {
    std::vector<int> order(n_);
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](int i) { return std::pair(ring_[i].x(), ring_[i].y()); };
    std::sort(order.begin(), order.end(),
              [&](int i, int j) { return std::pair(key(i), i) < std::pair(key(j), j); });
    // The error names the repetition that comes first along the ring.
    int first = -1;
    int repeated = n_;
    for (int k = 1; k < n_; ++k) {
      if (ring_[order[k]] == ring_[order[k - 1]] && order[k] < repeated) {
        first = order[k - 1];
        repeated = order[k];
      }
    }
    if (repeated == n_) return;
    throw InvalidPolygon(name(repeated) + " repeats " + name(first), vertex(repeated));
  }

  void require_no_spike() const {
    for (int i = 0; i < n_; ++i) {
      const Vec2& a = ring_[previous(i, n_)];
      const Vec2& b = ring_[i];
      const Vec2& c = ring_[next(i, n_)];
      if (orientation(a, b, c) != 0) continue;
      // The three points are collinear. The boundary goes straight on if b lies between a and c;
      // otherwise it turns back on itself. Coordinates are compared because that is exact, which
      // the sign of a dot product would not be.
      const int axis = a.x() != b.x() ? 0 : 1;
      if ((a[axis] < b[axis]) != (b[axis] < c[axis])) {
        throw InvalidPolygon(name(i) + " is a spike: the boundary turns back on itself", vertex(i));
      }
    }
  }

  void require_simple() const {
    if (ring_.size() > kMany && is_simple(ring_)) return;
    // The boxes of the edges are swept from left to right, and the exact test is made only where
    // two boxes overlap.
    std::vector<Box> boxes(n_);
    for (int i = 0; i < n_; ++i) boxes[i] = box_of(ring_[i], ring_[next(i, n_)]);
    std::vector<int> order(n_);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int i, int j) { return std::pair(boxes[i].x0, i) < std::pair(boxes[j].x0, j); });
    for (int k = 0; k < n_; ++k) {
      const int i = order[k];
      for (int l = k + 1; l < n_ && boxes[order[l]].x0 <= boxes[i].x1; ++l) {
        const int j = order[l];
        // Neighbours share their common vertex. That they share nothing else is what
        // require_no_spike has tested.
        if (apart(boxes[i], boxes[j]) || next(i, n_) == j || next(j, n_) == i) continue;
        if (segments_meet(ring_[i], ring_[next(i, n_)], ring_[j], ring_[next(j, n_)])) {
          const int first = std::min(edge(i), edge(j)), second = std::max(edge(i), edge(j));
          throw InvalidPolygon("edge " + std::to_string(first) + " and edge " +
                                   std::to_string(second) +
                                   " cross or touch (edge i starts at vertex i)",
                               second);
        }
      }
    }
  }

 private:
  [[nodiscard]] int vertex(int i) const { return merged_.empty() ? i : merged_[i].front(); }
  [[nodiscard]] int edge(int i) const { return merged_.empty() ? i : merged_[i].back(); }
  [[nodiscard]] std::string name(int i) const { return "vertex " + std::to_string(vertex(i)); }

  const std::vector<Vec2>& ring_;
  const Merged& merged_;
  int n_;
};

// True if a simple ring is clockwise. The test is exact: it takes the sense of the turn at the
// leftmost one of the lowest vertices. There the interior angle is below 180 degrees.
bool is_clockwise(const std::vector<Vec2>& ring) {
  const int n = static_cast<int>(ring.size());
  int lowest = 0;
  for (int i = 1; i < n; ++i) {
    if (std::pair(ring[i].y(), ring[i].x()) < std::pair(ring[lowest].y(), ring[lowest].x()))
      lowest = i;
  }
  return orientation(ring[previous(lowest, n)], ring[lowest], ring[next(lowest, n)]) < 0;
}

}  // namespace

Polygon::Polygon(std::vector<Vec2> ring) : vertices_(std::move(ring)) {
  require_usable_coordinates(vertices_);
  merged_ = merge_equal_neighbours(vertices_);
  const RingCheck check(vertices_, merged_);
  check.require_extent();
  check.require_distinct_vertices();
  check.require_no_spike();
  check.require_simple();
  reversed_ = is_clockwise(vertices_);
  if (reversed_) std::reverse(vertices_.begin() + 1, vertices_.end());
}

std::optional<int> Polygon::first_reflex_vertex() const {
  for (int i = 0; i < size(); ++i) {
    if (orientation(vertices_[previous(i, size())], vertices_[i], after(i)) < 0) return i;
  }
  return std::nullopt;
}

std::vector<Vec2> Polygon::local_vertices() const {
  std::vector<Vec2> local(vertices_);
  for (Vec2& v : local) v -= origin();
  return local;
}

AreaMoments area_moments(const Polygon& polygon) {
  // Area and centroid come from a fan of triangles about vertex 0. The second moment is summed
  // about the centroid, because about vertex 0 a large parallel-axis term would have to be
  // subtracted.
  const std::vector<Vec2> v = polygon.local_vertices();
  double twice_area = 0;
  Vec2 first = Vec2::Zero();
  for (size_t i = 1; i + 1 < v.size(); ++i) {
    const double twice = cross(v[i], v[i + 1]);
    twice_area += twice;
    first += twice * (v[i] + v[i + 1]);
  }
  const Vec2 centroid = first / (3 * twice_area);
  double polar = 0;
  for (size_t i = 0; i < v.size(); ++i) {
    const Vec2 p = v[i] - centroid;
    const Vec2 q = after(v, i) - centroid;
    polar += cross(p, q) * (p.squaredNorm() + p.dot(q) + q.squaredNorm());
  }
  return {twice_area / 2, centroid, polar / 12};
}

Box bounding_box(const Polygon& polygon) { return box_of(polygon.vertices()); }

}  // namespace apothem
