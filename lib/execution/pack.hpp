// Arithmetic on packs of doubles (SIMD). A kernel that is a template of its number type can be used
// with scalars, packs, complex numbers and long double.
//
// The compiler's vector extension maps a pack to as many registers as it needs: a pack of eight to
// one AVX-512 register, to two AVX registers or to four SSE2 registers. Each lane rounds like a
// scalar, because the code is compiled with -ffp-contract=off; hence the results have the same bits
// with all of these instruction sets.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <utility>

// Forces inlining. A kernel is compiled once per instruction set, and every function that it calls
// has to be inlined, so that it is compiled for the same instruction set. Under the sanitizers
// there is one version (dispatch.hpp), and kernels that are not inlined compile in a third of the
// time. APOTHEM_LAMBDA is the same for a lambda, behind its parameters.
#ifdef __SANITIZE_ADDRESS__
#define APOTHEM_INLINE inline
#define APOTHEM_LAMBDA
#else
#define APOTHEM_INLINE inline __attribute__((always_inline))
#define APOTHEM_LAMBDA __attribute__((always_inline))
#endif

namespace apothem {

/// One truth value for each lane of a pack.
template <int lanes>
struct MaskOf {
  // GCC forgets the attribute of an alias that depends on a parameter.
  typedef std::int64_t Vector
      __attribute__((vector_size(8 * lanes)));  // NOLINT(modernize-use-using)
  Vector m;                                     ///< all bits or none

  friend APOTHEM_INLINE MaskOf operator&(const MaskOf& a, const MaskOf& b) { return {a.m & b.m}; }
  friend APOTHEM_INLINE MaskOf operator|(const MaskOf& a, const MaskOf& b) { return {a.m | b.m}; }
  friend APOTHEM_INLINE MaskOf operator!(const MaskOf& a) { return {~a.m}; }
};

/// Doubles with elementwise arithmetic. A default-constructed pack is not initialised. Compiled for
/// wide registers, code relies on the alignment, which the vector type alone has there only.
template <int lanes>
struct alignas(8 * lanes) PackOf {
  typedef double Vector __attribute__((vector_size(8 * lanes)));  // NOLINT(modernize-use-using)
  using Mask = MaskOf<lanes>;
  Vector v;

  PackOf() = default;
  APOTHEM_INLINE PackOf(double x) : v(x - Vector{}) {}  // NOLINT: scalars mix with packs
  APOTHEM_INLINE explicit PackOf(const Vector& x) : v(x) {}
  /// The doubles from `from` on, which need not be aligned.
  static APOTHEM_INLINE PackOf load(const double* from) {
    PackOf result;
    std::memcpy(&result.v, from, sizeof(result.v));
    return result;
  }
  APOTHEM_INLINE void store(double* to) const { std::memcpy(to, &v, sizeof(v)); }

