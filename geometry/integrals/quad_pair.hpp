// The integrals of two convex quadrilaterals, several edges at once. It does the arithmetic of
// edge_trace.hpp in the same order, so the results have the same bits. This header is private to
// edge_integral.cpp.
//
//   heights of all vertices over the edges of the other quadrilateral, a pack for each vertex
//   -> edges that are not wholly beyond one of these: three or four of the eight in most contacts
//   -> these edges as the lanes of a pack: clip, phi along them, sums
#pragma once

#include <array>
#include <bit>

#include "apothem/execution/dispatch.hpp"
#include "apothem/geometry/integrals/edge_trace.hpp"

namespace apothem::edge_detail {

using Four = PackOf<4>;

template <class Real>
APOTHEM_INLINE Real larger(const Real& p, const Real& q) {
  return select(p < q, q, p);
}
APOTHEM_INLINE double largest(const Four& p) {
  return std::max(std::max(p.v[0], p.v[1]), std::max(p.v[2], p.v[3]));
}

// Heights of the vertices of each quadrilateral over the edges of the other one: a row for each
// vertex of a and its first one again, then the same of b, then two for each edge that has been
// shortened.
struct QuadHeights {
  static constexpr int kRows = 5;
  alignas(32) double rows[2 * kRows + 16][4];
  std::array<std::uint8_t, 8> row_of{0, 1, 2, 3, 5, 6, 7, 8};  // of the start of each edge

  // Fills the rows from `first` on with those of x, at (dx, dy), over the edges of y. Returns how
  // far outside one edge of y all of x lies, in the unit of the heights; 0 if there is no such
  // edge. `edges` become those of x that are not wholly beyond one edge of y by more than `margin`,
  // by bits.
  APOTHEM_INLINE double find(const PlacedPotential& x, const PlacedPotential& y, double dx,
                             double dy, int first, double margin, unsigned& edges) {
    const Four yx = Four::load(y.x), yy = Four::load(y.y);
    const Four gx = Four::load(y.gx), gy = Four::load(y.gy), least(-margin);
    Four of[4];
    unsigned beyond[4];  // which of these edges a vertex is beyond, by bits
    for (int v = 0; v < 4; ++v) {
      of[v] = gx * (Four(x.x[v] + dx) - yx) + gy * (Four(x.y[v] + dy) - yy);
      of[v].store(rows[first + v]);
      beyond[v] = bits(of[v] < least);
    }
    of[0].store(rows[first + 4]);
    edges = unsigned{(beyond[0] & beyond[1]) == 0} | unsigned{(beyond[1] & beyond[2]) == 0} << 1 |
            unsigned{(beyond[2] & beyond[3]) == 0} << 2 |
            unsigned{(beyond[3] & beyond[0]) == 0} << 3;
    if ((beyond[0] & beyond[1] & beyond[2] & beyond[3]) == 0) return 0;
    // A number that is not finite keeps the polygons together.
    const Four all = of[0] + of[1] + of[2] + of[3];
    if (any(!(all == all))) return 0;
    return largest(-larger(larger(of[0], of[1]), larger(of[2], of[3])));
  }
};

// The edges of a set of bits in ascending order, the first one also in the place of those that are
// missing; at most four.
struct QuadSets {
  std::array<std::array<std::uint8_t, 4>, 256> numbers{};
  constexpr QuadSets() {
    for (unsigned set = 1; set < numbers.size(); ++set) {
      unsigned rest = set;
      for (std::uint8_t& number : numbers[set]) {
        number = static_cast<std::uint8_t>(std::countr_zero(rest != 0 ? rest : set));
        rest &= rest - 1;
      }
    }
  }
};
inline constexpr QuadSets kQuadSets;

// The starts of all edges and the vectors along them, as those of PlacedEdge: first those of a.
struct QuadFrames {
  alignas(32) double qx[8], qy[8], ex[8], ey[8];
  std::array<double, 8> bits{1, 2, 4, 8, 1, 2, 4, 8};  // of the vertices there: see PairIntegral

