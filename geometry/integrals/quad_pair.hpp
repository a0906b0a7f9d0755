// The edges of two convex quadrilaterals with the edges of the other one, four at a time. It does
// the arithmetic of edge_trace.hpp in the same order, so the results have the same bits. This
// header is private to edge_integral.cpp.
#pragma once

#include <array>
#include <bit>

#include "apothem/execution/dispatch.hpp"
#include "apothem/geometry/integrals/edge_trace.hpp"

namespace apothem::edge_detail {

/// phi along the edges of two quadrilaterals that are partly inside the other one.
struct QuadEdges {
  struct Part {
    int edge;                    // of a, or 4 more than that of b
    double s0, s1;               // where it is inside
    double sum, first, largest;  // as in SegmentMoments
  };
  int count = 0;
  std::array<Part, 8> parts;    // ascending
  double gap_a = 0, gap_b = 0;  // as `heights` returns them, of b's edges and of a's
};

using Four = PackOf<4>;

// Heights of the vertices of x over the edges of y, the first row again at the end.
struct QuadHeights {
  double rows[5][4];

  // Returns the gap.
  APOTHEM_INLINE double fill(const PlacedPotential& x, const PlacedPotential& y, double dx,
                             double dy) {
    const Four gx = Four::load(y.gx), gy = Four::load(y.gy);
    const Four yx = Four::load(y.x), yy = Four::load(y.y);
    Four highest(-HUGE_VAL);
    Four::Mask inside{};
    for (int v = 0; v < 4; ++v) {
      const Four h = gx * (Four(x.x[v] + dx) - yx) + gy * (Four(x.y[v] + dy) - yy);
      h.store(rows[v]);
      highest = select(h > highest, h, highest);
      inside = inside | !(h < Four(0.));
    }
    std::copy(rows[0], rows[0] + 4, rows[4]);
    if (!any(!inside)) return 0;
    std::array<double, 4> gap{};
    select(inside, Four(0.), -highest).store(gap.data());
    return std::max(std::max(gap[0], gap[1]), std::max(gap[2], gap[3]));
  }
  // The edges that are not outside one edge of the other polygon. Which they are is unpredictable.
  [[nodiscard]] APOTHEM_INLINE int list(int first, int* to) const {
    int count = 0;
    for (int e = 0; e < 4; ++e) {
      const Four from = Four::load(rows[e]), until = Four::load(rows[e + 1]);
      to[count] = first + e;
      count += 1 + all_or_none((from < Four(0.)) & (until < Four(0.)));
    }
    return count;
  }
};

// Columns of four rows.
APOTHEM_INLINE void transpose(const double* const* rows, Four* columns) {
  const auto pair = [&](int i, int j, int k) __attribute__((always_inline)) {
    using Two = double __attribute__((vector_size(16)));
    Two low, high;
    std::memcpy(&low, rows[i] + k, sizeof(low));
    std::memcpy(&high, rows[j] + k, sizeof(high));
    return Four(__builtin_shufflevector(low, high, 0, 1, 2, 3));
  };
  for (int k = 0; k < 4; k += 2) {
    const Four even = pair(0, 2, k), odd = pair(1, 3, k);
    columns[k] = Four(__builtin_shufflevector(even.v, odd.v, 0, 4, 2, 6));
    columns[k + 1] = Four(__builtin_shufflevector(even.v, odd.v, 1, 5, 3, 7));
  }
}

APOTHEM_INLINE void trace_quads(const PlacedPotential& a, const PlacedPotential& b, double dx,
                                double dy, QuadEdges& result) {
  QuadHeights of_a, of_b;
  result.gap_a = of_a.fill(a, b, dx, dy);
  if (result.gap_a > 0) return;
  result.gap_b = of_b.fill(b, a, -dx, -dy);
  if (result.gap_b > 0) return;
  int edges[12];  // with room for the lanes that are left over
  int count = of_a.list(0, edges);
  count += of_b.list(4, edges + count);
  if (count == 0) return;
  for (int i = count; i < count + 3; ++i) edges[i] = edges[count - 1];
  for (int first = 0; first < count; first += 4) {
    const double *starts[4], *ends[4];
    for (int k = 0; k < 4; ++k) {
      const int e = edges[first + k];
      const QuadHeights& heights = e < 4 ? of_a : of_b;
      starts[k] = heights.rows[e % 4];
      ends[k] = heights.rows[e % 4 + 1];
    }
    Four from[4], until[4];
    transpose(starts, from);
    transpose(ends, until);
    Four s0, s1;
    const Row<Four> row{from, until, 4, 4};
    Four rest;
    for (int k = 0; k < 4; ++k) rest.v[k] = count - first - k;
    const Four::Mask inside = clip(row, s0, s1) & (rest > Four(0.));
    EnvelopeMoments<Four> moments;
    walk_envelope(
        row, s0, s1, inside,
        [&](const Four::Mask& there, const Four& u1, const Four& v1, const Four& u2, const Four& v2)
            __attribute__((always_inline)) { moments.add(there, u1, v1, u2, v2); });
    for (int k = 0; k < 4; ++k) {
      result.parts[static_cast<size_t>(result.count)] = {
          edges[first + k],    s0.v[k], s1.v[k], moments.sum.v[k], moments.first.v[k],
          moments.largest.v[k]};
      result.count -= static_cast<int>(inside.m[k]);
    }
  }
}

/// True if `trace_quads` serves the pair: two convex quadrilaterals of which no edge is shortened.
inline bool are_quads(const PlacedPotential& a, const PlacedPotential& b) {
  constexpr double kSimilar = 3.99;  // an edge is at most twice as long as the radius
  return a.size == 4 && b.size == 4 && a.convex() && b.convex() && !a.capped && !b.capped &&
         a.radius > 0 && b.radius > 0 && a.radius < kSimilar * b.radius &&
         b.radius < kSimilar * a.radius;
}

}  // namespace apothem::edge_detail
