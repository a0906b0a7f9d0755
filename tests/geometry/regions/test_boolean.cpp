// Boolean operations on polygons, and what rings surround by the even-odd rule.
#include "geometry/regions/boolean.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/exact/overlap.hpp"
#include "geometry/polygon/triangulation.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using test::Ring;
using Polygons = std::vector<PolygonWithHoles>;

namespace {

Ring box_ring(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

Polygons operate(const Ring& a, const Ring& b, BooleanOperation operation) {
  return boolean_operation(Polygon(a), Polygon(b), operation);
}

// Rings are simple, outer ones turn to the left, holes to the right.
void check_rings(const Polygons& polygons) {
  for (const PolygonWithHoles& polygon : polygons) {
    CHECK_NOTHROW(Polygon(polygon.outer));
    CHECK(ring_area(polygon.outer) > 0);
    for (const Ring& hole : polygon.holes) {
      CHECK_NOTHROW(Polygon(hole));
      CHECK(ring_area(hole) < 0);
    }
  }
}

}  // namespace

TEST_CASE("operations on two squares have the vertices that they should", "[boolean]") {
  const Ring a = box_ring(0, 0, 2, 2), b = box_ring(1, 1, 3, 3);
  const Polygons both = operate(a, b, BooleanOperation::intersection);
  REQUIRE(both.size() == 1);
  CHECK(both[0].outer == Ring{{2, 2}, {1, 2}, {1, 1}, {2, 1}});
  const Polygons joined = operate(a, b, BooleanOperation::join);
  REQUIRE(joined.size() == 1);
  CHECK(joined[0].outer == Ring{{0, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 3}, {1, 3}, {1, 2}, {0, 2}});
  const Polygons rest = operate(a, b, BooleanOperation::difference);
  REQUIRE(rest.size() == 1);
  CHECK(rest[0].outer == Ring{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
}

TEST_CASE("results may have holes and parts, or be empty", "[boolean]") {
  const Ring frame = box_ring(0, 0, 6, 6);
  const Polygons ring = operate(frame, box_ring(1, 1, 2, 2), BooleanOperation::difference);
  REQUIRE(ring.size() == 1);
  CHECK(ring[0].outer == frame);
  REQUIRE(ring[0].holes.size() == 1);
  CHECK(area_of(ring) == 35);
  const Polygons halves = operate(frame, box_ring(2, -1, 3, 7), BooleanOperation::difference);
  CHECK(halves.size() == 2);
  CHECK(area_of(halves) == 30);
  CHECK(operate(frame, box_ring(6, 0, 7, 6), BooleanOperation::intersection).empty());
  CHECK(operate(frame, frame, BooleanOperation::difference).empty());
  CHECK(operate(frame, frame, BooleanOperation::join)[0].outer == frame);
}

TEST_CASE("edges that meet along a length leave no vertex behind", "[boolean]") {
  const Polygons joined =
      operate(box_ring(0, 0, 2, 2), box_ring(2, 0, 4, 2), BooleanOperation::join);
  REQUIRE(joined.size() == 1);
  CHECK(joined[0].outer == Ring{{0, 0}, {2, 0}, {4, 0}, {4, 2}, {2, 2}, {0, 2}});
  // An edge that only touches from outside divides nothing.
  const Ring tip{{1, 2}, {2, 3}, {0, 3}};
  const Polygons rest = operate(box_ring(0, 0, 2, 2), tip, BooleanOperation::difference);
  REQUIRE(rest.size() == 1);
  CHECK(rest[0].outer == box_ring(0, 0, 2, 2));
}

TEST_CASE("rings that touch in points are kept apart", "[boolean]") {
  const auto diamond = [](double x, double y) {
    return Ring{{x - 1, y}, {x, y - 1}, {x + 1, y}, {x, y + 1}};
  };
  // A hole that touches the outer ring, and two that touch each other.
  const Polygons one = even_odd_polygons({box_ring(0, 0, 6, 6), diamond(1, 3), diamond(3, 3)});
  REQUIRE(one.size() == 1);
  CHECK(one[0].holes.size() == 2);
  CHECK(area_of(one) == 32);
  check_rings(one);
  // Two parts that meet in a point.
  const Polygons two = even_odd_polygons({box_ring(0, 0, 1, 1), box_ring(1, 1, 2, 2)});
  CHECK(two.size() == 2);
  check_rings(two);
  // What lies in a hole is a part of its own.
  CHECK(even_odd_polygons({box_ring(0, 0, 6, 6), box_ring(1, 1, 5, 5), box_ring(2, 2, 3, 3)})
            .size() == 2);
}

TEST_CASE("rings that cross themselves surround what the even-odd rule says", "[boolean]") {
  const Polygons bow = even_odd_polygons({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}});
  CHECK(bow.size() == 2);
  CHECK(area_of(bow) == 2);
  Ring star = test::regular_ring(5);
  star = {star[0], star[2], star[4], star[1], star[3]};
  const Polygons tips = even_odd_polygons({star});
  CHECK(tips.size() == 5);  // the middle is surrounded twice
  check_rings(tips);
  // Spikes, repeated vertices and lines without area vanish; straight vertices stay.
  const Ring spiky{{0, 0}, {1, 0}, {1, 0}, {2, 0}, {5, 0}, {2, 0}, {2, 2}, {0, 2}};
  const Polygons clean = even_odd_polygons({spiky, {{7, 7}, {8, 8}}, {{9, 9}}});
  REQUIRE(clean.size() == 1);
  CHECK(clean[0].outer == Ring{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}});
  CHECK(even_odd_polygons({{{0, 0}, {1, 0}, {2, 0}}}).empty());
  CHECK_THROWS_AS(even_odd_polygons({{{0, 0}, {NAN, 0}, {2, 0}}}), InvalidPolygon);
}

TEST_CASE("a valid ring stays as it is, counter-clockwise from its first vertex", "[boolean]") {
  test::SeededRandom random(71);
  for (int k = 0; k < test::scaled(400); ++k) {
    const Polygon polygon = test::random_polygon(random, 3 + k % 40);
    Ring ring = polygon.vertices();
    if (k % 2) std::reverse(ring.begin() + 1, ring.end());
    const Polygons same = even_odd_polygons({ring});
    REQUIRE(same.size() == 1);
    CHECK(same[0].outer == polygon.vertices());
  }
}

TEST_CASE("areas of random pairs add up, here and far away", "[boolean]") {
  test::SeededRandom random(72);
  for (int k = 0; k < test::scaled(400); ++k) {
    const Vec2 far = k % 2 ? Vec2(3e6, -7e6) : Vec2(0, 0);
    const Polygon a = samples::shifted(test::random_polygon(random, 3 + k % 30), far);
    const Polygon b = samples::shifted(test::random_polygon(random, 3 + k % 17),
                                       far + Vec2(random.uniform(-1, 1), random.uniform(-1, 1)));
    const Polygons joined = boolean_operation(a, b, BooleanOperation::join);
    const Polygons both = boolean_operation(a, b, BooleanOperation::intersection);
    const Polygons a_alone = boolean_operation(a, b, BooleanOperation::difference);
    const Polygons b_alone = boolean_operation(b, a, BooleanOperation::difference);
    for (const Polygons* result : {&joined, &both, &a_alone, &b_alone}) check_rings(*result);
    const double margin = k % 2 ? 1e-8 : 1e-13;  // a unit in the last place of 7e6 is 9e-10
    CHECK(std::abs(area_of(a_alone) + area_of(both) - area_moments(a).area) < margin);
    CHECK(std::abs(area_of(b_alone) + area_of(both) - area_moments(b).area) < margin);
    CHECK(std::abs(area_of(joined) - area_of(both) - area_of(a_alone) - area_of(b_alone)) < margin);
    double overlap = 0;  // by CGAL's own Boolean operations
    for (const OverlapPolygon& part : overlap_polygons(a, b, a.origin())) {
      overlap += ring_area(part.vertices);
    }
    CHECK(std::abs(area_of(both) - overlap) < margin);
  }
}

TEST_CASE("crossings are rounded to the nearest double", "[boolean]") {
  test::SeededRandom random(73);
  for (int k = 0; k < test::scaled(200); ++k) {
    // The steep edge crosses y = 0 at x = p + (q - p) / 3, which long double has with 11 digits
    // more.
    const double p = random.uniform(0, 1), q = random.uniform(2, 3);
    const Polygons both = operate({{p, 1}, {q, -2}, {9, -2}, {9, 1}}, box_ring(0, 0, 8, 1),
                                  BooleanOperation::intersection);
    REQUIRE(both.size() == 1);
    const long double exact = p + (static_cast<long double>(q) - p) / 3;
    const Ring& ring = both[0].outer;
    CHECK(std::count(ring.begin(), ring.end(), Vec2(static_cast<double>(exact), 0)) == 1);
  }
}

TEST_CASE("needles whose rounded crossings lie on the wrong side become valid rings", "[boolean]") {
  test::SeededRandom random(74);
  for (int k = 0; k < test::scaled(200); ++k) {
    Ring tangle;
    for (int i = 0; i < 12; ++i) {
      // A few units in the last place apart, far away.
      tangle.emplace_back(1e6 + 1e-9 * std::floor(random.uniform(0, 12)),
                          random.uniform(-1, 1) * (i % 3 ? 1 : 1e-9));
    }
    check_rings(even_odd_polygons({tangle}));
  }
}

TEST_CASE("a polygon with holes is triangulated", "[boolean]") {
  const PolygonWithHoles plate{{{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 3}},
                               {{{1, 1}, {1, 2}, {2, 2}, {2, 1}}, {{0, 3}, {1, 4}, {1, 3}}}};
  std::vector<Vec2> points;
  for (const Ring& ring : rings_of(plate)) points.insert(points.end(), ring.begin(), ring.end());
  double area = 0;
  for (const Triangle& t : triangulate(plate)) {
    const double part = ring_area({points[t[0]], points[t[1]], points[t[2]]});
    CHECK(part > 0);
    area += part;
  }
  CHECK(area == Approx(area_of(plate)).epsilon(1e-14));
}
