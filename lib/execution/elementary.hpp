// Elementary functions with the same bits on every processor. Those of the C library differ in the
// last digit between processors with and without fused multiplication and addition. Errors are at
// most one unit in the last place.
//
// Templates are for other number types, which take the functions of their own library.
#pragma once

#include <array>
#include <cmath>

namespace apothem {

struct SineCosine {
  double sine, cosine;
};
/// Of an angle in rad.
[[nodiscard]] SineCosine sine_cosine(double angle);
/// The same of two angles at once, with the same bits.
[[nodiscard]] std::array<SineCosine, 2> sine_cosine(const std::array<double, 2>& angles);
[[nodiscard]] double tangent(double angle);
/// sqrt(x^2 + y^2) for numbers of any size.
[[nodiscard]] double hypotenuse(double x, double y);
/// From -pi/2 to pi/2.
[[nodiscard]] double arc_sine(double x);
/// Angle of the direction (x, y), from -pi to pi.
[[nodiscard]] double arc_tangent(double y, double x);
template <class N>
[[nodiscard]] N arc_tangent(const N& y, const N& x) {
  using std::atan2;
  return atan2(y, x);
}
[[nodiscard]] double exponential(double x);
/// Natural logarithm.
[[nodiscard]] double natural_logarithm(double x);
/// x to the power y.
[[nodiscard]] double power(double x, double y);
[[nodiscard]] double cube_root(double x);
[[nodiscard]] double inverse_hyperbolic_sine(double x);
template <class N>
[[nodiscard]] N inverse_hyperbolic_sine(const N& x) {
  using std::asinh;
  return asinh(x);
}

}  // namespace apothem
