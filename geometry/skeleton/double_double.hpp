// Numbers with about 32 decimal digits: the unevaluated sum of two doubles (Dekker 1971). They cost
// about 20 operations of doubles each. This header is private to the construction of the straight
// skeleton.
#pragma once

#include <cmath>

namespace apothem {

/// The sum hi + lo, where |lo| is at most half a unit in the last place of hi. It needs round to
/// nearest and no contraction of products and sums; values beyond 1e290 overflow.
struct DoubleDouble {
  double hi = 0, lo = 0;

  constexpr DoubleDouble() = default;
  constexpr DoubleDouble(double value) : hi(value) {}  // NOLINT: implicit like double itself

  /// The exact sum of two doubles.
  static DoubleDouble sum(double a, double b) {
    const double s = a + b;
    const double shadow = s - a;
    return {s, (a - (s - shadow)) + (b - shadow)};
  }
  /// The exact product of two doubles.
  static DoubleDouble product(double a, double b) {
    const double p = a * b;
    const auto [a1, a2] = halves(a);
    const auto [b1, b2] = halves(b);
    return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
  }

  explicit operator double() const { return hi + lo; }
  DoubleDouble operator-() const { return {-hi, -lo}; }

  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    DoubleDouble s = sum(a.hi, b.hi);
    const DoubleDouble t = sum(a.lo, b.lo);
    s = ordered_sum(s.hi, s.lo + t.hi);
    return ordered_sum(s.hi, s.lo + t.lo);
  }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + (-b); }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble p = product(a.hi, b.hi);
    return ordered_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
  }
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.hi / b.hi;
    DoubleDouble rest = a - b * first;
    const double second = rest.hi / b.hi;
    rest = rest - b * second;
    return ordered_sum(first, second) + rest.hi / b.hi;
  }
  friend bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
    return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
  }
  friend bool operator>(const DoubleDouble& a, const DoubleDouble& b) { return b < a; }
  friend bool operator==(const DoubleDouble& a, const DoubleDouble& b) = default;

 private:
  constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}
  struct Halves {
    double high, low;
  };
  static Halves halves(double a) {
    const double t = 134217729.0 * a;  // 2^27 + 1
    const double high = t - (t - a);
    return {high, a - high};
  }
  static DoubleDouble ordered_sum(double a, double b) {  // |a| >= |b|, or a = 0
    const double s = a + b;
    return {s, b - (s - a)};
  }
};

/// The magnitude of a number.
inline DoubleDouble abs(const DoubleDouble& a) { return a.hi < 0 ? -a : a; }

/// The square root of a number that is not negative.
inline DoubleDouble sqrt(const DoubleDouble& a) {
  if (!(a.hi > 0)) return {};
  DoubleDouble root = std::sqrt(a.hi);
  for (int i = 0; i < 2; ++i) root = (root + a / root) * 0.5;
  return root;
}

/// A point or a vector of the plane with double-double coordinates.
struct FineVec {
  DoubleDouble x, y;
  friend FineVec operator+(const FineVec& a, const FineVec& b) { return {a.x + b.x, a.y + b.y}; }
  friend FineVec operator-(const FineVec& a, const FineVec& b) { return {a.x - b.x, a.y - b.y}; }
  friend FineVec operator*(const DoubleDouble& s, const FineVec& a) { return {s * a.x, s * a.y}; }
  [[nodiscard]] DoubleDouble dot(const FineVec& b) const { return x * b.x + y * b.y; }
};

/// The z component of the cross product a x b.
inline DoubleDouble cross(const FineVec& a, const FineVec& b) { return a.x * b.y - a.y * b.x; }

}  // namespace apothem
