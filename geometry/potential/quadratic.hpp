// Quadratic functions of one variable: their values, their mean values and where two of them meet.
#pragma once

#include <array>
#include <cmath>

namespace apothem {

/// The function c[0] + c[1] z + c[2] z^2 with z = s - origin. The origin is chosen so that the
/// values near it are small. `id` names the feature that the function belongs to.
template <class Real>
struct Quadratic {
  Real origin;
  std::array<Real, 3> c;
  int id;
  [[nodiscard]] Real operator()(const Real& s) const {
    const Real z = s - origin;
    return c[0] + z * (c[1] + z * c[2]);
  }
  [[nodiscard]] bool operator==(const Quadratic& g) const { return id == g.id; }
  /// The mean from a to b. It decides which of two functions is the lower one there.
  [[nodiscard]] Real mean(const Real& a, const Real& b) const {
    const Real half = (b - a) / 2;
    return (*this)((a + b) / 2) + c[2] * half * half / 3;
  }
  [[nodiscard]] bool below(const Quadratic& g, const Real& a, const Real& b) const {
    return mean(a, b) < g.mean(a, b);
  }
  [[nodiscard]] Quadratic times(const Real& f) const {
    return {origin, {c[0] * f, c[1] * f, c[2] * f}, id};
  }
  /// Writes candidates for the points where the function meets g. Where it does not, they may be
  /// NaN, infinite or outside the interval that starts at `from`. They are computed relative to
  /// the origin of the function with the larger curvature: far from there its coefficients would
  /// be so large that the two points of a narrow parabola are lost in their round-off.
  int crossings(const Quadratic& g, const Real& from, std::array<Real, 2>& roots) const {
    using std::abs;
    using std::sqrt;
    const Real own = abs(c[2]), other = abs(g.c[2]);
    const Real base = own > other ? origin : other > 0 ? g.origin : from;
    const Real c0 = (*this)(base)-g(base);
    const Real half = slope(base) / 2 - g.slope(base) / 2;
    const Real c2 = c[2] - g.c[2];
    const Real discriminant = half * half - c0 * c2;
    if (!(discriminant >= 0)) return 0;
    const Real q = -(half + (half < 0 ? Real(-sqrt(discriminant)) : Real(sqrt(discriminant))));
    roots = {Real(base + q / c2), Real(base + c0 / q)};
    return 2;
  }

 private:
  [[nodiscard]] Real slope(const Real& s) const { return c[1] + 2 * c[2] * (s - origin); }
};

}  // namespace apothem
