// Estimates from repeated runs, each with its 95 % interval. What cannot be estimated is NaN.
#pragma once

#include <cstddef>
#include <vector>

namespace apothem {

/// Holds the true value with a probability of 95 %.
struct Interval {
  double low, high;
};

/// The mean of a normal distribution. With s^2 = sum (x - mean)^2 / (n - 1):
///   standard error = s / sqrt(n),  interval = mean -+ t(0.975; n - 1) s / sqrt(n),
/// where t is the quantile of Student's distribution (Student, Biometrika 6, 1908, 1-25).
struct MeanEstimate {
  size_t n;
  double mean;            ///< NaN for no values
  double standard_error;  ///< NaN for fewer than two values, as is the interval
  Interval interval;
};
MeanEstimate estimate_mean(const std::vector<double>& values);

/// The probability p of an event that was seen `count` times in `n` trials, with the interval of
/// Wilson (J. Am. Stat. Assoc. 22, 1927, 209-212): the p for which the count is within z = 1.96
/// standard deviations, with x = count / n:
///   (x + z^2 / 2n -+ z sqrt(x (1 - x) / n + z^2 / 4n^2)) / (1 + z^2 / n)
struct ProportionEstimate {
  size_t n, count;
  double proportion;  ///< NaN for no trials, as is the interval
  Interval interval;
};
ProportionEstimate estimate_proportion(size_t count, size_t n);

/// The probability, if both proportions are the same, of these counts or of less likely ones with
/// the same sums: the two-sided exact test of Fisher (J. R. Stat. Soc. 85, 1922, 87-94). 1 without
/// trials.
double same_proportion(size_t count, size_t n, size_t other_count, size_t other_n);

/// The rate of an exponential distribution of survival, exp(-rate x). With d events in a total
/// exposure T = sum x, of the censored ones too, the rate of maximum likelihood is d / T, and
///   interval = chi2(0.025; 2 d) / 2T  to  chi2(0.975; 2 d + 2) / 2T.
/// The upper end has 2 d degrees of freedom if no value is censored: then the interval is exact;
/// with values censored at fixed exposures it is slightly too wide. (J. F. Lawless, Statistical
/// Models and Methods for Lifetime Data, 2nd ed., Wiley 2003, sec. 4.1.)
struct RateEstimate {
  size_t n, events;
  double exposure;  ///< T, in the unit of the values
  double rate;      ///< in its inverse; NaN without exposure, as is the interval
  Interval interval;
};
/// A value that ended with the event, or that was censored before it.
struct Survival {
  double exposure;  ///< 0 or more
  bool event;
};
RateEstimate estimate_rate(const std::vector<Survival>& values);

}  // namespace apothem
