// The integrals of two convex quadrilaterals, the edges of both at once. It does the arithmetic of
// edge_trace.hpp in the same order, so the results have the same bits. This header is private to
// edge_integral.cpp.
#pragma once

#include "apothem/execution/dispatch.hpp"
#include "apothem/geometry/integrals/edge_trace.hpp"

namespace apothem::edge_detail {

using Four = PackOf<4>;

// Numbers of the edges of a and of the edges of b. What is done with the ones does not wait for the
// others.
struct TwiceMask {
  Four::Mask a, b;
  friend APOTHEM_INLINE TwiceMask operator&(const TwiceMask& p, const TwiceMask& q) {
    return {p.a & q.a, p.b & q.b};
  }
  friend APOTHEM_INLINE TwiceMask operator|(const TwiceMask& p, const TwiceMask& q) {
    return {p.a | q.a, p.b | q.b};
  }
  friend APOTHEM_INLINE TwiceMask operator!(const TwiceMask& p) { return {!p.a, !p.b}; }
};

struct Twice {
  Four a, b;
  Twice() = default;
  APOTHEM_INLINE Twice(double x) : a(x), b(x) {}  // NOLINT: numbers mix with packs
  APOTHEM_INLINE Twice(const Four& of_a, const Four& of_b) : a(of_a), b(of_b) {}
  friend APOTHEM_INLINE Twice operator+(const Twice& p, const Twice& q) {
    return {p.a + q.a, p.b + q.b};
  }
  friend APOTHEM_INLINE Twice operator-(const Twice& p, const Twice& q) {
    return {p.a - q.a, p.b - q.b};
  }
  friend APOTHEM_INLINE Twice operator*(const Twice& p, const Twice& q) {
    return {p.a * q.a, p.b * q.b};
  }
  friend APOTHEM_INLINE Twice operator/(const Twice& p, const Twice& q) {
    return {p.a / q.a, p.b / q.b};
  }
  friend APOTHEM_INLINE Twice operator-(const Twice& p) { return {-p.a, -p.b}; }
  friend APOTHEM_INLINE TwiceMask operator<(const Twice& p, const Twice& q) {
    return {p.a < q.a, p.b < q.b};
  }
  friend APOTHEM_INLINE TwiceMask operator>(const Twice& p, const Twice& q) {
    return {p.a > q.a, p.b > q.b};
  }
  friend APOTHEM_INLINE TwiceMask operator<=(const Twice& p, const Twice& q) {
    return {p.a <= q.a, p.b <= q.b};
  }
  friend APOTHEM_INLINE TwiceMask operator>=(const Twice& p, const Twice& q) {
    return {p.a >= q.a, p.b >= q.b};
  }
  friend APOTHEM_INLINE TwiceMask operator==(const Twice& p, const Twice& q) {
    return {p.a == q.a, p.b == q.b};
  }
};
APOTHEM_INLINE Twice select(const TwiceMask& mask, const Twice& p, const Twice& q) {
  return {select(mask.a, p.a, q.a), select(mask.b, p.b, q.b)};
}
APOTHEM_INLINE Twice magnitude(const Twice& p) { return {magnitude(p.a), magnitude(p.b)}; }
APOTHEM_INLINE bool any(const TwiceMask& mask) { return any(mask.a | mask.b); }
APOTHEM_INLINE Twice square_root(const Twice& p) { return {square_root(p.a), square_root(p.b)}; }

// Lanes 1, 2, 3 and 0.
APOTHEM_INLINE Four next(const Four& p) {
  return Four(__builtin_shufflevector(p.v, p.v, 1, 2, 3, 0));
}

// The same lanes of four packs, as a matrix that is turned round its diagonal.
APOTHEM_INLINE void transpose(const Four& p, const Four& q, const Four& r, const Four& s,
                              Four* lanes) {
  const auto even = __builtin_shufflevector(p.v, q.v, 0, 4, 2, 6);
  const auto odd = __builtin_shufflevector(p.v, q.v, 1, 5, 3, 7);
  const auto even2 = __builtin_shufflevector(r.v, s.v, 0, 4, 2, 6);
  const auto odd2 = __builtin_shufflevector(r.v, s.v, 1, 5, 3, 7);
  lanes[0].v = __builtin_shufflevector(even, even2, 0, 1, 4, 5);
  lanes[1].v = __builtin_shufflevector(odd, odd2, 0, 1, 4, 5);
  lanes[2].v = __builtin_shufflevector(even, even2, 2, 3, 6, 7);
  lanes[3].v = __builtin_shufflevector(odd, odd2, 2, 3, 6, 7);
}

// Sums of the lanes of four packs, from the first lane on.
APOTHEM_INLINE Four sums(const Four& p, const Four& q, const Four& r, const Four& s) {
  Four lanes[4];
  transpose(p, q, r, s, lanes);
  return lanes[0] + lanes[1] + lanes[2] + lanes[3];
}
APOTHEM_INLINE Twice sums(const Twice& p, const Twice& q, const Twice& r, const Twice& s) {
  return {sums(p.a, q.a, r.a, s.a), sums(p.b, q.b, r.b, s.b)};
}

template <class Real>
APOTHEM_INLINE Real larger(const Real& p, const Real& q) {
  return select(p < q, q, p);
}
APOTHEM_INLINE double largest(const Four& p) {
  return std::max(std::max(p.v[0], p.v[1]), std::max(p.v[2], p.v[3]));
}

// Heights of the vertices of x over the edges of y, one pack for each edge. Returns how far outside
// one edge all of x lies, in the unit of the heights; 0 if there is no such edge.
APOTHEM_INLINE double quad_heights(const PlacedPotential& y, const Four& px, const Four& py,
                                   Four* heights) {
  for (int i = 0; i < 4; ++i) {
    heights[i] = Four(y.gx[i]) * (px - Four(y.x[i])) + Four(y.gy[i]) * (py - Four(y.y[i]));
  }
  Four of[4];  // the heights of a vertex
  transpose(heights[0], heights[1], heights[2], heights[3], of);
  const Four highest = larger(larger(of[0], of[1]), larger(of[2], of[3]));
  const double gap = largest(-highest);
  if (!(gap > 0)) return 0;
  // A number that is not finite keeps the polygons together.
  const Four all = heights[0] + heights[1] + heights[2] + heights[3];
  return any(!(all == all)) ? 0 : gap;
}

APOTHEM_INLINE Half half_of(const Four& linear, const Four& others, double largest_phi) {
  Half half;
  half.fx = linear.v[0], half.fy = linear.v[1];
  half.moment = linear.v[2];
  half.weight = linear.v[3];
  half.wx = others.v[0], half.wy = others.v[1];
  half.length = others.v[2];
  half.inside = static_cast<std::uint64_t>(others.v[3]);
  half.largest = largest_phi;
  return half;
}

// The parts of edges inside the other quadrilateral, and phi along them.
struct QuadEdges {
  Twice qx, qy, ex, ey;  // of the edges, as those of PlacedEdge
  TwiceMask inside;
  Twice s0, s1;
  EnvelopeMoments<Twice> moments;

