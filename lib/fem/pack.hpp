// Eight doubles at a time. One kernel source serves scalars, packs, complex and long double.
//
// The compiler's vector extension maps a pack to one AVX-512 register, two of AVX or four of SSE2;
// each lane rounds like a scalar, so the results have the same bits on all of them
// (-ffp-contract=off).
#pragma once

#include <cmath>
#include <complex>

// A kernel is compiled once per instruction set; what it calls must dissolve into it.
#define APOTHEM_INLINE inline __attribute__((always_inline))

namespace apothem {

inline constexpr int kLanes = 8;

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

APOTHEM_INLINE Pack square_root(const Pack& a) {
  Pack r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = std::sqrt(a.v[i]);
  return r;
}
APOTHEM_INLINE double square_root(double a) { return std::sqrt(a); }
APOTHEM_INLINE long double square_root(long double a) { return std::sqrt(a); }
inline std::complex<double> square_root(const std::complex<double>& a) { return std::sqrt(a); }

/// What an element keeps, a column of kLanes per number: read as a pack, or for one lane as any
/// other number.
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
