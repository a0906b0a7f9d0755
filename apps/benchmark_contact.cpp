// Contact of deformable bodies: one edge against one face by itself, whole interfaces in place, and
// the same interface as pairs of the elements on it.

#include <benchmark/benchmark.h>

#include <cmath>

#include "contact/deformable_friction.hpp"
#include "contact/placed_shapes.hpp"
#include "geometry/samples.hpp"
#include "mesh/rectangle_mesh.hpp"

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
  DeformableFriction friction({0, 0}, 1, {{.5, .6}});
  for (auto _ : state) friction.update(bars.contact, bars.displacement, {}, 1e-3);
  per(state, "ns_per_contact", bars.contact.contacts().size());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

// The elements of the two facing rows as bodies of their own: placed and integrated, without
// the inradii of the deformed elements and the distribution to nodes.
void element_pairs(benchmark::State& state) {
  Interface bars(static_cast<int>(state.range(0)));
  PlacedShapes shapes;
  std::vector<Potential> potentials;
  std::vector<Vec2> centres;
  const auto collect = [&](const Mesh& mesh, size_t first_node, double y) {
    for (int e = 0; e < mesh.element_count(); ++e) {
      std::vector<Vec2> corners;
      bool on_row = false;
      for (const int n : mesh.element(e)) {
        const size_t k = 2 * (first_node + static_cast<size_t>(n));
        corners.emplace_back(mesh.nodes[n] + Vec2(bars.displacement[k], bars.displacement[k + 1]));
        on_row |= std::abs(mesh.nodes[n].y() - y) < 1e-9;
      }
      if (!on_row) continue;
      const Polygon polygon(corners);
      const Vec2 centre = area_moments(polygon).centroid;
      potentials.push_back(translated(make_potential(polygon), centre));
      centres.emplace_back(polygon.origin() + centre);
    }
  };
  collect(bars.lower, 0, 4);
  const int lower = static_cast<int>(potentials.size());
  collect(bars.upper, bars.lower.nodes.size(), 3.95);
  for (const Potential& potential : potentials) shapes.add(potential);
  for (int i = 0; i < shapes.size(); ++i) shapes.place(i, centres[i].x(), centres[i].y(), 0);
  std::vector<BoxPair> pairs;
  BoxGrid grid;
  std::vector<Box> grown;
  for (const Box& box : shapes.boxes()) grown.push_back(box.grown(.05));
  grid.find_pairs(grown, pairs);
  std::erase_if(pairs, [&](const BoxPair& p) { return (p.first < lower) == (p.second < lower); });
  EdgeWorkspace workspace;
  for (auto _ : state) {
    for (int i = 0; i < shapes.size(); ++i) shapes.place(i, centres[i].x(), centres[i].y(), 0);
    for (const auto& [a, b] : pairs) {
      if (apart(shapes.boxes()[a], shapes.boxes()[b])) continue;
      benchmark::DoNotOptimize(
          pair_integral(shapes.view(a), shapes.view(b), centres[a] - centres[b], workspace));
    }
  }
  per(state, "ns_per_pair", pairs.size());
  per(state, "ns_per_cell", static_cast<size_t>(state.range(0)));
}

BENCHMARK(collar_edge_face);
BENCHMARK(deformable_interface)->Arg(100)->Arg(10000);
BENCHMARK(deformable_evaluation)->Arg(100)->Arg(10000);
BENCHMARK(deformable_friction)->Arg(100)->Arg(10000);
BENCHMARK(element_pairs)->Arg(100)->Arg(10000);

}  // namespace
