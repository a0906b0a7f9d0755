// The collar of an outline: its roof near the surface, as a function of the outline's vertices. One
// edge of another outline against one cell of the collar, in closed form (docs/theory.md, Contact).
//
// A cell belongs to the edge a->b, with the inside on its left. In its coordinates tau along the
// edge and h inwards it lies in 0 <= h <= depth between the bisectors {v + h m} at its ends. Above
// the height at which these cross, the cell counts negatively. The upper sides of all cells form
// the top of the collar, a closed line. With the sign s of each cell and the winding number w of
// the top, the depth below the surface is
//
//   SUM s h + depth w,
//
// which is continuous everywhere and the depth of the plateau inside the top.
//
// For any number type. Comparisons look at the real part, so that a complex step gives derivatives;
// with packs several edges go at once, each against one cell.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <type_traits>
#include <utility>

#include "lib/execution/pack.hpp"

namespace apothem {

inline double real_part(double x) { return x; }
inline double real_part(const std::complex<double>& x) { return x.real(); }
template <int lanes>
APOTHEM_INLINE PackOf<lanes> real_part(const PackOf<lanes>& x) {
  return x;
}
/// What the numbers of a type are compared by.
template <class Number>
using RealPart = std::decay_t<decltype(real_part(std::declval<const Number&>()))>;

/// Direction m of the bisector at a vertex between edges with the unit tangents p (before) and q:
/// m . n = 1 for the inward normals n of both.
template <class Number>
struct Mitre {
  Number x, y;

  APOTHEM_INLINE Mitre(const Number& px, const Number& py, const Number& qx, const Number& qy) {
    const Number scale = 1. / (1. + (px * qx + py * qy));
    x = -(py + qy) * scale;
    y = (px + qx) * scale;
  }
};

/// Height at which a face between bisectors of these slopes shrinks to a point. Of numbers or
/// packs.
template <class Real>
APOTHEM_INLINE Real collar_event(const Real& length, const Real& alpha, const Real& beta) {
  return select(alpha > beta, length / (alpha - beta),
                Real(std::numeric_limits<double>::infinity()));
}

/// The height up to which an edge needs no look at the top of a cell or at its negative part.
template <class Real>
APOTHEM_INLINE Real plain_depth(const Real& depth, const Real& event) {
  return select(event < depth, event, depth) * Real(1 - 1e-9);
}

template <class Number>
struct CollarFace {
  Number ax, ay, bx, by;
  Number tx, ty;           ///< unit tangent
  Number length;           ///< of the edge
  Number max, may;         ///< bisector at a
  Number mbx, mby;         ///< bisector at b
  RealPart<Number> depth;  ///< of the collar
  RealPart<Number> plain;  ///< up to here, and a little more, the cell is positive: see plain_depth

  /// The same face with its plain part.
  [[nodiscard]] APOTHEM_INLINE CollarFace with_plain() const {
    CollarFace face = *this;
    face.plain =
        plain_depth(depth, collar_event(real_part(length), real_part(alpha()), real_part(beta())));
    return face;
  }

  /// Slopes d tau / d h of the bisectors.
  [[nodiscard]] APOTHEM_INLINE Number alpha() const { return max * tx + may * ty; }
  [[nodiscard]] APOTHEM_INLINE Number beta() const { return mbx * tx + mby * ty; }
};

/// What the edge P->Q = {P + u (Q - P)} contributes.
template <class Number>
struct CollarPiece {
  Number from, to;    ///< the part of the edge in the cell, in u
  Number sum, first;  ///< INT s h du and INT s h u du over it
  /// Parts of INT s dA, INT s tau dA and INT s h dA over the cell inside the outline of P->Q, as
  /// far as that outline does not contain the top.
  Number area, along, height;
  RealPart<Number> deepest;  ///< largest h, m
};

/// Pieces, and which of them there are.
template <class Number>
struct CollarPieces : CollarPiece<Number> {
  Truth<RealPart<Number>> met;   ///< the edge meets its cell
  Truth<RealPart<Number>> deep;  ///< only deep_collar_piece tells whether it does; it is not met
};

/// Where an edge crosses the top of a cell.
template <class Number>
struct CollarCrossing {
  Number u;    ///< on the edge
  Number tau;  ///< on the top
  /// The winding number of the top changes by this along the edge, and that of the edge's outline
  /// by the opposite along the top.
  int sign;
};
template <class Number>
struct CollarCrossings {
  int count = 0;
  std::array<CollarCrossing<Number>, 2> at;
};

namespace detail {

constexpr double kThird = 1. / 3, kSixth = 1. / 6;  // a division takes as long as ten products

// Signs and heights that an edge has in a cell: at its ends P and Q, against the lines of the base
// and of the bisectors at a and b.
template <class Number>
struct CollarSides {
  Number pax, pay, pbx, pby;  // P relative to a and to b
  Number hp, hq, ap, aq, bp, bq;

