// Arithmetic on packs of eight doubles (SIMD). A kernel that is a template of its number type can
// be used with scalars, packs, complex numbers and long double.
//
// The compiler's vector extension maps a pack to one AVX-512 register, to two AVX registers or to
// four SSE2 registers. Each lane rounds like a scalar, because the code is compiled with
// -ffp-contract=off; hence the results have the same bits with all of these instruction sets.
#pragma once

#include <cmath>
#include <complex>

// Forces inlining. A kernel is compiled once per instruction set, and every function that it calls
// has to be inlined, so that it is compiled for the same instruction set.
#define APOTHEM_INLINE inline __attribute__((always_inline))

namespace apothem {

/// Number of doubles in a pack.
inline constexpr int kLanes = 8;

/// kLanes doubles with elementwise arithmetic. A default-constructed pack is not initialised.
struct Pack {
  using Vector = double __attribute__((vector_size(8 * kLanes)));
  Vector v;

  Pack() = default;
  APOTHEM_INLINE Pack(double x) : v{x, x, x, x, x, x, x, x} {}  // NOLINT: scalars mix with packs
  APOTHEM_INLINE explicit Pack(Vector x) : v(x) {}

  friend APOTHEM_INLINE Pack operator+(const Pack& a, const Pack& b) { return Pack(a.v + b.v); }
  friend APOTHEM_INLINE Pack operator-(const Pack& a, const Pack& b) { return Pack(a.v - b.v); }
  friend APOTHEM_INLINE Pack operator*(const Pack& a, const Pack& b) { return Pack(a.v * b.v); }
  friend APOTHEM_INLINE Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }
  friend APOTHEM_INLINE Pack operator-(const Pack& a) { return Pack(-a.v); }
  APOTHEM_INLINE Pack& operator+=(const Pack& b) {
    v += b.v;
    return *this;
  }
};

/// Square root of a number of any type that kernels use; of a pack, the square root of every lane.
APOTHEM_INLINE Pack square_root(const Pack& a) {
  Pack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = std::sqrt(a.v[i]);
  return r;
}
APOTHEM_INLINE double square_root(double a) { return std::sqrt(a); }
APOTHEM_INLINE long double square_root(long double a) { return std::sqrt(a); }
inline std::complex<double> square_root(const std::complex<double>& a) { return std::sqrt(a); }

/// Read access to the numbers that kLanes finite elements keep. Number k of these elements is
/// stored in the kLanes consecutive doubles from base + k * kLanes. A pack reads all of them. Any
/// other number type reads the first of them; to read another element, `base` is shifted to its
/// lane.
template <class Number>
struct Stored {
  const double* base;
  APOTHEM_INLINE Number operator[](int k) const { return Number(base[k * kLanes]); }
};
template <>
struct Stored<Pack> {
  const double* base;
  APOTHEM_INLINE Pack operator[](int k) const {
    return Pack(*reinterpret_cast<const Pack::Vector*>(base + k * kLanes));
  }
};

}  // namespace apothem
