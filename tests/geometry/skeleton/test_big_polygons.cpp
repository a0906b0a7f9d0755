// Skeletons of polygons with many vertices, which are made by the trace of a wavefront.
#include <catch2/catch.hpp>
#include <set>

#include "geometry/polygon/predicates.hpp"
#include "geometry/skeleton/double_double.hpp"
#include "geometry/skeleton/skeleton.hpp"
#include "geometry/skeleton/skeleton_parts.hpp"
#include "geometry/skeleton/wavefront.hpp"
#include "tests/random_simple.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::samples;

namespace {

using Ring = std::vector<Vec2>;

// Fails unless the skeleton passes the laws at the first attempt and CGAL is not asked.
Skeleton traced(const Polygon& polygon) {
  std::set<std::string> stages;
  Skeleton skeleton =
      straight_skeleton(polygon, [&](const Stage& stage) { stages.emplace(stage.name); });
  CHECK(skeleton.attempts == 1);
  CHECK(stages == std::set<std::string>{"straight skeleton", "check of the skeleton"});
  const std::optional<std::string> broken = broken_law(skeleton, polygon);
  INFO(broken.value_or(""));
  CHECK(!broken);
  return skeleton;
}

// Every edge divided into `parts` by vertices on it.
Polygon divided(const Polygon& polygon, int parts) {
  Ring ring;
  for (int i = 0; i < polygon.size(); ++i) {
    for (int k = 0; k < parts; ++k) {
      ring.push_back(polygon[i] + double(k) / parts * (polygon.after(i) - polygon[i]));
    }
  }
  return Polygon(ring);
}

}  // namespace

TEST_CASE("double-double numbers have 31 digits", "[skeleton]") {
  const DoubleDouble root = sqrt(DoubleDouble(2));
  CHECK(std::abs(static_cast<double>(root * root - 2.0)) < 1e-30);
  CHECK(static_cast<double>((DoubleDouble(1) + 0x1p-80) - 1.0) == 0x1p-80);
  const DoubleDouble third = DoubleDouble(1) / 3.0;
  CHECK(std::abs(static_cast<double>(third * 3.0 - 1.0)) < 1e-31);
  CHECK(static_cast<double>(third) == 1. / 3);
  CHECK(DoubleDouble(1) < DoubleDouble(1) + 0x1p-90);
  CHECK_FALSE(DoubleDouble(1) + 0x1p-90 < DoubleDouble(1));
}

TEST_CASE("big polygons get a skeleton without CGAL", "[skeleton]") {
  test::SeededRandom random(5);
  const int n = std::max(300, test::scaled(10000));
  traced(random_star_shaped(random, n, .7));
  traced(random_star_shaped(random, n, .99));
  traced(coastline(random, n));
  traced(turned(spiral(6, n / 12), .3));
  traced(random_simple(random, 300));
}

// Where many events happen at the same time and place, exact constructions took minutes for 2000
// vertices and 4 GB for 20 000.
TEST_CASE("big polygons full of simultaneous events get a skeleton without CGAL", "[skeleton]") {
  test::SeededRandom random(6);
  const int n = std::max(300, test::scaled(2000));
  for (const double angle : {0., .3}) {
    CHECK(std::abs(traced(turned(samples::comb(n / 4, 9), angle)).roof_height - .5) < 1e-12);
    traced(turned(star(n / 2, .5), angle));
    traced(turned(skyline(random, n), angle));
    traced(turned(coastline(random, n), angle));
    CHECK(std::abs(traced(turned(divided(cross_of_squares(), n / 12), angle)).roof_height - .5) <
          1e-10);
    CHECK(std::abs(traced(divided(l_shape(), n / 6)).roof_height - .5) < 1e-10);
  }
}

TEST_CASE("the wavefront finds the skeletons that CGAL finds", "[skeleton]") {
  test::SeededRandom random(7);
  for (int i = 0; i < test::scaled(200); ++i) {
    const Polygon polygon = scaled(random_star_shaped(random, random.integer(4, 60), .2), .5);
    const Skeleton expected = straight_skeleton(polygon);
    const std::optional<SkeletonParts> parts = trace_wavefront(polygon, 1, {});
    REQUIRE(parts);
    INFO("polygon " << i);
    CHECK(parts->faces.size() == expected.faces.size());
    CHECK(parts->nodes.size() == expected.nodes.size());
    double roof_height = 0;
    for (const Skeleton::Node& node : parts->nodes) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Skeleton::Node& other : expected.nodes) {
        nearest = std::min(nearest, (polygon.origin() + other.point - node.point).norm() +
                                        std::abs(other.height - node.height));
      }
      CHECK(nearest < 1e-10);
      roof_height = std::max(roof_height, node.height);
    }
    CHECK(std::abs(roof_height - expected.roof_height) < 1e-12);
  }
}

