#include "lib/execution/elementary.hpp"

#include <sleef.h>

#include <utility>

namespace apothem {
namespace {

// C. F. Borges, An improved algorithm for hypot(a, b), arXiv:1904.09481 (2019), without fused
// operations: what the square root of the rounded sum misses is found from differences that have
// no rounding error, and put right by one step of Newton's method. x >= y >= 0, and squares of x
// neither overflow nor underflow.
double corrected_root(double x, double y) {
  const double h = std::sqrt(x * x + y * y);
  double first, second;  // their sum is h^2 - x^2 - y^2
  if (h <= 2 * y) {
    const double beyond = h - y;
    first = x * (2 * beyond - x);
    second = (beyond - 2 * (x - y)) * beyond;
  } else {
    const double beyond = h - x;
    first = 2 * beyond * (x - 2 * y);
    second = (4 * beyond - y) * y + beyond * beyond;
  }
  return h - (first + second) / (2 * h);
}

}  // namespace

SineCosine sine_cosine(double angle) {
  const Sleef_double_2 both = Sleef_cinz_sincosd1_u10purec(angle);
  return {both.x, both.y};
}

std::array<SineCosine, 2> sine_cosine(const std::array<double, 2>& angles) {
#if defined(__x86_64__)
  const Sleef___m128d_2 both = Sleef_cinz_sincosd2_u10sse2(_mm_loadu_pd(angles.data()));
  return {{{both.x[0], both.y[0]}, {both.x[1], both.y[1]}}};
#else
  return {sine_cosine(angles[0]), sine_cosine(angles[1])};
#endif
}

double tangent(double angle) { return Sleef_cinz_tand1_u10purec(angle); }
double arc_sine(double x) { return Sleef_cinz_asind1_u10purec(x); }
double arc_tangent(double y, double x) { return Sleef_cinz_atan2d1_u10purec(y, x); }
double exponential(double x) { return Sleef_cinz_expd1_u10purec(x); }
double natural_logarithm(double x) { return Sleef_cinz_logd1_u10purec(x); }
double power(double x, double y) { return Sleef_cinz_powd1_u10purec(x, y); }
double cube_root(double x) { return Sleef_cinz_cbrtd1_u10purec(x); }

double hypotenuse(double x, double y) {
  double larger = std::abs(x), smaller = std::abs(y);
  if (larger < smaller) std::swap(larger, smaller);
  if (std::isinf(larger) || std::isinf(smaller)) return HUGE_VAL;
  if (!(smaller > 0) || std::isnan(larger)) return larger + smaller;
  constexpr double kLarge = 0x1p+500, kSmall = 0x1p-450, kScale = 0x1p-600;
  if (larger > kLarge) return corrected_root(larger * kScale, smaller * kScale) / kScale;
  if (larger < kSmall) return corrected_root(larger / kScale, smaller / kScale) * kScale;
  return corrected_root(larger, smaller);
}

double inverse_hyperbolic_sine(double x) {
  constexpr double kSquareLost = 1e8;  // from here on sqrt(x^2 + 1) is x
  constexpr double kLogarithmOfTwo = 0.69314718055994530942;
  if (!(std::abs(x) > kSquareLost)) return Sleef_cinz_asinhd1_u10purec(x);
  return std::copysign(natural_logarithm(std::abs(x)) + kLogarithmOfTwo, x);
}

}  // namespace apothem
