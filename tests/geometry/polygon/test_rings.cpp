// The small tools for rings, boxes and sets that all of the geometry shares.
#include <catch2/catch.hpp>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/disjoint_sets.hpp"
#include "geometry/polygon/half_plane.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/polygon/segment.hpp"

using namespace apothem;

namespace {

const std::vector<Vec2> kTestRing{{1, 1}, {3, 1}, {3, 3}, {1, 3}};

}  // namespace

TEST_CASE("entries of a ring have neighbours across its end", "[rings]") {
  CHECK(next(3, 4) == 0);
  CHECK(next(1, 4) == 2);
  CHECK(previous(0, 4) == 3);
  CHECK(previous(2, 4) == 1);
  CHECK(after(kTestRing, 3) == Vec2(1, 1));
  CHECK(before(kTestRing, 0) == Vec2(1, 3));
}

TEST_CASE("boxes of points, segments and boxes", "[rings]") {
  const Box box = box_of(kTestRing);
  CHECK((box.x0 == 1 && box.y0 == 1 && box.x1 == 3 && box.y1 == 3));
  const Box line = box_of(Vec2(2, -1), Vec2(0, 5));
  CHECK((line.x0 == 0 && line.y0 == -1 && line.x1 == 2 && line.y1 == 5));
  Box both = box;
  both.include(line);
  CHECK((both.x0 == 0 && both.y0 == -1 && both.x1 == 3 && both.y1 == 5));
  both.include(Box());  // an empty one
  CHECK((both.x0 == 0 && both.y0 == -1 && both.x1 == 3 && both.y1 == 5));
}

TEST_CASE("area and moments of a ring", "[rings]") {
  const RingMoments m = ring_moments(kTestRing, {0, 0});
  CHECK(m.area == 4);
  CHECK((m.first - Vec2(8, 8)).norm() < 1e-14);
  CHECK(ring_area(kTestRing) == 4);
  CHECK(ring_area({kTestRing.rbegin(), kTestRing.rend()}) == -4);
}

TEST_CASE("distance of a point from a ring", "[rings]") {
  CHECK(distance_to_ring(kTestRing, {2, 2}) == 1);
  CHECK(distance_to_ring(kTestRing, {0, 2}) == 1);
  CHECK(distance_to_ring(kTestRing, {6, 7}) == 5);
  CHECK(distance_to_ring(std::vector<Vec2>{{1, 1}, {1, 1}}, {4, 5}) == 5);  // of no length
}

TEST_CASE("the part of a ring above a line", "[rings]") {
  std::vector<Vec2> cuts;
  const std::vector<Vec2> part = part_above(
      kTestRing, [](const Vec2& p) { return p.x() - 2; }, &cuts);
  CHECK(ring_area(part) == 2);
  CHECK(cuts == std::vector<Vec2>{{2, 1}, {2, 3}});
  CHECK(part_above(kTestRing, [](const Vec2& p) { return p.x() - 9; }).empty());
}

TEST_CASE("the smallest turn of a ring tells whether it is convex", "[rings]") {
  CHECK(smallest_turn(kTestRing) == 1);
  CHECK(smallest_turn(std::vector<Vec2>{{0, 0}, {1, 0}, {2, 0}, {1, 1}}) == 0);
  CHECK(smallest_turn(std::vector<Vec2>{{0, 0}, {2, 0}, {1, .5}, {1, 2}}) == -1);
}

TEST_CASE("joined sets have one number", "[rings]") {
  DisjointSets sets(4);
  CHECK(sets.join(0, 2));
  CHECK(sets.join(3, 0));
  CHECK_FALSE(sets.join(2, 3));
  CHECK(sets.find(0) == 2);
  CHECK(sets.find(3) == 2);
  CHECK(sets.find(1) == 1);
  sets.reset(4);
  CHECK(sets.find(3) == 3);
}
