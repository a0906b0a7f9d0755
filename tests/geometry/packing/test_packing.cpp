// Blocks that are placed never overlap, by exact predicates on the coordinates that scenes get.
#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/packing/arrange.hpp"
#include "geometry/packing/block_shapes.hpp"
#include "geometry/packing/voronoi_blocks.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/spatial/boxes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace packing {
namespace {

using Ring = std::vector<Vec2>;

Box box_of(const Ring& ring) {
  Box box;
  for (const Vec2& v : ring) box.include(v.x(), v.y());
  return box;
}

// No two points of the borders are the same, and none lies in the other: by exact predicates.
bool exactly_apart(const Ring& a, const Ring& b) {
  if (apart(box_of(a), box_of(b))) return true;
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t j = 0; j < b.size(); ++j) {
      if (segments_meet(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return false;
    }
  }
  return !strictly_inside(a, b[0]) && !strictly_inside(b, a[0]);
}

bool exactly_inside(const Ring& inner, const Ring& outer) {
  for (size_t i = 0; i < inner.size(); ++i) {
    for (size_t j = 0; j < outer.size(); ++j) {
      if (segments_meet(inner[i], inner[(i + 1) % inner.size()], outer[j],
                        outer[(j + 1) % outer.size()])) {
        return false;
      }
    }
  }
  return strictly_inside(outer, inner[0]);
}

double distance(const Ring& a, const Ring& b) {
  double least = HUGE_VAL;
  const auto look = [&](const Ring& of, const Ring& to) {
    for (const Vec2& p : of) {
      for (size_t j = 0; j < to.size(); ++j) {
        const Vec2 from = to[j], along = to[(j + 1) % to.size()] - from;
        const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0., 1.);
        least = std::min(least, (from + t * along - p).norm());
      }
    }
  };
  look(a, b), look(b, a);
  return least;
}

void check_all(const std::vector<Ring>& rings, const Ring& region, const std::vector<Ring>& solids,
               double gap) {
  for (size_t i = 0; i < rings.size(); ++i) {
    CHECK(exactly_inside(rings[i], region));
    for (const Ring& solid : solids) CHECK(exactly_apart(rings[i], solid));
    for (size_t j = 0; j < i; ++j) {
      CHECK(exactly_apart(rings[i], rings[j]));
      if (gap > 0) CHECK(distance(rings[i], rings[j]) >= gap * (1 - 1e-12));
    }
  }
}

enum class Kind { quads, polygons, crosses, sizes };

std::vector<Block> blocks_of(Kind kind, RandomNumbers& random, int count) {
  std::vector<Block> blocks;
  for (int i = 0; i < count; ++i) {
    Block b;
    b.scale = kind == Kind::sizes ? .3 * std::pow(10, random.uniform(-2, 0)) : .15;
    b.angle = random.uniform(0, 2 * M_PI);
    b.shape = kind == Kind::crosses ? cross_shape(1)
              : kind == Kind::quads ? random_quadrilateral(random, .9, 2.3)
                                    : random_polygon(random, random.whole(3, 9),
                                                     random.uniform(1, 3), random.uniform(0, 1));
    blocks.push_back(std::move(b));
  }
  return blocks;
}

// An L with a hole, far from the origin of the world.
const Vec2 kFar(1e5, -3e4);
Ring moved(Ring ring) {
  for (Vec2& v : ring) v += kFar;
  return ring;
}
const Ring kRegion = moved({{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 4}, {0, 4}});
const Ring kHole = moved({{.6, .6}, {1.2, .5}, {1, 1.3}});
const Ring kObstacle = moved({{2.5, -1}, {3, 1}, {2.6, 1.2}, {2.4, .5}});

PackingSpace space_with(double gap) {
  PackingSpace space(Polygon(kRegion), {Polygon(kHole)}, gap, .15);
  space.add_obstacle(kObstacle);
  return space;
}

}  // namespace

TEST_CASE("shapes of blocks are simple, about their centroid, and of area 1", "[packing]") {
  RandomNumbers random(3);
  for (int i = 0; i < 300; ++i) {
    const int corners = random.whole(3, 12);
    const Ring quad = random_quadrilateral(random, .9, 2.3);
    const Ring convex = random_polygon(random, corners, random.uniform(1, 5), random.uniform(0, 1));
    CHECK(Polygon(quad).is_convex());
    CHECK(Polygon(convex).is_convex());
    CHECK(static_cast<int>(convex.size()) == corners);
    for (size_t k = 0; k < 4; ++k) {
      const Vec2 a = quad[(k + 1) % 4] - quad[k], b = quad[(k + 3) % 4] - quad[k];
      const double angle = std::acos(a.dot(b) / a.norm() / b.norm());
      CHECK(angle > .9 - 1e-9);
      CHECK(angle < 2.3 + 1e-9);
    }
    for (const Ring& ring : {quad, convex, cross_shape(random.uniform(.2, 3))}) {
      CHECK(ring_area(ring) == Approx(1).epsilon(1e-12));
      const AreaMoments m = area_moments(Polygon(ring));
      CHECK((ring[0] + m.centroid).norm() < 1e-13);
    }
  }
  CHECK_THROWS_AS(random_quadrilateral(random, 1.5707, 1.5709), std::invalid_argument);
}

