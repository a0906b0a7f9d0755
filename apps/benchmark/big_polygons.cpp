// Big polygons: what `apothem polygon` computes of a ring of n vertices, without printing, and
// pairs of such rings with distance fields.

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "apps/benchmark/bench.hpp"
#include "apps/cases/samples.hpp"
#include "geometry/integrals/edge_integral.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "geometry/skeleton/singular_area.hpp"

namespace apothem {
namespace {

using Shape = std::function<Polygon(int)>;

// `items` is how many the polygon counts for.
Work big_polygon(const Shape& shape, int vertices, double items) {
  const auto ring = std::make_shared<std::vector<Vec2>>(shape(vertices).vertices());
  const auto attempts = std::make_shared<int>(0);
  return {.once =
              [ring, attempts, items] {
                const Polygon polygon(*ring);
                const InscribedCircle circle = largest_inscribed_circle(polygon);
                const Skeleton skeleton = straight_skeleton(polygon);
                keep(singular_area(skeleton, circle.radius / 2));
                *attempts = skeleton.attempts;
                return items;
              },
          .extras =
              [attempts] {
                return std::vector<Extra>{{"attempts", static_cast<double>(*attempts)}};
              }};
}

// The polygon and its image beside it, which it overlaps.
Work big_pair(const Shape& shape, int vertices) {
  const Polygon a = shape(vertices);
  const Box box = bounding_box(a);
  const Polygon b = samples::shifted(a, {.6 * (box.x1 - box.x0), .013 * (box.y1 - box.y0)});
  const PotentialChoice choice{.field = PotentialChoice::Field::distance};
  const Potential of_a = make_potential(a, choice), of_b = make_potential(b, choice);
  return {.once = [a, b, of_a, of_b, vertices] {
    keep(edge_method(a, of_a, b, of_b));
    return static_cast<double>(vertices);
  }};
}

Shape of_random(Polygon (*shape)(samples::Random& random, int n)) {
  return [shape](int n) {
    samples::Random random(1);
    return shape(random, n);
  };
}

Polygon noisy_circle(samples::Random& random, int n) {
  return samples::random_star_shaped(random, n, .7);
}

// Outlines of 10 vertices and more, whose times are those of a vertex.
void add_outlines(std::vector<BenchmarkCase>& cases) {
  const std::pair<const char*, Shape> shapes[]{
      {"noisy_circle", of_random(noisy_circle)},
      {"star", [](int n) { return samples::star(n / 2, .5); }},
      {"comb", [](int n) { return samples::comb(n / 4, 9); }},
      {"gear", [](int n) { return samples::gear(std::max(n / 4, 3)); }},
      {"staircase", [](int n) { return samples::staircase(n / 4); }}};
  for (const auto& [name, shape] : shapes) {
    for (const int n : {10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000}) {
      cases.push_back(
          {.name = fmt::format("outline/{}/{}", name, n),
           .item = "vertex",
           .about = "roof, inscribed circle and singular area",
           .prepare = [shape = shape, n](int) { return big_polygon(shape, n, n); },
           // Smaller polygons begin with CGAL, in a process that takes longer than they do.
           .size = n < 100 ? 0. : n,
           .on_request = true,
           .clock = n < 100 ? ClockKind::wall : ClockKind::processor});
    }
    for (const int n : {10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000}) {
      cases.push_back({.name = fmt::format("outline_pair/{}/{}", name, n),
                       .item = "vertex",
                       .about = "force, energy and area of two outlines with distance fields",
                       .prepare = [shape = shape, n](int) { return big_pair(shape, n); },
                       .size = static_cast<double>(n),
                       .on_request = true});
    }
  }
}

}  // namespace

std::vector<BenchmarkCase> big_polygon_cases() {
  const std::pair<const char*, Shape> shapes[]{
      {"noisy_circle", of_random(noisy_circle)},
      {"coastline", of_random(samples::coastline)},
      {"skyline", of_random(samples::skyline)},
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
                       .prepare = [shape = shape, n](int) { return big_polygon(shape, n, 1); },
                       .on_request = true,
                       .clock = ClockKind::wall});
    }
  }
  add_outlines(cases);
  return cases;
}

}  // namespace apothem
