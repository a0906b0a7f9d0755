// Big polygons: what `apothem polygon` computes of a ring of n vertices, without printing.

#include <memory>
#include <utility>

#include "apps/benchmark/bench.hpp"
#include "apps/cases/samples.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "geometry/skeleton/singular_area.hpp"

namespace apothem {
namespace {

using Shape = std::function<Polygon(int)>;

Work big_polygon(const Shape& shape, int vertices) {
  const auto ring = std::make_shared<std::vector<Vec2>>(shape(vertices).vertices());
  const auto attempts = std::make_shared<int>(0);
  return {.once =
              [ring, attempts] {
                const Polygon polygon(*ring);
                const InscribedCircle circle = largest_inscribed_circle(polygon);
                const Skeleton skeleton = straight_skeleton(polygon);
                keep(singular_area(skeleton, circle.radius / 2));
                *attempts = skeleton.attempts;
                return 1.;
              },
          .extras =
              [attempts] {
                return std::vector<Extra>{{"attempts", static_cast<double>(*attempts)}};
              }};
}

}  // namespace

std::vector<BenchmarkCase> big_polygon_cases() {
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
  std::vector<BenchmarkCase> cases;
  for (const auto& [name, shape] : shapes) {
    for (const int n : {100, 500, 1000, 2000, 5000, 10000, 20000}) {
      cases.push_back({.name = std::string("big_polygon/") + name + "/" + std::to_string(n),
                       .item = "polygon",
                       .about = "roof, inscribed circle and singular area of so many vertices",
                       .prepare = [shape = shape, n](int) { return big_polygon(shape, n); },
                       .on_request = true,
                       .clock = ClockKind::wall});
    }
  }
  return cases;
}

}  // namespace apothem
