// Elastic materials (docs/theory.md; T. Belytschko, W. K. Liu, B. Moran, K. Elkhodary, Nonlinear
// Finite Elements for Continua and Structures, 2nd ed., 2014, Sec. 5.4). To add a law, write a
// struct with the functions of StVenantKirchhoff and add its name to kElasticLaws (kinds.hpp) and a
// line to with_law.
//
// Throughout, h is the displacement gradient H = F - I in the plane, with h.xy = du_x/dY, and J is
// the determinant of the deformation gradient F.
#pragma once

#include <utility>

#include "lib/execution/elementary.hpp"
#include "lib/fem/kinds.hpp"
#include "lib/fem/tensor.hpp"

namespace apothem {

/// Hooke's law for plane stress or plane strain: maps any strain measure to its conjugate stress.
struct Hooke {
  double constrained, coupled, twice_shear;
  explicit Hooke(const Elastic& e)
      : constrained(e.constrained()), coupled(e.coupled()), twice_shear(2 * e.shear()) {}
  template <class N>
  APOTHEM_INLINE Symmetric<N> operator()(const Symmetric<N>& e) const {
    const N c(constrained), d(coupled), g(twice_shear);
    return {c * e.xx + d * e.yy, d * e.xx + c * e.yy, g * e.xy};
  }
};

/// St. Venant-Kirchhoff material: second Piola-Kirchhoff stress S = C : E of Green's strain E, for
/// plane stress and plane strain. It collapses in strong compression.
struct StVenantKirchhoff {
  Hooke hooke;
  double transverse;   // E_33 = -transverse (E_11 + E_22)
  double lame_across;  // S_33 = lame_across (E_11 + E_22)
  explicit StVenantKirchhoff(const Elastic& e)
      : hooke(e),
        transverse(e.plane == Plane::stress ? e.poisson / (1 - e.poisson) : 0),
        lame_across(e.plane == Plane::stress ? 0 : e.lame()) {}
  /// First Piola-Kirchhoff stress, Pa, at the displacement gradient h.
  template <class N>
  APOTHEM_INLINE Tensor<N> stress(const Tensor<N>& h) const {
    return first_piola(h, hooke(green_strain(h)));
  }
  /// Strain energy per reference volume, J/m^3.
  template <class N>
  APOTHEM_INLINE N energy(const Tensor<N>& h) const {
    const Symmetric<N> e = green_strain(h);
    return N(0.5) * product(hooke(e), e);
  }
  /// Present thickness over reference thickness.
  template <class N>
  APOTHEM_INLINE N thickness_stretch(const Tensor<N>& h) const {
    const Symmetric<N> e = green_strain(h);
    return square_root(N(1) - N(2 * transverse) * (e.xx + e.yy));
  }
  /// Second Piola-Kirchhoff stress perpendicular to the plane, Pa.
  template <class N>
  APOTHEM_INLINE N transverse_stress(const Tensor<N>& h) const {
    const Symmetric<N> e = green_strain(h);
    return N(lame_across) * (e.xx + e.yy);
  }
};

/// Compressible neo-Hookean material with the strain energy per reference volume
/// psi = mu/2 (tr F^T F - 3) - mu ln J + lambda/2 (J - 1)^2, F and J in three dimensions; for small
/// strains it is Hooke's law. In plane stress the thickness stretch follows in closed form from
/// vanishing stress perpendicular to the plane. The functions are those of StVenantKirchhoff.
template <Plane plane>
struct NeoHookean {
  double mu, lambda;
  explicit NeoHookean(const Elastic& e) : mu(e.shear()), lambda(e.lame()) {}

