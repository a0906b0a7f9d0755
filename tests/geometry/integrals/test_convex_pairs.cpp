// Pairs of convex polygons, many at a time.
#include "geometry/integrals/convex_pairs.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <deque>

#include "apps/cases/samples.hpp"
#include "geometry/integrals/edge_integral.hpp"
#include "geometry/integrals/placed_shapes.hpp"
#include "geometry/potential/potential.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

// All numbers of two integrals have the same bits.
void check_same(const PairIntegral& x, const PairIntegral& y) {
  CHECK(x.force == y.force);
  CHECK(x.moment_a == y.moment_a);
  CHECK(x.moment_b == y.moment_b);
  CHECK(x.weight == y.weight);
  CHECK(x.centre == y.centre);
  CHECK(x.own_length_a == y.own_length_a);
  CHECK(x.own_length_b == y.own_length_b);
  CHECK(x.largest_phi == y.largest_phi);
  CHECK(x.depth == y.depth);
  CHECK(x.breadth == y.breadth);
  CHECK(x.middle == y.middle);
  CHECK(x.inside_a == y.inside_a);
  CHECK(x.inside_b == y.inside_b);
}

struct Case {
  Potential potential_a, potential_b;
  Vec2 offset;
  double angle;
};

Case square_on_square(samples::Random& random) {
  const Potential square = make_potential(Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  const auto quarter = [&] { return .25 * std::floor(random.uniform(-5, 6)); };
  const double x = quarter();
  return {square, square, {x, quarter()}, 0};
}

// b is `size` times as large as a.
Case any_pair(samples::Random& random, double size) {
  const Polygon a = samples::random_convex(random, random.integer(3, 16));
  std::vector<Vec2> b = samples::random_convex(random, random.integer(3, 16)).vertices();
  for (Vec2& v : b) v *= size;
  const double reach = 1 + .7 * size;
  return {make_potential(a), make_potential(Polygon(b)),
          Vec2(random.uniform(-reach, reach), random.uniform(-reach, reach)), random.uniform(0, 6)};
}

}  // namespace

TEST_CASE("convex pairs have the same bits many at a time, alone, and edge by edge", "[convex]") {
  samples::Random random(11);
  ConvexPairs pairs, single;
  EdgeWorkspace workspace;
  int touching = 0, apart = 0;
  const int batches = 400;
  for (int batch = 0; batch < batches; ++batch) {
    std::deque<Case> cases;  // potentials must stay where they are
    PlacedShapes shapes;
    const int count = random.integer(1, ConvexPairs::kAtOnce);
    std::vector<NearEdges> near(static_cast<size_t>(count));
    for (int i = 0; i < count; ++i) {
      // Edges that lie on each other; any polygons; and long edges, which are shortened.
      const int kind = random.integer(0, 3);
      cases.push_back(kind == 0 ? square_on_square(random) : any_pair(random, kind == 3 ? 25 : 1));
      shapes.add(cases.back().potential_a);
      shapes.add(cases.back().potential_b);
      shapes.place(2 * i, 0, 0, cases.back().angle);
      shapes.place(2 * i + 1, 0, 0, 0);
    }
    for (int i = 0; i < count; ++i) {
      pairs.add(shapes.view(2 * i), shapes.view(2 * i + 1), cases[static_cast<size_t>(i)].offset,
                near[static_cast<size_t>(i)]);
    }
    CHECK(pairs.full() == (count == ConvexPairs::kAtOnce));
    const std::span<const PairIntegral> found = pairs.evaluate();
    REQUIRE(found.size() == static_cast<size_t>(count));
    CHECK(pairs.count() == 0);
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<size_t>(i);
      const Vec2 offset = cases[k].offset;
      PlacedPotential a = shapes.view(2 * i), b = shapes.view(2 * i + 1);
      CAPTURE(batch, i, a.size, b.size);
      NearEdges near_alone, near_swapped;
      single.add(a, b, offset, near_alone);
      check_same(single.evaluate()[0], found[k]);
      CHECK(near_alone.skin == near[k].skin);
      single.add(b, a, -offset, near_swapped);
      const PairIntegral& swapped = single.evaluate()[0];
      CHECK(swapped.force == -found[k].force);
      CHECK(swapped.moment_a == found[k].moment_b);
      CHECK(swapped.moment_b == found[k].moment_a);
      touching += found[k].touching();
      apart += near[k].skin > 0;
      CHECK(!(found[k].touching() && near[k].skin > 0));
      if (a.radius * 4 < b.radius || b.radius * 4 < a.radius) continue;
      // Without a radius a polygon is none of those that go together.
      a.radius = b.radius = 0;
      REQUIRE(!ConvexPairs::serves(a));
      check_same(pair_integral(a, b, offset, workspace), found[k]);
    }
  }
  CHECK(touching > 1000);
  CHECK(apart > 300);
}

