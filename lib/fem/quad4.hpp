// The quadrilateral elements: with one integration point and bending stabilisation (Quad4), and
// with full 2 x 2 integration (Quad4Full). The corners X_i lie at (xi, eta) = (-1,-1), (1,-1),
// (1,1), (-1,1), so that X = X_0 + A xi + B eta + Q xi eta; displacements u are interpolated in the
// same way, with coefficients u_xi, u_eta and u_h in the place of A, B and Q.
#pragma once

#include <span>

#include "geometry/polygon/point.hpp"
#include "lib/fem/response.hpp"

namespace apothem {

namespace quad {

/// The coefficients A, B, Q of the reference configuration, m.
struct Reference {
  Vec2 a, b, q;
  explicit Reference(std::span<const Vec2> x)
      : a(((x[1] - x[0]) + (x[2] - x[3])) / 4),
        b(((x[3] - x[0]) + (x[2] - x[1])) / 4),
        q(((x[2] - x[3]) - (x[1] - x[0])) / 4) {}
};

/// The coefficients u_xi, u_eta, u_h (hourglass mode) of nodal displacements or velocities, or the
/// generalised forces that are conjugate to them.
template <class N>
struct Modes {
  Point<N> xi, eta, hourglass;
};

/// The coefficients of the four nodal values `u`.
template <class N>
APOTHEM_INLINE Modes<N> modes(const Point<N>* u) {
  const Point<N> lower = u[1] - u[0], upper = u[2] - u[3];
  const Point<N> left = u[3] - u[0], right = u[2] - u[1];
  const N quarter(0.25);
  return {quarter * (lower + upper), quarter * (left + right), quarter * (upper - lower)};
}

/// Nodal forces of the generalised forces on u_xi, u_eta, u_h. Their sum is zero.
template <class N>
APOTHEM_INLINE void scatter(const Modes<N>& g, Point<N>* f) {
  const N quarter(0.25);
  const Point<N> p = quarter * (g.xi + g.eta), m = quarter * (g.xi - g.eta);
  const Point<N> h = quarter * g.hourglass;
  f[0] = h - p;
  f[1] = m - h;
  f[2] = p + h;
  f[3] = Point<N>{-m.x - h.x, -m.y - h.y};
}

}  // namespace quad

/// The quadrilateral that does not lock in bending: one integration point, and the bending energy
/// of the stress modes of Pian and Sumihara (Int. J. Numer. Meth. Eng. 20, 1984), written for large
/// rotations.
///
/// Let q = u_h - H Q be the hourglass part that the mean gradient H leaves over. The strain along A
/// then varies across the element by a.q eta, where a = A + u_xi is A in the present configuration,
/// so that a rotation causes no strain. The stress of this strain acts along A only, with the
/// modulus E of uniaxial stress:
///   W_h = 1/2 E t det_0 4/3 [ (a.q)^2/|A|^4 + (b.q)^2/|B|^4 ],
/// with the thickness t, det_0 = A x B, and b = B + u_eta. Functions as in Tri3.
struct Quad4 {
  static constexpr int kCorners = 4;
  static int stored(int) { return 9; }

  /// Stores A, B, Q (m), 1/det_0 (1/m^2), and the bending stiffnesses along A and B (N/m^3).
  static void prepare(std::span<const Vec2> x, const Elastic& e, double thickness, double* out) {
    const auto [a, b, q] = quad::Reference(x);
    const double det = cross(a, b);
    const double bending = 4. / 3 * e.uniaxial() * thickness * det;
    const double values[] = {a.x(),
                             a.y(),
                             b.x(),
                             b.y(),
                             q.x(),
                             q.y(),
                             1 / det,
                             bending / (a.squaredNorm() * a.squaredNorm()),
                             bending / (b.squaredNorm() * b.squaredNorm())};
    for (int k = 0; k < 9; ++k) out[k * kLanes] = values[k];
  }

