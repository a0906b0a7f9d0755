// Pairs of polygons with few near edges, against the segments of each edge alone.
#include <catch2/catch.hpp>
#include <cmath>

#include "apps/cases/samples.hpp"
#include "geometry/integrals/contact_patches.hpp"
#include "tests/geometry/nonconvex_pairs.hpp"
#include "tests/geometry/patches.hpp"
#include "tests/support.hpp"

namespace apothem {
namespace {

using Field = PotentialChoice::Field;

// Two crosses that have been moved together along a direction until they overlap by `depth`.
struct Touching {
  PlacedShapes placed;
  Vec2 offset = Vec2::Zero();
  NearEdges near;

  Touching(const Potential& potential, samples::Random& random, double depth) {
    EdgeWorkspace memory;
    const double turned = random.uniform(0, 6);
    // The other one is turned at random, or its sides are nearly parallel.
    const double other = random.integer(0, 1) ? random.uniform(0, 6)
                                              : turned + M_PI / 2 * random.integer(0, 3) +
                                                    random.uniform(-1e-3, 1e-3);
    placed.place(placed.add(potential), 0, 0, turned);
    placed.place(placed.add(potential), 0, 0, other);
    const double direction = random.uniform(0, 6);
    const Vec2 away(std::cos(direction), std::sin(direction));
    double touching = 1, apart = 4;
    for (int k = 0; k < 40; ++k) {
      const double middle = (touching + apart) / 2;
      const bool touch = whole(middle * away, memory).touching();
      (touch ? touching : apart) = middle;
    }
    offset = (touching - depth) * away;
    NearEdgesWorkspace near_memory;
    near = near_edges(placed.view(0), placed.view(1), offset, 1e-3, near_memory);
  }
  [[nodiscard]] PairIntegral whole(const Vec2& at, EdgeWorkspace& memory) const {
    return pair_integral(placed.view(0), placed.view(1), at, memory);
  }
};

bool same(const PairIntegral& p, const PairIntegral& q) {
  return p.force == q.force && p.moment_a == q.moment_a && p.moment_b == q.moment_b &&
         p.weight == q.weight && p.centre == q.centre && p.depth == q.depth &&
         p.breadth == q.breadth && p.middle == q.middle && p.largest_phi == q.largest_phi &&
         p.own_length_a == q.own_length_a && p.own_length_b == q.own_length_b &&
         p.inside_a == q.inside_a && p.inside_b == q.inside_b;
}

bool same(const BoundarySegment& r, const BoundarySegment& s) {
  return r.of_a == s.of_a && r.edge == s.edge && r.patch == s.patch && r.from == s.from &&
         r.to == s.to && r.start == s.start && r.end == s.end && r.force == s.force &&
         r.moment_a == s.moment_a && r.moment_b == s.moment_b && r.weight == s.weight &&
         r.centre == s.centre && r.length == s.length && r.largest_phi == s.largest_phi;
}

}  // namespace

TEST_CASE("crosses that touch with few edges: the bits of each edge by itself", "[layer][near]") {
  test::SeededRandom random(7);
  PatchWorkspace memory;
  for (const Field field : {Field::roof, Field::distance}) {
    const Polygon cross = samples::cross_of_squares();
    const Potential potential =
        translated(make_potential(cross, {.field = field}), area_moments(cross).centroid);
    const int pairs = test::scaled(400);
    int by_pair = 0, across = 0, split = 0;
    for (int i = 0; i < pairs; ++i) {
      Touching t(potential, random, std::pow(10, random.uniform(-7, -1)));
      const PlacedPotential a = t.placed.view(0), b = t.placed.view(1);
      test::PatchResult alone, found;
      const PairIntegral whole =
          contact_patches(a, b, t.offset, memory, alone.segments, alone.patches);
      const PairIntegral pair =
          contact_patches(a, b, t.offset, memory, found.segments, found.patches, t.near);
      REQUIRE(same(pair, whole));
      REQUIRE(same(pair_integral(a, b, t.offset, memory.edge, t.near), whole));
      REQUIRE(found.patches.size() == alone.patches.size());
      for (size_t p = 0; p < alone.patches.size(); ++p) {
        REQUIRE(same(found.patches[p], alone.patches[p]));
      }
      REQUIRE(found.segments.size() == alone.segments.size());
      for (size_t r = 0; r < alone.segments.size(); ++r)
        REQUIRE(same(found.segments[r], alone.segments[r]));
      if (!memory.edge.layer_pair.find(a, b, t.offset, t.near)) continue;
      ++by_pair;
      split += alone.patches.size() > 1;
      // Runs that go on from one cell to the next.
      for (const LayerPair::PairSegment& segment : memory.edge.layer_pair.segments()) {
        across += segment.edge0 >= 0 && segment.edge1 >= 0 && segment.edge0 != segment.edge1;
      }
    }
    CAPTURE(by_pair, across, split);
    CHECK(by_pair > test::least(pairs / 2));
    CHECK(across > test::least(pairs / 20));
    CHECK(split > test::least(0));
  }
}

// A cell that is not to be used, an edge that is deeper than its cell, and too many edges.
TEST_CASE("pairs that boundary layers of few edges do not decide", "[layer][near]") {
  test::SeededRandom random(8);
  const Polygon cross = samples::cross_of_squares();
  const Potential potential =
      translated(make_potential(cross, PotentialChoice{}), area_moments(cross).centroid);
  LayerPair pair;
  int deep = 0;
  for (int i = 0; i < test::scaled(100); ++i) {
    Touching t(potential, random, .01);
    const PlacedPotential a = t.placed.view(0);
    PlacedPotential b = t.placed.view(1);
    CHECK_FALSE(pair.find(a, b, t.offset, {}));
    if (!pair.find(a, b, t.offset, t.near)) continue;
    BoundaryLayer cells = *b.layer;
    b.layer = &cells;
    for (double& depth : cells.depth) depth = 1e-6;
    deep += !pair.find(a, b, t.offset, t.near);
    for (double& depth : cells.depth) depth = 0;
    CHECK_FALSE(pair.find(a, b, t.offset, t.near));
  }
  CHECK(deep > test::least(test::scaled(100) / 2));
}

}  // namespace apothem