namespace {

// A convex polygon with 17 to 2 048 sides, up to a hundred times as long as wide, or a square.
Potential many_sided(samples::Random& random, bool square) {
  const int sides = square ? 4 : static_cast<int>(std::exp2(random.uniform(4.1, 11)));
  std::vector<Vec2> vertices = random.integer(0, 2) == 0 && sides < 200
                                   ? samples::random_convex(random, sides).vertices()
                                   : samples::regular(sides).vertices();
  const double width = std::pow(10, random.uniform(-2, 0));
  for (Vec2& v : vertices) v.y() *= width;
  return make_potential(samples::turned(Polygon(vertices), random.uniform(0, 6)));
}

// The vertex that is farthest in a direction.
Vec2 farthest(const PlacedPotential& p, const Vec2& direction) {
  Vec2 best(p.x[0], p.y[0]);
  for (int v = 1; v < p.size; ++v) {
    if (const Vec2 q(p.x[v], p.y[v]); q.dot(direction) > best.dot(direction)) best = q;
  }
  return best;
}

}  // namespace

TEST_CASE("windows of polygons with many sides have the bits of the polygons", "[convex]") {
  test::SeededRandom random(13);
  EdgeWorkspace workspace;
  const int cases = test::scaled(2000);
  int shallow = 0, shallow_by_windows = 0, apart = 0, apart_by_windows = 0;
  for (int i = 0; i < cases; ++i) {
    const Potential potential_a = many_sided(random, false);
    const Potential potential_b = many_sided(random, random.integer(0, 2) == 0);
    PlacedShapes shapes;
    shapes.add(potential_a), shapes.add(potential_b);
    shapes.place(0, 0, 0, random.uniform(0, 6)), shapes.place(1, 0, 0, random.uniform(0, 6));
    PlacedPotential a = shapes.view(0), b = shapes.view(1);
    const double angle = random.uniform(0, 6);
    const Vec2 normal(std::cos(angle), std::sin(angle));
    const double depth = std::pow(10, random.uniform(-9, 0)) / std::max(a.steepest, b.steepest);
    const double by = random.integer(0, 3) == 0 ? -depth : depth;
    const Vec2 offset = farthest(b, normal) - farthest(a, -normal) - by * normal;
    CAPTURE(i, a.size, b.size, by);
    if (a.radius > 3.9 * b.radius || b.radius > 3.9 * a.radius) continue;  // edges are shortened
    NearEdges near, swapped;
    const auto found = windowed_integral(a, b, offset, near, workspace);
    const auto found_swapped = windowed_integral(b, a, -offset, swapped, workspace);
    // Without a radius nothing is known of the size.
    a.radius = b.radius = 0;
    REQUIRE(!ConvexWindow::serves(a));
    const PairIntegral whole = pair_integral(a, b, offset, workspace);
    if (found) check_same(*found, whole);
    if (found && found_swapped) {
      CHECK(found_swapped->force == -whole.force);
      CHECK(found_swapped->moment_a == whole.moment_b);
    }
    if (whole.touching()) {
      const bool is_shallow = whole.largest_phi < 1e-4;
      shallow += is_shallow;
      shallow_by_windows += is_shallow && found;
    } else {
      ++apart;
      apart_by_windows += found.has_value();
      if (found) CHECK((near.none() && near.skin > 0 && near.skin <= std::abs(by) * (1 + 1e-9)));
    }
  }
  CHECK(shallow_by_windows > test::least(shallow * 2 / 3));
  CHECK(apart_by_windows > test::least(apart * 2 / 3));
}

TEST_CASE("the margin of convex pairs is a bound of their distance", "[convex]") {
  samples::Random random(12);
  ConvexPairs pairs;
  int apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const Case c = any_pair(random, 1);
    PlacedShapes shapes;
    shapes.add(c.potential_a);
    shapes.add(c.potential_b);
    shapes.place(0, 0, 0, c.angle);
    shapes.place(1, 0, 0, 0);
    NearEdges near;
    pairs.add(shapes.view(0), shapes.view(1), c.offset, near);
    if (pairs.evaluate()[0].touching() || near.skin == 0) continue;
    ++apart;
    // Polygons that are moved by almost the skin in any direction still do not touch.
    for (int k = 0; k < 8; ++k) {
      const double direction = k * M_PI / 4;
      const Vec2 moved =
          c.offset + .999 * near.skin * Vec2(std::cos(direction), std::sin(direction));
      NearEdges again;
      pairs.add(shapes.view(0), shapes.view(1), moved, again);
      CHECK(!pairs.evaluate()[0].touching());
    }
  }
  CHECK(apart > 300);
}

TEST_CASE("a pair with a number that is not finite spoils no other pair", "[convex]") {
  const double nan = std::nan("");
  const Potential square = make_potential(Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  PlacedShapes shapes;
  shapes.add(square);
  shapes.place(0, 0, 0, 0);
  const double x[] = {0, 1, nan, 0, 0};
  PlacedPotential broken = shapes.view(0);
  broken.x = x;
  ConvexPairs pairs;
  std::array<NearEdges, 4> near;
  pairs.add(shapes.view(0), shapes.view(0), {.9, .1}, near[0]);
  pairs.add(broken, shapes.view(0), {.9, .1}, near[1]);
  pairs.add(shapes.view(0), shapes.view(0), {nan, 0}, near[2]);
  pairs.add(shapes.view(0), shapes.view(0), {.9, .1}, near[3]);
  const std::span<const PairIntegral> found = pairs.evaluate();
  CHECK(std::isnan(found[1].weight));
  CHECK(std::isnan(found[2].weight));
  CHECK(found[0].weight > 0);
  check_same(found[0], found[3]);
}
