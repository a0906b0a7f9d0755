// The collar of an outline is its roof near the surface, as a function of the outline's vertices.
// This header evaluates one edge of another outline against one face of the collar, in closed form
// (docs/theory.md, Contact).
//
// A face belongs to the edge a->b, with the inside on its left. In the coordinates tau along the
// edge and h inwards it is the region 0 <= h <= depth between the bisectors {v + h m} at the ends
// of the edge. Above the height at which the bisectors cross, the face counts negatively. The upper
// sides of all faces form the offset curve of the outline, a closed line; inside it is the
// saturated region. With the sign s of each face and the winding number w of the offset curve, the
// depth below the surface is
//
//   SUM s h + depth w,
//
// which is continuous everywhere and equals `depth` in the saturated region.
//
// The functions are templates for any number type. Comparisons use the real part, so that a complex
// step gives derivatives. With packs several edges are treated at once, each against one face.
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
/// The type by which the numbers of a type are compared.
template <class Number>
using RealPart = std::decay_t<decltype(real_part(std::declval<const Number&>()))>;

/// The direction m of the bisector at a vertex between edges with the unit tangents p (before) and
/// q (after), with m . n = 1 for the inward normals n of both edges.
template <class Number>
struct Mitre {
  Number x, y;

  APOTHEM_INLINE Mitre(const Number& px, const Number& py, const Number& qx, const Number& qy) {
    const Number scale = 1. / (1. + (px * qx + py * qy));
    x = -(py + qy) * scale;
    y = (px + qx) * scale;
  }
};

/// The height of the edge event, at which a face between bisectors of these slopes shrinks to a
/// point. `Real` is a number or a pack.
template <class Real>
APOTHEM_INLINE Real edge_event_height(const Real& length, const Real& alpha, const Real& beta) {
  return select(alpha > beta, length / (alpha - beta),
                Real(std::numeric_limits<double>::infinity()));
}

/// The regular depth of a face: up to this height an edge neither reaches the saturated region nor
/// the part of the face that counts negatively.
template <class Real>
APOTHEM_INLINE Real regular_depth_of(const Real& depth, const Real& event) {
  return select(event < depth, event, depth) * Real(1 - 1e-9);
}

template <class Number>
struct CollarFace {
  Number ax, ay, bx, by;
  Number tx, ty;                   ///< unit tangent of the edge
  Number length;                   ///< length of the edge
  Number max, may;                 ///< direction of the bisector at a
  Number mbx, mby;                 ///< direction of the bisector at b
  RealPart<Number> depth;          ///< depth of the collar
  RealPart<Number> regular_depth;  ///< see regular_depth_of()

  /// The same face with its regular depth.
  [[nodiscard]] APOTHEM_INLINE CollarFace with_regular_depth() const {
    CollarFace face = *this;
    face.regular_depth = regular_depth_of(
        depth, edge_event_height(real_part(length), real_part(alpha()), real_part(beta())));
    return face;
  }

  /// Slopes d tau / d h of the bisectors.
  [[nodiscard]] APOTHEM_INLINE Number alpha() const { return max * tx + may * ty; }
  [[nodiscard]] APOTHEM_INLINE Number beta() const { return mbx * tx + mby * ty; }
};

/// The contribution of the edge P->Q = {P + u (Q - P)}.
template <class Number>
struct CollarPiece {
  Number from, to;    ///< the part of the edge in the face, as an interval of u
  Number sum, first;  ///< INT s h du and INT s h u du over it
  /// Contributions to INT s dA, INT s tau dA and INT s h dA over the part of the face inside the
  /// outline of P->Q, without the terms along the offset curve.
  Number area, along, height;
  RealPart<Number> deepest;  ///< largest h, m
};

/// Pieces of several edges, and which of them exist.
template <class Number>
struct CollarPieces : CollarPiece<Number> {
  Truth<RealPart<Number>> met;      ///< the edge meets its face
  Truth<RealPart<Number>> general;  ///< only general_collar_piece can decide; `met` is false then
};

