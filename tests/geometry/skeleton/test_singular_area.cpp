#include "geometry/skeleton/singular_area.hpp"

#include <catch2/catch.hpp>
#include <stdexcept>

#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;
using samples::Random;
using Kind = SingularArea::Kind;

namespace {

SingularArea singular(const Ring& ring, double depth) {
  return singular_area(straight_skeleton(Polygon(ring)), depth);
}

double perimeter(const SingularArea& area) {
  double sum = 0;
  for (const Ring& ring : rings_of(area.polygons)) {
    for (size_t i = 0; i < ring.size(); ++i) sum += (ring[(i + 1) % ring.size()] - ring[i]).norm();
  }
  return sum;
}

double area_of(const Ring& ring) {
  double twice = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    twice += apothem::cross(ring[i] - ring[0], ring[(i + 1) % ring.size()] - ring[0]);
  }
  return twice / 2;
}

Ring part_ring(const CutFaces& cut, const CutFaces::Part& part) {
  Ring ring;
  for (const int i : part.nodes) ring.push_back(cut.nodes[i].point);
  return ring;
}

// The part of a convex polygon at least `depth` away from every edge's line: by half-planes alone.
Ring shrunk(const Polygon& polygon, double depth) {
  Ring ring = polygon.local_vertices();
  for (int e = 0; e < polygon.size(); ++e) {
    const Vec2 a = polygon[e] - polygon.origin();
    const Vec2 t = (polygon.after(e) - polygon[e]).normalized();
    const auto height = [&](const Vec2& x) { return apothem::cross(t, x - a) - depth; };
    Ring kept;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 &p = ring[i], &q = ring[(i + 1) % ring.size()];
      const double hp = height(p), hq = height(q);
      if (hp >= 0) kept.push_back(p);
      if ((hp >= 0) != (hq >= 0)) kept.push_back(p + hp / (hp - hq) * (q - p));
    }
    ring = kept;
  }
  return ring;
}

bool inside(const Ring& ring, const Vec2& x) {
  bool result = false;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 a = ring[i] - x, b = ring[(i + 1) % ring.size()] - x;
    if ((a.y() > 0) != (b.y() > 0) && (apothem::cross(a, b) > 0) == (b.y() > a.y()))
      result = !result;
  }
  return result;
}

// Sets of connected skeleton nodes above the depth: by flooding.
int components_above(const Skeleton& skeleton, double depth) {
  std::vector<bool> open;
  for (const Skeleton::Node& node : skeleton.nodes) open.push_back(node.height > depth);
  int count = 0;
  for (size_t first = 0; first < open.size(); ++first) {
    if (!open[first]) continue;
    ++count;
    std::vector<int> queue{static_cast<int>(first)};
    open[first] = false;
    while (!queue.empty()) {
      const int node = queue.back();
      queue.pop_back();
      for (const Skeleton::Arc& arc : skeleton.arcs) {
        if (arc.start != node && arc.end != node) continue;
        const int other = arc.start == node ? arc.end : arc.start;
        if (!open[other]) continue;
        open[other] = false;
        queue.push_back(other);
      }
    }
  }
  return count;
}

double largest_extent(const Polygon& polygon) { return bounding_box(polygon).extent(); }

}  // namespace