  template <class R, class N>
  static APOTHEM_INLINE void force(const Stored<N>& d, const R& material, int, const Point<N>* u,
                                   const Point<N>* v, Point<N>* f, N& power) {
    const Frame<N> s(d);
    const quad::Modes<N> m = quad::modes(u);
    const Tensor<N> h = s.gradient(m);
    const Point<N> q = s.bending(m);
    const Point<N> a = s.a + m.xi, b = s.b + m.eta;
    N along_a = dot(a, q), along_b = dot(b, q);
    Tensor<N> rate{};
    if constexpr (R::kDamped) {
      const quad::Modes<N> w = quad::modes(v);
      const N beta(material.beta);
      rate = s.gradient(w);
      const Point<N> q_rate = s.bending(w);
      const Point<N> q_before = material.before(q, q_rate);
      const N rate_a = dot(w.xi, q_before) + dot(material.before(a, w.xi), q_rate);
      const N rate_b = dot(w.eta, q_before) + dot(material.before(b, w.eta), q_rate);
      along_a += beta * rate_a;
      along_b += beta * rate_b;
      power += N(4 * material.thickness) / d[6] * material.damping_power(h, rate) +
               beta * (d[7] * rate_a * rate_a + d[8] * rate_b * rate_b);
    }
    const N sa = d[7] * along_a, sb = d[8] * along_b;
    // 4 det_0 t P times the rows of J^-1, J the Jacobian matrix; these rows have det_0 in the
    // denominator, which cancels.
    const Tensor<N> p = N(4 * material.thickness) * material.stress(h, rate);
    const Point<N> w = sa * a + sb * b;
    quad::scatter({p * s.across_b + sa * q - s.q_xi * w, p * s.across_a + sb * q - s.q_eta * w, w},
                  f);
  }

  template <class R, class N>
  static APOTHEM_INLINE N energy(const Stored<N>& d, const R& material, int, const Point<N>* u) {
    const Frame<N> s(d);
    const quad::Modes<N> m = quad::modes(u);
    const Point<N> q = s.bending(m);
    const N along_a = dot(s.a + m.xi, q), along_b = dot(s.b + m.eta, q);
    return N(4 * material.thickness) / d[6] * material.law.energy(s.gradient(m)) +
           N(0.5) * (d[7] * along_a * along_a + d[8] * along_b * along_b);
  }

  template <class N>
  static Tensor<N> mean_gradient(const Stored<N>& d, int, const Point<N>* u) {
    return Frame<N>(d).gradient(quad::modes(u));
  }

 private:
  // Geometry of the reference configuration at the centre.
  template <class N>
  struct Frame {
    Point<N> a, b, across_a, across_b;  // det_0 times the rows of J^-1
    N inverse_det, q_xi, q_eta;         // coefficients of Q = A q_xi + B q_eta
    explicit APOTHEM_INLINE Frame(const Stored<N>& d)
        : a{d[0], d[1]},
          b{d[2], d[3]},
          across_a{-d[1], d[0]},
          across_b{d[3], -d[2]},
          inverse_det(d[6]),
          q_xi(inverse_det * (d[4] * d[3] - d[5] * d[2])),
          q_eta(inverse_det * (d[5] * d[0] - d[4] * d[1])) {}
    [[nodiscard]] APOTHEM_INLINE Tensor<N> gradient(const quad::Modes<N>& m) const {
      return outer(m.xi, inverse_det * across_b) + outer(m.eta, inverse_det * across_a);
    }
    [[nodiscard]] APOTHEM_INLINE Point<N> bending(const quad::Modes<N>& m) const {
      return m.hourglass - q_xi * m.xi - q_eta * m.eta;
    }
  };
};

/// The quadrilateral with 2 x 2 Gauss points, which the paper uses. It locks in bending. Functions
/// as in Tri3.
struct Quad4Full {
  static constexpr int kCorners = 4;
  static int stored(int) { return 10; }