  APOTHEM_INLINE void put(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                          int first) {
    const Four px = Four::load(x.x), py = Four::load(x.y);
    (px + Four(dx) - Four(y.reference.x())).store(qx + first);
    (py + Four(dy) - Four(y.reference.y())).store(qy + first);
    (Four::load(x.x + 1) - px).store(ex + first);
    (Four::load(x.y + 1) - py).store(ey + first);
  }
};

// Above this ratio of the sizes of two polygons edges may have to be shortened.
inline constexpr double kSimilar = 3.99;  // an edge is at most twice as long as the radius

// Edges of x, which is much larger than y, are shortened: see BasicEdge. `first` is 0 for edges of
// a and 4 for those of b.
inline void shorten_edges(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                          int first, unsigned edges, QuadHeights& heights, QuadFrames& frames) {
  for (; edges != 0; edges &= edges - 1) {
    const int e = std::countr_zero(edges);
    const PlacedEdge edge(x, y, e, dx, dy);
    if (!edge.shortened) continue;
    const auto i = static_cast<size_t>(first + e);
    const size_t row = 2 * (QuadHeights::kRows + i);
    height_row(y, edge.px, edge.py, heights.rows[row]);
    height_row(y, edge.px + edge.ex, edge.py + edge.ey, heights.rows[row + 1]);
    heights.row_of[i] = static_cast<std::uint8_t>(row);
    frames.qx[i] = edge.qx, frames.qy[i] = edge.qy;
    frames.ex[i] = edge.ex, frames.ey[i] = edge.ey;
    if (edge.first != 0) frames.bits[i] = 0;
  }
}

// One of the linear functions along each edge.
struct QuadLine {
  Four base, slope, height, number;

  APOTHEM_INLINE QuadLine(const Row<Four>& row, int i, const Four& s)
      : base(row.a[i]), slope(row.b[i] - row.a[i]), height(base + s * slope), number(double(i)) {}
  // In each lane this one or the other.
  APOTHEM_INLINE void take(const Four::Mask& mask, const QuadLine& other) {
    base = select(mask, other.base, base);
    slope = select(mask, other.slope, slope);
    height = select(mask, other.height, height);
    number = select(mask, other.number, number);
  }
};

// phi along edges, which is a concave lower envelope: most have one piece or two. Where there are
// more, walk_envelope finds them.
APOTHEM_INLINE void integrate_envelope(const Row<Four>& row, const Four& s0, const Four& s1,
                                       const Four::Mask& inside, EnvelopeMoments<Four>& moments) {
  QuadLine first[4] = {{row, 0, s0}, {row, 1, s0}, {row, 2, s0}, {row, 3, s0}};
  QuadLine last[4] = {{row, 0, s1}, {row, 1, s1}, {row, 2, s1}, {row, 3, s1}};
  // The lowest function at the start, of equals the one that falls faster, and at the end, of
  // equals the one that was lower before.
  const auto lower_first = [](QuadLine& p, const QuadLine& q) APOTHEM_LAMBDA {
    p.take((!(q.height >= p.height)) | ((q.height == p.height) & (q.slope < p.slope)), q);
  };
  const auto lower_last = [](QuadLine& p, const QuadLine& q) APOTHEM_LAMBDA {
    p.take((q.height < p.height) | ((q.height == p.height) & (q.slope > p.slope)), q);
  };
  lower_first(first[0], first[1]);
  lower_last(last[0], last[1]);
  lower_first(first[2], first[3]);
  lower_last(last[2], last[3]);
  lower_first(first[0], first[2]);
  lower_last(last[0], last[2]);
  const QuadLine& p = first[0];
  const QuadLine& q = last[0];
  const Four zero(0.), fall = p.slope - q.slope;
  const Four above = q.base + s0 * q.slope - p.height;
  const Four gap = select(above < zero, zero, above);
  const Four::Mask two = gap < (s1 - s0) * fall;
  const Four meeting = s0 + gap / fall;
  const Four::Mask early = two & (!(s1 < meeting));
  const Four middle = select(early, meeting, s1);
  const Four::Mask flatter = two & (magnitude(q.slope) < magnitude(p.slope));
  const Four middle_height =
      select(flatter, q.base, p.base) + middle * select(flatter, q.slope, p.slope);
  // A function below the meeting of these two is a third piece; without a meeting one that is
  // lower at the end is a second one.
  Four::Mask more = (!two) & (q.height < p.base + s1 * p.slope);
  for (int i = 0; i < 4; ++i) {
    const Four height = row.a[i] + middle * (row.b[i] - row.a[i]);
    const Four number(1. * i);
    more = more |
           (early & (height < middle_height) & (!(number == p.number)) & (!(number == q.number)));
  }
  if (any(inside & more)) {
    walk_envelope(row, s0, s1, inside,
                  [&](const Four::Mask& there, const Four& u1, const Four& v1, const Four& u2,
                      const Four& v2) APOTHEM_LAMBDA { moments.add(there, u1, v1, u2, v2); });
    return;
  }
  moments.add(inside & ((!two) | (middle > s0)), s0, p.height, middle, middle_height);
  const Four::Mask goes_on = inside & early & (!(middle >= s1));
  moments.add(goes_on, middle, middle_height, s1, q.base + s1 * q.slope);
}

// Up to four edges of both quadrilaterals: the parts inside the other one, and phi along them.
class QuadEdges {
 public:
  // The edges by their bits, those of b from bit 4 on; at most four.
  APOTHEM_INLINE void integrate(unsigned set, const QuadHeights& heights,
                                const QuadFrames& frames) {
    const std::array<std::uint8_t, 4>& number = kQuadSets.numbers[set];
    FourOf<Four> from, until;
    const auto edge = [&](int k) APOTHEM_LAMBDA { return number[static_cast<size_t>(k)]; };
    const auto row = [&](int k) APOTHEM_LAMBDA { return heights.rows[heights.row_of[edge(k)]]; };
    read_rows(row, from);
    read_rows([&](int k) APOTHEM_LAMBDA { return row(k) + 4; }, until);
    const auto lanes = [&](const double* of) APOTHEM_LAMBDA {
      return pack_of<4>([&](int k) APOTHEM_LAMBDA { return of[edge(k)]; });
    };
    qx_ = lanes(frames.qx), qy_ = lanes(frames.qy);
    ex_ = lanes(frames.ex), ey_ = lanes(frames.ey);
    bits_ = lanes(frames.bits.data());
    const Four order(Four::Vector{0, 1, 2, 3});
    is_a_ = order < Four(1. * std::popcount(set & 0xfU));
    const Row<Four> lines{from.data(), until.data(), 4, 4};
    inside_ = clip(lines, s0_, s1_) & (order < Four(1. * std::popcount(set)));
    if (any(inside_)) integrate_envelope(lines, s0_, s1_, inside_, moments_);
  }

