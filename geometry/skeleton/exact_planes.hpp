// Exact decisions about coinciding events of a moving front. This header is private to the
// construction of the straight skeleton.
//
// At the time t, the line of an edge consists of the points with a x + b y - sqrt(m) t = c, where
// the coefficients a, b, c and m follow from the coordinates of the edge's ends, as they are given,
// by sums and products, and are made whole numbers by a common power of two. What has to be decided
// about two events is then whether a sum of square roots of whole numbers, with whole factors, is
// zero. Roots whose radicands have a square as their product are rational multiples of each other,
// and roots of different classes are linearly independent over the rationals (Besicovitch 1940). So
// the sum is zero if and only if it is zero in each class, which whole numbers tell.
#pragma once

#include <array>
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

  /// Three planes that meet in one point: where and when an event happens.
  using Triple = std::array<int, 3>;

  /// True if the two events happen at the same time.
  [[nodiscard]] bool simultaneous(const Triple& p, const Triple& q) const;
  /// True if a plane passes the point in which the three planes of an event meet.
  [[nodiscard]] bool concurrent(const Triple& p, int plane) const;
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
  /// The planes' determinant without the times, and the one without the constants, by which it has
  /// to be divided for the time of the event.
  [[nodiscard]] std::pair<Whole, Roots> time(const Triple& p) const;

  std::vector<Plane> planes_;
};

}  // namespace apothem
