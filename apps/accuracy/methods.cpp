#include "apps/accuracy/methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>

#include "apps/accuracy/forked_work.hpp"
#include "apps/peers/peers.hpp"
#include "geometry/exact/exact_integral.hpp"
#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/placed_shapes.hpp"
#include "lib/system/clock.hpp"

namespace apothem {
namespace {

// The edge-integral kernel as the step loop calls it: shapes are placed and memory is allocated.
class EdgeKernel {
 public:
  explicit EdgeKernel(const std::vector<PreparedPair>& pairs) {
    for (const PreparedPair& pair : pairs) {
      shapes_.add(pair.potential_a);
      shapes_.add(pair.potential_b);
      offsets_.push_back(pair.a.origin() - pair.b.origin());
    }
    for (int i = 0; i < shapes_.size(); ++i) shapes_.place(i, 0, 0, 0);
  }
  PairIntegral operator()(size_t i) {
    const int a = 2 * static_cast<int>(i);
    return pair_integral(shapes_.view(a), shapes_.view(a + 1), offsets_[i], workspace_);
  }

 private:
  PlacedShapes shapes_;
  std::vector<Vec2> offsets_;
  EdgeWorkspace workspace_;
};

// Calls use(method), where `method` is a function from the index of a pair to its result.
template <class Use>
void with_method(std::string_view method, const std::vector<PreparedPair>& pairs, const Use& use) {
  const auto with = [&](const auto& evaluate) {
    use([&](size_t i) -> PairResult { return evaluate(pairs[i]); });
  };
  // Without the energy, because the method "edge" does not compute it either.
  const auto with_overlap = [&](const auto& overlap) {
    with([&](const PreparedPair& p) -> PairResult {
      return {overlap_integral(overlap(p), p.a.origin(), p.a, p.potential_a, p.b, p.potential_b),
              {}};
    });
  };
  if (method == "edge") {
    EdgeKernel kernel(pairs);
    use([&](size_t i) -> PairResult { return {kernel(i), {}}; });
  } else if (method == "exact") {
    with([](const PreparedPair& p) { return exact_method(p.a, p.b, {}); });
  } else if (method == "overlap") {
    with([](const PreparedPair& p) {
      return overlap_method(p.a, p.potential_a, p.b, p.potential_b);
    });
  } else if (method == "overlap-inexact") {
    with_overlap([](const PreparedPair& p) {
      return overlap_polygons(p.a, p.b, p.a.origin(), Arithmetic::inexact);
    });
  } else if (method == "boost") {
    with_overlap([](const PreparedPair& p) { return boost_overlap(p.a, p.b); });
  } else {
    with_overlap([](const PreparedPair& p) { return clip_overlap(p.a, p.b, p.convex); });
  }
}

// The result for one pair, as a child process sends it.
struct Record {
  double threw, seconds;
  double force_x, force_y, moment_a, moment_b, weight, own_length_a, own_length_b;
  double energy, overlap_area;
};
constexpr size_t kRecord = sizeof(Record) / sizeof(double);

void evaluate_from(size_t first, std::string_view method, const std::vector<PreparedPair>& pairs,
                   const SendNumbers& send) {
  with_method(method, pairs, [&](const auto& evaluate) {
    for (size_t i = first; i < pairs.size(); ++i) {
      Record r{};
      const Clock::time_point start = Clock::now();
      try {
        const auto [pair, volume] = evaluate(i);
        r = {0,
             seconds_since(start),
             pair.force.x(),
             pair.force.y(),
             pair.moment_a,
             pair.moment_b,
             pair.weight,
             pair.own_length_a,
             pair.own_length_b,
             volume.energy,
             volume.overlap_area};
      } catch (const std::exception&) {
        r.threw = 1;
      }
      const auto numbers = std::bit_cast<std::array<double, kRecord>>(r);
      send({numbers.begin(), numbers.end()});
    }
  });
}

// Times rounds over all pairs with a result, in blocks of about 20 us. Blocks are that short so
// that at least one round of each runs undisturbed by other processes; the fastest rounds count.
void time_rounds(std::string_view method, const std::vector<PreparedPair>& pairs,
                 const std::vector<size_t>& good, double seconds_per_pair,
                 const SendNumbers& send) {
  with_method(method, pairs, [&](const auto& evaluate) {
    const size_t block = 1 + static_cast<size_t>(20e-6 / seconds_per_pair);
    const size_t length = good.size() * (1 + 10 * block / good.size());
    std::vector<double> fastest((length + block - 1) / block, HUGE_VAL);
    volatile double sink = 0;
    const Clock::time_point start = Clock::now();
    for (int round = 0; round < 3 || seconds_since(start) < .05; ++round) {
      for (size_t b = 0; b < fastest.size(); ++b) {
        const Clock::time_point before = Clock::now();
        for (size_t k = b * block; k < std::min(length, (b + 1) * block); ++k) {
          sink = evaluate(good[k % good.size()]).integral.force.x();
        }
        fastest[b] = std::min(fastest[b], seconds_since(before));
      }
    }
    (void)sink;
    send(
        {1e9 * std::accumulate(fastest.begin(), fastest.end(), 0.0) / static_cast<double>(length)});
  });
}

// Processor time in which a child process may be silent, s.
double patience_with(std::string_view method) { return method == "exact" ? 600 : 20; }

std::string describe(const HelperAnswer& answer, double patience) {
  switch (answer.end) {
    case HelperAnswer::End::crashed:
      return fmt::format("crashed with signal {}", answer.signal);
    case HelperAnswer::End::overran:
      return fmt::format("did not return within {:.0f} s of processor time", patience);
    default:
      return "ended without an answer";
  }
}

}  // namespace

PreparedPair::PreparedPair(std::string pair_name, Polygon polygon_a, Polygon polygon_b)
    : name(std::move(pair_name)),
      a(std::move(polygon_a)),
      b(std::move(polygon_b)),
      potential_a(make_potential(a)),
      potential_b(make_potential(b)),
      size(std::max(bounding_box(a).extent(), bounding_box(b).extent())),
      convex(a.is_convex() && b.is_convex()) {}

AccuracyRun run_method(std::string_view method, const std::vector<PreparedPair>& pairs) {
  const double patience = patience_with(method);
  AccuracyRun run;
  while (run.outcomes.size() < pairs.size()) {
    const HelperAnswer answer = run_forked(
        [&](const SendNumbers& send) { evaluate_from(run.outcomes.size(), method, pairs, send); },
        patience);
    for (size_t at = 0; at + kRecord <= answer.numbers.size(); at += kRecord) {
      std::array<double, kRecord> numbers{};
      std::copy_n(answer.numbers.data() + at, kRecord, numbers.begin());
      const auto r = std::bit_cast<Record>(numbers);
      AccuracyOutcome& outcome = run.outcomes.emplace_back();
      if (r.threw != 0) {
        outcome.failure = "threw an exception";
        continue;
      }
      PairIntegral& pair = outcome.integral;
      pair.force = {r.force_x, r.force_y};
      pair.moment_a = r.moment_a;
      pair.moment_b = r.moment_b;
      pair.weight = r.weight;
      pair.own_length_a = r.own_length_a;
      pair.own_length_b = r.own_length_b;
      outcome.volume = {r.energy, r.overlap_area};
      const size_t i = run.outcomes.size() - 1;
      // The moments of this method refer to the first vertices; the others refer to the centroids.
      if (method == "edge") {
        pair.moment_a -= cross(area_moments(pairs[i].a).centroid, pair.force);
        pair.moment_b += cross(area_moments(pairs[i].b).centroid, pair.force);
      }
      run.seconds += r.seconds;
    }
    if (run.outcomes.size() < pairs.size()) {
      run.outcomes.emplace_back().failure = describe(answer, patience);
    }
  }
  return run;
}

double time_method(std::string_view method, const std::vector<PreparedPair>& pairs,
                   const AccuracyRun& run) {
  std::vector<size_t> good;
  for (size_t i = 0; i < run.outcomes.size(); ++i) {
    if (run.outcomes[i].failure.empty()) good.push_back(i);
  }
  if (good.empty()) return std::nan("");
  const double seconds_per_pair = run.seconds / static_cast<double>(good.size());
  if (run.seconds <= .3) {
    const HelperAnswer timing = run_forked(
        [&](const SendNumbers& send) { time_rounds(method, pairs, good, seconds_per_pair, send); },
        patience_with(method));
    if (!timing.numbers.empty()) return timing.numbers[0];
  }
  return 1e9 * seconds_per_pair;
}

}  // namespace apothem