  // Adds what the edges come to, as `accumulate` does it one by one.
  APOTHEM_INLINE void add_up(Half& half_a, Half& half_b) const {
    const Four zero(0.), length2 = ex_ * ex_ + ey_ * ey_, length = square_root(length2);
    const auto there = [&](const Four& p) APOTHEM_LAMBDA { return select(inside_, p, zero); };
    const Four& sum = moments_.sum;
    const Four& first = moments_.first;
    Four linear_a, linear_b, others_a, others_b;
    sum_lanes(there(ey_ * sum), there(-(ex_ * sum)),
              there(-((qx_ * ex_ + qy_ * ey_) * sum + length2 * first)), there(length * sum),
              linear_a, linear_b);
    sum_lanes(there(length * (qx_ * sum + ex_ * first)), there(length * (qy_ * sum + ey_ * first)),
              there(length * (s1_ - s0_)), select(inside_ & (s0_ == zero), bits_, zero), others_a,
              others_b);
    const Four phi = there(moments_.largest);
    add(linear_a, others_a, largest(select(is_a_, phi, zero)), half_a);
    add(linear_b, others_b, largest(select(is_a_, zero, phi)), half_b);
  }

  // The extent along (-ny, nx) of the ends of the parts, with `shift` for the edges of b.
  APOTHEM_INLINE void extend(double nx, double ny, double shift, Extent& extent) const {
    const Four shifts = select(is_a_, Four(0.), Four(shift));
    const auto along = [&](const Four& s) APOTHEM_LAMBDA {
      return Four(nx) * (qy_ + s * ey_) - Four(ny) * (qx_ + s * ex_) + shifts;
    };
    const Four p = along(s0_), q = along(s1_);
    extent.high = std::max(extent.high, largest(select(inside_, larger(p, q), Four(-HUGE_VAL))));
    extent.low = std::min(extent.low, -largest(select(inside_, larger(-p, -q), Four(-HUGE_VAL))));
  }