/// A place where an edge crosses the offset curve.
template <class Number>
struct CollarCrossing {
  Number u;    ///< position on the edge
  Number tau;  ///< position along the side of the offset curve
  /// The change of the winding number of the offset curve along the edge; that of the edge's
  /// outline changes by the opposite along the offset curve.
  int sign;
};
template <class Number>
struct CollarCrossings {
  int count = 0;
  std::array<CollarCrossing<Number>, 2> list;
};

namespace detail {

// Factors in place of divisions, which take as long as ten products.
constexpr double kThird = 1. / 3, kSixth = 1. / 6;

// The heights of the ends P and Q of an edge over the base of a face, and their sides of the
// bisectors at a and b.
template <class Number>
struct CollarSides {
  Number pax, pay, pbx, pby;  // P relative to a and relative to b
  Number hp, hq, ap, aq, bp, bq;

  APOTHEM_INLINE CollarSides(const CollarFace<Number>& f, const Number& px, const Number& py,
                             const Number& qx, const Number& qy)
      : pax(px - f.ax), pay(py - f.ay), pbx(px - f.bx), pby(py - f.by) {
    const Number qax = qx - f.ax, qay = qy - f.ay, qbx = qx - f.bx, qby = qy - f.by;
    hp = f.tx * pay - f.ty * pax, hq = f.tx * qay - f.ty * qax;
    ap = pax * f.may - pay * f.max, aq = qax * f.may - qay * f.max;
    bp = pbx * f.mby - pby * f.mbx, bq = qbx * f.mby - qby * f.mbx;
  }
  // A sum that is NaN if one of the numbers is not finite.
  [[nodiscard]] APOTHEM_INLINE Number all() const { return hp + hq + ap + aq + bp + bq; }
};

// The contribution of the part of an edge from u = lo to hi, where its heights are h1 and h2, by
// Green's theorem. tau is `tp` at P and changes by `dt` along the edge.
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

// The contribution of the path along a bisector, at a or else at b, between the base and the height
// h, where an edge enters a face (sign -1) or leaves it (sign 1).
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
  // Adds the contribution to a piece.
  APOTHEM_INLINE void add_to(CollarPiece<Number>& piece,
                             const Truth<RealPart<Number>>& there) const {
    piece.area = select(there, Number(piece.area + area), piece.area);
    piece.along = select(there, Number(piece.along + along), piece.along);
    piece.height = select(there, Number(piece.height + height), piece.height);
  }
};

}  // namespace detail