  APOTHEM_INLINE CollarSides(const CollarFace<Number>& f, const Number& px, const Number& py,
                             const Number& qx, const Number& qy)
      : pax(px - f.ax), pay(py - f.ay), pbx(px - f.bx), pby(py - f.by) {
    const Number qax = qx - f.ax, qay = qy - f.ay, qbx = qx - f.bx, qby = qy - f.by;
    hp = f.tx * pay - f.ty * pax, hq = f.tx * qay - f.ty * qax;
    ap = pax * f.may - pay * f.max, aq = qax * f.may - qay * f.max;
    bp = pbx * f.mby - pby * f.mbx, bq = qbx * f.mby - qby * f.mbx;
  }
  // NaN if one of them is not finite.
  [[nodiscard]] APOTHEM_INLINE Number all() const { return hp + hq + ap + aq + bp + bq; }
};

// What the part of an edge between heights h1 and h2 contributes, by Green's theorem. tau is `tp`
// at P and changes by `dt` along the edge.
template <class Number>
APOTHEM_INLINE CollarPiece<Number> collar_part(const Number& tp, const Number& dt, const Number& lo,
                                               const Number& hi, const Number& h1,
                                               const Number& h2) {
  const Number d = hi - lo, t1 = tp + lo * dt, t2 = tp + hi * dt;
  const RealPart<Number> r1 = real_part(h1), r2 = real_part(h2);
  return {lo,
          hi,
          d * (h1 + h2) * .5,
          d * (h1 * (2. * lo + hi) + h2 * (lo + 2. * hi)) * kSixth,
          -d * dt * (h1 + h2) * .5,
          -d * dt * (h1 * (2. * t1 + t2) + h2 * (t1 + 2. * t2)) * kSixth,
          -d * dt * (h1 * h1 + h1 * h2 + h2 * h2) * kSixth,
          select(r1 < r2, r2, r1)};
}

// What the way along a bisector, at a or else at b, from the base up to the height h contributes,
// or down: where an edge enters a cell (sign -1) or leaves it (sign 1).
template <class Number>
struct AlongBisector {
  Number area, along, height;

