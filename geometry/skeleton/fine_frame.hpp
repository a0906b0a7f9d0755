// Coordinates of 100 digits, in which the places of a skeleton's nodes are computed, and how they
// are rounded. This header is private to the construction of the straight skeleton.
//
// A place is rounded once, to a multiple of 2^-52 of the polygon's size (the next power of two) in
// the coordinates of the vertices. So it does not matter which vertex is the first one, to which
// the nodes are relative, as long as the vertices are such multiples themselves, and neither
// mirrors nor quarter turns nor powers of two matter.
#pragma once

#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/skeleton/skeleton.hpp"

namespace apothem {

using Fine = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<100, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;

/// Numbers smaller than this in the frame below may be zero and nothing but round-off.
inline const Fine kFineNoise = ldexp(Fine(1), -200);

/// The line of an edge: at the time t it consists of the points x with normal . x = offset + t.
struct FineLine {
  Fine tx, ty;  ///< unit tangent; the normal is (-ty, tx)
  Fine offset;
  [[nodiscard]] Fine along(const Fine& x, const Fine& y) const { return tx * x + ty * y; }
  [[nodiscard]] Fine across(const Fine& x, const Fine& y) const { return tx * y - ty * x; }
};

/// The frame: the polygon's first vertex lies in the origin, and its size is between 1/2 and 1.
class FineFrame {
 public:
  explicit FineFrame(const Polygon& polygon) : polygon_(polygon) {
    size_ = std::ilogb(bounding_box(polygon).extent()) + 1;
  }

  [[nodiscard]] Fine x(int v) const { return inward(polygon_[v].x(), polygon_.origin().x()); }
  [[nodiscard]] Fine y(int v) const { return inward(polygon_[v].y(), polygon_.origin().y()); }
  [[nodiscard]] std::vector<FineLine> lines() const {
    std::vector<FineLine> lines;
    for (int e = 0; e < polygon_.size(); ++e) {
      const int end = polygon_.next(e);
      const Fine dx = x(end) - x(e);
      const Fine dy = y(end) - y(e);
      const Fine length = sqrt(dx * dx + dy * dy);
      lines.push_back({dx / length, dy / length, 0});
      lines.back().offset = lines.back().across(x(e), y(e));
    }
    return lines;
  }

  /// A node of the skeleton, rounded.
  [[nodiscard]] Skeleton::Node node(const Fine& x, const Fine& y, const Fine& time) const {
    return {{outward(x, polygon_.origin().x()), outward(y, polygon_.origin().y())},
            static_cast<double>(ldexp(settled(time, kSettled), size_))};
  }

 private:
  static constexpr int kDigits = 52;
  // Numbers are first rounded to this many binary digits, which takes their own round-off away, so
  // that it cannot decide where a number lies half way between two of the final ones.
  static constexpr int kSettled = 200;

  // The nearest multiple of 2^-digits, and of two of these the one further from zero.
  static Fine settled(const Fine& value, int digits) {
    const Fine steps = floor(ldexp(abs(value), digits) + 0.5);
    return ldexp(value < 0 ? Fine(-steps) : steps, -digits);
  }
  [[nodiscard]] Fine inward(double value, double origin) const {
    return ldexp(Fine(value) - origin, -size_);
  }
  [[nodiscard]] double outward(const Fine& value, double origin) const {
    const Fine start = ldexp(Fine(origin), -size_);
    const Fine place = settled(settled(value + start, kSettled), kDigits);
    return static_cast<double>(ldexp(Fine(place - start), size_));
  }

  const Polygon& polygon_;
  int size_;  // exponent
};

}  // namespace apothem
