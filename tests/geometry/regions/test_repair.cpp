// Faults of rings, their repair, and values at points.
#include "geometry/regions/repair.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/polygon/segment.hpp"
#include "geometry/potential/point_values.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using test::Ring;

namespace {

std::vector<std::string> words(const Rings& rings) {
  std::vector<std::string> list;
  for (const RingFault& fault : faults_of(rings)) list.push_back(describe(fault));
  return list;
}
using Words = std::vector<std::string>;

}  // namespace

TEST_CASE("all faults of a ring are found, with their places", "[repair]") {
  const Ring square{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  CHECK(words({square}).empty());
  CHECK(words({{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}}}).empty());  // closed as formats ask for
  CHECK(
      words({{{0, 0}, {2, 2}, {2, 0}, {0, 2}, {0, 2}}}) ==
      Words{"vertex 4 repeats the one before at (0, 2) m", "edge 0 and edge 2 cross at (1, 1) m"});
  CHECK(words({{{0, 0}, {4, 0}, {6, 0}, {4, 0}, {4, 4}, {0, 4}}}) ==
        Words{"vertex 2 is a spike at (6, 0) m", "vertex 3 repeats the one before at (4, 0) m"});
  CHECK(words({{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}}) ==
        Words{"vertex 3 touches edge 0 at (2, 0) m"});
  CHECK(words({{{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}}) ==
        Words{"vertex 4 touches vertex 1 at (2, 2) m"});
  CHECK(words({{{0, 0}, {1, 0}, {2, 0}}}).back() == "the ring has no area at (0, 0) m");
  CHECK(words({square, {{1, 1}, {1, 5}, {2, 1}}}) ==
        Words{"edge 2 and edge 0 of hole 1 cross at (1, 4) m",
              "edge 2 and edge 1 of hole 1 cross at (1.25, 4) m"});
  CHECK(words({square, {{5, 5}, {6, 5}, {6, 6}}}) == Words{"hole 1 lies outside at (5, 5) m"});
  CHECK(words({square, {{1, 1}, {1, 3}, {3, 3}, {3, 1}}, {{1.5, 1.5}, {2, 1.5}, {2, 2}}}) ==
        Words{"hole 2 lies in hole 1 at (1.5, 1.5) m"});
  const Words along = words({{{0, 0}, {4, 0}, {4, 2}, {1, 0}, {3, 0}, {4, 4}}});
  CHECK(std::count(along.begin(), along.end(), "edge 0 and edge 3 lie on each other at (1, 0) m") ==
        1);
}

TEST_CASE("rings without faults are those that are polygons", "[repair]") {
  test::SeededRandom random(81);
  for (int k = 0; k < test::scaled(2000); ++k) {
    Ring ring;  // on a small lattice, so that vertices and edges often meet
    for (int i = 0; i < 4 + k % 4; ++i) {
      ring.emplace_back(std::floor(random.uniform(0, 4)), std::floor(random.uniform(0, 4)));
    }
    bool polygon = true;
    try {
      const Polygon valid(ring);
      polygon = valid.vertices().size() == ring.size();
    } catch (const InvalidPolygon&) {
      polygon = false;
    }
    INFO(k);
    const bool closed = ring.front() == ring.back();
    if (!closed) CHECK(words({ring}).empty() == polygon);
  }
}

TEST_CASE("simplification stays within its distance and keeps polygons valid", "[repair]") {
  test::SeededRandom random(82);
  for (int k = 0; k < test::scaled(100); ++k) {
    const Polygon polygon = test::random_polygon(random, 60);
    const double tolerance = random.uniform(0.001, 0.05);
    const Repaired repaired = repair({polygon.vertices()}, tolerance);
    CHECK(repaired.faults.empty());
    CHECK(repaired.hausdorff_distance <= tolerance);
    Rings after = rings_of(repaired.polygons);
    if (after.size() != 1) continue;
    CHECK_NOTHROW(Polygon(after[0]));
    for (const Vec2& v : polygon.vertices()) {
      CHECK(distance_to_ring(after[0], v) <= repaired.hausdorff_distance + 1e-15);
    }
  }
}

TEST_CASE("values at points are decided exactly at the boundary", "[points]") {
  const Polygon polygon(test::l_ring());
  const Potential potential = make_potential(polygon);
  const PointEvaluator at(polygon, potential);
  for (int i = 0; i < polygon.size(); ++i) {
    const PointValues corner = at(polygon[i]);
    CHECK(corner.side == Side::boundary);
    CHECK(corner.phi == 0);
    CHECK(corner.signed_distance == 0);
    const PointValues middle = at((polygon[i] + polygon.after(i)) / 2);
    CHECK(middle.side == Side::boundary);
    CHECK(middle.nearest_edge == i);
    CHECK(middle.gradient.norm() > 0);
  }
  CHECK(at({-1e-150, 0.5}).side == Side::outside);
  CHECK(at({-1e-150, 0.5}).phi == 0);
  CHECK(at({-1e-150, 0.5}).signed_distance > 0);
}

TEST_CASE("the potential at points of a roof is continuous and its gradient right", "[points]") {
  test::SeededRandom random(83);
  for (int k = 0; k < test::scaled(40); ++k) {
    const Polygon polygon = test::random_polygon(random, 5 + k % 20);
    for (const PotentialChoice::Field field :
         {PotentialChoice::Field::roof, PotentialChoice::Field::distance}) {
      const Potential potential = make_potential(polygon, {.field = field});
      const PointEvaluator at(polygon, potential);
      int checked = 0, right = 0;
      for (int i = 0; i < 50; ++i) {
        const Vec2 p(random.uniform(-1, 1), random.uniform(-1, 1));
        const PointValues here = at(p);
        CHECK((here.phi > 0) == (here.side == Side::inside));
        CHECK(here.phi <= 1);
        if (here.side != Side::inside) continue;
        const double step = 1e-8;
        const Vec2 difference((at(p + Vec2(step, 0)).phi - at(p - Vec2(step, 0)).phi) / (2 * step),
                              (at(p + Vec2(0, step)).phi - at(p - Vec2(0, step)).phi) / (2 * step));
        ++checked;
        right += (difference - here.gradient).norm() < 1e-5 * potential.steepest + 1e-4;
      }
      CHECK(right >= checked - 1);  // one point may be within a step of a ridge
    }
  }
}