  /// Stores A, B, Q (m) and 1/det at the four Gauss points (1/m^2).
  static void prepare(std::span<const Vec2> x, const Elastic&, double, double* out) {
    const auto [a, b, q] = quad::Reference(x);
    const double values[] = {a.x(), a.y(), b.x(), b.y(), q.x(), q.y()};
    for (int k = 0; k < 6; ++k) out[k * kLanes] = values[k];
    for (int g = 0; g < 4; ++g) {
      out[(6 + g) * kLanes] = 1 / cross(a + kGauss[g][1] * q, b + kGauss[g][0] * q);
    }
  }

  template <class R, class N>
  static APOTHEM_INLINE void force(const Stored<N>& d, const R& material, int, const Point<N>* u,
                                   const Point<N>* v, Point<N>* f, N& power) {
    const quad::Modes<N> m = quad::modes(u);
    quad::Modes<N> m_rate{};
    if constexpr (R::kDamped) m_rate = quad::modes(v);
    quad::Modes<N> sum{};
    for (int g = 0; g < 4; ++g) {
      const Gauss<N> s(d, g);
      Tensor<N> rate{};
      const Tensor<N> h = s.gradient(m);
      if constexpr (R::kDamped) {
        rate = s.gradient(m_rate);
        power += N(material.thickness) / s.inverse_det * material.damping_power(h, rate);
      }
      const Tensor<N> p = material.stress(h, rate);
      const Point<N> on_xi = p * s.across_b, on_eta = p * s.across_a;
      sum.xi = sum.xi + on_xi;
      sum.eta = sum.eta + on_eta;
      sum.hourglass = sum.hourglass + s.eta * on_xi + s.xi * on_eta;
    }
    const N t(material.thickness);
    quad::scatter({t * sum.xi, t * sum.eta, t * sum.hourglass}, f);
  }

  template <class R, class N>
  static APOTHEM_INLINE N energy(const Stored<N>& d, const R& material, int, const Point<N>* u) {
    const quad::Modes<N> m = quad::modes(u);
    N sum(0.);
    for (int g = 0; g < 4; ++g) {
      const Gauss<N> s(d, g);
      sum += material.law.energy(s.gradient(m)) / s.inverse_det;
    }
    return N(material.thickness) * sum;
  }

  /// The gradient at the centre, which equals the mean.
  template <class N>
  static Tensor<N> mean_gradient(const Stored<N>& d, int, const Point<N>* u) {
    const quad::Modes<N> m = quad::modes(u);
    const N w = N(1.) / (d[0] * d[3] - d[1] * d[2]);
    return outer(m.xi, Point<N>{w * d[3], -w * d[2]}) + outer(m.eta, Point<N>{-w * d[1], w * d[0]});
  }

 private:
  static constexpr double kPlace = 0.57735026918962576451;  // 1/sqrt(3)
  static constexpr double kGauss[4][2] = {
      {-kPlace, -kPlace}, {kPlace, -kPlace}, {kPlace, kPlace}, {-kPlace, kPlace}};

  // Geometry of the reference configuration at one Gauss point.
  template <class N>
  struct Gauss {
    N xi, eta, inverse_det;
    Point<N> across_a, across_b;
    APOTHEM_INLINE Gauss(const Stored<N>& d, int g)
        : xi(kGauss[g][0]),
          eta(kGauss[g][1]),
          inverse_det(d[6 + g]),
          across_a{-(d[1] + eta * d[5]), d[0] + eta * d[4]},
          across_b{d[3] + xi * d[5], -(d[2] + xi * d[4])} {}
    [[nodiscard]] APOTHEM_INLINE Tensor<N> gradient(const quad::Modes<N>& m) const {
      return outer(m.xi + eta * m.hourglass, inverse_det * across_b) +
             outer(m.eta + xi * m.hourglass, inverse_det * across_a);
    }
  };
};

}  // namespace apothem
