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
// For any number type; comparisons look at the real part, so that a complex step gives derivatives.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

#include "lib/execution/pack.hpp"

namespace apothem {

inline double real_part(double x) { return x; }
inline double real_part(const std::complex<double>& x) { return x.real(); }

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
  Number tx, ty;    ///< unit tangent
  Number length;    ///< of the edge
  Number max, may;  ///< bisector at a
  Number mbx, mby;  ///< bisector at b
  double depth;     ///< of the collar
  double plain;     ///< up to here, and a little more, the cell is positive: see plain_depth

  /// The same face with its plain part.
  [[nodiscard]] CollarFace with_plain() const {
    CollarFace face = *this;
    face.plain =
        plain_depth(depth, collar_event(real_part(length), real_part(alpha()), real_part(beta())));
    return face;
  }

  /// Slopes d tau / d h of the bisectors.
  [[nodiscard]] Number alpha() const { return max * tx + may * ty; }
  [[nodiscard]] Number beta() const { return mbx * tx + mby * ty; }
};

/// What the edge P->Q = {P + u (Q - P)} contributes.
template <class Number>
struct CollarPiece {
  Number from, to;    ///< the part of the edge in the cell, in u
  Number sum, first;  ///< INT s h du and INT s h u du over it
  /// Parts of INT s dA, INT s tau dA and INT s h dA over the cell inside the outline of P->Q, as
  /// far as that outline does not contain the top.
  Number area, along, height;
  double deepest;  ///< largest h, m
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

// One edge and one cell.
template <class Number>
struct CollarClip {
  const CollarFace<Number>& f;
  Number ex, ey;  // the edge
  Number tp, dt;  // tau at P, and its change along the edge
  CollarPiece<Number>& piece;

  // What a part of the edge between heights h1 and h2 contributes, by Green's theorem.
  [[nodiscard]] CollarPiece<Number> part(const Number& lo, const Number& hi, const Number& h1,
                                         const Number& h2) const {
    const Number d = hi - lo, t1 = tp + lo * dt, t2 = tp + hi * dt;
    return {lo,
            hi,
            d * (h1 + h2) * .5,
            d * (h1 * (2. * lo + hi) + h2 * (lo + 2. * hi)) * kSixth,
            -d * dt * (h1 + h2) * .5,
            -d * dt * (h1 * (2. * t1 + t2) + h2 * (t1 + 2. * t2)) * kSixth,
            -d * dt * (h1 * h1 + h1 * h2 + h2 * h2) * kSixth,
            std::max(real_part(h1), real_part(h2))};
  }
  void add(const CollarPiece<Number>& p, double sign) {
    piece.sum += sign * p.sum, piece.first += sign * p.first;
    piece.area += sign * p.area, piece.along += sign * p.along, piece.height += sign * p.height;
    piece.deepest = std::max(piece.deepest, p.deepest);
  }
  // The same along a bisector from the base to the height h.
  void along_a(const Number& h, double sign) {
    const Number slope = f.alpha(), s = sign * slope * h * h;
    piece.area += s * .5;
    piece.along += s * slope * h * kThird;
    piece.height += s * h * kSixth;
  }
  void along_b(const Number& h, double sign) {
    const Number slope = f.beta(), s = sign * slope * h * h;
    piece.area -= s * .5;
    piece.along -= s * (f.length * .5 + slope * h * kThird);
    piece.height -= s * h * kSixth;
  }
};

// Signs and heights that an edge has in a cell: at its ends P and Q, against the lines of the base
// and of the bisectors at a and b.
template <class Number>
struct CollarSides {
  Number pax, pay, hp, hq, ap, aq, bp, bq;
};

// An edge that may cross the top of the cell or its negative part. All decisions are signs that
// neighbouring cells and edges share to the last bit, so that the crossings of a closed line with
// the top add up to nothing.
template <class Number>
inline bool deep_collar_piece(const CollarFace<Number>& f, const CollarSides<Number>& side,
                              const Number& px, const Number& py, const Number& qx,
                              const Number& qy, CollarPiece<Number>& piece,
                              CollarCrossings<Number>& top) {
  struct Cut {
    Number u, h;
    bool above, below;
  };
  const auto cut = [&](const Number& u, const Number& h) {
    return Cut{u, h, real_part(h) > f.depth, real_part(h) < 0};
  };
  const auto& [pax, pay, hp, hq, ap, aq, bp, bq] = side;
  const auto inside = [](const Number& x) { return !(real_part(x) < 0); };
  const bool pa = inside(ap), qa = inside(aq), pb = inside(bp), qb = inside(bq);
  const Number all = hp + hq + ap + aq + bp + bq;
  const bool finite = real_part(all) == real_part(all);
  if (finite && pa == qa && pb == qb && pa == pb) return false;
  const double above = f.depth * (1 + 1e-9);
  if (real_part(hp) > above && real_part(hq) > above) return false;

  const Number ex = qx - px, ey = qy - py;
  detail::CollarClip<Number> clip{f, ex, ey, f.tx * pax + f.ty * pay, f.tx * ex + f.ty * ey, piece};
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
      if (top.count < 2)
        top.at[static_cast<size_t>(top.count++)] = {u, clip.tp + u * clip.dt, change};
    };
    if (start.below) lo = at(0), h1 = 0;
    if (end.below) hi = at(0), h2 = 0;
    if (start.above) lo = at(f.depth), h1 = f.depth, cross(lo, -sign);
    if (end.above) hi = at(f.depth), h2 = f.depth, cross(hi, sign);
    if (!found || real_part(lo) < real_part(piece.from)) piece.from = lo;
    if (!found || real_part(hi) > real_part(piece.to)) piece.to = hi;
    found = true;
    clip.add(clip.part(lo, hi, h1, h2), sign);
  };

  const Cut p = cut(0., hp), q = cut(1., hq);
  Cut a = p, b = p;
  if (pa != qa) {
    a = cut(ap / (ap - aq), on_bisector(pax, pay, f.max, f.may));
    if (!a.above && !a.below) clip.along_a(a.h, qa ? -1 : 1);
  }
  if (pb != qb) {
    b = cut(bp / (bp - bq), on_bisector(px - f.bx, py - f.by, f.mbx, f.mby));
    if (!b.above && !b.below) clip.along_b(b.h, qb ? -1 : 1);
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

}  // namespace detail

