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

// Calls f for the pairs of boxes that are not apart. They are swept from left to right.
template <class F>
void for_each_overlap(const std::vector<Box>& boxes, const F& f) {
  const int n = static_cast<int>(boxes.size());
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return std::pair(boxes[i].x0, i) < std::pair(boxes[j].x0, j); });
  for (int k = 0; k < n; ++k) {
    const int i = order[k];
    for (int l = k + 1; l < n && boxes[order[l]].x0 <= boxes[i].x1; ++l) {
      if (!apart(boxes[i], boxes[order[l]])) f(i, order[l]);
    }
  }
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
    throw InvalidPolygon(name(repeated) + " repeats " + name(first) +
                             " (a ring passes a point once: move one of them, or divide the ring "
                             "there, as apothem polygon --repair does)",
                         vertex(repeated));
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
    std::vector<Box> boxes(n_);
    for (int i = 0; i < n_; ++i) boxes[i] = box_of(ring_[i], ring_[next(i, n_)]);
    for_each_overlap(boxes, [&](int i, int j) {
      // Neighbours share their common vertex. That they share nothing else is what
      // require_no_spike has tested.
      if (next(i, n_) == j || next(j, n_) == i) return;
      if (segments_meet(ring_[i], ring_[next(i, n_)], ring_[j], ring_[next(j, n_)])) {
        const int first = std::min(edge(i), edge(j)), second = std::max(edge(i), edge(j));
        throw InvalidPolygon("edge " + std::to_string(first) + " and edge " +
                                 std::to_string(second) +
                                 " cross or touch (edge i starts at vertex i)",
                             second);
      }
    });
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

std::string ring_name(int ring) {
  return ring == 0 ? "the outer ring" : "hole " + std::to_string(ring - 1);
}

// Rings that are simple by themselves make a polygon if no edges of two rings meet, and every hole
// lies inside the outer ring and outside of the other holes.
void require_holes_apart(const Polygon& polygon) {
  std::vector<int> ring_of;
  std::vector<Box> boxes, ring_boxes(static_cast<size_t>(polygon.rings()));
  for (int k = 0; k < polygon.rings(); ++k) {
    ring_of.resize(static_cast<size_t>(polygon.ring_start(k + 1)), k);
    ring_boxes[k] = box_of(polygon.ring(k));
  }
  for (int i = 0; i < polygon.size(); ++i) boxes.push_back(box_of(polygon[i], polygon.after(i)));
  for_each_overlap(boxes, [&](int i, int j) {
    if (ring_of[i] > ring_of[j]) std::swap(i, j);
    const int k = ring_of[j];
    if (ring_of[i] == k ||
        !segments_meet(polygon[i], polygon.after(i), polygon[j], polygon.after(j))) {
      return;
    }
    throw InvalidPolygon(ring_name(k) + " crosses or touches " + ring_name(ring_of[i]) +
                             " (a hole lies inside, at a distance; join rings that share an edge, "
                             "and move a vertex where rings touch at a point)",
                         0, k - 1);
  });
  const auto encloses = [&](int outer, int inner) {
    return !apart(ring_boxes[outer], ring_boxes[inner]) &&
           strictly_inside(polygon.ring(outer), polygon.ring(inner).front());
  };
  for (int k = 1; k < polygon.rings(); ++k) {
    if (!encloses(0, k)) {
      throw InvalidPolygon(ring_name(k) + " lies outside of the outer ring", 0, k - 1);
    }
    for (int l = 1; l < polygon.rings(); ++l) {
      if (l == k || !encloses(l, k)) continue;
      throw InvalidPolygon(ring_name(k) + " lies inside " + ring_name(l) +
                               " (what lies in a hole is a polygon of its own)",
                           0, k - 1);
    }
  }
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

Polygon::Polygon(const std::vector<Vec2>& outer, const Rings& holes) : Polygon(outer) {
  if (holes.empty()) return;
  int given = static_cast<int>(outer.size());
  RingTables tables;
  tables.links.add(size());
  for (int i = 0; i < size(); ++i) tables.input.push_back({input_index(i), input_edge(i)});
  rings_ = std::move(tables);
  for (size_t h = 0; h < holes.size(); ++h) {
    try {
      add_hole(Polygon(holes[h]), given);
    } catch (const InvalidPolygon& error) {
      const int hole = static_cast<int>(h);
      throw InvalidPolygon("hole " + std::to_string(hole) + ": " + error.what(), error.vertex(),
                           hole);
    }
    given += static_cast<int>(holes[h].size());
  }
  require_holes_apart(*this);
}

// Appends a hole, clockwise, whose vertices have the indices from `given` on.
void Polygon::add_hole(const Polygon& hole, int given) {
  const int n = hole.size();
  for (int k = 0; k < n; ++k) {
    const int i = k == 0 ? 0 : n - k;
    vertices_.push_back(hole[i]);
    rings_->input.push_back(
        {given + hole.input_index(i), given + hole.input_edge(hole.previous(i))});
  }
  rings_->links.add(n);
}

std::optional<int> Polygon::first_reflex_vertex() const {
  for (int i = 0; i < size(); ++i) {
    if (orientation(before(i), vertices_[i], after(i)) < 0) return i;
  }
  return std::nullopt;
}

int side_of(const Polygon& polygon, const Vec2& point) {
  const int outer = side_of_ring(polygon.outer_ring(), point);
  if (outer <= 0) return outer;
  for (int k = 1; k < polygon.rings(); ++k) {
    if (const int side = side_of_ring(polygon.ring(k), point); side >= 0) return -side;
  }
  return 1;
}

Rings rings_of(const Polygon& polygon) {
  Rings rings;
  for (int k = 0; k < polygon.rings(); ++k) {
    const std::span<const Vec2> ring = polygon.ring(k);
    rings.emplace_back(ring.begin(), ring.end());
  }
  return rings;
}

std::vector<Vec2> Polygon::local_vertices() const {
  std::vector<Vec2> local(vertices_);
  for (Vec2& v : local) v -= origin();
  return local;
}

AreaMoments area_moments(const Polygon& polygon) {
  // Area and centroid come from triangles between vertex 0 and the edges. The second moment is
  // summed about the centroid, because about vertex 0 a large parallel-axis term would have to be
  // subtracted.
  const std::vector<Vec2> v = polygon.local_vertices();
  double twice_area = 0;
  Vec2 first = Vec2::Zero();
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2& end = v[polygon.next(i)];
    const double twice = cross(v[i], end);
    twice_area += twice;
    first += twice * (v[i] + end);
  }
  const Vec2 centroid = first / (3 * twice_area);
  double polar = 0;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 p = v[i] - centroid;
    const Vec2 q = v[polygon.next(i)] - centroid;
    polar += cross(p, q) * (p.squaredNorm() + p.dot(q) + q.squaredNorm());
  }
  return {twice_area / 2, centroid, polar / 12};
}

Box bounding_box(const Polygon& polygon) { return box_of(polygon.vertices()); }

}  // namespace apothem
