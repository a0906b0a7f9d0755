// Vectors and 2 x 2 tensors over any number type (double, SIMD pack, complex), for the elements.
#pragma once

#include "lib/execution/pack.hpp"

namespace apothem {

/// A vector or point of the plane.
template <class N>
struct Point {
  N x, y;
  friend APOTHEM_INLINE Point operator+(const Point& a, const Point& b) {
    return {a.x + b.x, a.y + b.y};
  }
  friend APOTHEM_INLINE Point operator-(const Point& a, const Point& b) {
    return {a.x - b.x, a.y - b.y};
  }
  friend APOTHEM_INLINE Point operator*(const N& s, const Point& a) { return {s * a.x, s * a.y}; }
};

template <class N>
APOTHEM_INLINE N dot(const Point<N>& a, const Point<N>& b) {
  return a.x * b.x + a.y * b.y;
}

/// A 2 x 2 tensor.
template <class N>
struct Tensor {
  N xx, xy, yx, yy;  // row by row: xy is row x, column y
  friend APOTHEM_INLINE Tensor operator+(const Tensor& a, const Tensor& b) {
    return {a.xx + b.xx, a.xy + b.xy, a.yx + b.yx, a.yy + b.yy};
  }
  friend APOTHEM_INLINE Tensor operator*(const N& s, const Tensor& a) {
    return {s * a.xx, s * a.xy, s * a.yx, s * a.yy};
  }
  friend APOTHEM_INLINE Point<N> operator*(const Tensor& a, const Point<N>& p) {
    return {a.xx * p.x + a.xy * p.y, a.yx * p.x + a.yy * p.y};
  }
  friend APOTHEM_INLINE Tensor operator*(const Tensor& a, const Tensor& b) {
    return {a.xx * b.xx + a.xy * b.yx, a.xx * b.xy + a.xy * b.yy, a.yx * b.xx + a.yy * b.yx,
            a.yx * b.xy + a.yy * b.yy};
  }
};

/// The dyadic product a b^T.
template <class N>
APOTHEM_INLINE Tensor<N> outer(const Point<N>& a, const Point<N>& b) {
  return {a.x * b.x, a.x * b.y, a.y * b.x, a.y * b.y};
}

/// The double contraction a : b, the sum of the products of equal components.
template <class N>
APOTHEM_INLINE N contract(const Tensor<N>& a, const Tensor<N>& b) {
  return a.xx * b.xx + a.xy * b.xy + a.yx * b.yx + a.yy * b.yy;
}

template <class N>
APOTHEM_INLINE N determinant(const Tensor<N>& a) {
  return a.xx * a.yy - a.xy * a.yx;
}

/// A symmetric 2 x 2 tensor: strain or second Piola-Kirchhoff stress.
template <class N>
struct Symmetric {
  N xx, yy, xy;
};

/// The double contraction S : E.
template <class N>
APOTHEM_INLINE N product(const Symmetric<N>& s, const Symmetric<N>& e) {
  return s.xx * e.xx + s.yy * e.yy + N(2) * (s.xy * e.xy);
}

/// Green's strain E = sym H + H^T H / 2 of the displacement gradient H, free of cancellation.
template <class N>
APOTHEM_INLINE Symmetric<N> green_strain(const Tensor<N>& h) {
  const N half(0.5);
  return {h.xx + half * (h.xx * h.xx + h.yx * h.yx), h.yy + half * (h.xy * h.xy + h.yy * h.yy),
          half * (h.xy + h.yx + h.xx * h.xy + h.yx * h.yy)};
}

/// The rate of Green's strain, sym(F^T H'), with F = I + H and the rate H' of the displacement
/// gradient.
template <class N>
APOTHEM_INLINE Symmetric<N> green_strain_rate(const Tensor<N>& h, const Tensor<N>& rate) {
  const N half(0.5);
  return {rate.xx + h.xx * rate.xx + h.yx * rate.yx, rate.yy + h.xy * rate.xy + h.yy * rate.yy,
          half * (rate.xy + rate.yx + h.xx * rate.xy + h.yx * rate.yy + rate.xx * h.xy +
                  rate.yx * h.yy)};
}

/// First Piola-Kirchhoff stress F S with F = I + H, from the second one.
template <class N>
APOTHEM_INLINE Tensor<N> first_piola(const Tensor<N>& h, const Symmetric<N>& s) {
  return {s.xx + h.xx * s.xx + h.xy * s.xy, s.xy + h.xx * s.xy + h.xy * s.yy,
          s.xy + h.yx * s.xx + h.yy * s.xy, s.yy + h.yx * s.xy + h.yy * s.yy};
}

}  // namespace apothem