/// False if the edge misses the cell. Both cells at a bisector see the same sign and the same
/// crossing of it, to the last bit: an edge near a bisector, or on it, is in one of them only.
/// Crossings of the top are appended to `top`.
template <class Number>
inline bool collar_piece(const CollarFace<Number>& f, const Number& px, const Number& py,
                         const Number& qx, const Number& qy, CollarPiece<Number>& piece,
                         CollarCrossings<Number>& top) {
  const auto negative = [](const Number& x) { return real_part(x) < 0; };
  const Number pax = px - f.ax, pay = py - f.ay, qax = qx - f.ax, qay = qy - f.ay;
  const Number hp = f.tx * pay - f.ty * pax, hq = f.tx * qay - f.ty * qax;
  // Written so that NaN is never a miss.
  if (negative(hp) && negative(hq)) return false;
  const Number ap = pax * f.may - pay * f.max, aq = qax * f.may - qay * f.max;
  const Number bp = (px - f.bx) * f.mby - (py - f.by) * f.mbx;
  const Number bq = (qx - f.bx) * f.mby - (qy - f.by) * f.mbx;
  const auto deep = [&] {
    return detail::deep_collar_piece(f, {pax, pay, hp, hq, ap, aq, bp, bq}, px, py, qx, qy, piece,
                                     top);
  };
  // An edge that is nowhere beyond both bisectors does not meet the negative part of the cell, and
  // what lies between the bisectors may be plain although the edge goes on to larger heights.
  const bool plain = real_part(hp) <= f.plain && real_part(hq) <= f.plain;
  const bool beyond_both = (negative(ap) && !negative(bp)) || (negative(aq) && !negative(bq));
  const bool beyond_a = negative(ap) && negative(aq), beyond_b = !negative(bp) && !negative(bq);
  if (!plain && (beyond_both || beyond_a || beyond_b)) return deep();
  if (beyond_a) return false;
  if (real_part(bp) >= 0 && real_part(bq) >= 0) return false;

  enum class End { vertex, base, a, b };
  Number lo = 0, hi = 1;
  End in = End::vertex, out = End::vertex;
  const auto clip = [&](const Number& p, const Number& q, bool p_out, bool q_out, End end) {
    if (p_out == q_out) return;
    const Number u = p / (p - q);
    if (p_out && !(real_part(u) < real_part(lo))) lo = u, in = end;
    if (q_out && !(real_part(u) > real_part(hi))) hi = u, out = end;
  };
  clip(hp, hq, negative(hp), negative(hq), End::base);
  clip(ap, aq, negative(ap), negative(aq), End::a);
  clip(bp, bq, !negative(bp), !negative(bq), End::b);
  // A piece without length still crosses a bisector.
  if (real_part(lo) > real_part(hi)) return plain ? false : deep();

  const Number dh = hq - hp;
  const Number ex = qx - px, ey = qy - py;
  // On a bisector the height is that of the crossing, for both cells the same.
  const auto height = [&](const Number& u, End end) -> Number {
    if (end == End::a) return (pax * ey - pay * ex) / (f.max * ey - f.may * ex);
    if (end == End::b) return ((px - f.bx) * ey - (py - f.by) * ex) / (f.mbx * ey - f.mby * ex);
    return hp + u * dh;
  };
  const Number h1 = height(lo, in), h2 = height(hi, out);
  if (!plain && !(real_part(h1) <= f.plain && real_part(h2) <= f.plain)) return deep();
  detail::CollarClip<Number> clipped{f,    ex, ey, f.tx * pax + f.ty * pay, f.tx * ex + f.ty * ey,
                                     piece};
  piece = clipped.part(lo, hi, h1, h2);
  if (in == End::a) clipped.along_a(h1, -1);
  if (in == End::b) clipped.along_b(h1, 1);
  if (out == End::a) clipped.along_a(h2, 1);
  if (out == End::b) clipped.along_b(h2, -1);
  return true;
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