/// Evaluates an edge that may reach the saturated region or the negative part of the face. All
/// decisions are signs that neighbouring faces and edges share to the last bit, so that the
/// crossings of a closed line with the offset curve add up to zero. Arguments and result are those
/// of collar_piece.
template <class Number>
inline bool general_collar_piece(const CollarFace<Number>& f, const Number& px, const Number& py,
                                 const Number& qx, const Number& qy, CollarPiece<Number>& piece,
                                 CollarCrossings<Number>& crossings) {
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
  // The height at a bisector is that of the crossing, which is the same for both faces, and lies
  // between those of the feet of P and Q.
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
    const auto fraction_at = [&](double level) -> Number {
      return start.u + d * ((level - start.h) / dh);
    };
    Number lo = start.u, hi = end.u, h1 = start.h, h2 = end.h;
    const auto cross = [&](const Number& u, int change) {
      if (crossings.count < 2)
        crossings.list[static_cast<size_t>(crossings.count++)] = {u, tp + u * dt, change};
    };
    if (start.below) lo = fraction_at(0), h1 = 0;
    if (end.below) hi = fraction_at(0), h2 = 0;
    if (start.above) lo = fraction_at(f.depth), h1 = f.depth, cross(lo, -sign);
    if (end.above) hi = fraction_at(f.depth), h2 = f.depth, cross(hi, sign);
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

/// Evaluates several edges, each against one face, except those that need general_collar_piece.
template <class Number>
APOTHEM_INLINE CollarPieces<Number> collar_pieces(const CollarFace<Number>& f, const Number& px,
                                                  const Number& py, const Number& qx,
                                                  const Number& qy) {
  using Real = RealPart<Number>;
  using Mask = Truth<Real>;
  const auto negative = [](const Number& x)
                            APOTHEM_LAMBDA -> Mask { return real_part(x) < Real(0.); };
  const auto is_regular = [&](const Number& p, const Number& q) APOTHEM_LAMBDA -> Mask {
    const Mask at_p = real_part(p) <= f.regular_depth, at_q = real_part(q) <= f.regular_depth;
    return at_p & at_q;
  };
  const detail::CollarSides<Number> side(f, px, py, qx, qy);
  const auto& [pax, pay, pbx, pby, hp, hq, ap, aq, bp, bq] = side;
  const Mask out_ap = negative(ap), out_aq = negative(aq);
  const Mask out_bp = !negative(bp), out_bq = !negative(bq);
  const Mask under = negative(hp) & negative(hq);
  const Mask regular = is_regular(hp, hq);
  // Edges that are entirely beyond one bisector and not beyond the other one miss the face, unless
  // a number is not finite.
  const Real all = real_part(side.all());
  const Mask beside =
      ((out_ap & out_aq & (!(out_bp | out_bq))) | ((!(out_ap | out_aq)) & out_bp & out_bq)) &
      (all == all);
  const Mask missed =
      under | (out_ap & out_aq) | ((real_part(bp) >= Real(0.)) & (real_part(bq) >= Real(0.)));

  // The part inside begins or ends at an end of the edge, at the base, or at a bisector.
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

  // The height at a bisector is that of the crossing, which is the same for both faces.
  const Number dh = hq - hp, ex = qx - px, ey = qy - py;
  const Number on_a = (pax * ey - pay * ex) / (f.max * ey - f.may * ex);
  const Number on_b = (pbx * ey - pby * ex) / (f.mbx * ey - f.mby * ex);
  const Number h1 = select(in_a, on_a, select(in_b, on_b, Number(hp + lo * dh)));
  const Number h2 = select(out_a, on_a, select(out_b, on_b, Number(hp + hi * dh)));
  // An edge that is nowhere beyond both bisectors does not meet the negative part of the face, and
  // the part between the bisectors may be regular although the edge continues to larger heights. A
  // piece of zero length still crosses a bisector. The conditions are written so that NaN never
  // counts as a miss.
  const Mask reversed = real_part(lo) > real_part(hi);
  const Mask easy =
      regular | !((out_ap & out_bp) | (out_aq & out_bq) | reversed | !is_regular(h1, h2));
  CollarPieces<Number> piece{detail::collar_part(Number(f.tx * pax + f.ty * pay),
                                                 Number(f.tx * ex + f.ty * ey), lo, hi, h1, h2),
                             Mask(easy & !(missed | reversed)), !(easy | under | beside)};
  detail::AlongBisector<Number>(f, in_a, h1, -1).add_to(piece, in_a | in_b);
  detail::AlongBisector<Number>(f, out_a, h2, 1).add_to(piece, out_a | out_b);
  return piece;
}

/// Evaluates an edge against a face. Returns false if the edge misses the face. Both faces at a
/// bisector see the same sign and the same crossing of it, to the last bit, so that an edge near a
/// bisector, or on it, is in one of them only. Crossings of the offset curve are appended to
/// `crossings`.
template <class Number>
inline bool collar_piece(const CollarFace<Number>& f, const Number& px, const Number& py,
                         const Number& qx, const Number& qy, CollarPiece<Number>& piece,
                         CollarCrossings<Number>& crossings) {
  const CollarPieces<Number> found = collar_pieces(f, px, py, qx, qy);
  if (found.general) return general_collar_piece(f, px, py, qx, qy, piece, crossings);
  if (found.met) piece = found;
  return found.met;
}

/// The terms of Green's theorem along the offset curve, where an outline contains the face's side
/// of it: INT s dA, INT s tau dA and INT s h dA.
template <class Number>
struct CollarMoments {
  Number area, along, height;
};
/// The moments of the whole face, for an outline around all of it.
template <class Number>
inline CollarMoments<Number> collar_cell(const CollarFace<Number>& f) {
  const Number a = f.alpha(), b = f.beta(), &l = f.length;
  const double h = f.depth;
  return {h * (l + (b - a) * h / 2.), h * (l * (l + b * h) + (b - a) * (b + a) * h * h / 3.) / 2.,
          h * h * (l / 2. + (b - a) * h / 3.)};
}
/// The moments of the path along the offset curve from tau to the end at b and down the bisector
/// there, for an outline that contains this part of the offset curve.
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
