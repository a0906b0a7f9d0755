// Speed, side by side in one run. Machines are noisy: quote ratios.
//
//   apothem_benchmark --benchmark_repetitions=5 --benchmark_report_aggregates_only
//
// Pairs of convex quadrilaterals that overlap; `error` is the worst |dF|/W of the method against
// the exact oracle on these pairs, `failures` how many of them it failed on or got wrong by more
// than 1 %.

#include <benchmark/benchmark.h>

#include <cmath>
#include <numeric>

#include "apothem/dynamics/simulation.hpp"
#include "apothem/geometry/exact/exact_integral.hpp"
#include "apothem/geometry/exact/overlap.hpp"
#include "apothem/geometry/integrals/contact_patches.hpp"
#include "apothem/geometry/integrals/placed_shapes.hpp"
#include "apothem/scene/scene.hpp"
#include "cases/samples.hpp"

namespace {

using namespace apothem;

struct Pair {
  Polygon a, b;
  Potential potential_a, potential_b;
  PairResult exact;
};

// Overlapping pairs, the centres `distance` apart, moved by `offset`.
std::vector<Pair> make_pairs(double distance, double offset = 0) {
  samples::Random random(1);
  std::vector<Pair> pairs;
  while (pairs.size() < 256) {
    const Vec2 far(offset, offset);
    const double direction = random.uniform(0, 2 * M_PI);
    const Vec2 apart = distance * Vec2(std::cos(direction), std::sin(direction));
    const Polygon far_a = samples::shifted(samples::random_quad(random), far);
    const Polygon far_b =
        samples::shifted(samples::shifted(samples::random_quad(random), apart), far);
    const PairResult exact = exact_method(far_a, far_b, {});
    if (exact.integral.depth < 1e-2) continue;
    pairs.push_back({far_a, far_b, make_potential(far_a), make_potential(far_b), exact});
  }
  return pairs;
}

const std::vector<Pair>& touching_pairs() {
  static const std::vector<Pair> pairs = make_pairs(1.2);
  return pairs;
}

template <class Method>
void measure(benchmark::State& state, const std::vector<Pair>& pairs, const Method& method) {
  double worst = 0;
  int failures = 0;
  for (const Pair& pair : pairs) {
    try {
      const double error = (method(pair).integral.force - pair.exact.integral.force).norm() /
                           pair.exact.integral.weight;
      if (!(error < 1e-2)) {
        ++failures;
      } else {
        worst = std::max(worst, error);
      }
    } catch (const std::runtime_error&) {
      ++failures;
    }
  }
  size_t i = 0;
  for ([[maybe_unused]] auto _ : state) {
    try {
      benchmark::DoNotOptimize(method(pairs[i++ % pairs.size()]));
    } catch (const std::runtime_error&) {
      // counted above; its time counts as well
    }
  }
  state.counters["error"] = worst;
  state.counters["failures"] = failures;
}

// The kernel as the step loop calls it: shapes placed, memory at hand.
void edge_kernel(benchmark::State& state, const std::vector<Pair>& pairs) {
  struct Placed {
    PlacedShapes shapes;
    Vec2 offset;
  };
  std::vector<Placed> placed;
  EdgeWorkspace workspace;
  double worst = 0;
  for (const Pair& pair : pairs) {
    Placed& p = placed.emplace_back();
    p.shapes.add(pair.potential_a);
    p.shapes.add(pair.potential_b);
    p.shapes.place(0, 0, 0, 0);
    p.shapes.place(1, 0, 0, 0);
    p.offset = pair.a.origin() - pair.b.origin();
    const PairIntegral result =
        pair_integral(p.shapes.view(0), p.shapes.view(1), p.offset, workspace);
    worst = std::max(
        worst, (result.force - pair.exact.integral.force).norm() / pair.exact.integral.weight);
  }
  size_t i = 0;
  for ([[maybe_unused]] auto _ : state) {
    const Placed& p = placed[i++ % placed.size()];
    benchmark::DoNotOptimize(
        pair_integral(p.shapes.view(0), p.shapes.view(1), p.offset, workspace));
  }
  state.counters["error"] = worst;
  state.counters["failures"] = 0;
}

void quad_pair_edge(benchmark::State& state) { edge_kernel(state, touching_pairs()); }
void quad_pair_edge_offset(benchmark::State& state) {
  edge_kernel(state, make_pairs(1.2, static_cast<double>(state.range(0))));
}
void quad_pair_near_miss(benchmark::State& state) {
  std::vector<Pair> pairs = touching_pairs();
  for (Pair& pair : pairs) {  // apart, but their boxes may still overlap
    pair.exact = {};
    pair.exact.integral.weight = 1;
    const Vec2 away = pair.b[0] + pair.b[2] - pair.a[0] - pair.a[2];
    pair.b = samples::shifted(pair.b, .85 * away.normalized());
  }
  edge_kernel(state, pairs);
}
void quad_pair_overlap_inexact(benchmark::State& state) {
  measure(state, touching_pairs(), [](const Pair& p) {
    return overlap_method(p.a, p.potential_a, p.b, p.potential_b, Arithmetic::inexact);
  });
}
void quad_pair_overlap_exact(benchmark::State& state) {
  measure(state, touching_pairs(), [](const Pair& p) {
    return overlap_method(p.a, p.potential_a, p.b, p.potential_b, Arithmetic::exact);
  });
}
void quad_pair_oracle(benchmark::State& state) {
  measure(state, touching_pairs(), [](const Pair& p) { return exact_method(p.a, p.b, {}); });
}

// Crosses of five unit squares, arm on arm. Field 0: the roof, 1: the distance field.
struct CrossPairs {
  static constexpr int kPairs = 64;
  explicit CrossPairs(PotentialChoice::Field field) {
    const Polygon cross = samples::cross_of_squares();
    const PotentialChoice choice{.field = field,
                                 .reference = PotentialChoice::Reference::inscribed_circle};
    potential = translated(make_potential(cross, choice), area_moments(cross).centroid);
    samples::Random random(3);
    for (int i = 0; i < kPairs; ++i) {
      for (int k = 0; k < 2; ++k) {
        shapes.place(shapes.add(potential), 0, 0, random.uniform(0, 2 * M_PI));
      }
      const double direction = random.uniform(0, 2 * M_PI);
      offsets.emplace_back(1.9 * std::cos(direction), 1.9 * std::sin(direction));
    }
  }
  Potential potential;
  PlacedShapes shapes;
  std::vector<Vec2> offsets;
};
void cross_pair_edge(benchmark::State& state) {
  const CrossPairs pairs(PotentialChoice::Field(state.range(0)));
  EdgeWorkspace workspace;
  int i = 0;
  for ([[maybe_unused]] auto _ : state) {
    const int k = i++ % CrossPairs::kPairs;
    benchmark::DoNotOptimize(pair_integral(pairs.shapes.view(2 * k), pairs.shapes.view(2 * k + 1),
                                           pairs.offsets[k], workspace));
  }
}
void cross_pair_patches(benchmark::State& state) {
  const CrossPairs pairs(PotentialChoice::Field(state.range(0)));
  PatchWorkspace workspace;
  std::vector<BoundaryRun> runs;
  std::vector<PairIntegral> patches;
  int i = 0;
  double count = 0;
  for ([[maybe_unused]] auto _ : state) {
    const int k = i++ % CrossPairs::kPairs;
    contact_patches(pairs.shapes.view(2 * k), pairs.shapes.view(2 * k + 1), pairs.offsets[k],
                    workspace, runs, patches);
    count += static_cast<double>(patches.size());
  }
  state.counters["patches"] = count / static_cast<double>(state.iterations());
}

void impact_steps(benchmark::State& state) {
  const Scene scene = read_scene(APOTHEM_SOURCE "/data/scenes/impact-asymmetric.json");
  std::unique_ptr<Simulation> simulation;
  for ([[maybe_unused]] auto _ : state) {
    if (!simulation || simulation->state().time >= scene.time.end) {
      state.PauseTiming();
      simulation = std::make_unique<Simulation>(scene.model, scene.time, scene.output.frames, 1);
      state.ResumeTiming();
    }
    simulation->step();
  }
  state.counters["steps/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

// The whole impacted beam, contacts by the bodies' surfaces (0) or by potentials of elements (1).
// The shares of the phases are of the time in steps: all of them add up to 1.
void beam_run(benchmark::State& state) {
  Scene scene = read_scene(APOTHEM_SOURCE "/data/scenes/impacted-beam.json");
  if (state.range(0) == 1) {
    scene.model.contact.surface = ContactSurface::element;
    scene.model.contact.distribution = ForceDistribution::resultant;
  }
  double steps = 0;
  std::array<double, kPhaseNames.size()> seconds{};
  for ([[maybe_unused]] auto _ : state) {
    Simulation simulation(scene.model, scene.time, scene.output.frames, 1);
    while (simulation.state().time < scene.time.end) simulation.step();
    steps += static_cast<double>(simulation.own_steps());
    for (size_t i = 0; i < seconds.size(); ++i) seconds[i] += simulation.phase_seconds()[i];
  }
  state.counters["steps/s"] = benchmark::Counter(steps, benchmark::Counter::kIsRate);
  const double all = std::accumulate(seconds.begin(), seconds.end(), 0.);
  for (size_t i = 0; i < seconds.size(); ++i) state.counters[kPhaseNames[i]] = seconds[i] / all;
}

// A pack of quadrilaterals inside the skin of their neighbours: the whole step per body.
void pack_step(benchmark::State& state) {
  Model model;
  model.materials = {{"rock", 2000}};
  model.contact.normal_stiffness = 2e9;
  samples::Random random(2);
  const int n = static_cast<int>(state.range(0));
  const int columns = static_cast<int>(std::sqrt(n));
  for (int i = 0; i < n; ++i) {
    RigidBody body;
    body.name = std::to_string(i);
    set_shape(body,
              samples::shifted(samples::random_quad(random), 1.5 * Vec2(i % columns, i / columns)),
              model);
    const double vx = random.uniform(-1, 1);
    body.velocity = {vx, random.uniform(-1, 1)};
    model.bodies.push_back(body);
  }
  Simulation simulation(model, {.end = 1e3, .safety = .1}, 1, 1);
  for ([[maybe_unused]] auto _ : state) simulation.step();
  state.counters["per_body"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * n,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["touching"] = simulation.counts().touching_now;
}

BENCHMARK(quad_pair_edge);
BENCHMARK(quad_pair_edge_offset)->Arg(1'000'000)->Arg(1'000'000'000);
BENCHMARK(quad_pair_near_miss);
BENCHMARK(quad_pair_overlap_inexact);
BENCHMARK(quad_pair_overlap_exact);
BENCHMARK(quad_pair_oracle);
BENCHMARK(cross_pair_edge)->ArgName("distance_field")->Arg(0)->Arg(1);
BENCHMARK(cross_pair_patches)->ArgName("distance_field")->Arg(0)->Arg(1);
BENCHMARK(impact_steps);
BENCHMARK(beam_run)->ArgName("elements")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(pack_step)->Arg(300)->Arg(3000);

}  // namespace

BENCHMARK_MAIN();
