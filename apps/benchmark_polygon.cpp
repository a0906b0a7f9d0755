// Big polygons: what `apothem polygon` computes of a ring of n vertices, without printing.
#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "apothem/geometry/potential/inscribed_circle.hpp"
#include "apothem/geometry/skeleton/singular_area.hpp"
#include "cases/samples.hpp"

namespace {

using namespace apothem;
using Shape = std::function<Polygon(int)>;

void big_polygon(benchmark::State& state, const Shape& shape) {
  const std::vector<Vec2> ring = shape(static_cast<int>(state.range(0))).vertices();
  int attempts = 0;
  for (auto _ : state) {
    const Polygon polygon(ring);
    const InscribedCircle circle = largest_inscribed_circle(polygon);
    const Skeleton skeleton = straight_skeleton(polygon);
    benchmark::DoNotOptimize(singular_area(skeleton, circle.radius / 2));
    attempts = skeleton.attempts;
  }
  state.counters["attempts"] = attempts;
}

const bool registered = [] {
  const std::pair<const char*, Shape> shapes[]{
      {"noisy_circle",
       [](int n) {
         samples::Random random(1);
         return samples::random_star_shaped(random, n, .7);
       }},
      {"coastline",
       [](int n) {
         samples::Random random(1);
         return samples::coastline(random, n);
       }},
      {"skyline",
       [](int n) {
         samples::Random random(1);
         return samples::skyline(random, n);
       }},
      {"star", [](int n) { return samples::star(n / 2, .5); }},
      {"comb", [](int n) { return samples::comb(n / 4, 9); }},
      {"spiral", [](int n) { return samples::spiral(5, n / 10); }},
      {"regular", [](int n) { return samples::regular(n); }}};
  for (const auto& [name, shape] : shapes) {
    auto* entry = benchmark::RegisterBenchmark(
        (std::string("big_polygon/") + name).c_str(),
        [shape = shape](benchmark::State& state) { big_polygon(state, shape); });
    for (const int n : {100, 500, 1000, 2000, 5000, 10000, 20000}) entry->Arg(n);
    entry->Unit(benchmark::kMillisecond)->MinTime(.05);
  }
  return true;
}();

}  // namespace
