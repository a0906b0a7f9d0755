// Numbers that carry derivatives by a few of very many variables (forward differentiation, see
// dual.hpp), for laws in which neighbours take part whose number is not known in advance.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "lib/execution/pack.hpp"

namespace apothem {

/// A number and its derivatives by the variables that it depends on. Comparisons look at the number
/// alone, so that a law takes the branches that it takes with doubles.
class SparseDual {
 public:
  struct Derivative {
    std::int32_t variable;
    double value;
  };

  SparseDual(double value = 0) : value_(value) {}  // NOLINT: constants mix with duals
  /// The variable with this number.
  static SparseDual variable(double value, std::int32_t number) {
    SparseDual x(value);
    x.derivatives_.push_back({number, 1});
    return x;
  }

  [[nodiscard]] double value() const { return value_; }
  /// In ascending order of the variables.
  [[nodiscard]] const std::vector<Derivative>& derivatives() const { return derivatives_; }

  friend SparseDual operator+(const SparseDual& a, const SparseDual& b) {
    return {a.value_ + b.value_, a, 1, b, 1};
  }
  friend SparseDual operator-(const SparseDual& a, const SparseDual& b) {
    return {a.value_ - b.value_, a, 1, b, -1};
  }
  friend SparseDual operator*(const SparseDual& a, const SparseDual& b) {
    return {a.value_ * b.value_, a, b.value_, b, a.value_};
  }
  friend SparseDual operator/(const SparseDual& a, const SparseDual& b) {
    const double quotient = a.value_ / b.value_;
    return {quotient, a, 1 / b.value_, b, -quotient / b.value_};
  }
  friend SparseDual operator-(const SparseDual& a) { return SparseDual(0.) - a; }
  SparseDual& operator+=(const SparseDual& b) { return *this = *this + b; }
  friend bool operator<(const SparseDual& a, const SparseDual& b) { return a.value_ < b.value_; }
  friend bool operator>(const SparseDual& a, const SparseDual& b) { return a.value_ > b.value_; }
  friend bool operator==(const SparseDual& a, const SparseDual& b) { return a.value_ == b.value_; }
  /// The root of 0 has no derivative: not a number.
  friend SparseDual square_root(const SparseDual& a) {
    const double root = std::sqrt(a.value_);
    return {root, a, 1 / (2 * root), SparseDual(), 0};
  }
  friend double real_part(const SparseDual& a) { return a.value_; }

 private:
  // The number with k times the derivatives of a and l times those of b.
  SparseDual(double value, const SparseDual& a, double k, const SparseDual& b, double l)
      : value_(value) {
    derivatives_.reserve(a.derivatives_.size() + b.derivatives_.size());
    auto i = a.derivatives_.begin();
    auto j = b.derivatives_.begin();
    while (i != a.derivatives_.end() || j != b.derivatives_.end()) {
      const bool of_a =
          j == b.derivatives_.end() || (i != a.derivatives_.end() && i->variable <= j->variable);
      const bool of_b =
          i == a.derivatives_.end() || (j != b.derivatives_.end() && j->variable <= i->variable);
      const std::int32_t variable = of_a ? i->variable : j->variable;
      double sum = 0;
      if (of_a) sum += k * (i++)->value;
      if (of_b) sum += l * (j++)->value;
      derivatives_.push_back({variable, sum});
    }
  }

  double value_;
  std::vector<Derivative> derivatives_;
};

}  // namespace apothem