 private:
  // Sums over the lanes of a, and over those of b, of four packs: they become the lanes of one.
  APOTHEM_INLINE void sum_lanes(const Four& p, const Four& q, const Four& r, const Four& s,
                                Four& of_a, Four& of_b) const {
    FourOf<Four> lanes;
    transpose({p, q, r, s}, lanes);
    of_a = of_b = Four(0.);
    for (size_t k = 0; k < 4; ++k) {
      const Four::Mask mine{Four::Mask::Vector{} + is_a_.m[k]};
      of_a = of_a + select(mine, lanes[k], Four(0.));
      of_b = of_b + select(mine, Four(0.), lanes[k]);
    }
  }
  static APOTHEM_INLINE void add(const Four& linear, const Four& others, double largest_phi,
                                 Half& half) {
    half.fx += linear.v[0], half.fy += linear.v[1];
    half.moment += linear.v[2];
    half.weight += linear.v[3];
    half.wx += others.v[0], half.wy += others.v[1];
    half.length += others.v[2];
    half.inside |= static_cast<std::uint64_t>(others.v[3]);
    half.largest = std::max(half.largest, largest_phi);
  }

  Four qx_, qy_, ex_, ey_;  // of the edges, as those of PlacedEdge
  Four bits_;               // of their first vertices
  Four::Mask is_a_, inside_;
  Four s0_, s1_;
  EnvelopeMoments<Four> moments_;
};

// The integrals of a pair of quadrilaterals; nothing where they do not touch.
APOTHEM_INLINE void quad_integral(const PlacedPotential& a, const PlacedPotential& b,
                                  const Vec2& offset, NearEdges& near, PairIntegral& pair) {
  // Heights at the ends of long edges are not exact enough to leave edges out.
  const bool a_is_long = !(a.radius < kSimilar * b.radius);
  const bool b_is_long = !(b.radius < kSimilar * a.radius);
  const double dx = offset.x(), dy = offset.y();
  QuadHeights heights;
  unsigned of_a, of_b;
  if (separated(
          heights.find(a, b, dx, dy, 0, a_is_long ? kRoundOff * a.radius * b.steepest : 0, of_a), a,
          b, b.steepest, near) ||
      separated(heights.find(b, a, -dx, -dy, QuadHeights::kRows,
                             b_is_long ? kRoundOff * b.radius * a.steepest : 0, of_b),
                a, b, a.steepest, near)) {
    return;
  }
  const unsigned set = of_a | of_b << 4;
  if (set == 0) return;
  QuadFrames frames;
  frames.put(a, b, dx, dy, 0);
  frames.put(b, a, -dx, -dy, 4);
  if (a_is_long) shorten_edges(a, b, dx, dy, 0, of_a, heights, frames);
  if (b_is_long) shorten_edges(b, a, -dx, -dy, 4, of_b, heights, frames);
  const bool together = std::popcount(set) <= 4;
  QuadEdges edges, others;
  Half half_a, half_b;
  edges.integrate(together ? set : of_a, heights, frames);
  edges.add_up(half_a, half_b);
  if (!together) {
    others.integrate(of_b << 4, heights, frames);
    others.add_up(half_a, half_b);
  }
  const Vec2 r = arm(a, b, offset);
  pair = combine(half_a, half_b, r);
  pair.depth = depth(a, b, half_a, half_b);
  const double fx = pair.force.x(), fy = pair.force.y();
  const double size = std::sqrt(fx * fx + fy * fy);
  if (!(size > 0)) return;
  const double nx = fx / size, ny = fy / size;
  const double shift = nx * r.y() - ny * r.x();
  Extent extent;
  edges.extend(nx, ny, shift, extent);
  if (!together) others.extend(nx, ny, shift, extent);
  pair.breadth = extent.high - extent.low;
  pair.middle = (extent.high + extent.low) / 2 - shift;
}

/// True if `quad_integral` serves the pair: two convex quadrilaterals.
inline bool are_quads(const PlacedPotential& a, const PlacedPotential& b) {
  return a.size == 4 && b.size == 4 && a.convex() && b.convex() && !a.capped && !b.capped &&
         a.radius > 0 && b.radius > 0;
}

}  // namespace apothem::edge_detail
