// Searches along a closed line, for many points.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/point.hpp"
#include "geometry/spatial/strip.hpp"

namespace apothem {

/// What is to be done with a run of edges around which there is a box.
enum class RunUse { none, whole, edges };

/// The boxes around runs of edges of a ring, which halve each other. Edge i begins in point i.
class RingTree {
 public:
  explicit RingTree(std::vector<Vec2> ring) : ring_(std::move(ring)) {
    if (!ring_.empty()) enclose(0, 0, ring_.size());
  }

  /// Makes slabs around short runs, too, for each_near_first. Of a run of long edges that are
  /// nearly parallel and oblique they contain much less than the box.
  void add_slabs() {
    slabs_.resize(boxes_.size());
    if (!ring_.empty()) add_slabs(0, 0, ring_.size());
  }

  /// Number of edges.
  [[nodiscard]] int size() const { return static_cast<int>(ring_.size()); }

  /// True if the ray from p to the right crosses the ring an odd number of times: p is inside, if
  /// it does not lie on the ring. An end of an edge at the height of p counts as below it. A run
  /// beside p counts by its two ends alone, so that this takes about log n steps.
  [[nodiscard]] bool odd_crossings(const Vec2& p) const {
    return !ring_.empty() && odd_crossings(p, 0, 0, ring_.size());
  }

  /// Calls f(edge) for edges in ascending order. It leaves out only runs of them around which
  /// there is a box for which meets(box) is false.
  template <class Meets, class F>
  void each(const Meets& meets, const F& f) const {
    if (!ring_.empty()) each(meets, f, 0, 0, ring_.size());
  }

  /// Calls f(edge) for edges, roughly those first around which there are boxes and slabs with a
  /// small distance(box, slab). It leaves out only those for which counts(box, slab, distance) is
  /// false when their turn comes; what counts may become less meanwhile. add_slabs() comes before.
  template <class Distance, class Counts, class F>
  void each_near_first(const Distance& distance, const Counts& counts, const F& f) const {
    if (!ring_.empty()) {
      each_near_first(distance, counts, f, {0, 0, ring_.size(), distance(boxes_[0], slabs_[0])});
    }
  }

  /// A run of edges and a measure of it.
  struct Run {
    size_t i, first, end;
    double measure;
  };
  /// The same in ascending order of measure(box), up to the edges of a run: a part of a box has no
  /// smaller measure. `memory` is kept between calls.
  template <class Measure, class Counts, class F>
  void each_in_order(const Measure& measure, const Counts& counts, const F& f,
                     std::vector<Run>& memory) const {
    const auto behind = [](const Run& a, const Run& b) { return a.measure > b.measure; };
    memory.clear();
    const auto push = [&](size_t i, size_t first, size_t end) {
      memory.push_back({i, first, end, measure(boxes_[i])});
      std::ranges::push_heap(memory, behind);
    };
    if (!ring_.empty()) push(0, 0, ring_.size());
    while (!memory.empty()) {
      std::ranges::pop_heap(memory, behind);
      const Run run = memory.back();
      memory.pop_back();
      if (!counts(boxes_[run.i], slabs_[run.i], run.measure)) continue;
      if (run.end - run.first > kRun) {
        const size_t middle = (run.first + run.end) / 2;
        push(2 * run.i + 1, run.first, middle);
        push(2 * run.i + 2, middle, run.end);
      } else {
        for (size_t e = run.first; e < run.end; ++e) f(static_cast<int>(e));
      }
    }
  }

  /// Calls f(from, to) for lines from one point of the ring to another, in ascending order. They
  /// are edges, but judge(box) may say that a run of edges in the box is left out, or that one line
  /// from its first point to its last one does for all of it.
  template <class Judge, class F>
  void each_line(const Judge& judge, const F& f) const {
    if (!ring_.empty()) each_line(judge, f, 0, 0, ring_.size());
  }

 private:
  static constexpr size_t kRun = 8;     // edges that have no boxes of their own
  static constexpr size_t kShort = 64;  // of more edges there are no slabs

  // The run `i` of the edges from `first` to `end` - 1 has the halves 2 i + 1 and 2 i + 2.
  const Box& enclose(size_t i, size_t first, size_t end) {
    if (boxes_.size() <= i) boxes_.resize(i + 1);
    Box box;
    if (end - first <= kRun) {
      for (size_t e = first; e < end; ++e) box.include(ring_[e]), box.include(after(ring_, e));
    } else {
      const size_t middle = (first + end) / 2;
      box.include(enclose(2 * i + 1, first, middle));
      box.include(enclose(2 * i + 2, middle, end));
    }
    return boxes_[i] = box;
  }

  void add_slabs(size_t i, size_t first, size_t end) {
    if (end - first <= kShort) slabs_[i] = slab_around(boxes_[i], first, end);
    if (end - first <= kRun) return;
    const size_t middle = (first + end) / 2;
    add_slabs(2 * i + 1, first, middle);
    add_slabs(2 * i + 2, middle, end);
  }