TEST_CASE("singular area of a rectangle: a rectangle, then its ridge, then nothing", "[singular]") {
  const Ring rectangle{{-1, 2}, {4, 2}, {4, 4}, {-1, 4}};
  for (const double r : {1e-9, .1, .5, .9, 1 - 1e-9}) {
    const SingularArea area = singular(rectangle, r);
    CHECK(area.kind() == Kind::polygons);
    REQUIRE(area.polygons.size() == 1);
    CHECK(area.polygons[0].outer.size() == 4);
    CHECK(area.segments.empty());
    CHECK(area.points.empty());
    CHECK(std::abs(area.area() - (5 - 2 * r) * (2 - 2 * r)) < 1e-13);
  }
  const SingularArea ridge = singular(rectangle, 1);
  CHECK(ridge.kind() == Kind::segment);
  CHECK(ridge.points.empty());
  REQUIRE(ridge.segments.size() == 1);
  const auto [first, last] = std::minmax({ridge.segments[0][0].x(), ridge.segments[0][1].x()});
  CHECK(first == Approx(1).margin(1e-14));  // from vertex 0 at (-1, 2)
  CHECK(last == Approx(4).margin(1e-14));
  CHECK(ridge.segments[0][0].y() == Approx(1).margin(1e-14));
  CHECK(singular(rectangle, 1 + 1e-9).kind() == Kind::none);
  CHECK(singular(rectangle, HUGE_VAL).kind() == Kind::none);
  // A vertex on a straight side divides the ridge of the skeleton, not that of the singular area.
  const SingularArea divided =
      singular({{-1, 2}, {1, 2}, {2, 2}, {4, 2}, {4, 4}, {1.5, 4}, {-1, 4}}, 1);
  REQUIRE(divided.segments.size() == 1);
  CHECK((divided.segments[0][1] - divided.segments[0][0]).norm() == Approx(3).margin(1e-13));
}

TEST_CASE("singular area at the roof's top", "[singular]") {
  SECTION("a triangle and regular polygons: a point") {
    for (const Ring& ring : {Ring{{0, 0}, {1, 0}, {.3, .9}}, regular_ring(4), regular_ring(5),
                             regular_ring(100), regular_ring(300), regular_ring(1000)}) {
      const Skeleton skeleton = straight_skeleton(Polygon(ring));
      const SingularArea area = singular_area(skeleton, skeleton.roof_height);
      CHECK(area.kind() == Kind::point);
      CHECK(area.points.size() == 1);
      CHECK(area.segments.empty());
    }
  }
  SECTION("a stadium with round ends of many short edges: a segment") {
    // Its end is as deep below the first edge of the round, turned by a, as below the straight one.
    const double length = 3 - 2 * std::tan(M_PI / 1600);
    Ring stadium;
    for (int i = 0; i <= 400; ++i) {
      const double angle = M_PI * (i / 400. - .5);
      stadium.emplace_back(3 + std::cos(angle), std::sin(angle));
    }
    for (int i = 0; i <= 400; ++i) {
      const double angle = M_PI * (i / 400. + .5);
      stadium.emplace_back(std::cos(angle), std::sin(angle));
    }
    for (const double angle : {0., .7}) {
      const Skeleton skeleton = straight_skeleton(Polygon(turned(stadium, angle)));
      const SingularArea area = singular_area(skeleton, skeleton.roof_height);
      CHECK(area.kind() == Kind::segment);
      REQUIRE(area.segments.size() == 1);
      CHECK((area.segments[0][1] - area.segments[0][0]).norm() == Approx(length).margin(1e-10));
      CHECK(area.points.empty());
    }
  }
  SECTION("a cross of five unit squares: a plus of ridges") {
    for (const double angle : {0., .3, 1.}) {
      const SingularArea area = singular(turned(cross_ring(), angle), .5);
      CHECK(area.kind() == Kind::segment);
      CHECK(area.points.empty());
      REQUIRE(area.segments.size() == 4);
      double length = 0;
      for (const auto& [a, b] : area.segments) length += (b - a).norm();
      CHECK(length == Approx(4).margin(1e-12));
    }
  }
  SECTION("three equal tops: three points; one higher: polygons and points") {
    // Diamonds of width 2 on thin necks, the last one larger.
    const auto beads = [](double last) {
      Ring lower, upper;
      for (int i = 0; i < 3; ++i) {
        const double h = i == 2 ? last : 1, x = 4 * i;
        for (const auto& [dx, y] : {std::pair{-h, .1}, {0., h}, {h, .1}}) {
          lower.emplace_back(x + dx, -y);
          upper.emplace_back(x + dx, y);
        }
      }
      lower.insert(lower.end(), upper.rbegin(), upper.rend());
      return lower;
    };
    const Skeleton equal = straight_skeleton(Polygon(beads(1)));
    const SingularArea points = singular_area(equal, equal.roof_height);
    CHECK(points.kind() == Kind::point);
    CHECK(points.points.size() == 3);
    const SingularArea mixed =
        singular_area(straight_skeleton(Polygon(beads(1.5))), equal.roof_height);
    CHECK(mixed.kind() == Kind::polygons);
    CHECK(mixed.polygons.size() == 1);
    CHECK(mixed.points.size() == 2);
    CHECK(mixed.segments.empty());
  }
  SECTION("two rooms and a corridor just as deep: polygons and a segment") {
    const Ring dumbbell{{0, 0},  {4, 0}, {4, 1}, {6, 1}, {6, 0}, {10, 0},
                        {10, 4}, {6, 4}, {6, 3}, {4, 3}, {4, 4}, {0, 4}};
    const SingularArea area = singular(dumbbell, 1);
    CHECK(area.kind() == Kind::polygons);
    CHECK(area.polygons.size() == 2);
    CHECK(area.area() == Approx(2 * 4).margin(1e-13));
    CHECK(area.points.empty());
    REQUIRE(area.segments.size() == 1);
    CHECK((area.segments[0][1] - area.segments[0][0]).norm() == Approx(4).margin(1e-13));
    CHECK(singular(dumbbell, 1 - 1e-6).polygons.size() == 1);
    CHECK(singular(dumbbell, 1 + 1e-6).polygons.size() == 2);
    CHECK(singular(dumbbell, 1 + 1e-6).segments.empty());
  }
}

