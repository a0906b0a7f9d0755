// Elementary functions against those of the C library in extended precision.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "lib/execution/elementary.hpp"

using namespace apothem;

namespace {

// In units of the last place of the exact value, which is normal.
double error(double value, long double exact) {
  const double place = std::nextafter(std::abs(static_cast<double>(exact)), HUGE_VAL) -
                       std::abs(static_cast<double>(exact));
  return static_cast<double>(std::abs(value - exact) / place);
}

// Of either sign, evenly over the powers of ten.
template <class F>
void each_number(double smallest_power, double largest_power, const F& f) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> exponent(smallest_power, largest_power), mantissa(1, 10);
  for (int i = 0; i < 20000; ++i) {
    const double size = mantissa(engine) * std::pow(10, exponent(engine));
    f(i % 2 == 0 ? size : -size);
  }
}

constexpr double kBound = 1.01;  // units in the last place, with the rounding of the reference

}  // namespace

TEST_CASE("inverse hyperbolic sine is right to the last digit for numbers of any size") {
  double worst = 0;
  each_number(-300, 306, [&](double x) {
    worst = std::max(worst, error(inverse_hyperbolic_sine(x), std::asinh((long double)x)));
  });
  each_number(-3, 12, [&](double x) {
    worst = std::max(worst, error(inverse_hyperbolic_sine(x), std::asinh((long double)x)));
  });
  CHECK(worst < kBound);
  CHECK(inverse_hyperbolic_sine(0.) == 0);
  CHECK(inverse_hyperbolic_sine(std::numeric_limits<double>::max()) == Approx(710.4758600739439));
  CHECK(std::isnan(inverse_hyperbolic_sine(std::nan(""))));
}

TEST_CASE("sine, cosine, tangent, exponential, logarithm and roots are right to the last digit") {
  double worst = 0;
  const auto look = [&](double value, long double exact) {
    worst = std::max(worst, error(value, exact));
  };
  each_number(-8, 4, [&](double x) {
    const auto fine = static_cast<long double>(x);
    look(sine_cosine(x).sine, std::sin(fine));
    look(sine_cosine(x).cosine, std::cos(fine));
    look(tangent(x), std::tan(fine));
    look(cube_root(x), std::cbrt(fine));
    look(arc_tangent(x, 1.), std::atan2(fine, 1.L));
    if (std::abs(x) <= 1) look(arc_sine(x), std::asin(fine));
    look(arc_tangent(1., x), std::atan2(1.L, fine));
    look(natural_logarithm(std::abs(x)), std::log(std::abs(fine)));
    if (std::abs(x) < 700) look(exponential(x), std::exp(fine));
    if (std::abs(x) < 100) look(power(1.5, x), std::pow(1.5L, fine));
  });
  CHECK(worst < kBound);
}

TEST_CASE("the hypotenuse is right to the last digit for numbers of any size") {
  double worst = 0;
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> ratio(0, 2);
  each_number(-290, 300, [&](double x) {
    const double y = x * ratio(engine);
    worst = std::max(worst, error(hypotenuse(x, y), std::hypot((long double)x, (long double)y)));
  });
  CHECK(worst < .6);  // correctly rounded results have .5
  const double huge = std::numeric_limits<double>::max();
  const double tiny = std::numeric_limits<double>::denorm_min();
  CHECK(hypotenuse(3, -4) == 5);
  CHECK(hypotenuse(-0x1p1000, 0) == 0x1p1000);
  CHECK(hypotenuse(3 * 0x1p1000, 4 * 0x1p1000) == 5 * 0x1p1000);
  CHECK(hypotenuse(3 * tiny, 4 * tiny) == 5 * tiny);
  CHECK(hypotenuse(1, tiny) == 1);
  CHECK(hypotenuse(0, 0) == 0);
  CHECK(hypotenuse(huge, huge) == HUGE_VAL);
  CHECK(hypotenuse(std::nan(""), -HUGE_VAL) == HUGE_VAL);
  CHECK(std::isnan(hypotenuse(std::nan(""), 1)));
  CHECK(std::isnan(hypotenuse(0, std::nan(""))));
}
