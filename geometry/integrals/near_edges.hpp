// A Verlet list of the edges of two polygons that are near the other polygon. Bodies move little in
// a step, so a list with a skin serves for many steps, and the contact kernel considers only these
// edges. Most pairs of polygons whose boxes overlap have none.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

struct PlacedPotential;

/// The edges of a pair of polygons that may be nearer than `skin` to the other polygon, its
/// interior included. Bit i mod 64 of a set stands for all edges i with that remainder. All other
/// edges are farther away than the skin, and remain outside as long as the polygons have moved
/// relative to each other by less than the skin.
struct NearEdges {
  static constexpr std::uint64_t kAll = ~std::uint64_t{0};
  std::uint64_t of_a = kAll;  ///< edges of a
  std::uint64_t of_b = kAll;  ///< edges of b
  double skin = 0;            ///< m; 0 if nothing is known
  /// True if the polygons are apart by the skin.
  [[nodiscard]] bool none() const { return of_a == 0 && of_b == 0; }
};

/// Memory of near_edges. Keep one per thread.
struct NearEdgesWorkspace {
  /// An edge of a polygon in the frame of b.
  struct Segment {
    Vec2 from, to;
    Box box;
    int edge;
    double distance2;  ///< squared distance from the other polygon, or a lower bound of it, m^2
  };
  std::vector<Segment> of_a, of_b;
};

/// Finds the edges of two polygons that are nearer than `skin` (m) to the other one. If there are
/// none, the skin of the result is larger, and is a lower bound of the distance of the polygons.
/// The arguments a, b and offset are those of pair_integral. If a coordinate is not finite, all
/// edges are near and the skin is 0.
NearEdges near_edges(const PlacedPotential& a, const PlacedPotential& b, const Vec2& offset,
                     double skin, NearEdgesWorkspace& workspace);

/// Calls f(edge) for the edges of a polygon with `size` edges that a set stands for, in ascending
/// order.
template <class F>
void for_each_edge(std::uint64_t set, int size, const F& f) {
  for (int first = 0; first < size; first += 64) {
    std::uint64_t rest = set;
    if (size - first < 64) rest &= (std::uint64_t{1} << (size - first)) - 1;
    for (; rest != 0; rest &= rest - 1) f(first + std::countr_zero(rest));
  }
}

}  // namespace apothem
