// Moments of phi along a segment, put together from its linear pieces; for any number type.
#pragma once

#include <algorithm>

namespace apothem {

/// Along one segment, u in [0, 1].
template <class Real>
struct SegmentMoments {
  Real sum = 0;    ///< INT phi du
  Real first = 0;  ///< INT phi u du
  Real largest = 0;

  /// A linear piece from (u1, v1) to (u2, v2).
  void add(const Real& u1, const Real& v1, const Real& u2, const Real& v2) {
    const Real h = u2 - u1;
    sum += h * (v1 + v2) / 2;
    first += h * (v1 * (2 * u1 + u2) + v2 * (u1 + 2 * u2)) / 6;
    largest = std::max(largest, std::max(v1, v2));
  }
};

}  // namespace apothem