TEST_CASE("a lattice of equal blocks begins at the border", "[packing]") {
  SeededRandom random(12);
  for (int i = 0; i < scaled(400); ++i) {
    const int n = random.integer(2, 6);
    const double side = random.uniform(.1, 3), gap = i % 2 == 0 ? 0 : side * random.uniform(0, .2);
    const Vec2 from(random.uniform(-5, 5), random.uniform(-5, 5));
    // Room for n squares with gaps beside and twice the gap between them, and hardly more.
    const double size = n * (side + 2 * gap) + 1e-8 * side * n;
    const Polygon region(
        {from, from + Vec2(size, 0), from + Vec2(size, size), from + Vec2(0, size)});
    PackingSpace space(region, {}, gap, side);
    const Block square{{{-.5, -.5}, {.5, -.5}, {.5, .5}, {-.5, .5}}, side};
    const std::vector<Block> blocks(static_cast<size_t>(n * n), square);
    CAPTURE(n, side, gap);
    CHECK(put_on_lattice(space, blocks).placed == n * n);
  }
}

TEST_CASE("blocks of all arrangements keep apart exactly", "[packing]") {
  const Kind kind = GENERATE(Kind::quads, Kind::polygons, Kind::crosses, Kind::sizes);
  for (const double gap : {0., .01}) {
    RandomNumbers random(7);
    const int count = kSanitized ? 30 : 120;
    const std::vector<Block> many = blocks_of(kind, random, count);
    CAPTURE(static_cast<int>(kind), gap);
    {
      PackingSpace space = space_with(gap);
      const Arrangement a = insert_at_random(space, random, many);
      REQUIRE(a.placed == count);
      check_all(a.rings, kRegion, {kHole, kObstacle}, gap);
    }
    {
      PackingSpace space = space_with(gap);
      const std::vector<Block> few(many.begin(), many.begin() + 30);
      const Arrangement a = put_on_lattice(space, few);
      REQUIRE(a.placed == 30);
      check_all(a.rings, kRegion, {kHole, kObstacle}, gap);
    }
    if (kind == Kind::sizes || (kSanitized && kind == Kind::polygons)) continue;
    for (const int number : kSanitized ? std::vector{15} : std::vector{15, 60}) {
      PackingSpace space = space_with(gap);
      std::vector<Block> dense = blocks_of(kind, random, number);
      double solid = 0;
      for (const Block& b : dense) solid += b.scale * b.scale;
      // Few large blocks waste more room at the walls.
      const double goal = std::sqrt((number < 60 ? .42 : .62) * space.area() / solid);
      for (Block& b : dense) b.scale *= goal;
      const Arrangement a = grow(space, random, dense, true);
      REQUIRE(a.placed == number);
      if (kind == Kind::quads) CHECK(a.scale == 1);
      CHECK(a.scale > .9);
      check_all(a.rings, kRegion, {kHole, kObstacle}, gap);
    }
  }
}

TEST_CASE("a space that is full says how many blocks it has taken", "[packing]") {
  RandomNumbers random(1);
  const Ring region{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  PackingSpace space(Polygon(region), {}, 0, .3);
  std::vector<Block> blocks(40, Block{cross_shape(1), .3, 0});
  const Arrangement a = insert_at_random(space, random, blocks);
  CHECK(a.placed > 2);
  CHECK(a.placed < 40);
  int rings = 0;
  for (const Ring& ring : a.rings) rings += !ring.empty();
  CHECK(rings == a.placed);
}

TEST_CASE("the same seed gives the same bits", "[packing]") {
  const auto make = [](std::uint64_t seed) {
    RandomNumbers random(seed);
    PackingSpace space = space_with(0);
    const std::vector<Block> blocks = blocks_of(Kind::polygons, random, 40);
    return insert_at_random(space, random, blocks).rings;
  };
  CHECK(make(5) == make(5));
  CHECK(make(5) != make(6));
}

TEST_CASE("Voronoi blocks fill a region, or leave the gap", "[packing]") {
  const Polygon region({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});
  VoronoiOptions options;
  options.cells = 40;
  for (const double gap : {0., .02}) {
    const std::vector<Ring> blocks = voronoi_blocks(region, options, gap);
    REQUIRE(blocks.size() == 40);
    double area = 0;
    for (const Ring& ring : blocks) area += ring_area(ring);
    if (gap == 0) {
      CHECK(area == Approx(5).epsilon(1e-12));
      continue;
    }
    CHECK(area < 5);
    for (size_t i = 0; i < blocks.size(); ++i) {
      CHECK(distance(blocks[i], region.vertices()) > .01 * (1 - 1e-9));
      for (size_t j = 0; j < i; ++j) {
        CHECK(exactly_apart(blocks[i], blocks[j]));
        CHECK(distance(blocks[i], blocks[j]) > .02 * (1 - 1e-9));
      }
    }
  }
}

TEST_CASE("normal random numbers have the moments of the normal distribution", "[packing]") {
  RandomNumbers random(11);
  const int n = 200000;
  double mean = 0, square = 0, fourth = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    mean += x / n, square += x * x / n, fourth += x * x * x * x / n;
  }
  CHECK(std::abs(mean) < 5 / std::sqrt(double(n)));
  CHECK(std::abs(square - 1) < 5 * std::sqrt(2. / n));
  CHECK(std::abs(fourth - 3) < 5 * std::sqrt(96. / n));
}

}  // namespace packing
