// Searches among the edges of a polygon of many vertices, with or without holes.
#pragma once

#include <vector>

#include "geometry/polygon/ring_links.hpp"
#include "geometry/spatial/ring_tree.hpp"
#include "geometry/spatial/strip.hpp"

namespace apothem {

/// A tree of boxes for each ring of a polygon.
class EdgeTrees {
 public:
  /// With fewer edges, to look at all of them costs less than to look for those that count.
  static constexpr int kMany = 64;

  /// The polygon with the vertices x[i], y[i]; `links` are null without holes.
  EdgeTrees(const double* x, const double* y, int size, const RingLinks* links) {
    for_each_ring(links, size, [&](int first, int last) {
      std::vector<Vec2> ring;
      for (int i = first; i < last; ++i) ring.emplace_back(x[i], y[i]);
      firsts_.push_back(first);
      trees_.emplace_back(std::move(ring));
      trees_.back().add_slabs();
    });
  }

  /// Calls f(edge) for edges in ascending order. It leaves out only those in boxes for which
  /// meets(box) is false.
  template <class Meets, class F>
  void each(const Meets& meets, const F& f) const {
    for (size_t k = 0; k < trees_.size(); ++k) {
      trees_[k].each(meets, [&](int e) { f(firsts_[k] + e); });
    }
  }

  /// Calls f(from, to) for lines from one vertex of a ring to another, as RingTree::each_line().
  template <class Judge, class F>
  void each_line(const Judge& judge, const F& f) const {
    for (size_t k = 0; k < trees_.size(); ++k) {
      const int first = firsts_[k];
      trees_[k].each_line(judge, [&](size_t from, size_t to) {
        f(first + static_cast<int>(from), first + static_cast<int>(to));
      });
    }
  }

  /// Calls f(edge) for edges, roughly those first that are near the segment from a to b. It leaves
  /// out only those that are farther from it than reach(), which may become smaller meanwhile.
  template <class Reach, class F>
  void each_near_first(const Vec2& a, const Vec2& b, const Reach& reach, const F& f) const {
    const SegmentDistance distance(a, b);
    for (size_t k = 0; k < trees_.size(); ++k) {
      trees_[k].each_near_first(
          [&](const Box& box, const Slab& slab) { return distance.least(box, slab); },
          [&](const Box&, const Slab&, double least) { return !(least > reach()); },
          [&](int e) { f(firsts_[k] + e); });
    }
  }

  /// Whether the polygon encloses a point, by the even-odd rule and without a tolerance.
  [[nodiscard]] bool encloses(const Vec2& point) const {
    bool inside = false;
    for (const RingTree& tree : trees_) inside = inside != tree.odd_crossings(point);
    return inside;
  }

 private:
  std::vector<int> firsts_;  // number of the first edge of each ring
  std::vector<RingTree> trees_;
};

}  // namespace apothem
