// Contact of deformable bodies: one edge against one face by itself, whole interfaces in place, and
// the same interface by potentials of the elements on it.

#include <benchmark/benchmark.h>

#include <cmath>

#include "apothem/contact/contacts.hpp"
#include "apothem/mesh/rectangle_mesh.hpp"
#include "cases/samples.hpp"

namespace {

using namespace apothem;

ContactLaw law_of(const Friction& friction = {}) {
  ContactLaw law;
  law.normal_stiffness = 1;
  law.friction = friction;
  return law;
}

// Two bars on each other, cells that do not match, a little wavy.
struct Interface {
  Interface(int cells, const ContactLaw& law)
      : lower(rectangle_mesh({1. * cells, 4}, {cells, 4}, {0, 0}, ElementShape::quadrilateral)),
        upper(rectangle_mesh({.97 * cells, 4}, {cells, 4}, {.01 * cells, 3.95},
                             ElementShape::quadrilateral)),
        displacement(2 * (lower.nodes.size() + upper.nodes.size())),
        now{{}, displacement, {}, displacement},
        contacts(law, 1, surfaces(law.surface == ContactSurface::body), PairTable(law, {0, 0}, 1),
                 1) {
    for (size_t i = 0; i < displacement.size(); ++i)
      displacement[i] = .01 * std::sin(static_cast<double>(i));
    place();
    contacts.evaluate();
  }
  void place() {
    contacts.place(now);
    contacts.search_if_stale();
  }
  Mesh lower, upper;
  std::vector<double> displacement;
  Kinematics now;  // the velocities are as wavy as the displacements
  Contacts contacts;

 private:
  [[nodiscard]] Surfaces surfaces(bool outlines) const {
    Surfaces made(.1, .1, outlines);
    const int second = static_cast<int>(lower.nodes.size());
    for (const auto& [mesh, first] : {std::pair(&lower, 0), std::pair(&upper, second)}) {
      if (outlines) {
        made.add_outline(*mesh, first, {});
      } else {
        made.add_elements(*mesh, first, {});
      }
    }
    return made;
  }
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
    Pair pair{{0, 0, 1, 0, 1, 0, 1, alpha, 1, beta, 1, .5, .4},
              {random.uniform(0, 1.5), random.uniform(-.1, .2)},
              {random.uniform(-.5, 1), random.uniform(-.1, .2)}};
    CollarPiece<double> piece;
    CollarCrossings<double> top;
    if (collar_piece(pair.face, pair.p.x(), pair.p.y(), pair.q.x(), pair.q.y(), piece, top))
      pairs.push_back(pair);
  }
  for (auto _ : state) {
    for (const Pair& pair : pairs) {
      CollarPiece<double> piece;
      CollarCrossings<double> top;
      benchmark::DoNotOptimize(
          collar_piece(pair.face, pair.p.x(), pair.p.y(), pair.q.x(), pair.q.y(), piece, top));
      benchmark::DoNotOptimize(piece);
    }
  }
  per(state, "ns_per_pair", pairs.size());
}

// All that a step needs: surfaces moved, candidates checked, pairs, nodal forces.
void step(benchmark::State& state, Interface& bars) {
  std::vector<double> f(bars.displacement.size());
  for (auto _ : state) {
    bars.place();
    bars.contacts.evaluate();
    bars.contacts.add_forces({{}, f, {}});
    benchmark::DoNotOptimize(f.data());
  }
}

void deformable_interface(benchmark::State& state) {
  Interface bars(static_cast<int>(state.range(0)), law_of());
  step(state, bars);
  per(state, "ns_per_contact", bars.contacts.contacts().size());
  per(state, "ns_per_candidate", bars.contacts.candidates());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

void deformable_evaluation(benchmark::State& state) {
  Interface bars(static_cast<int>(state.range(0)), law_of());
  for (auto _ : state) bars.contacts.evaluate();
  per(state, "ns_per_contact", bars.contacts.contacts().size());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

void deformable_friction(benchmark::State& state) {
  Interface bars(static_cast<int>(state.range(0)), law_of({.5, .6}));
  for (auto _ : state) bars.contacts.slide(bars.now, 1e-3);
  per(state, "ns_per_contact", bars.contacts.contacts().size());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

// The same interface by potentials of the outermost elements: all that a step needs.
void element_interface(benchmark::State& state, ForceDistribution distribution) {
  ContactLaw law = law_of();
  law.surface = ContactSurface::element;
  law.distribution = distribution;
  Interface bars(static_cast<int>(state.range(0)), law);
  step(state, bars);
  per(state, "ns_per_pair", bars.contacts.contacts().size());
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
