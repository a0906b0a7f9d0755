#include "lib/contact/law/stiffness.hpp"

namespace apothem {
namespace {

constexpr double kSharp = 1e-9;  // relative error of a rate
constexpr int kMostLooks = 100;

}  // namespace

// Newton's method on the characteristic polynomial. From a start above the largest root it descends
// to this root without passing it. The eigenvalue functions of Eigen give other bits on other
// processors.
double rate_of(const BodyStiffness& k, const std::array<double, 3>& inverse_mass) {
  const auto& [wx, wy, wt] = inverse_mass;
  const double x = k.xx * wx, y = k.yy * wy, t = k.tt * wt;
  const double xy2 = k.xy * k.xy * wx * wy, xt2 = k.xt * k.xt * wx * wt,
               yt2 = k.yt * k.yt * wy * wt;
  const double sum = x + y + t;
  const double minors = (x * y - xy2) + (x * t - xt2) + (y * t - yt2);
  const double determinant =
      x * y * t + 2 * (k.xy * wx) * (k.yt * wy) * (k.xt * wt) - x * yt2 - y * xt2 - t * xy2;
  double rate = rate_bound_of(k, inverse_mass);
  for (int i = 0; i < kMostLooks; ++i) {
    const double value = ((rate - sum) * rate + minors) * rate - determinant;
    const double slope = (3 * rate - 2 * sum) * rate + minors;
    if (!(value > 0 && slope > 0)) break;
    const double step = value / slope;
    rate -= step;
    if (step < kSharp * rate) break;
  }
  return rate;
}

// The bound follows from mean and variance of the eigenvalues: the largest one is at most mean +
// sqrt(2 variance).
double rate_bound_of(const BodyStiffness& k, const std::array<double, 3>& inverse_mass) {
  const auto& [wx, wy, wt] = inverse_mass;
  const double x = k.xx * wx, y = k.yy * wy, t = k.tt * wt;
  const double mean = (x + y + t) / 3;
  const double squares =
      x * x + y * y + t * t +
      2 * (k.xy * k.xy * wx * wy + k.xt * k.xt * wx * wt + k.yt * k.yt * wy * wt);
  return mean + std::sqrt(std::max(2 * (squares / 3 - mean * mean), 0.0));
}

}  // namespace apothem
