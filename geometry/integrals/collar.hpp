// The collar of an outline: its roof near the surface, as a function of the outline's vertices. One
// edge of another outline against one face of the collar, in closed form (docs/theory.md, Contact).
//
// A face belongs to the edge a->b, with the inside on its left. In its coordinates tau along the
// edge and h inwards it is {0 <= h <= depth} between the bisectors {v + h m} at its ends, and h is
// the roof. Nothing is integrated above the depth: the caller must notice `beyond`.
//
// For any number type; comparisons look at the real part, so that a complex step gives derivatives.
#pragma once

#include <algorithm>
#include <complex>
#include <limits>

namespace apothem {

inline double real_part(double x) { return x; }
inline double real_part(const std::complex<double>& x) { return x.real(); }

/// Direction m of the bisector at a vertex between edges with the unit tangents p (before) and q:
/// m . n = 1 for the inward normals n of both.
template <class Number>
struct Mitre {
  Number x, y;

  Mitre(const Number& px, const Number& py, const Number& qx, const Number& qy) {
    const Number scale = 1. / (1. + (px * qx + py * qy));
    x = -(py + qy) * scale;
    y = (px + qx) * scale;
  }
};

template <class Number>
struct CollarFace {
  Number ax, ay, bx, by;
  Number tx, ty;    ///< unit tangent
  Number length;    ///< of the edge
  Number max, may;  ///< bisector at a
  Number mbx, mby;  ///< bisector at b
  double depth;     ///< of the collar
  double depth_a;   ///< and of the neighbour behind a,
  double depth_b;   ///< behind b

  /// Slopes d tau / d h of the bisectors.
  [[nodiscard]] Number alpha() const { return max * tx + may * ty; }
  [[nodiscard]] Number beta() const { return mbx * tx + mby * ty; }
};

/// Height at which a face between bisectors of these slopes shrinks to a point.
inline double collar_event(double length, double alpha, double beta) {
  return alpha > beta ? length / (alpha - beta) : std::numeric_limits<double>::infinity();
}

/// What the edge P->Q = {P + u (Q - P)} contributes.
template <class Number>
struct CollarPiece {
  Number from, to;    ///< the part of the edge in the face, in u
  Number sum, first;  ///< INT h du and INT h u du over it
  /// Parts of INT dA, INT tau dA and INT h dA over the face inside the outline of P->Q.
  Number area, along, height;
  double deepest;  ///< largest h, m
  bool beyond;     ///< it crosses the end of the collar, here or into a neighbour
};

/// False if the edge misses the face. Both faces at a bisector see the same sign and the same
/// crossing of it, to the last bit: an edge near a bisector, or on it, is in one of them only.
template <class Number>
inline bool collar_piece(const CollarFace<Number>& f, const Number& px, const Number& py,
                         const Number& qx, const Number& qy, CollarPiece<Number>& piece) {
  const auto negative = [](const Number& x) { return real_part(x) < 0; };
  const Number pax = px - f.ax, pay = py - f.ay, qax = qx - f.ax, qay = qy - f.ay;
  const Number hp = f.tx * pay - f.ty * pax, hq = f.tx * qay - f.ty * qax;
  // Written so that NaN is never a miss.
  if (negative(hp) && negative(hq)) return false;
  const Number ap = pax * f.may - pay * f.max, aq = qax * f.may - qay * f.max;
  if (negative(ap) && negative(aq)) return false;
  const Number bp = (px - f.bx) * f.mby - (py - f.by) * f.mbx;
  const Number bq = (qx - f.bx) * f.mby - (qy - f.by) * f.mbx;
  if (real_part(bp) >= 0 && real_part(bq) >= 0) return false;
  if (real_part(hp) > f.depth && real_part(hq) > f.depth) return false;

  enum class End { vertex, base, a, b, top };
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
  clip(hp - f.depth, hq - f.depth, real_part(hp) > f.depth, real_part(hq) > f.depth, End::top);
  // A piece without length still crosses a bisector.
  if (real_part(lo) > real_part(hi)) return false;

  const Number dh = hq - hp, d = hi - lo;
  const Number ex = qx - px, ey = qy - py;
  // On a bisector the height is that of the crossing, for both faces the same.
  const auto height = [&](const Number& u, End end) -> Number {
    if (end == End::a) return (pax * ey - pay * ex) / (f.max * ey - f.may * ex);
    if (end == End::b) return ((px - f.bx) * ey - (py - f.by) * ex) / (f.mbx * ey - f.mby * ex);
    return hp + u * dh;
  };
  const Number h1 = height(lo, in), h2 = height(hi, out);
  const Number tp = f.tx * pax + f.ty * pay;
  const Number dt = f.tx * ex + f.ty * ey;
  const Number t1 = tp + lo * dt, t2 = tp + hi * dt;
  piece.from = lo, piece.to = hi;
  piece.sum = d * (h1 + h2) / 2.;
  piece.first = d * (h1 * (2. * lo + hi) + h2 * (lo + 2. * hi)) / 6.;
  // Green's theorem along the piece, and along the bisectors down to the base.
  piece.area = -d * dt * (h1 + h2) / 2.;
  piece.along = -d * dt * (h1 * (2. * t1 + t2) + h2 * (t1 + 2. * t2)) / 6.;
  piece.height = -d * dt * (h1 * h1 + h1 * h2 + h2 * h2) / 6.;
  const auto along_a = [&](const Number& h, double sign) {
    const Number slope = f.alpha(), s = sign * slope * h * h;
    piece.area += s / 2.;
    piece.along += s * slope * h / 3.;
    piece.height += s * h / 6.;
  };
  const auto along_b = [&](const Number& h, double sign) {
    const Number slope = f.beta(), s = sign * slope * h * h;
    piece.area -= s / 2.;
    piece.along -= s * (f.length / 2. + slope * h / 3.);
    piece.height -= s * h / 6.;
  };
  if (in == End::a) along_a(h1, -1);
  if (out == End::a) along_a(h2, 1);
  if (in == End::b) along_b(h1, 1);
  if (out == End::b) along_b(h2, -1);
  piece.deepest = std::max(real_part(h1), real_part(h2));
  const auto leaves_collar = [&](End end, const Number& h) {
    return end == End::top || (end == End::a && real_part(h) > f.depth_a) ||
           (end == End::b && real_part(h) > f.depth_b);
  };
  piece.beyond = leaves_collar(in, h1) || leaves_collar(out, h2);
  return true;
}

}  // namespace apothem