TEST_CASE("the same big polygon gets the same skeleton to the last bit", "[skeleton]") {
  Random random(8);
  const Polygon polygon = coastline(random, 1000);
  const Skeleton first = straight_skeleton(polygon);
  const Skeleton again = straight_skeleton(polygon);
  REQUIRE(again.faces == first.faces);
  for (size_t i = 0; i < first.nodes.size(); ++i) {
    REQUIRE(again.nodes[i].point == first.nodes[i].point);
    REQUIRE(again.nodes[i].height == first.nodes[i].height);
  }
}

TEST_CASE("a wrong skeleton of a big polygon breaks a law", "[skeleton]") {
  Random random(9);
  const Polygon polygon = coastline(random, 500);
  const Skeleton good = straight_skeleton(polygon);
  const auto law = [&](auto spoil) {
    Skeleton bad = good;
    spoil(bad);
    return broken_law(bad, polygon).value_or("none");
  };
  CHECK(law([](Skeleton&) {}) == "none");
  for (const size_t i : {polygon.vertices().size(), good.nodes.size() - 1}) {
    CHECK(law([&](Skeleton& s) { s.nodes[i].point.x() += 1e-6; }) != "none");
    CHECK(law([&](Skeleton& s) { s.nodes[i].point += Vec2(3, 0); }) != "none");
    CHECK(law([&](Skeleton& s) { s.nodes[i].height += 1e-6; }) != "none");
  }
  // All nodes, faces and arcs agree, but the polygon is another one.
  Ring ring = polygon.vertices();
  ring[100] = ring[100] + 1e-3 * (ring[101] - ring[100]);
  CHECK(broken_law(good, Polygon(ring)).has_value());
}

TEST_CASE("a skeleton is refused beyond the limit of vertices", "[skeleton]") {
  CHECK_NOTHROW(require_few_vertices(kMostVertices));
  CHECK_THROWS_WITH(require_few_vertices(kMostVertices + 1),
                    Catch::Contains("has 100001 vertices") &&
                        Catch::Contains("limited to 100000") && Catch::Contains("simplify"));
  CHECK_THROWS_AS(straight_skeleton(regular(kMostVertices + 1)), InvalidPolygon);
}

TEST_CASE("a report that throws ends the construction", "[skeleton]") {
  struct Enough {};
  Random random(10);
  const Polygon polygon = random_star_shaped(random, 1000, .7);
  double last = 0;
  const auto stop_half_way = [&](const Stage& stage) {
    CHECK(stage.done.value_or(last) >= last);
    last = stage.done.value_or(last);
    if (last > .5) throw Enough();
  };
  CHECK_THROWS_AS(straight_skeleton(polygon, stop_half_way), Enough);
  CHECK(last < .6);
}

TEST_CASE("a ring is simple if no two of its edges meet", "[predicates]") {
  test::SeededRandom random(11);
  int simple = 0;
  const int cases = test::scaled(3000);
  for (int i = 0; i < cases; ++i) {
    // On a lattice, so that vertices often lie on edges.
    const int n = random.integer(4, 9);
    Ring ring;
    std::set<std::pair<double, double>> places;
    while (static_cast<int>(ring.size()) < n) {
      const Vec2 v(random.integer(0, 5), random.integer(0, 5));
      if (places.emplace(v.x(), v.y()).second) ring.push_back(v);
    }
    bool spike = false;
    bool meets = false;
    for (int a = 0; a < n; ++a) {
      const int b = (a + 1) % n;
      const int c = (a + 2) % n;
      spike = spike || (orientation(ring[a], ring[b], ring[c]) == 0 &&
                        (ring[b] - ring[a]).dot(ring[c] - ring[b]) < 0);
      for (int k = a + 2; k < n; ++k) {
        if ((k + 1) % n == a) continue;
        meets = meets || segments_meet(ring[a], ring[b], ring[k], ring[(k + 1) % n]);
      }
    }
    if (spike) continue;
    CHECK(is_simple(ring) == !meets);
    simple += meets ? 0 : 1;
  }
  CHECK(simple > test::least(cases / 100));
}
