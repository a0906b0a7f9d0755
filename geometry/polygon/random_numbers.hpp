// Random numbers that are the same on every platform: the standard fixes the generator, but not its
// distributions.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "lib/execution/elementary.hpp"

namespace apothem {

class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : generator_(seed) {}

  /// Uniform in [from, to).
  double uniform(double from, double to) {
    return from + (to - from) * (static_cast<double>(generator_() >> 11U) * 0x1p-53);
  }
  /// A whole number, uniform in [from, to].
  int whole(int from, int to) {
    return std::min(to, from + static_cast<int>(uniform(0, static_cast<double>(to - from) + 1)));
  }
  /// Of the normal distribution with mean 0 and standard deviation 1, by the polar form of Box and
  /// Muller (G. Marsaglia, T. A. Bray, SIAM Review 6 (1964) 260-264).
  double normal() {
    while (true) {
      const double x = uniform(-1, 1), y = uniform(-1, 1), s = x * x + y * y;
      if (s > 0 && s < 1) return x * std::sqrt(-2 * natural_logarithm(s) / s);
    }
  }

 protected:
  std::mt19937_64 generator_;
};

}  // namespace apothem