TEST_CASE("singular area against closed forms", "[singular]") {
  const double r = .25;
  SECTION("regular polygons") {
    for (const int n : {3, 5, 6, 17, 100}) {
      const double apothem = std::cos(M_PI / n);
      const double area = n * apothem * std::sin(M_PI / n);
      const double share = (apothem - r) / apothem;
      CHECK(std::abs(singular(regular_ring(n), r).area() - area * share * share) < 1e-13);
    }
  }
  SECTION("L and cross: strips, a square at each convex corner, one less at each reflex one") {
    // A(r) = A - r P + r^2 (convex - reflex corners), all corners right angles.
    CHECK(std::abs(singular(l_ring(), r).area() - (3 - 8 * r + r * r * 4)) < 1e-14);
    CHECK(std::abs(singular(cross_ring(), r).area() - (5 - 12 * r + r * r * 4)) < 1e-14);
    CHECK(singular(cross_ring(), r).polygons.size() == 1);
    CHECK(singular(cross_ring(), r).polygons[0].outer.size() == 12);
  }
  SECTION("a comb falls apart into its back and its teeth") {
    // Back 5 x .6, three teeth 1 x 3: the back is gone from .3 to .5 but where teeth stand on it.
    const Ring comb{{0, 0},   {5, 0},   {5, 3.6}, {4, 3.6}, {4, .6},  {3, .6},
                    {3, 3.6}, {2, 3.6}, {2, .6},  {1, .6},  {1, 3.6}, {0, 3.6}};
    CHECK(singular(comb, .29).polygons.size() == 1);
    const SingularArea teeth = singular(comb, .4);
    REQUIRE(teeth.polygons.size() == 3);
    for (const Ring& tooth : rings_of(teeth.polygons)) {
      CHECK(area_of(tooth) == Approx((1 - 2 * .4) * (3.6 - 2 * .4)).margin(1e-13));
    }
  }
}

TEST_CASE("singular area of a convex polygon: the intersection of shifted half-planes",
          "[singular]") {
  test::SeededRandom random(7);
  for (int i = 0; i < scaled(300); ++i) {
    const Polygon polygon = samples::random_convex(random, random.integer(3, 40));
    const Skeleton skeleton = straight_skeleton(polygon);
    const double r = random.uniform(0, 1) * skeleton.roof_height;
    CHECK(std::abs(singular_area(skeleton, r).area() - area_of(shrunk(polygon, r))) < 1e-14);
    // The inradius is the same height, found another way.
    CHECK(singular_area(skeleton, inscribed_circle(polygon).radius).kind() == Kind::point);
  }
}

