// The element with any number of corners, convex or not: the virtual element method of first order
// (L. Beirao da Veiga et al., Math. Models Methods Appl. Sci. 23, 2013; P. Wriggers et al., Comput.
// Mech. 60, 2017) with a stabilisation that represents bending.
//
// The mean displacement gradient follows from the boundary alone. Let r_i be the part of the
// displacement of corner i that the mean displacement and the mean gradient leave over. It gets
// - with four corners the bending energy of Quad4, so that the two elements are the same;
// - from five corners on the energy of the four equilibrated stress fields that are linear in the
//   coordinates (as in hybrid stress elements). With s_k orthonormal in complementary energy,
//   W = 1/2 SUM_k beta_k^2, beta_k = INT_boundary (s_k n).(F^T u) ds, F the mean deformation
//   gradient, so that a rotation stores no energy;
// - and 1/2 kappa |r'|^2, where r' is the part of r to which no linear stress field responds (it is
//   orthogonal to the functionals beta_k). Since |r'|^2 is |r|^2 less the squares of orthogonal
//   functionals, prepare() subtracts these squares from the beta_k, and the kernel only needs
//   1/2 kappa SUM |r_i|^2.
#pragma once

#include <span>

#include "geometry/polygon/point.hpp"
#include "lib/fem/response.hpp"

namespace apothem {

/// The polygonal element. Functions as in Tri3.
struct PolygonElement {
  static constexpr int kCorners = 0;     // any number
  static constexpr int kPerCorner = 12;  // stored numbers per corner
  static int stored(int corners) { return 2 + kPerCorner * corners; }

  /// Stores area times thickness (m^3), kappa (N/m), and for each corner i: the gradient vector g_i
  /// with H = SUM u_i (x) g_i (1/m), the place relative to the mean of the corners (m), and four
  /// bending functionals. `x` are the corners, counter-clockwise, in m. Number k goes to
  /// out[k * kLanes].
  static void prepare(std::span<const Vec2> x, const Elastic& e, double thickness, double* out);

  template <class R, class N>
  static APOTHEM_INLINE void force(const Stored<N>& d, const R& material, int corners,
                                   const Point<N>* u, const Point<N>* v, Point<N>* f, N& power) {
    const Fit<N> fit(d, corners, u);
    Tensor<N> rate{};
    N beta[4];
    fit.bending(fit.h, beta);
    if constexpr (R::kDamped) {
      const Fit<N> moving(d, corners, v);
      rate = moving.h;
      const N damping(material.beta);
      for (int k = 0; k < 4; ++k) {
        const N change = contract(moving.t[k], material.before(fit.h, rate)) + moving.t[k].xx +
                         moving.t[k].yy + contract(material.before(fit.t[k], moving.t[k]), rate);
        beta[k] += damping * change;
        power += damping * change * change;
      }
      power += d[0] * material.damping_power(fit.h, rate);
    }
    Tensor<N> p = d[0] * material.stress(fit.h, rate);
    for (int k = 0; k < 4; ++k) p = p + beta[k] * fit.t[k];
    const N kappa = d[1];
    for (int i = 0; i < corners; ++i) {
      const Point<N> r = fit.rest(d, i, u);
      f[i] = kappa * r;
      p = p + outer(Point<N>{-kappa * r.x, -kappa * r.y}, place(d, i));
    }
    for (int i = 0; i < corners; ++i) {
      Point<N> w{N(0.), N(0.)};
      for (int k = 0; k < 4; ++k) w = w + beta[k] * functional(d, i, k);
      f[i] = f[i] + p * slope(d, i) + w + fit.h * w;
    }
  }

  template <class R, class N>
  static APOTHEM_INLINE N energy(const Stored<N>& d, const R& material, int corners,
                                 const Point<N>* u) {
    const Fit<N> fit(d, corners, u);
    N beta[4];
    fit.bending(fit.h, beta);
    N sum = d[0] * material.law.energy(fit.h);
    for (int k = 0; k < 4; ++k) sum += N(0.5) * beta[k] * beta[k];
    for (int i = 0; i < corners; ++i) {
      const Point<N> r = fit.rest(d, i, u);
      sum += N(0.5) * d[1] * dot(r, r);
    }
    return sum;
  }

  template <class N>
  static Tensor<N> mean_gradient(const Stored<N>& d, int corners, const Point<N>* u) {
    return Fit<N>(d, corners, u).h;
  }

 private:
  template <class N>
  static APOTHEM_INLINE Point<N> slope(const Stored<N>& d, int i) {
    return {d[2 + kPerCorner * i], d[3 + kPerCorner * i]};
  }
  template <class N>
  static APOTHEM_INLINE Point<N> place(const Stored<N>& d, int i) {
    return {d[4 + kPerCorner * i], d[5 + kPerCorner * i]};
  }
  template <class N>
  static APOTHEM_INLINE Point<N> functional(const Stored<N>& d, int i, int k) {
    return {d[6 + kPerCorner * i + 2 * k], d[7 + kPerCorner * i + 2 * k]};
  }

  // Mean of the displacements, mean gradient h, and T_k = SUM_i u_i (x) functional_ki, with which
  // beta_k = T_k : F.
  template <class N>
  struct Fit {
    Point<N> mean{N(0.), N(0.)};
    Tensor<N> h{N(0.), N(0.), N(0.), N(0.)};
    Tensor<N> t[4]{};
    APOTHEM_INLINE Fit(const Stored<N>& d, int corners, const Point<N>* u) {
      for (int k = 0; k < 4; ++k) t[k] = {N(0.), N(0.), N(0.), N(0.)};
      for (int i = 0; i < corners; ++i) {
        mean = mean + u[i];
        h = h + outer(u[i], slope(d, i));
        for (int k = 0; k < 4; ++k) t[k] = t[k] + outer(u[i], functional(d, i, k));
      }
      mean = N(1. / corners) * mean;
    }
    APOTHEM_INLINE void bending(const Tensor<N>& gradient, N* beta) const {
      for (int k = 0; k < 4; ++k) beta[k] = contract(t[k], gradient) + t[k].xx + t[k].yy;
    }
    APOTHEM_INLINE Point<N> rest(const Stored<N>& d, int i, const Point<N>* u) const {
      return u[i] - mean - h * place(d, i);
    }
  };
};

}  // namespace apothem