  /// First Piola-Kirchhoff stress, Pa.
  template <class N>
  APOTHEM_INLINE Tensor<N> stress(const Tensor<N>& h) const {
    // With j = det F in the plane and grown = j - 1:
    // F - F^-T = (grown F + F - cof F) / j. Written out in H, this form has no cancellation.
    const N grown = h.xx + h.yy + determinant(h);
    const N j = N(1) + grown;
    const Tensor<N> cofactor{N(1) + h.yy, -h.yx, -h.xy, N(1) + h.xx};
    const N part = N(mu) / j;
    const N skew = h.xx - h.yy, twist = h.xy + h.yx;
    const Tensor<N> f_minus_cofactor{skew, twist, twist, -skew};
    const Tensor<N> f{N(1) + h.xx, h.xy, h.yx, N(1) + h.yy};
    const N swelling = N(lambda) * volume_change(grown, j) * thickness(grown, j);
    return part * (f_minus_cofactor + grown * f) + swelling * cofactor;
  }
  /// Strain energy per reference volume, J/m^3.
  template <class N>
  APOTHEM_INLINE N energy(const Tensor<N>& h) const;
  /// Present thickness over reference thickness.
  template <class N>
  APOTHEM_INLINE N thickness_stretch(const Tensor<N>& h) const {
    const N grown = h.xx + h.yy + determinant(h);
    return thickness(grown, N(1) + grown);
  }
  /// Second Piola-Kirchhoff stress perpendicular to the plane, Pa.
  template <class N>
  APOTHEM_INLINE N transverse_stress(const Tensor<N>& h) const {
    if constexpr (plane == Plane::stress) return N(0);
    const N grown = h.xx + h.yy + determinant(h);
    return N(lambda) * grown *
           (N(1) + grown);  // mu (t^2 - 1) + lambda (J - 1) J with thickness stretch t = 1
  }

 private:
  // Thickness stretch t: d psi/dt = 0 gives (mu + lambda j^2) t^2 - lambda j t - mu = 0.
  template <class N>
  APOTHEM_INLINE N thickness(const N& grown, const N& j) const {
    if constexpr (plane == Plane::strain) return N(1);
    return N(1) + thinning(grown, j);
  }
  // d = t - 1 without cancellation: the root near 0 of
  // (mu + lambda j^2) d^2 + (2 mu + lambda j (2j - 1)) d + lambda j (j - 1) = 0.
  template <class N>
  APOTHEM_INLINE N thinning(const N& grown, const N& j) const {
    const N m(mu), l = N(lambda) * j;
    const N a = m + l * j;
    const N b = N(2) * m + l * (j + grown);
    const N c = l * grown;
    return N(-2) * c / (b + square_root(b * b - N(4) * a * c));
  }
  // J - 1 in three dimensions: j t - 1.
  template <class N>
  APOTHEM_INLINE N volume_change(const N& grown, const N& j) const {
    if constexpr (plane == Plane::strain) return grown;
    return grown + j * thinning(grown, j);
  }
};

/// Natural logarithm of a scalar, or of each lane of a pack.
template <class N>
inline N logarithm(const N& x) {
  using std::log;
  return log(x);
}
inline double logarithm(double x) { return natural_logarithm(x); }
template <int lanes>
APOTHEM_INLINE PackOf<lanes> logarithm(const PackOf<lanes>& x) {
  PackOf<lanes> r;
  for (int i = 0; i < lanes; ++i) r.v[i] = natural_logarithm(x.v[i]);
  return r;
}

template <Plane plane>
template <class N>
APOTHEM_INLINE N NeoHookean<plane>::energy(const Tensor<N>& h) const {
  const N grown = h.xx + h.yy + determinant(h);
  const N j = N(1) + grown;
  const N t = thickness(grown, j), t1 = t - N(1);
  const N v = volume_change(grown, j);
  const N square = h.xx * h.xx + h.xy * h.xy + h.yx * h.yx + h.yy * h.yy;
  return N(0.5 * mu) * (N(2) * (h.xx + h.yy) + square + t1 * (t + N(1))) -
         N(mu) * logarithm(N(1) + v) + N(0.5 * lambda) * v * v;
}

/// Calls `f` with an object of the struct that implements the material's law, and returns what `f`
/// returns.
template <class F>
decltype(auto) with_law(const Elastic& e, F&& f) {
  if (e.law == ElasticLaw::st_venant_kirchhoff) return std::forward<F>(f)(StVenantKirchhoff(e));
  if (e.plane == Plane::stress) return std::forward<F>(f)(NeoHookean<Plane::stress>(e));
  return std::forward<F>(f)(NeoHookean<Plane::strain>(e));
}

}  // namespace apothem
