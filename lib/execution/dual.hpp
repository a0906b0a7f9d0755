// Numbers that carry derivatives (forward differentiation): a kernel that is a template of its
// number type gives, with these in place of doubles, its values and their exact derivatives. So no
// law is written twice, and a tangent cannot disagree with its force.
#pragma once

#include <limits>

#include "lib/execution/pack.hpp"

namespace apothem {

/// A number and its derivatives by `n` variables. Comparisons look at the number alone, so that a
/// kernel takes the branches that it takes with doubles.
template <int n>
struct Dual {
  double v = 0;                 ///< the number
  PackOf<n> d = PackOf<n>(0.);  ///< its derivatives

  Dual() = default;
  APOTHEM_INLINE Dual(double value) : v(value), d(0.) {}  // NOLINT: constants mix with duals
  APOTHEM_INLINE Dual(double value, const PackOf<n>& derivatives) : v(value), d(derivatives) {}
  /// The variable with this number.
  static APOTHEM_INLINE Dual variable(double value, int number) {
    Dual x(value);
    x.d.v[number] = 1;
    return x;
  }

  friend APOTHEM_INLINE Dual operator+(const Dual& a, const Dual& b) {
    return {a.v + b.v, a.d + b.d};
  }
  friend APOTHEM_INLINE Dual operator-(const Dual& a, const Dual& b) {
    return {a.v - b.v, a.d - b.d};
  }
  friend APOTHEM_INLINE Dual operator*(const Dual& a, const Dual& b) {
    return {a.v * b.v, PackOf<n>(a.v) * b.d + PackOf<n>(b.v) * a.d};
  }
  friend APOTHEM_INLINE Dual operator/(const Dual& a, const Dual& b) {
    const double quotient = a.v / b.v;
    return {quotient, (a.d - PackOf<n>(quotient) * b.d) / PackOf<n>(b.v)};
  }
  friend APOTHEM_INLINE Dual operator-(const Dual& a) { return {-a.v, -a.d}; }
  APOTHEM_INLINE Dual& operator+=(const Dual& b) { return *this = *this + b; }
  APOTHEM_INLINE Dual& operator-=(const Dual& b) { return *this = *this - b; }
  APOTHEM_INLINE Dual& operator/=(const Dual& b) { return *this = *this / b; }
  friend APOTHEM_INLINE bool operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend APOTHEM_INLINE bool operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend APOTHEM_INLINE bool operator<=(const Dual& a, const Dual& b) { return a.v <= b.v; }
  friend APOTHEM_INLINE bool operator>=(const Dual& a, const Dual& b) { return a.v >= b.v; }
  friend APOTHEM_INLINE bool operator==(const Dual& a, const Dual& b) { return a.v == b.v; }
};

/// The root of 0 has no derivative: not a number.
template <int n>
APOTHEM_INLINE Dual<n> square_root(const Dual<n>& a) {
  const double root = std::sqrt(a.v);
  return {root, a.d / PackOf<n>(2 * root)};
}
template <int n>
APOTHEM_INLINE double real_part(const Dual<n>& a) {
  return a.v;
}
// The names by which kernels call the functions of other number types.
template <int n>
Dual<n> sqrt(const Dual<n>& a) {
  return square_root(a);
}
template <int n>
Dual<n> abs(const Dual<n>& a) {
  return a.v < 0 ? -a : a;
}
template <int n>
Dual<n> asinh(const Dual<n>& a) {
  return {std::asinh(a.v), a.d / PackOf<n>(std::sqrt(1 + a.v * a.v))};
}

}  // namespace apothem

template <int n>
struct std::numeric_limits<apothem::Dual<n>> : std::numeric_limits<double> {
  static apothem::Dual<n> infinity() { return std::numeric_limits<double>::infinity(); }
};
