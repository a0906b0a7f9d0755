// Private header: a number that counts the operations done with it. A kernel that is a template of
// its number type tells so how many operations it needs: additions, subtractions, multiplications,
// divisions and square roots count 1; comparisons and signs do not count.
#pragma once

#include <compare>

namespace apothem {

struct Counted {
  double x = 0;
  static inline long operations = 0;

  Counted() = default;
  Counted(double value) : x(value) {}  // NOLINT: plain numbers mix with counted ones

  friend Counted operator+(const Counted& a, const Counted& b) { return counted(a.x + b.x); }
  friend Counted operator-(const Counted& a, const Counted& b) { return counted(a.x - b.x); }
  friend Counted operator*(const Counted& a, const Counted& b) { return counted(a.x * b.x); }
  friend Counted operator/(const Counted& a, const Counted& b) { return counted(a.x / b.x); }
  friend Counted operator-(const Counted& a) { return {-a.x}; }
  Counted& operator+=(const Counted& b) { return *this = *this + b; }
  Counted& operator-=(const Counted& b) { return *this = *this - b; }
  Counted& operator*=(const Counted& b) { return *this = *this * b; }
  friend auto operator<=>(const Counted& a, const Counted& b) = default;

 private:
  static Counted counted(double value) {
    ++operations;
    return {value};
  }
};

inline double real_part(const Counted& a) { return a.x; }

}  // namespace apothem
