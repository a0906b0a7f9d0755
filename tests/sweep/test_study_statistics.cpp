// Estimates and intervals against published values, and the share of intervals that hold the true
// value.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "lib/sweep/statistics.hpp"

using namespace apothem;

namespace {

Survival died(double exposure) { return {exposure, true}; }
Survival lost(double exposure) { return {exposure, false}; }

}  // namespace

// Student's own example, the additional hours of sleep gained with a drug (Biometrika 6, 1908):
// mean 0.75, s = 1.789; t(0.975; 9) = 2.262157.
TEST_CASE("mean, standard error and t interval of Student's example", "[sweep]") {
  const MeanEstimate e = estimate_mean({0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0});
  CHECK(e.n == 10);
  CHECK(e.mean == Approx(0.75).epsilon(1e-14));
  CHECK(e.standard_error == Approx(1.789010 / std::sqrt(10)).epsilon(1e-6));
  CHECK(e.interval.low == Approx(-0.5297804).epsilon(1e-6));
  CHECK(e.interval.high == Approx(2.0297804).epsilon(1e-6));
}

TEST_CASE("t intervals of few values", "[sweep]") {
  const MeanEstimate two = estimate_mean({1, 3});  // t(0.975; 1) = 12.7062
  CHECK(two.interval.low == Approx(2 - 12.7062).epsilon(1e-6));
  const MeanEstimate one = estimate_mean({5});
  CHECK(one.n == 1);
  CHECK(one.mean == 5);
  CHECK(std::isnan(one.standard_error));
  CHECK(std::isnan(one.interval.high));
  CHECK(std::isnan(estimate_mean({}).mean));
  const MeanEstimate equal = estimate_mean({2, 2, 2});
  CHECK(equal.standard_error == 0);
  CHECK(equal.interval.low == 2);
}

// R. G. Newcombe, Statistics in Medicine 17 (1998), table I, method 3: 81/263, 15/148, 0/20, 1/29.
TEST_CASE("Wilson's interval against published values", "[sweep]") {
  struct Case {
    size_t count, n;
    double low, high;
  };
  for (const Case& c : {Case{81, 263, 0.2553, 0.3662},
                        {15, 148, 0.0624, 0.1605},
                        {0, 20, 0, 0.1611},
                        {1, 29, 0.0061, 0.1718},
                        {8, 10, 0.4902, 0.9433}}) {
    const ProportionEstimate e = estimate_proportion(c.count, c.n);
    INFO(c.count << " of " << c.n);
    CHECK(e.proportion == static_cast<double>(c.count) / static_cast<double>(c.n));
    CHECK(e.interval.low == Approx(c.low).margin(5e-5));
    CHECK(e.interval.high == Approx(c.high).margin(5e-5));
  }
  CHECK(estimate_proportion(0, 7).interval.low == 0);
  CHECK(estimate_proportion(7, 7).interval.high == 1);
  CHECK(estimate_proportion(7, 7).interval.low ==
        Approx(1 - estimate_proportion(0, 7).interval.high).epsilon(1e-12));
  CHECK(std::isnan(estimate_proportion(0, 0).proportion));
}

// chi2(0.025; 10) = 3.24697, chi2(0.975; 10) = 20.4832, chi2(0.975; 12) = 23.3367 and
// chi2(0.975; 2) = 7.37776, as in every table.
TEST_CASE("rate of an exponential distribution with and without censored values", "[sweep]") {
  const RateEstimate all =
      estimate_rate({died(10), died(20), died(30), died(40), died(100)});  // T = 200
  CHECK(all.events == 5);
  CHECK(all.exposure == 200);
  CHECK(all.rate == Approx(0.025));
  CHECK(all.interval.low == Approx(3.24697 / 400).epsilon(1e-5));
  CHECK(all.interval.high == Approx(20.4832 / 400).epsilon(1e-5));
  const RateEstimate some =
      estimate_rate({died(10), died(20), died(30), died(40), died(50), lost(50)});
  CHECK(some.n == 6);
  CHECK(some.rate == Approx(0.025));
  CHECK(some.interval.low == Approx(3.24697 / 400).epsilon(1e-5));
  CHECK(some.interval.high == Approx(23.3367 / 400).epsilon(1e-5));
  const RateEstimate none = estimate_rate({lost(50), lost(150)});
  CHECK(none.rate == 0);
  CHECK(none.interval.low == 0);
  CHECK(none.interval.high == Approx(7.37776 / 400).epsilon(1e-5));
  CHECK(std::isnan(estimate_rate({}).rate));
  CHECK(std::isnan(estimate_rate({died(0)}).rate));
}

// Of 20 000 intervals, 95 % hold the true value, +- 0.5 % (three standard deviations) where all
// values end with the event; no fewer where some are censored.
TEST_CASE("intervals hold the true value as often as they say", "[sweep]") {
  constexpr int kTrials = 20'000;
  constexpr double kMargin = 0.005, kRate = 0.3, kMean = -2, kChance = 0.3;
  std::mt19937_64 random(7);
  std::exponential_distribution<double> life(kRate);
  std::normal_distribution<double> normal(kMean, 3);
  std::binomial_distribution<int> binomial(50, kChance);
  int complete = 0, censored = 0, mean = 0, proportion = 0;
  const auto holds = [](const Interval& i, double value) {
    return value >= i.low && value <= i.high;
  };
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<Survival> all, some;
    std::vector<double> values;
    for (int i = 0; i < 8; ++i) {
      const double x = life(random);
      all.push_back(died(x));
      some.push_back(x < 4 ? died(x) : lost(4));
      values.push_back(normal(random));
    }
    complete += holds(estimate_rate(all).interval, kRate);
    censored += holds(estimate_rate(some).interval, kRate);
    mean += holds(estimate_mean(values).interval, kMean);
    proportion +=
        holds(estimate_proportion(static_cast<size_t>(binomial(random)), 50).interval, kChance);
  }
  CHECK(complete / double(kTrials) == Approx(0.95).margin(kMargin));
  CHECK(censored / double(kTrials) > 0.95 - kMargin);
  CHECK(mean / double(kTrials) == Approx(0.95).margin(kMargin));
  // Wilson's interval is close to 95 % without being exact: counts are whole numbers.
  CHECK(proportion / double(kTrials) == Approx(0.95).margin(0.02));
}

TEST_CASE("whether two proportions are the same, by Fisher's exact test") {
  // Tea tasting (R. A. Fisher, The Design of Experiments, 1935): 34 of 70 arrangements.
  CHECK(same_proportion(3, 4, 1, 4) == Approx(34. / 70));
  CHECK(same_proportion(4, 4, 0, 4) == Approx(2. / 70));
  // C(16, 2) / C(62, 2): all other tables are likelier.
  CHECK(same_proportion(0, 2, 46, 60) == Approx(120. / 1891));
  CHECK(same_proportion(46, 60, 0, 2) == Approx(120. / 1891));
  CHECK(same_proportion(5, 10, 10, 20) == Approx(1));
  CHECK(same_proportion(0, 10, 0, 20) == 1);
  CHECK(same_proportion(10, 10, 20, 20) == 1);
  CHECK(same_proportion(0, 0, 3, 5) == 1);
}
