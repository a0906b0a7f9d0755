// The own lengths of a pair: which part of each boundary counts where edges lie on each other. All
// methods have to agree about it.
#include "geometry/spatial/boundary_inside.hpp"

#include <catch2/catch.hpp>

#include "geometry/exact/exact_integral.hpp"
#include "geometry/exact/overlap.hpp"
#include "tests/fuzz/pair_check.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

// Turns that the coordinates represent exactly, so that shared edges stay shared.
const std::vector<std::array<double, 4>> kExactMaps{
    {1, 0, 0, 1}, {0, -1, 1, 0}, {3, -4, 4, 3}, {5, -12, 12, 5}, {1, -1, 1, 1}};

Polygon mapped(const Polygon& polygon, const std::array<double, 4>& m) {
  return samples::mapped(polygon, [&](const Vec2& v) {
    return Vec2(m[0] * v.x() + m[1] * v.y(), m[2] * v.x() + m[3] * v.y());
  });
}

// Checks the own lengths of a and b by every method, for both fields, in several turns, with the
// polygons in both orders.
void check(const Polygon& a, const Polygon& b, double own_a, double own_b) {
  for (const auto& map : kExactMaps) {
    const double scale = std::hypot(map[0], map[2]);
    for (const bool swapped : {false, true}) {
      const Polygon x = mapped(swapped ? b : a, map);
      const Polygon y = mapped(swapped ? a : b, map);
      const double own_x = scale * (swapped ? own_b : own_a);
      const double own_y = scale * (swapped ? own_a : own_b);
      for (const auto field : {PotentialChoice::Field::roof, PotentialChoice::Field::distance}) {
        const PotentialChoice choice{.field = field};
        const Potential of_x = make_potential(x, choice), of_y = make_potential(y, choice);
        for (const PairResult& r : {edge_method(x, of_x, y, of_y), overlap_method(x, of_x, y, of_y),
                                    exact_method(x, y, choice)}) {
          CHECK(r.integral.own_length_a == Approx(own_x).epsilon(1e-14).margin(1e-300));
          CHECK(r.integral.own_length_b == Approx(own_y).epsilon(1e-14).margin(1e-300));
        }
      }
    }
  }
}

const Polygon kSquare = samples::block(0, 0, 4, 4);
const Polygon kCorner({{0, 0}, {8, 0}, {8, 4}, {4, 4}, {4, 8}, {0, 8}});

}  // namespace

TEST_CASE("own lengths of polygons that share an edge from outside are zero",
          "[own-length][slow]") {
  check(kSquare, samples::block(4, 0, 8, 4), 0, 0);  // the whole edge
  check(kSquare, samples::block(4, 1, 8, 9), 0, 0);  // parts of both
  check(kSquare, samples::block(4, 4, 8, 8), 0, 0);  // a vertex
  check(kCorner, samples::block(4, 4, 8, 8), 0, 0);  // two edges at a reflex vertex
  check(kCorner, kCorner, 32, 32);
}

TEST_CASE("own lengths count edges shared from inside for both", "[own-length]") {
  check(kSquare, kSquare, 16, 16);
  check(kSquare, samples::block(0, 0, 2, 2), 4, 8);  // two edges shared in part
  check(kSquare, samples::block(1, 0, 3, 2), 2, 8);  // the middle of an edge
  check(kSquare, samples::block(0, 0, 4, 2), 8, 12);
  check(kCorner, kSquare, 8, 16);
  check(kCorner, samples::block(0, 0, 8, 2), 12, 20);
}

TEST_CASE("own lengths where edges are shared from both sides", "[own-length][slow]") {
  // The block fills the corner, lies on one of its edges from outside, and overlaps with the rest.
  check(kCorner, samples::block(2, 4, 6, 6), 2, 6);
  // A U holds a block that lies on its bottom from outside and bites into one of its legs.
  const Polygon u({{0, 0}, {12, 0}, {12, 8}, {8, 8}, {8, 2}, {4, 2}, {4, 8}, {0, 8}});
  check(u, samples::block(5, 2, 9, 6), 4, 6);
  check(u, samples::block(4, 2, 8, 6), 0, 0);
}