  APOTHEM_INLINE AlongBisector(const CollarFace<Number>& f, const Truth<RealPart<Number>>& at_a,
                               const Number& h, double sign) {
    const Number slope = select(at_a, f.alpha(), f.beta()), s = sign * slope * h * h;
    const Number third = select(at_a, Number(s * slope * h), Number(slope * h)) * kThird;
    area = s * .5;
    along = select(at_a, third, Number(s * (f.length * .5 + third)));
    height = s * h * kSixth;
  }
  // Adds it to a piece.
  APOTHEM_INLINE void add_to(CollarPiece<Number>& piece,
                             const Truth<RealPart<Number>>& there) const {
    piece.area = select(there, Number(piece.area + area), piece.area);
    piece.along = select(there, Number(piece.along + along), piece.along);
    piece.height = select(there, Number(piece.height + height), piece.height);
  }
};

}  // namespace detail

/// An edge that may cross the top of the cell or its negative part. All decisions are signs that
/// neighbouring cells and edges share to the last bit, so that the crossings of a closed line with
/// the top add up to nothing. Arguments and result are those of collar_piece.
template <class Number>
inline bool deep_collar_piece(const CollarFace<Number>& f, const Number& px, const Number& py,
                              const Number& qx, const Number& qy, CollarPiece<Number>& piece,
                              CollarCrossings<Number>& top) {
  struct Cut {
    Number u, h;
    bool above, below;
  };
  const auto cut = [&](const Number& u, const Number& h) {
    return Cut{u, h, real_part(h) > f.depth, real_part(h) < 0};
  };
  const detail::CollarSides<Number> side(f, px, py, qx, qy);
  const auto& [pax, pay, pbx, pby, hp, hq, ap, aq, bp, bq] = side;
  const auto inside = [](const Number& x) { return !(real_part(x) < 0); };
  const bool pa = inside(ap), qa = inside(aq), pb = inside(bp), qb = inside(bq);
  const Number all = side.all();
  const bool finite = real_part(all) == real_part(all);
  if (finite && pa == qa && pb == qb && pa == pb) return false;
  const double above = f.depth * (1 + 1e-9);
  if (real_part(hp) > above && real_part(hq) > above) return false;

  const Number ex = qx - px, ey = qy - py;
  const Number tp = f.tx * pax + f.ty * pay, dt = f.tx * ex + f.ty * ey;
  bool found = !finite;
  piece = {};
  if (!finite) {
    piece.from = piece.to = piece.sum = piece.first = all;
    piece.area = piece.along = piece.height = all;
    piece.deepest = real_part(all);
  }
  // On a bisector the height is that of the crossing, for both cells the same, and between those of
  // the feet of P and Q.
  const auto on_bisector = [&](const Number& x, const Number& y, const Number& mx,
                               const Number& my) -> Number {
    const Number h = (x * ey - y * ex) / (mx * ey - my * ex);
    const Number m2 = mx * mx + my * my;
    const Number p = (x * mx + y * my) / m2, q = p + (ex * mx + ey * my) / m2;
    const bool up = real_part(p) < real_part(q);
    const Number &low = up ? p : q, &high = up ? q : p;
    return real_part(h) < real_part(low) ? low : real_part(h) > real_part(high) ? high : h;
  };
  const auto part = [&](const Cut& start, const Cut& end, int sign) {
    if (sign == 0 || (start.above && end.above) || (start.below && end.below)) return;
    const Number d = end.u - start.u, dh = end.h - start.h;
    const auto at = [&](double level) -> Number { return start.u + d * ((level - start.h) / dh); };
    Number lo = start.u, hi = end.u, h1 = start.h, h2 = end.h;
    const auto cross = [&](const Number& u, int change) {
      if (top.count < 2) top.at[static_cast<size_t>(top.count++)] = {u, tp + u * dt, change};
    };
    if (start.below) lo = at(0), h1 = 0;
    if (end.below) hi = at(0), h2 = 0;
    if (start.above) lo = at(f.depth), h1 = f.depth, cross(lo, -sign);
    if (end.above) hi = at(f.depth), h2 = f.depth, cross(hi, sign);
    if (!found || real_part(lo) < real_part(piece.from)) piece.from = lo;
    if (!found || real_part(hi) > real_part(piece.to)) piece.to = hi;
    found = true;
    const CollarPiece<Number> p = detail::collar_part(tp, dt, lo, hi, h1, h2);
    const double s = sign;
    piece.sum += s * p.sum, piece.first += s * p.first;
    piece.area += s * p.area, piece.along += s * p.along, piece.height += s * p.height;
    piece.deepest = std::max(piece.deepest, p.deepest);
  };

  const auto along = [&](bool at_a, const Number& h, double up) {
    detail::AlongBisector<Number>(f, at_a, h, up).add_to(piece, true);
  };
  const Cut p = cut(0., hp), q = cut(1., hq);
  Cut a = p, b = p;
  if (pa != qa) {
    a = cut(ap / (ap - aq), on_bisector(pax, pay, f.max, f.may));
    if (!a.above && !a.below) along(true, a.h, qa ? -1 : 1);
  }
  if (pb != qb) {
    b = cut(bp / (bp - bq), on_bisector(pbx, pby, f.mbx, f.mby));
    if (!b.above && !b.below) along(false, b.h, qb ? 1 : -1);
  }
  const auto sign = [](bool in_a, bool in_b) {
    return static_cast<int>(in_a) - static_cast<int>(in_b);
  };
  if (pa == qa && pb == qb) {
    part(p, q, sign(pa, pb));
  } else if (pb == qb) {
    part(p, a, sign(pa, pb)), part(a, q, sign(qa, pb));
  } else if (pa == qa) {
    part(p, b, sign(pa, pb)), part(b, q, sign(pa, qb));
  } else {
    const bool a_first = real_part(a.u) < real_part(b.u);
    const Cut &one = a_first ? a : b, &other = a_first ? b : a;
    part(p, one, sign(pa, pb));
    part(one, other, a_first ? sign(qa, pb) : sign(pa, qb));
    part(other, q, sign(qa, qb));
  }
  return found;
}

/// Edges, each against one cell, but for what deep_collar_piece has to tell.
template <class Number>
APOTHEM_INLINE CollarPieces<Number> collar_pieces(const CollarFace<Number>& f, const Number& px,
                                                  const Number& py, const Number& qx,
                                                  const Number& qy) {
  using Real = RealPart<Number>;
  using Mask = Truth<Real>;
  const auto negative = [](const Number& x)
                            APOTHEM_LAMBDA -> Mask { return real_part(x) < Real(0.); };
  const auto is_plain = [&](const Number& p, const Number& q) APOTHEM_LAMBDA -> Mask {
    return (real_part(p) <= f.plain) & (real_part(q) <= f.plain);
  };
  const detail::CollarSides<Number> side(f, px, py, qx, qy);
  const auto& [pax, pay, pbx, pby, hp, hq, ap, aq, bp, bq] = side;
  const Mask out_ap = negative(ap), out_aq = negative(aq);
  const Mask out_bp = !negative(bp), out_bq = !negative(bq);
  const Mask under = negative(hp) & negative(hq);
  const Mask plain = is_plain(hp, hq);
  // Edges that are beyond one bisector only, and all of them, miss the cell, unless a number is not
  // finite.
  const Real all = real_part(side.all());
  const Mask beside =
      ((out_ap & out_aq & (!(out_bp | out_bq))) | ((!(out_ap | out_aq)) & out_bp & out_bq)) &
      (all == all);
  const Mask missed =
      under | (out_ap & out_aq) | ((real_part(bp) >= Real(0.)) & (real_part(bq) >= Real(0.)));

  // The part inside: it begins or ends at the edge's end, at the base, or at a bisector.
  Number lo(0.), hi(1.);
  const auto clip = [&](const Number& p, const Number& q, const Mask& p_out, const Mask& q_out,
                        Mask& starts, Mask& ends) APOTHEM_LAMBDA {
    const Number u = p / (p - q);
    starts = p_out & (!(q_out | (real_part(u) < real_part(lo))));
    ends = q_out & (!(p_out | (real_part(u) > real_part(hi))));
    lo = select(starts, u, lo);
    hi = select(ends, u, hi);
  };
  Mask in_base, out_base, in_a, out_a, in_b, out_b;
  clip(hp, hq, negative(hp), negative(hq), in_base, out_base);
  clip(ap, aq, out_ap, out_aq, in_a, out_a);
  clip(bp, bq, out_bp, out_bq, in_b, out_b);
  in_a = in_a & (!in_b);
  out_a = out_a & (!out_b);

  // On a bisector the height is that of the crossing, for both cells the same.
  const Number dh = hq - hp, ex = qx - px, ey = qy - py;
  const Number on_a = (pax * ey - pay * ex) / (f.max * ey - f.may * ex);
  const Number on_b = (pbx * ey - pby * ex) / (f.mbx * ey - f.mby * ex);
  const Number h1 = select(in_a, on_a, select(in_b, on_b, Number(hp + lo * dh)));
  const Number h2 = select(out_a, on_a, select(out_b, on_b, Number(hp + hi * dh)));
  // An edge that is nowhere beyond both bisectors does not meet the negative part of the cell, and
  // what lies between the bisectors may be plain although the edge goes on to larger heights. A
  // piece without length still crosses a bisector. Written so that NaN is never a miss.
  const Mask reversed = real_part(lo) > real_part(hi);
  const Mask easy = plain | !((out_ap & out_bp) | (out_aq & out_bq) | reversed | !is_plain(h1, h2));
  CollarPieces<Number> piece{detail::collar_part(Number(f.tx * pax + f.ty * pay),
                                                 Number(f.tx * ex + f.ty * ey), lo, hi, h1, h2),
                             Mask(easy & !(missed | reversed)), !(easy | under | beside)};
  detail::AlongBisector<Number>(f, in_a, h1, -1).add_to(piece, in_a | in_b);
  detail::AlongBisector<Number>(f, out_a, h2, 1).add_to(piece, out_a | out_b);
  return piece;
}

/// False if the edge misses the cell. Both cells at a bisector see the same sign and the same
/// crossing of it, to the last bit: an edge near a bisector, or on it, is in one of them only.
/// Crossings of the top are appended to `top`.
template <class Number>
inline bool collar_piece(const CollarFace<Number>& f, const Number& px, const Number& py,
                         const Number& qx, const Number& qy, CollarPiece<Number>& piece,
                         CollarCrossings<Number>& top) {
  const CollarPieces<Number> found = collar_pieces(f, px, py, qx, qy);
  if (found.deep) return deep_collar_piece(f, px, py, qx, qy, piece, top);
  if (found.met) piece = found;
  return found.met;
}

/// Where an outline contains the top of a cell, Green's theorem goes along it as well. INT s dA,
/// INT s tau dA and INT s h dA
template <class Number>
struct CollarMoments {
  Number area, along, height;
};
/// over the whole cell, for an outline around all of it,
template <class Number>
inline CollarMoments<Number> collar_cell(const CollarFace<Number>& f) {
  const Number a = f.alpha(), b = f.beta(), &l = f.length;
  const double h = f.depth;
  return {h * (l + (b - a) * h / 2.), h * (l * (l + b * h) + (b - a) * (b + a) * h * h / 3.) / 2.,
          h * h * (l / 2. + (b - a) * h / 3.)};
}
/// and, of the way along the top from tau to the end at b and down the bisector there, for an
/// outline that contains this part of the top.
template <class Number>
inline CollarMoments<Number> collar_rest(const CollarFace<Number>& f, const Number& tau) {
  const Number b = f.beta(), &l = f.length;
  const double h = f.depth;
  const Number end = l + b * h;
  return {h * (end - tau) - b * h * h / 2.,
          h * (end * end - tau * tau) / 2. - b * h * h * (l / 2. + b * h / 3.),
          h * h * ((end - tau) / 2. - b * h / 6.)};
}

}  // namespace apothem
