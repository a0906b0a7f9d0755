#include "apps/benchmark/bench.hpp"

#include <algorithm>
#include <cmath>

#include "lib/system/clock.hpp"

namespace apothem {
namespace {

double now(ClockKind clock) {
  return clock == ClockKind::wall ? seconds_since({}) : processor_time();
}

struct Sample {
  double seconds = 0, items = 0;
};

Sample sample(const Work& work, ClockKind clock, std::int64_t calls) {
  Sample s;
  if (work.before) {
    for (std::int64_t i = 0; i < calls; ++i) {
      work.before();
      const double begin = now(clock);
      s.items += work.once();
      s.seconds += now(clock) - begin;
    }
    return s;
  }
  const double begin = now(clock);
  for (std::int64_t i = 0; i < calls; ++i) s.items += work.once();
  s.seconds = now(clock) - begin;
  return s;
}

}  // namespace

double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double Timed::median() const { return median_of(times); }
double Timed::least() const { return *std::ranges::min_element(times); }
double Timed::largest() const { return *std::ranges::max_element(times); }

Timed time_case(const BenchmarkCase& benchmark, const Timing& timing) {
  const Work work = benchmark.prepare(timing.threads);
  const ClockKind clock = timing.threads > 1 ? ClockKind::wall : benchmark.clock;
  Timed timed{{}, work.bytes, work.operations, {}};
  // The calls of a repetition: more and more, until they take long enough. The first ones fill the
  // caches, and count only if they have taken so long that filling them is a small part.
  std::int64_t calls = 1;
  Sample s = sample(work, clock, calls);
  const bool long_one = s.seconds > 10 * timing.seconds;
  while (s.seconds < timing.seconds) {
    const double more = s.seconds > 0 ? 1.2 * timing.seconds / s.seconds : 10;
    calls = static_cast<std::int64_t>(
        std::ceil(static_cast<double>(calls) * std::clamp(more, 1.2, 10.)));
    s = sample(work, clock, calls);
  }
  if (long_one) timed.times.push_back(s.seconds / s.items);
  while (static_cast<int>(timed.times.size()) < timing.repetitions) {
    s = sample(work, clock, calls);
    timed.times.push_back(s.seconds / s.items);
  }
  if (work.extras) timed.extras = work.extras();
  return timed;
}

MachineLimits machine_limits(const Timing& timing) {
  MachineLimits limits;
  Timing one = timing;
  one.threads = 1;
  for (const BenchmarkCase& c : machine_cases()) {
    const double rate = 1 / time_case(c, one).least();
    (c.name == kBandwidthCase ? limits.bandwidth : limits.arithmetic) = rate;
  }
  return limits;
}

void add_family(std::vector<BenchmarkCase>& cases, const BenchmarkCase& all,
                std::initializer_list<int> sizes,
                const std::function<Work(int size, int threads)>& make, int usual) {
  for (const int size : sizes) {
    BenchmarkCase& one = cases.emplace_back(all);
    one.name += "/" + std::to_string(size);
    one.prepare = [make, size](int threads) { return make(size, threads); };
    one.size = size;
    one.on_request = size > usual;
  }
}

std::vector<BenchmarkCase> benchmark_cases() {
  std::vector<BenchmarkCase> all;
  for (const auto cases : {machine_cases, pair_cases, contact_cases, element_cases, scene_cases,
                           start_cases, rest_cases, big_polygon_cases, work_cases}) {
    for (BenchmarkCase& c : cases()) all.push_back(std::move(c));
  }
  return all;
}

}  // namespace apothem
