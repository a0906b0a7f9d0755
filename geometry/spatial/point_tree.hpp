// The search for points near segments.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "geometry/spatial/strip.hpp"

namespace apothem {

/// Points in boxes that halve each other. A short segment, or one with few points near it, takes
/// about log n steps.
class PointTree {
 public:
  explicit PointTree(std::vector<Vec2> points)
      : points_(std::move(points)), order_(points_.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (!points_.empty()) divide(0, 0, points_.size());
  }

  /// True if f(i) is for one of the points that may be within a distance of the segment from a to
  /// b. It is called for all that are, unless it is true before.
  template <class F>
  [[nodiscard]] bool any_near(const Vec2& a, const Vec2& b, double distance, const F& f) const {
    if (points_.empty()) return false;
    return any_near(Strip(a, b, distance), f, 0, 0, points_.size());
  }

 private:
  static constexpr size_t kFew = 8;  // points that are not divided

  // The part `i` of the points has the halves 2 i + 1 and 2 i + 2.
  void divide(size_t i, size_t first, size_t end) {
    if (boxes_.size() <= i) boxes_.resize(i + 1);
    Box box;
    for (size_t k = first; k < end; ++k) box.include(points_[order_[k]]);
    boxes_[i] = box;
    if (end - first <= kFew) return;
    const size_t middle = (first + end) / 2;
    const int axis = box.x1 - box.x0 > box.y1 - box.y0 ? 0 : 1;
    const auto at = [&](size_t k) { return order_.begin() + static_cast<std::ptrdiff_t>(k); };
    std::nth_element(at(first), at(middle), at(end),
                     [&](int p, int q) { return points_[p][axis] < points_[q][axis]; });
    divide(2 * i + 1, first, middle);
    divide(2 * i + 2, middle, end);
  }

  template <class F>
  [[nodiscard]] bool any_near(const Strip& strip, const F& f, size_t i, size_t first,
                              size_t end) const {
    if (!strip.meets(boxes_[i])) return false;
    if (end - first <= kFew) {
      return std::any_of(order_.begin() + static_cast<std::ptrdiff_t>(first),
                         order_.begin() + static_cast<std::ptrdiff_t>(end), f);
    }
    const size_t middle = (first + end) / 2;
    return any_near(strip, f, 2 * i + 1, first, middle) ||
           any_near(strip, f, 2 * i + 2, middle, end);
  }

  std::vector<Vec2> points_;
  std::vector<int> order_;
  std::vector<Box> boxes_;
};

}  // namespace apothem