  // What the edges add up to, as `accumulate` does it one by one.
  APOTHEM_INLINE void add_up(Half& half_a, Half& half_b) const {
    const Twice zero(0.), length2 = ex * ex + ey * ey, length = square_root(length2);
    const auto there = [&](const Twice& p) APOTHEM_LAMBDA { return select(inside, p, zero); };
    const Twice& sum = moments.sum;
    const Twice& first = moments.first;
    const Twice linear =
        sums(there(ey * sum), there(-(ex * sum)),
             there(-((qx * ex + qy * ey) * sum + length2 * first)), there(length * sum));
    Four bits;
    for (int e = 0; e < 4; ++e) bits.v[e] = 1 << e;
    const Twice vertices(bits, bits);
    const Twice others =
        sums(there(length * (qx * sum + ex * first)), there(length * (qy * sum + ey * first)),
             there(length * (s1 - s0)), select(inside & (s0 == zero), vertices, zero));
    const Twice phi = there(moments.largest);
    half_a = half_of(linear.a, others.a, largest(phi.a));
    half_b = half_of(linear.b, others.b, largest(phi.b));
  }

  // The part of `join` that needs the ends of edges.
  APOTHEM_INLINE void find_breadth(const Vec2& arm, PairIntegral& pair) const {
    const double fx = pair.force.x(), fy = pair.force.y();
    const double size = std::sqrt(fx * fx + fy * fy);
    if (!(size > 0)) return;
    const double nx = fx / size, ny = fy / size;
    const double shift = nx * arm.y() - ny * arm.x();
    const Twice shifts(Four(0.), Four(shift));
    const auto along = [&](const Twice& s) APOTHEM_LAMBDA {
      return Twice(nx) * (qy + s * ey) - Twice(ny) * (qx + s * ex) + shifts;
    };
    const Twice p = along(s0), q = along(s1);
    const Twice high = select(inside, larger(p, q), Twice(-HUGE_VAL));
    const Twice low = select(inside, larger(-p, -q), Twice(-HUGE_VAL));
    const double highest = largest(larger(high.a, high.b));
    const double lowest = -largest(larger(low.a, low.b));
    pair.breadth = highest - lowest;
    pair.middle = (highest + lowest) / 2 - shift;
  }
};

// The integrals of a pair of quadrilaterals; nothing where they do not touch.
APOTHEM_INLINE void quad_integral(const PlacedPotential& a, const PlacedPotential& b,
                                  const Vec2& offset, NearEdges& near, PairIntegral& pair) {
  const Four ax = Four::load(a.x), ay = Four::load(a.y);
  const Four bx = Four::load(b.x), by = Four::load(b.y);
  const Four dx(offset.x()), dy(offset.y());
  const Twice px(ax + dx, bx - dx), py(ay + dy, by - dy);
  Four of_a[4], of_b[4];
  if (separated(quad_heights(b, px.a, py.a, of_a), a, b, b.steepest, near) ||
      separated(quad_heights(a, px.b, py.b, of_b), a, b, a.steepest, near)) {
    return;
  }
  Twice from[4], until[4];
  for (int i = 0; i < 4; ++i) {
    from[i] = {of_a[i], of_b[i]};
    until[i] = {next(of_a[i]), next(of_b[i])};
  }
  const Row<Twice> row{from, until, 4, 4};
  QuadEdges edges;
  edges.inside = clip(row, edges.s0, edges.s1);
  if (!any(edges.inside)) return;
  walk_envelope(row, edges.s0, edges.s1, edges.inside,
                [&](const TwiceMask& there, const Twice& u1, const Twice& v1, const Twice& u2,
                    const Twice& v2) APOTHEM_LAMBDA { edges.moments.add(there, u1, v1, u2, v2); });
  edges.qx = {px.a - Four(b.reference.x()), px.b - Four(a.reference.x())};
  edges.qy = {py.a - Four(b.reference.y()), py.b - Four(a.reference.y())};
  edges.ex = {Four::load(a.x + 1) - ax, Four::load(b.x + 1) - bx};
  edges.ey = {Four::load(a.y + 1) - ay, Four::load(b.y + 1) - by};
  Half half_a, half_b;
  edges.add_up(half_a, half_b);
  const Vec2 r = arm(a, b, offset);
  pair = combine(half_a, half_b, r);
  pair.depth = depth(a, b, half_a, half_b);
  edges.find_breadth(r, pair);
}

/// True if `quad_integral` serves the pair: two convex quadrilaterals of which no edge is
/// shortened.
inline bool are_quads(const PlacedPotential& a, const PlacedPotential& b) {
  constexpr double kSimilar = 3.99;  // an edge is at most twice as long as the radius
  return a.size == 4 && b.size == 4 && a.convex() && b.convex() && !a.capped && !b.capped &&
         a.radius > 0 && b.radius > 0 && a.radius < kSimilar * b.radius &&
         b.radius < kSimilar * a.radius;
}

}  // namespace apothem::edge_detail
