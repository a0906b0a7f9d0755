#include <catch2/catch.hpp>
#include <optional>

#include "geometry/exact/exact_integral.hpp"
#include "geometry/exact/overlap.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

constexpr double kUnitRoundOff = 0x1p-52;

PairResult overlap(const Polygon& a, const Polygon& b, const PotentialChoice& choice = {}) {
  return overlap_method(a, make_potential(a, choice), b, make_potential(b, choice));
}

double area(const std::vector<OverlapPolygon>& polygons) {
  double sum = 0;
  for (const OverlapPolygon& p : polygons) {
    for (size_t i = 0; i < p.vertices.size(); ++i) {
      sum += cross(p.vertices[i], p.vertices[(i + 1) % p.vertices.size()]) / 2;
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("edge and overlap kernel agree on random convex pairs", "[overlap]") {
  test::SeededRandom random(10);
  double worst = 0;
  double worst_conditioned = 0;  // error x depth / (eps size): flat in depth for a sane method
  int touching = 0;
  for (int i = 0; i < test::scaled(100000); ++i) {
    const Polygon a = samples::random_convex(random, random.integer(3, 12));
    const Polygon b = samples::shifted(samples::random_convex(random, random.integer(3, 12)),
                                       {random.uniform(-1.4, 1.4), random.uniform(-1.4, 1.4)});
    const PairResult e = test::edge(a, b);
    const PairResult o = overlap(a, b);
    const double weight = o.integral.weight;
    if (weight == 0 && e.integral.weight == 0) continue;
    ++touching;
    const double error = (e.integral.force - o.integral.force).norm() / weight;
    const double depth = o.integral.depth;
    worst_conditioned = std::max(worst_conditioned, error * depth / kUnitRoundOff);
    // Below a depth of 1e-3 the input itself, rounded to double, carries more than 1e-12.
    if (depth > 1e-3) worst = std::max(worst, error);
    REQUIRE(std::abs(e.integral.moment_a - o.integral.moment_a) <
            1e-12 * std::max(1.0, 1e-3 / depth) * weight);
    REQUIRE(std::abs(e.volume.energy - o.volume.energy) < 1e-13 * std::max(weight, 1e-2));
    REQUIRE(std::abs(e.volume.overlap_area - o.volume.overlap_area) < 1e-14);
    REQUIRE(std::abs(e.integral.own_length_a - o.integral.own_length_a) < 1e-10);
    REQUIRE(std::abs(e.integral.own_length_b - o.integral.own_length_b) < 1e-10);
  }
  CHECK(touching > test::least(test::scaled(50000)));
  CHECK(worst < 1e-12);
  CHECK(worst_conditioned < 50);
}

TEST_CASE("edge and overlap kernel against the exact oracle", "[overlap]") {
  test::SeededRandom random(12);
  for (const int kind : {0, 1, 2}) {  // distance, capped distance, area
    for (int i = 0; i < test::scaled(1000); ++i) {
      const Polygon a = samples::random_convex(random, kind == 2 ? 3 : random.integer(3, 12));
      const Polygon b =
          samples::shifted(samples::random_convex(random, kind == 2 ? 3 : random.integer(3, 12)),
                           {random.uniform(-1.4, 1.4), random.uniform(-1.4, 1.4)});
      const PotentialChoice choice = kind == 0 ? PotentialChoice{}
                                     : kind == 1
                                         ? test::length_choice(.3 * inscribed_circle(a).radius)
                                         : test::area_choice();
      const PairResult x = exact_method(a, b, choice);
      for (const PairResult& r : {test::edge(a, b, choice), overlap(a, b, choice)}) {
        const double tolerance =
            std::max(1e-13, 4 * kUnitRoundOff / std::max(x.integral.depth, 1e-9)) *
            x.integral.weight;
        REQUIRE((r.integral.force - x.integral.force).norm() <= tolerance);
        REQUIRE(std::abs(r.integral.moment_a - x.integral.moment_a) <= 2 * tolerance);
        REQUIRE(std::abs(r.integral.moment_b - x.integral.moment_b) <= 2 * tolerance);
        REQUIRE(std::abs(r.volume.energy - x.volume.energy) <= 1e-14);
        REQUIRE(std::abs(r.volume.overlap_area - x.volume.overlap_area) <= 1e-15);
        REQUIRE(std::abs(r.integral.largest_phi - x.integral.largest_phi) <= 1e-13);
        REQUIRE(std::abs(r.integral.depth - x.integral.depth) <= 1e-12);
      }
    }
  }
}

TEST_CASE("the same force far from the origin", "[overlap]") {
  test::SeededRandom random(13);
  for (int i = 0; i < test::scaled(200); ++i) {
    const Polygon a = samples::random_convex(random, random.integer(3, 8));
    const Polygon b = samples::shifted(samples::random_convex(random, random.integer(3, 8)),
                                       {random.uniform(-.8, .8), random.uniform(-.8, .8)});
    for (const double offset : {1e6, 1e9}) {
      // Rounding the shifted coordinates changes the shapes: compare with the oracle on those.
      const Polygon far_a = samples::shifted(a, {offset, -offset});
      const Polygon far_b = samples::shifted(b, {offset, -offset});
      const PairResult x = exact_method(far_a, far_b, {});
      if (x.integral.depth < 1e-2) continue;
      for (const PairResult& r : {test::edge(far_a, far_b), overlap(far_a, far_b)}) {
        REQUIRE((r.integral.force - x.integral.force).norm() <= 1e-12 * x.integral.weight);
      }
    }
  }
}

TEST_CASE("a tip on a long edge", "[overlap]") {
  // The part of the edge that counts is a tiny fraction of it.
  for (const double length : {4.0, 40.0, 4000.0, 4e6}) {
    INFO("length " << length);
    const double d = 6.1e-5;
    const Polygon tip({{0, -d}, {.25, 4 - d}, {-.25, 4 - d}});
    const Polygon floor({{-.47 * length, 0}, {-.3 * length, -1}, {.53 * length, 0}});
    const PairResult x = exact_method(tip, floor, {});
    const PairResult e = test::edge(tip, floor);
    const double rounding = kUnitRoundOff * 4 / d;  // of the tip's own coordinates, at any length
    CHECK((e.integral.force - x.integral.force).norm() < rounding * x.integral.weight);
    CHECK(std::abs(e.integral.own_length_b - x.integral.own_length_b) <
          10 * rounding * x.integral.own_length_b);
  }
}

TEST_CASE("degenerate pairs on a lattice", "[overlap]") {
  // Shared vertices and edges, ridges on edges, coincident polygons: all in plenty.
  test::SeededRandom random(14);
  int pairs = 0;
  while (pairs < test::scaled(2000)) {
    const auto lattice = [&]() -> std::optional<Polygon> {
      std::vector<Vec2> ring;
      for (int i = random.integer(3, 6); i > 0; --i)
        ring.emplace_back(random.integer(0, 4), random.integer(0, 4));
      try {
        Polygon polygon(ring);
        if (polygon.is_convex()) return polygon;
      } catch (const InvalidPolygon&) {
      }
      return std::nullopt;
    };
    std::optional<Polygon> a = lattice(), b = lattice();
    if (!a || !b) continue;
    if (pairs % 2) {  // turned: the degeneracies then hold up to one rounding
      const double angle = random.uniform(0, 6);
      a = samples::turned(*a, angle);
      b = samples::turned(*b, angle);
      if (!a->is_convex() || !b->is_convex()) continue;
    }
    ++pairs;
    const PairResult x = exact_method(*a, *b, {});
    for (const PairResult& r : {test::edge(*a, *b), overlap(*a, *b)}) {
      REQUIRE((r.integral.force - x.integral.force).norm() < 1e-13);
      REQUIRE(std::abs(r.integral.moment_a - x.integral.moment_a) < 1e-13);
      REQUIRE(std::abs(r.volume.energy - x.volume.energy) < 2e-14);
      REQUIRE(std::abs(r.volume.overlap_area - x.volume.overlap_area) < 2e-14);
    }
  }
}

TEST_CASE("overlap polygons of simple polygons", "[overlap]") {
  // A comb on a bar: three components.
  const Polygon comb({{0, 0},
                      {5, 0},
                      {5, 3},
                      {4, 3},
                      {4, 1},
                      {3, 1},
                      {3, 3},
                      {2, 3},
                      {2, 1},
                      {1, 1},
                      {1, 3},
                      {0, 3}});
  const Polygon bar({{-1, 2}, {6, 2}, {6, 2.5}, {-1, 2.5}});
  const auto three = overlap_polygons(comb, bar, Vec2::Zero());
  CHECK(three.size() == 3);
  CHECK(area(three) == Approx(1.5).epsilon(1e-15));
  for (const OverlapPolygon& p : three) {
    for (const OverlapEdge& e : p.edges) CHECK((e.edge_of_a >= 0) != (e.edge_of_b >= 0));
  }
}

TEST_CASE("degenerate contacts are ordinary input", "[overlap]") {
  const Polygon square({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const auto check = [&](const Polygon& b, double overlap_area) {
    const auto polygons = overlap_polygons(square, b, Vec2::Zero());
    CHECK(area(polygons) == Approx(overlap_area).margin(1e-15));
    const PairResult x = exact_method(square, b, {});
    for (const PairResult& r : {test::edge(square, b), overlap(square, b)}) {
      CHECK((r.integral.force - x.integral.force).norm() < 1e-14);
      CHECK(std::abs(r.volume.energy - x.volume.energy) < 1e-14);
      CHECK(std::abs(r.volume.overlap_area - overlap_area) < 1e-14);
    }
  };
  check(samples::shifted(square, {1, 0}), 0);                             // shared edge
  check(samples::shifted(square, {1, 1}), 0);                             // shared vertex
  check(samples::shifted(square, {1, .5}), 0);                            // part of an edge
  check(samples::shifted(square, {1.5, .5}), 0);                          // apart
  check(square, 1);                                                       // coincident
  check(samples::shifted(square, {.5, 0}), .5);                           // two collinear edges
  check(Polygon({{.25, .25}, {.75, .25}, {.75, .75}, {.25, .75}}), .25);  // one inside the other
  check(Polygon({{.25, 0}, {.75, 0}, {.75, .5}, {.25, .5}}), .25);        // inside, on an edge
  check(Polygon({{.5, 1}, {0, 2}, {-.5, 1}}), 0);  // vertex on edge, edge on edge
  check(Polygon({{1, 1}, {2, 1}, {2, 2}}), 0);
  check(samples::shifted(square, {std::nextafter(1.0, 0.0), 0}), 1 - std::nextafter(1.0, 0.0));
}
