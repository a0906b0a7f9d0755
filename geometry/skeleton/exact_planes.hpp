// Exact decisions about coinciding events of a moving front. This header is private to the
// construction of the straight skeleton.
//
// At the time t, the line of an edge consists of the points with a x + b y - sqrt(m) t = c, where
// the coefficients a, b, c and m follow from the coordinates of the edge's ends, as they are given,
// by sums and products, and are made whole numbers by a common power of two. Three such planes in
// space and time meet in the place and at the time of an event. Whether a fourth one passes there
// is then whether a sum of square roots of whole numbers, with whole factors, is zero. Roots whose
// radicands have a square as their product are rational multiples of each other, and roots of
// different classes are linearly independent over the rationals (Besicovitch 1940). So the sum is
// zero if and only if it is zero in each class, which whole numbers tell.
#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <utility>
#include <vector>

#include "geometry/polygon/polygon.hpp"

namespace apothem {

/// The planes over the lines of a polygon's edges, by their numbers, and the upright planes over
/// the normals of the edges in their start points: n + v stands in vertex v.
class ExactPlanes {
 public:
  explicit ExactPlanes(const Polygon& polygon);

  /// True if all of these planes pass one point: they meet in one place at one time. There is
  /// nothing to decide, and it counts as true, where no three of them determine a point.
  [[nodiscard]] bool concurrent(const std::vector<int>& planes) const;
  /// True if the lines of two edges are parallel.
  [[nodiscard]] bool parallel(int e, int f) const;

 private:
  using Whole = boost::multiprecision::mpz_int;
  struct Plane {
    Whole a, b, c, m;
  };
  /// A sum of square roots: factors and radicands.
  using Roots = std::vector<std::pair<Whole, Whole>>;

  [[nodiscard]] static bool is_zero(const Roots& sum);
  [[nodiscard]] static Whole minor(const Plane& p, const Plane& q, const Plane& r);
  /// True if three planes meet in one point alone.
  [[nodiscard]] bool independent(int p, int q, int r) const;
  /// True if a plane passes the point in which three others meet.
  [[nodiscard]] bool passes(int plane, int p, int q, int r) const;

  std::vector<Plane> planes_;
};

}  // namespace apothem