  // The slab along the direction in which the points of a run lie, or all points if it would not be
  // much narrower than the box around them.
  [[nodiscard]] Slab slab_around(const Box& box, size_t first, size_t end) const {
    const Vec2 middle((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2);
    const auto each_point = [&](const auto& f) {
      for (size_t k = first; k <= end; ++k) f(ring_[k % ring_.size()]);
    };
    double xx = 0, xy = 0, yy = 0;
    each_point([&](const Vec2& p) {
      const Vec2 arm = p - middle;
      xx += arm.x() * arm.x(), xy += arm.x() * arm.y(), yy += arm.y() * arm.y();
    });
    // Half the difference of the second moments about the two principal directions.
    const double half = std::hypot((xx - yy) / 2, xy);
    const Vec2 along = xx > yy ? Vec2((xx - yy) / 2 + half, xy) : Vec2(xy, (yy - xx) / 2 + half);
    const double size = along.norm();
    if (!(size > 0)) return {};
    Slab slab{.normal = Vec2(-along.y(), along.x()) / size, .low = HUGE_VAL, .high = -HUGE_VAL};
    double farthest = 0;
    each_point([&](const Vec2& p) {
      const double across = slab.normal.dot(p);
      slab.low = std::min(slab.low, across), slab.high = std::max(slab.high, across);
      farthest = std::max(farthest, std::abs(p.x()) + std::abs(p.y()));
    });
    if (slab.high - slab.low > std::min(box.x1 - box.x0, box.y1 - box.y0) / 2) return {};
    constexpr double kRoundOff = 1e-15;
    slab.low -= kRoundOff * farthest, slab.high += kRoundOff * farthest;
    return slab;
  }

  [[nodiscard]] bool odd_crossings(const Vec2& p, size_t i, size_t first, size_t end) const {
    const Box& box = boxes_[i];
    if (box.x1 < p.x() || box.y1 <= p.y() || box.y0 > p.y()) return false;
    if (box.x0 > p.x()) {
      return (ring_[first].y() > p.y()) != (ring_[end % ring_.size()].y() > p.y());
    }
    if (end - first > kRun) {
      const size_t middle = (first + end) / 2;
      return odd_crossings(p, 2 * i + 1, first, middle) != odd_crossings(p, 2 * i + 2, middle, end);
    }
    bool odd = false;
    for (size_t e = first; e < end; ++e) {
      const Vec2 a = ring_[e] - p, b = after(ring_, e) - p;
      if ((a.y() > 0) != (b.y() > 0) && (cross(a, b) > 0) == (b.y() > a.y())) odd = !odd;
    }
    return odd;
  }

  template <class Meets, class F>
  void each(const Meets& meets, const F& f, size_t i, size_t first, size_t end) const {
    if (!meets(boxes_[i])) return;
    if (end - first > kRun) {
      const size_t middle = (first + end) / 2;
      each(meets, f, 2 * i + 1, first, middle);
      each(meets, f, 2 * i + 2, middle, end);
      return;
    }
    for (size_t e = first; e < end; ++e) f(static_cast<int>(e));
  }

  template <class Distance, class Counts, class F>
  void each_near_first(const Distance& distance, const Counts& counts, const F& f,
                       const Run& run) const {
    if (!counts(boxes_[run.i], slabs_[run.i], run.measure)) return;
    if (run.end - run.first > kRun) {
      const size_t middle = (run.first + run.end) / 2;
      const size_t left = 2 * run.i + 1, right = 2 * run.i + 2;
      Run near{left, run.first, middle, distance(boxes_[left], slabs_[left])};
      Run far{right, middle, run.end, distance(boxes_[right], slabs_[right])};
      if (far.measure < near.measure) std::swap(near, far);
      each_near_first(distance, counts, f, near);
      each_near_first(distance, counts, f, far);
      return;
    }
    for (size_t e = run.first; e < run.end; ++e) f(static_cast<int>(e));
  }

  template <class Judge, class F>
  void each_line(const Judge& judge, const F& f, size_t i, size_t first, size_t end) const {
    const RunUse use = judge(boxes_[i]);
    if (use == RunUse::none) return;
    if (use == RunUse::whole) {
      f(first, end % ring_.size());
    } else if (end - first > kRun) {
      const size_t middle = (first + end) / 2;
      each_line(judge, f, 2 * i + 1, first, middle);
      each_line(judge, f, 2 * i + 2, middle, end);
    } else {
      for (size_t e = first; e < end; ++e) f(e, (e + 1) % ring_.size());
    }
  }

  std::vector<Vec2> ring_;
  std::vector<Box> boxes_;
  std::vector<Slab> slabs_;
};

}  // namespace apothem
