#include "lib/sweep/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/hypergeometric.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace apothem {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kLow = 0.025, kHigh = 0.975;  // the ends of an interval of 95 %

double chi_squared(double probability, size_t degrees) {
  return boost::math::quantile(boost::math::chi_squared(static_cast<double>(degrees)), probability);
}

}  // namespace

MeanEstimate estimate_mean(const std::vector<double>& values) {
  MeanEstimate result{values.size(), kUnknown, kUnknown, {kUnknown, kUnknown}};
  if (values.empty()) return result;
  const auto n = static_cast<double>(values.size());
  double sum = 0;
  for (const double x : values) sum += x;
  result.mean = sum / n;
  if (values.size() < 2) return result;
  double squares = 0;
  for (const double x : values) squares += (x - result.mean) * (x - result.mean);
  result.standard_error = std::sqrt(squares / (n - 1) / n);
  const double t = boost::math::quantile(boost::math::students_t(n - 1), kHigh);
  result.interval = {result.mean - t * result.standard_error,
                     result.mean + t * result.standard_error};
  return result;
}

ProportionEstimate estimate_proportion(size_t count, size_t trials) {
  ProportionEstimate result{trials, count, kUnknown, {kUnknown, kUnknown}};
  if (trials == 0) return result;
  const auto n = static_cast<double>(trials);
  const double x = static_cast<double>(count) / n;
  const double z = boost::math::quantile(boost::math::normal(), kHigh);
  const double middle = x + z * z / (2 * n);
  const double half = z * std::sqrt(x * (1 - x) / n + z * z / (4 * n * n));
  const double scale = 1 + z * z / n;
  result.proportion = x;
  // The ends at 0 and 1 are exact; rounding must not lead past them.
  result.interval = {count == 0 ? 0 : (middle - half) / scale,
                     count == trials ? 1 : (middle + half) / scale};
  return result;
}

double same_proportion(size_t count, size_t n, size_t other_count, size_t other_n) {
  constexpr double kEqual = 1 + 1e-7;  // probabilities that only round-off tells apart
  const size_t events = count + other_count;
  if (n == 0 || other_n == 0) return 1;
  const boost::math::hypergeometric table(static_cast<unsigned>(events), static_cast<unsigned>(n),
                                          static_cast<unsigned>(n + other_n));
  const auto likely = [&](size_t k) { return boost::math::pdf(table, static_cast<unsigned>(k)); };
  const double here = likely(count);
  double sum = 0;
  for (size_t k = events > other_n ? events - other_n : 0; k <= std::min(n, events); ++k) {
    if (const double p = likely(k); p <= kEqual * here) sum += p;
  }
  return std::min(sum, 1.);
}

RateEstimate estimate_rate(const std::vector<Survival>& values) {
  RateEstimate result{values.size(), 0, 0, kUnknown, {kUnknown, kUnknown}};
  for (const Survival& value : values) {
    result.exposure += value.exposure;
    if (value.event) ++result.events;
  }
  if (!(result.exposure > 0)) return result;
  const size_t d = result.events;
  const bool censored = d < values.size();
  result.rate = static_cast<double>(d) / result.exposure;
  result.interval = {d == 0 ? 0 : chi_squared(kLow, 2 * d) / (2 * result.exposure),
                     chi_squared(kHigh, censored ? 2 * d + 2 : 2 * d) / (2 * result.exposure)};
  return result;
}

}  // namespace apothem