  friend APOTHEM_INLINE PackOf operator+(const PackOf& a, const PackOf& b) {
    return PackOf(a.v + b.v);
  }
  friend APOTHEM_INLINE PackOf operator-(const PackOf& a, const PackOf& b) {
    return PackOf(a.v - b.v);
  }
  friend APOTHEM_INLINE PackOf operator*(const PackOf& a, const PackOf& b) {
    return PackOf(a.v * b.v);
  }
  friend APOTHEM_INLINE PackOf operator/(const PackOf& a, const PackOf& b) {
    return PackOf(a.v / b.v);
  }
  friend APOTHEM_INLINE PackOf operator-(const PackOf& a) { return PackOf(-a.v); }
  APOTHEM_INLINE PackOf& operator+=(const PackOf& b) {
    v += b.v;
    return *this;
  }
  friend APOTHEM_INLINE Mask operator<(const PackOf& a, const PackOf& b) { return {a.v < b.v}; }
  friend APOTHEM_INLINE Mask operator>(const PackOf& a, const PackOf& b) { return {a.v > b.v}; }
  friend APOTHEM_INLINE Mask operator<=(const PackOf& a, const PackOf& b) { return {a.v <= b.v}; }
  friend APOTHEM_INLINE Mask operator>=(const PackOf& a, const PackOf& b) { return {a.v >= b.v}; }
  friend APOTHEM_INLINE Mask operator==(const PackOf& a, const PackOf& b) { return {a.v == b.v}; }
};

/// How many numbers a number type holds.
template <class Real>
inline constexpr int lanes_of = 1;
template <int lanes>
inline constexpr int lanes_of<PackOf<lanes>> = lanes;

/// Number of doubles in the widest pack.
inline constexpr int kLanes = 8;
/// The same for kernels that compare much: compilers compare packs of eight lane by lane.
inline constexpr int kComparedLanes = 4;

/// What a comparison of numbers of this type gives.
template <class Real>
using Truth = decltype(std::declval<const Real&>() < std::declval<const Real&>());

/// In each lane `a` where the mask is true, else `b`.
template <int lanes>
APOTHEM_INLINE PackOf<lanes> select(const MaskOf<lanes>& mask, const PackOf<lanes>& a,
                                    const PackOf<lanes>& b) {
  return PackOf<lanes>(mask.m ? a.v : b.v);
}
template <class Real>
APOTHEM_INLINE Real select(bool mask, const Real& a, const Real& b) {
  return mask ? a : b;
}
template <int lanes>
APOTHEM_INLINE MaskOf<lanes> select(const MaskOf<lanes>& mask, const MaskOf<lanes>& a,
                                    const MaskOf<lanes>& b) {
  return (mask & a) | ((!mask) & b);
}
/// True if the mask is true in any lane.
APOTHEM_INLINE bool any(const MaskOf<4>& mask) {
  using Half = std::int64_t __attribute__((vector_size(16)));
  const Half low = __builtin_shufflevector(mask.m, mask.m, 0, 1);
  const Half both = low | __builtin_shufflevector(mask.m, mask.m, 2, 3);
  return (both[0] | both[1]) != 0;
}
APOTHEM_INLINE bool any(bool mask) { return mask; }
/// Bit k is set where lane k of the mask is true.
APOTHEM_INLINE unsigned bits(const MaskOf<4>& mask) {
#if defined(__x86_64__)
  using Pair = double __attribute__((vector_size(16)));
  const auto low = __builtin_shufflevector(mask.m, mask.m, 0, 1);
  const auto high = __builtin_shufflevector(mask.m, mask.m, 2, 3);
  return static_cast<unsigned>(__builtin_ia32_movmskpd(reinterpret_cast<Pair>(low)) |
                               __builtin_ia32_movmskpd(reinterpret_cast<Pair>(high)) << 2);
#else
  unsigned bits = 0;
  for (int k = 0; k < 4; ++k) bits |= static_cast<unsigned>(mask.m[k] & 1) << k;
  return bits;
#endif
}

/// A pack of f(0), f(1) and so on.
template <int lanes, class F>
APOTHEM_INLINE PackOf<lanes> pack_of(const F& f) {
  static_assert(lanes == 4 || lanes == 8);
  using Vector = typename PackOf<lanes>::Vector;
  if constexpr (lanes == 4) {
    return PackOf<lanes>(Vector{f(0), f(1), f(2), f(3)});
  } else {
    return PackOf<lanes>(Vector{f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)});
  }
}

/// The absolute value.
template <int lanes>
APOTHEM_INLINE PackOf<lanes> magnitude(const PackOf<lanes>& a) {
  return select(a < PackOf<lanes>(0.), -a, a);
}
template <class Real>
APOTHEM_INLINE Real magnitude(const Real& a) {
  return a < Real(0) ? -a : a;
}

/// Square root of a number of any type that kernels use; of a pack, the square root of every lane.
template <int lanes>
APOTHEM_INLINE PackOf<lanes> square_root(const PackOf<lanes>& a) {
  PackOf<lanes> r;
#if defined(__x86_64__)
  // std::sqrt looks at every lane for a negative one, because of errno.
  using Pair = double __attribute__((vector_size(16)));
  for (int i = 0; i < lanes; i += 2) {
    const Pair root = __builtin_ia32_sqrtpd(Pair{a.v[i], a.v[i + 1]});
    r.v[i] = root[0], r.v[i + 1] = root[1];
  }
#else
  for (int i = 0; i < lanes; ++i) r.v[i] = std::sqrt(a.v[i]);
#endif
  return r;
}
APOTHEM_INLINE double square_root(double a) { return std::sqrt(a); }
APOTHEM_INLINE long double square_root(long double a) { return std::sqrt(a); }
inline std::complex<double> square_root(const std::complex<double>& a) { return std::sqrt(a); }

