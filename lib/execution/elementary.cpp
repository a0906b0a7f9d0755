#include "apothem/execution/elementary.hpp"

#include <sleef.h>

namespace apothem {

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
double arc_tangent(double y, double x) { return Sleef_cinz_atan2d1_u10purec(y, x); }
double exponential(double x) { return Sleef_cinz_expd1_u10purec(x); }
double natural_logarithm(double x) { return Sleef_cinz_logd1_u10purec(x); }
double power(double x, double y) { return Sleef_cinz_powd1_u10purec(x, y); }
double cube_root(double x) { return Sleef_cinz_cbrtd1_u10purec(x); }

double inverse_hyperbolic_sine(double x) {
  constexpr double kSquareLost = 1e8;  // from here on sqrt(x^2 + 1) is x
  constexpr double kLogarithmOfTwo = 0.69314718055994530942;
  if (!(std::abs(x) > kSquareLost)) return Sleef_cinz_asinhd1_u10purec(x);
  return std::copysign(natural_logarithm(std::abs(x)) + kLogarithmOfTwo, x);
}

}  // namespace apothem
