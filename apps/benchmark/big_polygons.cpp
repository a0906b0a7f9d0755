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
#include "geometry/spatial/ring_tree.hpp"

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

// How often the boundaries of two polygons without holes cross.
int count_crossings(const Polygon& a, const Polygon& b) {
  const RingTree tree(b.vertices());
  int crossings = 0;
  for (int i = 0; i < a.size(); ++i) {
    const Vec2 &p = a[i], &q = a.after(i);
    const Box box = box_of(p, q);
    const auto left = [&](const Vec2& v) { return cross(Vec2(q - p), Vec2(v - p)) > 0; };
    tree.each([&](const Box& run) { return !apart(run, box); },
              [&](int e) {
                const Vec2 &r = b[e], &s = b.after(e);
                const auto beyond = [&](const Vec2& v) {
                  return cross(Vec2(s - r), Vec2(v - r)) > 0;
                };
                crossings += left(r) != left(s) && beyond(p) != beyond(q);
              });
  }
  return crossings;
}

// The polygon and its image, which it overlaps, moved by a share of the sizes of its box.
Work big_pair(const Shape& shape, const Vec2& shift, int vertices) {
  const Polygon a = shape(vertices);
  const Box box = bounding_box(a);
  const Polygon b =
      samples::shifted(a, {shift.x() * (box.x1 - box.x0), shift.y() * (box.y1 - box.y0)});
  const PotentialChoice choice{.field = PotentialChoice::Field::distance};
  const Potential of_a = make_potential(a, choice), of_b = make_potential(b, choice);
  return {.once =
              [a, b, of_a, of_b, vertices] {
                keep(edge_method(a, of_a, b, of_b));
                return static_cast<double>(vertices);
              },
          .extras =
              [a, b, vertices] {
                const double crossings = count_crossings(a, b);
                return std::vector<Extra>{{"crossings", crossings / vertices}};
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
  // Pairs overlap in about half of their length. Of stars and noisy circles, whose boundaries cross
  // often, the largest are left out: they would take minutes, or gigabytes for the layers of their
  // potentials.
  struct Outline {
    Vec2 shift = {.6, .013};
    const char* name;
    Shape shape;
    int most = 50000;
  };
  const Outline outlines[]{
      {.name = "noisy_circle", .shape = of_random(noisy_circle), .most = 20000},
      {.name = "star", .shape = [](int n) { return samples::star(n / 2, .5); }, .most = 10000},
      {.name = "comb", .shape = [](int n) { return samples::comb(n / 4, 9); }},
      {.name = "gear", .shape = [](int n) { return samples::gear(std::max(n / 4, 3)); }},
      {.shift = {.61, .61}, .name = "staircase", .shape = [](int n) {
         return samples::staircase(n / 4);
       }}};
  for (const Outline& outline : outlines) {
    for (const int n : {10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000}) {
      cases.push_back(
          {.name = fmt::format("outline/{}/{}", outline.name, n),
           .item = "vertex",
           .about = "roof, inscribed circle and singular area",
           .prepare = [shape = outline.shape, n](int) { return big_polygon(shape, n, n); },
           // Smaller polygons begin with CGAL, in a process that takes longer than they do.
           .size = n < 100 ? 0. : n,
           .on_request = true,
           .clock = n < 100 ? ClockKind::wall : ClockKind::processor});
    }
    for (const int n : {10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000}) {
      if (n > outline.most) continue;
      cases.push_back({.name = fmt::format("outline_pair/{}/{}", outline.name, n),
                       .item = "vertex",
                       .about = "force, energy and area of two outlines with distance fields",
                       .prepare = [shape = outline.shape, shift = outline.shift,
                                   n](int) { return big_pair(shape, shift, n); },
                       // In smaller ones all features are tried.
                       .size = n < 100 ? 0. : n,
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