TEST_CASE("own lengths without a shared edge", "[own-length]") {
  check(kSquare, samples::block(1, 1, 3, 3), 0, 8);
  check(kSquare, samples::block(2, 2, 6, 6), 4, 4);
  check(kSquare, samples::block(5, 5, 6, 6), 0, 0);
  check(kCorner, samples::block(-1, 3, 9, 5), 2 + 1 + 4 + 1, 2 * 4 + 4 + 4 - 4);
}

TEST_CASE("own lengths of edges that are shared at any angle", "[own-length]") {
  test::SeededRandom random(91);
  for (int i = 0; i < test::scaled(200); ++i) {
    // The polygons have vertices in common, and no other point of their boundaries.
    const double turn = random.uniform(0, 6);
    const Vec2 p = samples::turned(Vec2(random.uniform(-3, 3), 0), turn);
    const Vec2 q = p + samples::turned(Vec2(random.uniform(1, 2), 0), turn);
    const Vec2 n = samples::turned(Vec2(0, 1), turn);
    const Polygon above({p, q, q + .7 * n, p + n});
    const Polygon below({q, p, p - n, q - .8 * n});
    const Polygon flat({p, q, (p + q) / 2 + .3 * n});
    const double shared = (q - p).norm();
    const double sides = ((p + q) / 2 + .3 * n - p).norm() + ((p + q) / 2 + .3 * n - q).norm();
    CHECK(boundary_inside(above, below) == 0);
    CHECK(boundary_inside(below, above) == 0);
    CHECK(boundary_inside(above, flat) == Approx(shared).epsilon(1e-14));
    CHECK(boundary_inside(flat, above) == Approx(shared + sides).epsilon(1e-14));
    CHECK(test::edge(above, below).integral.own_length_a == 0);
    CHECK(test::edge(above, below).integral.weight == 0);
    const PairIntegral kernel =
        test::kernel(above, make_potential(above), below, make_potential(below));
    CHECK(kernel.weight < 1e-15);  // decided with rounded heights
    CHECK(test::edge(flat, above).integral.own_length_b == Approx(shared).epsilon(1e-14));
  }
}

// Combs and stars of so many edges that trees find what counts, against the exact overlap. Shifts
// by whole numbers lay many edges on each other.
TEST_CASE("the boundary and the area inside of polygons of many vertices", "[own-length]") {
  test::SeededRandom random(93);
  for (int i = 0; i < test::scaled(24); ++i) {
    const Polygon a = i % 2 == 0 ? samples::comb(random.integer(20, 40), 9)
                                 : samples::random_star_shaped(random, 120, .7);
    const double grid = i % 4 == 0 ? 1 : 1e-3;
    const Vec2 reach = .5 * Vec2::Constant(bounding_box(a).extent());
    const auto step = [&](double most) {
      return grid * std::round(random.uniform(0, most) / grid);
    };
    const Polygon b = samples::shifted(a, {step(reach.x()), step(i % 2 == 0 ? 5 : reach.y())});
    const PotentialChoice choice{.field = PotentialChoice::Field::distance,
                                 .reference = PotentialChoice::Reference::inscribed_circle};
    const PairResult exact =
        overlap_method(a, make_potential(a, choice), b, make_potential(b, choice));
    const PairResult edge = edge_method(a, make_potential(a, choice), b, make_potential(b, choice));
    INFO("pair " << i);
    const double length = exact.integral.own_length_a + exact.integral.own_length_b;
    CHECK(std::abs(boundary_inside(a, b) - exact.integral.own_length_a) <= 1e-12 * length);
    CHECK(std::abs(boundary_inside(b, a) - exact.integral.own_length_b) <= 1e-12 * length);
    CHECK(std::abs(area_inside(a, b) - exact.volume.overlap_area) <= 1e-12 * length);
    CHECK(std::abs(area_inside(b, a) - exact.volume.overlap_area) <= 1e-12 * length);
    CHECK((edge.integral.force - exact.integral.force).norm() <= 1e-12 * exact.integral.weight);
    CHECK(std::abs(edge.volume.energy - exact.volume.energy) <= 1e-12 * length);
  }
}
