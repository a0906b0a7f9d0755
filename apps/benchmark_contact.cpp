// Contact of deformable bodies: one edge against one face by itself, whole interfaces in place, and
// the same interface by potentials of the elements on it.

#include <benchmark/benchmark.h>

#include <cmath>

#include "apothem/contact/deformable_friction.hpp"
#include "apothem/contact/element_contact.hpp"
#include "apothem/mesh/rectangle_mesh.hpp"
#include "cases/samples.hpp"

namespace {

using namespace apothem;

// Two bars on each other, cells that do not match, a little wavy.
struct Interface {
  explicit Interface(int cells)
      : lower(rectangle_mesh({1. * cells, 4}, {cells, 4}, {0, 0}, ElementShape::quadrilateral)),
        upper(rectangle_mesh({.97 * cells, 4}, {cells, 4}, {.01 * cells, 3.95},
                             ElementShape::quadrilateral)),
        displacement(2 * (lower.nodes.size() + upper.nodes.size())),
        contact(1, 1, .1, 1) {
    for (size_t i = 0; i < displacement.size(); ++i)
      displacement[i] = .01 * std::sin(static_cast<double>(i));
    contact.add_deformable(lower, boundary(lower), 0);
    contact.add_deformable(upper, boundary(upper), static_cast<int>(lower.nodes.size()));
  }
  Mesh lower, upper;
  std::vector<double> displacement;
  DeformableContact contact;
};

void per(benchmark::State& state, const char* name, size_t count) {
  state.counters[name] = benchmark::Counter(
      static_cast<double>(state.iterations()) * static_cast<double>(count) * 1e-9,
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void collar_edge_face(benchmark::State& state) {
  samples::Random random(1);
  struct Pair {
    CollarFace<double> face;
    Vec2 p, q;
  };
  std::vector<Pair> pairs;
  while (pairs.size() < 256) {
    const double alpha = random.uniform(-.2, .2), beta = random.uniform(-.2, .2);
    Pair pair{{0, 0, 1, 0, 1, 0, 1, alpha, 1, beta, 1, .5, .5, .5},
              {random.uniform(0, 1.5), random.uniform(-.1, .2)},
              {random.uniform(-.5, 1), random.uniform(-.1, .2)}};
    CollarPiece<double> piece;
    if (collar_piece(pair.face, pair.p.x(), pair.p.y(), pair.q.x(), pair.q.y(), piece))
      pairs.push_back(pair);
  }
  for (auto _ : state) {
    for (const Pair& pair : pairs) {
      CollarPiece<double> piece;
      benchmark::DoNotOptimize(
          collar_piece(pair.face, pair.p.x(), pair.p.y(), pair.q.x(), pair.q.y(), piece));
      benchmark::DoNotOptimize(piece);
    }
  }
  per(state, "ns_per_pair", pairs.size());
}

// All that a step needs: outlines moved, candidates checked, pairs, nodal forces.
void deformable_interface(benchmark::State& state) {
  Interface bars(static_cast<int>(state.range(0)));
  DeformableContact& contact = bars.contact;
  contact.update(bars.displacement, {});
  std::vector<double> f(bars.displacement.size());
  for (auto _ : state) {
    contact.update(bars.displacement, {});
    contact.evaluate();
    contact.add_forces(f);
    benchmark::DoNotOptimize(f.data());
  }
  per(state, "ns_per_contact", contact.contacts().size());
  per(state, "ns_per_candidate", contact.candidates().size());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

void deformable_evaluation(benchmark::State& state) {
  Interface bars(static_cast<int>(state.range(0)));
  DeformableContact& contact = bars.contact;
  contact.update(bars.displacement, {});
  for (auto _ : state) contact.evaluate();
  per(state, "ns_per_contact", contact.contacts().size());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

void deformable_friction(benchmark::State& state) {
  Interface bars(static_cast<int>(state.range(0)));
  bars.contact.update(bars.displacement, {});
  bars.contact.evaluate();
  DeformableFriction friction({{0, 0}, 1, {{.5, .6}}});
  for (auto _ : state) friction.update(bars.contact, bars.displacement, {}, 1e-3);
  per(state, "ns_per_contact", bars.contact.contacts().size());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

// The same interface by potentials of the outermost elements: all that a step needs.
void element_interface(benchmark::State& state, ForceDistribution distribution) {
  const Interface bars(static_cast<int>(state.range(0)));
  ElementContact contact(1, 1, .1, distribution, 1);
  contact.add_deformable(bars.lower, boundary(bars.lower), 0);
  contact.add_deformable(bars.upper, boundary(bars.upper),
                         static_cast<int>(bars.lower.nodes.size()));
  std::vector<double> f(bars.displacement.size());
  contact.update(bars.displacement, {});
  contact.evaluate();
  for (auto _ : state) {
    contact.update(bars.displacement, {});
    contact.evaluate();
    contact.add_forces(f);
    benchmark::DoNotOptimize(f.data());
  }
  per(state, "ns_per_pair", contact.touching());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

BENCHMARK(collar_edge_face);
BENCHMARK(deformable_interface)->Arg(100)->Arg(10000);
BENCHMARK(deformable_evaluation)->Arg(100)->Arg(10000);
BENCHMARK(deformable_friction)->Arg(100)->Arg(10000);
BENCHMARK_CAPTURE(element_interface, resultant, ForceDistribution::resultant)->Arg(100)->Arg(10000);
BENCHMARK_CAPTURE(element_interface, integrated, ForceDistribution::integrated)
    ->Arg(100)
    ->Arg(10000);

}  // namespace
