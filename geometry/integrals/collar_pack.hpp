// Several edges, each against one cell of a collar: the arithmetic of collar.hpp in the same order,
// so that the results have the same bits. Edges that may cross the top of a cell or its negative
// part are left to collar_piece.
#pragma once

#include "geometry/integrals/collar.hpp"

namespace apothem {

/// The parts of edges in cells, as in CollarPiece.
template <class Pack>
struct CollarPieces {
  Pack from, to, sum, first, area, along, height, deepest;
  typename Pack::Mask met;   ///< lanes whose edge meets its cell
  typename Pack::Mask deep;  ///< lanes that need collar_piece; they are not met
};

/// Members as in CollarFace.
template <class Pack>
struct CollarFaces {
  Pack ax, ay, bx, by, tx, ty, length, max, may, mbx, mby, plain;

  [[nodiscard]] APOTHEM_INLINE Pack alpha() const { return max * tx + may * ty; }
  [[nodiscard]] APOTHEM_INLINE Pack beta() const { return mbx * tx + mby * ty; }
};

namespace detail {

// What the way along a bisector from the base up to the height h contributes, or down: where an
// edge enters a cell (sign -1) or leaves it (sign 1).
template <class Pack>
struct AlongBisector {
  Pack area, along, height;

  APOTHEM_INLINE AlongBisector(const typename Pack::Mask& at_a, const Pack& slope, const Pack& h,
                               const Pack& length, double sign) {
    const Pack s = Pack(sign) * slope * h * h;
    const Pack third = select(at_a, s * slope * h, slope * h) * Pack(kThird);
    area = s * Pack(.5);
    along = select(at_a, third, s * (length * Pack(.5) + third));
    height = s * h * Pack(kSixth);
  }
};

}  // namespace detail

template <class Pack>
APOTHEM_INLINE CollarPieces<Pack> collar_pieces(const CollarFaces<Pack>& f, const Pack& px,
                                                const Pack& py, const Pack& qx, const Pack& qy) {
  using Mask = typename Pack::Mask;
  const Pack zero(0.), one(1.);
  const Pack pax = px - f.ax, pay = py - f.ay, qax = qx - f.ax, qay = qy - f.ay;
  const Pack pbx = px - f.bx, pby = py - f.by, qbx = qx - f.bx, qby = qy - f.by;
  const Pack hp = f.tx * pay - f.ty * pax, hq = f.tx * qay - f.ty * qax;
  const Pack ap = pax * f.may - pay * f.max, aq = qax * f.may - qay * f.max;
  const Pack bp = pbx * f.mby - pby * f.mbx, bq = qbx * f.mby - qby * f.mbx;
  const Mask under = (hp < zero) & (hq < zero);
  CollarPieces<Pack> piece;
  const Mask out_ap = ap < zero, out_aq = aq < zero, out_bp = !(bp < zero), out_bq = !(bq < zero);
  const Mask plain = (hp <= f.plain) & (hq <= f.plain);
  // Edges that are beyond one bisector only, and all of them, miss the cell, unless a number is not
  // finite.
  const Pack all = hp + hq + ap + aq + bp + bq;
  const Mask beside =
      ((out_ap & out_aq & (!(out_bp | out_bq))) | ((!(out_ap | out_aq)) & out_bp & out_bq)) &
      (all == all);
  const Mask missed = under | (out_ap & out_aq) | ((bp >= zero) & (bq >= zero));

  // The part inside: it begins or ends at the edge's end, at the base, or at a bisector.
  Pack lo = zero, hi = one;
  Mask in_a = zero < zero, in_b = in_a, out_a = in_a, out_b = in_a;
  const auto clip = [&](const Pack& p, const Pack& q, const Mask& p_out, const Mask& q_out,
                        Mask& starts, Mask& ends) __attribute__((always_inline)) {
    const Pack u = p / (p - q);
    starts = p_out & (!(q_out | (u < lo)));
    ends = q_out & (!(p_out | (u > hi)));
    lo = select(starts, u, lo);
    hi = select(ends, u, hi);
  };
  Mask in_base, out_base;
  clip(hp, hq, hp < zero, hq < zero, in_base, out_base);
  clip(ap, aq, out_ap, out_aq, in_a, out_a);
  clip(bp, bq, out_bp, out_bq, in_b, out_b);
  in_a = in_a & (!in_b);
  out_a = out_a & (!out_b);

  const Pack dh = hq - hp, ex = qx - px, ey = qy - py;
  const Pack on_a = (pax * ey - pay * ex) / (f.max * ey - f.may * ex);
  const Pack on_b = (pbx * ey - pby * ex) / (f.mbx * ey - f.mby * ex);
  const Pack h1 = select(in_a, on_a, select(in_b, on_b, hp + lo * dh));
  const Pack h2 = select(out_a, on_a, select(out_b, on_b, hp + hi * dh));
  const Mask reversed = lo > hi;
  const Mask easy = plain | !((out_ap & out_bp) | (out_aq & out_bq) | reversed |
                              !((h1 <= f.plain) & (h2 <= f.plain)));
  piece.deep = !(easy | under | beside);
  piece.met = easy & !(missed | reversed);

  const Pack tp = f.tx * pax + f.ty * pay, dt = f.tx * ex + f.ty * ey;
  const Pack d = hi - lo, t1 = tp + lo * dt, t2 = tp + hi * dt, two(2.), half(.5),
             sixth(detail::kSixth);
  piece.from = lo;
  piece.to = hi;
  piece.sum = d * (h1 + h2) * half;
  piece.first = d * (h1 * (two * lo + hi) + h2 * (lo + two * hi)) * sixth;
  piece.area = -d * dt * (h1 + h2) * half;
  piece.along = -d * dt * (h1 * (two * t1 + t2) + h2 * (t1 + two * t2)) * sixth;
  piece.height = -d * dt * (h1 * h1 + h1 * h2 + h2 * h2) * sixth;
  piece.deepest = select(h1 < h2, h2, h1);

  const Pack alpha = f.alpha(), beta = f.beta();
  const detail::AlongBisector<Pack> enters(in_a, select(in_a, alpha, beta), h1, f.length, -1);
  const detail::AlongBisector<Pack> leaves(out_a, select(out_a, alpha, beta), h2, f.length, 1);
  const Mask in = in_a | in_b, out = out_a | out_b;
  const auto add = [&](const Pack& entering, const Pack& leaving, Pack& sum) APOTHEM_LAMBDA {
    sum = select(in, sum + entering, sum);
    sum = select(out, sum + leaving, sum);
  };
  add(enters.area, leaves.area, piece.area);
  add(enters.along, leaves.along, piece.along);
  add(enters.height, leaves.height, piece.height);
  return piece;
}

}  // namespace apothem