/// Read access to the numbers that kLanes finite elements keep. Number k of these elements is
/// stored in the kLanes consecutive doubles from base + k * kLanes. A pack reads as many of them as
/// it has lanes, any other number type the first one; to read others, `base` is shifted.
template <class Number>
struct Stored {
  const double* base;
  APOTHEM_INLINE Number operator[](int k) const { return Number(base[k * kLanes]); }
};
template <int lanes>
struct Stored<PackOf<lanes>> {
  const double* base;
  APOTHEM_INLINE PackOf<lanes> operator[](int k) const {
    return PackOf<lanes>::load(base + k * kLanes);
  }
};

/// Four numbers of any type that kernels use.
template <class Real>
using FourOf = std::array<Real, 4>;

/// Lane k of pack i becomes lane i of pack k.
APOTHEM_INLINE void transpose(const FourOf<PackOf<4>>& from, FourOf<PackOf<4>>& to) {
  PackOf<4>::Vector t[4];
  for (size_t k = 0; k < 4; k += 2) {
    t[k] = __builtin_shufflevector(from[k].v, from[k + 1].v, 0, 4, 2, 6);
    t[k + 1] = __builtin_shufflevector(from[k].v, from[k + 1].v, 1, 5, 3, 7);
  }
  for (size_t k = 0; k < 2; ++k) {
    to[k].v = __builtin_shufflevector(t[k], t[k + 2], 0, 1, 4, 5);
    to[k + 2].v = __builtin_shufflevector(t[k], t[k + 2], 2, 3, 6, 7);
  }
}

/// Reads four consecutive doubles from row(k) on for every lane k of packs; for plain numbers from
/// row(0).
template <class Row>
APOTHEM_INLINE void read_rows(const Row& row, FourOf<double>& to) {
  std::memcpy(to.data(), row(0), sizeof(to));
}
template <class Row>
APOTHEM_INLINE void read_rows(const Row& row, FourOf<PackOf<4>>& to) {
  FourOf<PackOf<4>> rows;
  for (int k = 0; k < 4; ++k) rows[static_cast<size_t>(k)] = PackOf<4>::load(row(k));
  transpose(rows, to);
}

/// Writes four consecutive doubles from row(k) on for every lane k.
template <class Row>
APOTHEM_INLINE void write_rows(const FourOf<PackOf<4>>& from, const Row& row) {
  FourOf<PackOf<4>> rows;
  transpose(from, rows);
  for (int k = 0; k < 4; ++k) rows[static_cast<size_t>(k)].store(row(k));
}

/// Reads a struct that consists of numbers alone, for a struct of packs that of(k) of every lane k;
/// for plain numbers of(0).
template <template <class> class T, class F>
APOTHEM_INLINE void gather(T<double>& to, const F& of) {
  to = of(0);
}
template <template <class> class T, class F>
APOTHEM_INLINE void gather(T<PackOf<4>>& to, const F& of) {
  constexpr size_t n = sizeof(T<double>) / sizeof(double);
  static_assert(sizeof(to) == n * sizeof(PackOf<4>));
  const auto row = [&](int k) APOTHEM_LAMBDA { return reinterpret_cast<const double*>(&of(k)); };
  std::array<PackOf<4>, n> numbers;
  for (size_t i = 0; i + 4 <= n; i += 4) {
    FourOf<PackOf<4>> four;
    read_rows([&](int k) APOTHEM_LAMBDA { return row(k) + i; }, four);
    for (size_t j = 0; j < 4; ++j) numbers[i + j] = four[j];
  }
  for (size_t i = n - n % 4; i < n; ++i) {
    numbers[i] = pack_of<4>([&](int k) APOTHEM_LAMBDA { return row(k)[i]; });
  }
  std::memcpy(static_cast<void*>(&to), numbers.data(), sizeof to);
}

/// Writes a struct that consists of packs alone: that of lane k to to(k).
template <template <class> class T, class F>
APOTHEM_INLINE void scatter(const T<PackOf<4>>& from, const F& to) {
  constexpr size_t n = sizeof(T<double>) / sizeof(double);
  static_assert(sizeof(from) == n * sizeof(PackOf<4>));
  const auto row = [&](int k) APOTHEM_LAMBDA { return reinterpret_cast<double*>(&to(k)); };
  std::array<PackOf<4>, n> numbers;
  std::memcpy(numbers.data(), static_cast<const void*>(&from), sizeof from);
  for (size_t i = 0; i + 4 <= n; i += 4) {
    write_rows({numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]},
               [&](int k) APOTHEM_LAMBDA { return row(k) + i; });
  }
  for (size_t i = n - n % 4; i < n; ++i) {
    for (int k = 0; k < 4; ++k) row(k)[i] = numbers[i].v[k];
  }
}

}  // namespace apothem