TEST_CASE("singular areas of any shape are level, nested, simple and shrink by their perimeter",
          "[singular]") {
  test::SeededRandom random(8);
  std::vector<Polygon> polygons{Polygon(cross_ring(.7)),    Polygon(l_ring()),
                                Polygon(star_ring(7, .35)), Polygon(comb_ring(6)),
                                Polygon(spiral_ring(2)),    Polygon(regular_ring(30))};
  for (int i = 0; i < scaled(200); ++i) {
    polygons.push_back(random_polygon(random, random.integer(5, 60)));
  }
  for (const Polygon& polygon : polygons) {
    const Skeleton skeleton = straight_skeleton(polygon);
    const double size = largest_extent(polygon);
    SingularArea outer;
    outer.polygons = {{polygon.local_vertices(), {}}};
    for (const double share : {.02, .2, .4, .6, .8, .95}) {
      const double r = share * skeleton.roof_height;
      const SingularArea area = singular_area(skeleton, r);
      REQUIRE(!area.polygons.empty());
      CHECK(static_cast<int>(area.polygons.size()) == components_above(skeleton, r));
      double worst = 0;
      for (const Ring& ring : rings_of(area.polygons)) {
        CHECK(area_of(ring) > 0);
        // Level: in the face that holds it, the roof is the distance to the face's line.
        for (const Vec2& x : ring) {
          double nearest = HUGE_VAL;
          for (int e = 0; e < polygon.size(); ++e) {
            const Vec2 t = (polygon.after(e) - polygon[e]).normalized();
            const double h = apothem::cross(t, x - (polygon[e] - polygon.origin()));
            nearest = std::min(nearest, std::abs(h - r));
          }
          worst = std::max(worst, nearest);
          CHECK(std::any_of(outer.polygons.begin(), outer.polygons.end(),
                            [&](const PolygonWithHoles& o) { return inside(o.outer, x); }));
        }
      }
      CHECK(worst < 1e-13 * size);
      // dA/dr = - perimeter, exactly linear between the heights of two nodes: central difference.
      const double step = 1e-6 * skeleton.roof_height;
      const double slope =
          (singular_area(skeleton, r + step).area() - singular_area(skeleton, r - step).area()) /
          (2 * step);
      CHECK(std::abs(slope + perimeter(area)) < 1e-4 * perimeter(area));
      outer = area;
    }
  }
}

TEST_CASE("faces cut at a depth tile the polygon, the parts above it the singular area",
          "[singular]") {
  test::SeededRandom random(9);
  for (int i = 0; i < scaled(200); ++i) {
    const Polygon polygon = random_polygon(random, random.integer(5, 60));
    const Skeleton skeleton = straight_skeleton(polygon);
    const double r = random.uniform(0, 1.1) * skeleton.roof_height;
    const CutFaces cut = cut_faces(skeleton, r);
    double above = 0, below = 0;
    for (const CutFaces::Part& part : cut.parts) {
      (part.above ? above : below) += area_of(part_ring(cut, part));
      for (const int node : part.nodes) {
        const double height = cut.nodes[node].height;
        CHECK((part.above ? height >= r : height <= r));
      }
    }
    const double area = area_moments(polygon).area;
    CHECK(std::abs(above + below - area) < 1e-13 * area);
    CHECK(std::abs(above - singular_area(skeleton, r).area()) < 1e-13 * area);
  }
}

TEST_CASE("a depth that is none is refused", "[singular]") {
  const Skeleton skeleton = straight_skeleton(quad_q());
  for (const double depth : {0., -1., std::nan("")}) {
    CHECK_THROWS_AS(singular_area(skeleton, depth), std::invalid_argument);
    CHECK_THROWS_AS(cut_faces(skeleton, depth), std::invalid_argument);
  }
}
