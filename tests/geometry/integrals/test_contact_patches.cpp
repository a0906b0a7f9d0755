#include "geometry/integrals/contact_patches.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <set>

#include "geometry/integrals/placed_shapes.hpp"
#include "tests/fuzz/hard_pairs.hpp"
#include "tests/fuzz/pair_check.hpp"
#include "tests/geometry/patches.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

PatchWorkspace& workspace() {
  static PatchWorkspace memory;
  return memory;
}

test::PatchResult split(const Polygon& a, const Polygon& b, const PotentialChoice& choice = {}) {
  return test::edge_patches(a, make_potential(a, choice), b, make_potential(b, choice));
}

struct Sum {
  Vec2 force = Vec2::Zero(), first = Vec2::Zero();
  double moment_a = 0, moment_b = 0, weight = 0, largest = 0;
  template <class Part>
  void add(const Part& p) {
    force += p.force;
    first += p.weight * p.centre;
    moment_a += p.moment_a;
    moment_b += p.moment_b;
    weight += p.weight;
    largest = std::max(largest, p.largest_phi);
  }
  [[nodiscard]] double difference(const Sum& s) const {
    return std::max({(force - s.force).norm(), (first - s.first).norm(),
                     std::abs(moment_a - s.moment_a), std::abs(moment_b - s.moment_b),
                     std::abs(weight - s.weight), std::abs(largest - s.largest)});
  }
};

// Checks that every segment is in one patch, that every patch is the sum of its segments, and that
// all patches together are the pair.
// Returns the largest difference in units of round-off: eps (size/r) own length, and size.
double worst_sum(const test::PatchResult& split, const PairIntegral& pair, double size,
                 double steepest) {
  const double length = pair.own_length_a + pair.own_length_b;
  const double unit = 0x1p-52 * size * steepest * (length + size) * std::max(size, 1.0);
  double worst = 0;
  Sum all;
  double own_a = 0, own_b = 0;
  std::vector<Sum> by_segment(split.patches.size());
  for (const BoundarySegment& segment : split.segments) {
    REQUIRE(segment.patch >= 0);
    REQUIRE(segment.patch < static_cast<int>(split.patches.size()));
    REQUIRE(segment.from >= 0);
    REQUIRE(segment.from <= segment.to);
    REQUIRE(segment.to <= 1);
    REQUIRE(is_finite(segment.start + segment.end + segment.force + segment.centre));
    by_segment[segment.patch].add(segment);
    (segment.of_a ? own_a : own_b) += segment.length;
  }
  for (size_t i = 0; i < split.patches.size(); ++i) {
    const PairIntegral& p = split.patches[i];
    REQUIRE(is_finite(p.force + p.centre));
    REQUIRE(std::isfinite(p.moment_a + p.moment_b + p.weight + p.depth + p.breadth));
    Sum alone;
    alone.add(p);
    all.add(p);
    worst = std::max(worst, alone.difference(by_segment[i]));
  }
  Sum expected;
  expected.add(pair);
  worst = std::max(worst, all.difference(expected));
  worst = std::max(worst, std::abs(own_a - pair.own_length_a) / size * steepest * size);
  worst = std::max(worst, std::abs(own_b - pair.own_length_b) / size * steepest * size);
  return worst == 0 ? 0 : worst / unit;
}

double extent(const Polygon& a, const Polygon& b) {
  return std::max(bounding_box(a).extent(), bounding_box(b).extent());
}

Polygon notch() {  // a U, 1 wide inside
  return Polygon({{-1, -1}, {2, -1}, {2, 2}, {1, 2}, {1, 0}, {0, 0}, {0, 2}, {-1, 2}});
}

}  // namespace

TEST_CASE("a cross in a notch touches left and right", "[patches]") {
  const double d = .02;
  // Arms 1 + 2 d wide all in all; the lower arm ends above the floor of the notch.
  const double b = .5 + d, a = .2;
  std::vector<Vec2> ring{{a, -b}, {a, -a}, {b, -a}, {b, a},   {a, a},   {a, b},
                         {-a, b}, {-a, a}, {-b, a}, {-b, -a}, {-a, -a}, {-a, -b}};
  for (Vec2& v : ring) v += Vec2(.5, 1);
  const Polygon cross(ring);
  for (const auto field : {PotentialChoice::Field::roof, PotentialChoice::Field::distance}) {
    const test::PatchResult s = split(cross, notch(), {.field = field});
    REQUIRE(s.patches.size() == 2);
    // Flat on flat: both potentials rise with slope 1/r from the sides in contact.
    const PairIntegral& p = s.patches[0];
    const PairIntegral& q = s.patches[1];
    CHECK(p.depth == Approx(d).epsilon(1e-12));
    CHECK(p.breadth == Approx(2 * a).epsilon(1e-12));
    CHECK((p.force + q.force).norm() < 1e-15);
    CHECK(std::abs(p.force.y()) < 1e-15);
    CHECK(std::abs(std::abs(p.centre.x()) - .5) < d);
    CHECK(p.centre.x() * p.force.x() < 0);  // pushed inward on both sides
    CHECK(q.centre.x() * q.force.x() < 0);
    CHECK(p.force.x() * q.force.x() < 0);
    const double r_cross = make_potential(cross, {.field = field}).steepest;
    const double r_notch = make_potential(notch(), {.field = field}).steepest;
    CHECK(std::abs(p.force.x()) ==
          Approx(d * (2 * a * r_notch + (2 * a - d) * r_cross)).epsilon(1e-12));
  }
}

TEST_CASE("a comb in a comb", "[patches]") {
  const Polygon comb(test::comb_ring(8));  // teeth 1 wide, gaps 1 wide, from y = 0 to 3
  std::vector<Vec2> ring;
  for (const Vec2& v : test::comb_ring(8)) ring.emplace_back(15 - v.x() + 1.05, 5 - v.y());
  const Polygon other(ring);  // upside down; its teeth are .05 into those on one side
  const test::PatchResult s = split(comb, other);
  CHECK(s.patches.size() == overlap_polygons(comb, other, Vec2::Zero()).size());
  CHECK(s.patches.size() == 7);
  for (const PairIntegral& p : s.patches) CHECK(p.breadth == Approx(1).epsilon(.1));
}

TEST_CASE("a block in the corner of an L", "[patches]") {
  const double d = .05;
  const Polygon l(test::l_ring());  // the corner is at (1, 1)
  const double x = 1 - d;
  const Polygon block({{x, x}, {2.5, x}, {2.5, 2.5}, {x, 2.5}});
  CHECK(split(block, l).patches.size() == 1);
  const Polygon bevelled({{x + .2, x}, {2.5, x}, {2.5, 2.5}, {x, 2.5}, {x, x + .2}});
  const test::PatchResult s = split(bevelled, l);
  REQUIRE(s.patches.size() == 2);
  const double scale = s.patches[0].force.norm();
  for (const PairIntegral& p : s.patches) {
    CHECK(p.force.norm() == Approx(scale).epsilon(1e-12));  // mirror images
    CHECK(p.force.minCoeff() > -.3 * scale);                // up or to the right
  }
  CHECK(s.patches[0].force.x() == Approx(s.patches[1].force.y()).epsilon(1e-12));
}

TEST_CASE("as many patches as components, each with Eq. 8 on its own", "[patches]") {
  test::SeededRandom random(71);
  const auto shape = [&]() -> Polygon {
    const double turn = random.uniform(0, 6);
    switch (random.integer(0, 7)) {
      case 0:
        return Polygon(test::turned(test::cross_ring(random.uniform(.5, 3)), turn));
      case 1:
        return Polygon(test::turned(test::l_ring(), turn));
      case 2:
        return Polygon(
            test::turned(test::star_ring(random.integer(3, 9), random.uniform(.3, .8)), turn));
      case 3:
        return Polygon(test::turned(test::comb_ring(2), turn));
      case 4:
      case 5:
        return Polygon(test::turned(test::comb_ring(random.integer(3, 5)), turn));
      case 6:
        return test::random_polygon(random, random.integer(4, 14));
      default:
        return samples::random_convex(random, random.integer(3, 8));
    }
  };
  int several = 0, touching = 0;
  double worst = 0, worst_sums = 0;
  while (touching < (test::long_run() ? 2000 : test::scaled(400))) {
    const PotentialChoice::Field field =
        random.integer(0, 3) == 0 ? PotentialChoice::Field::distance : PotentialChoice::Field::roof;
    const PotentialChoice choice{.field = field,
                                 .reference = random.integer(0, 1)
                                                  ? PotentialChoice::Reference::roof
                                                  : PotentialChoice::Reference::length,
                                 .length = .2};  // capped
    const Polygon a = shape();
    const Polygon b = shape();
    if (a.is_convex() && b.is_convex()) continue;
    const Polygon moved = samples::shifted(b, {random.uniform(-3, 3), random.uniform(-3, 3)});
    const Potential potential_a = make_potential(a, choice);
    const Potential potential_b = make_potential(moved, choice);
    const std::vector<PairIntegral> exact =
        test::overlap_patches(a, potential_a, moved, potential_b);
    const test::PatchResult s = test::edge_patches(a, potential_a, moved, potential_b);
    REQUIRE(s.patches.size() == exact.size());
    if (exact.empty()) continue;
    ++touching;
    several += exact.size() > 1;
    const PairIntegral pair = edge_method(a, potential_a, moved, potential_b).integral;
    worst_sums = std::max(
        worst_sums,
        worst_sum(s, pair, extent(a, moved), std::max(potential_a.steepest, potential_b.steepest)));
    std::set<size_t> taken;
    for (const PairIntegral& p : s.patches) {
      const auto nearest = std::min_element(
          exact.begin(), exact.end(), [&](const PairIntegral& x, const PairIntegral& y) {
            return (x.centre - p.centre).norm() < (y.centre - p.centre).norm();
          });
      REQUIRE(taken.insert(nearest - exact.begin()).second);
      const PairIntegral& x = *nearest;
      // Relative to the whole pair: the digits that a shallow patch cannot have are lost in the
      // coordinates.
      worst = std::max({worst, (p.force - x.force).norm() / pair.weight,
                        std::abs(p.moment_a - x.moment_a) / pair.weight,
                        std::abs(p.moment_b - x.moment_b) / pair.weight,
                        std::abs(p.weight - x.weight) / pair.weight});
      REQUIRE(p.depth == Approx(x.depth).margin(1e-10));
      REQUIRE(std::abs(p.own_length_a - x.own_length_a) < 1e-10);
      REQUIRE(std::abs(p.own_length_b - x.own_length_b) < 1e-10);
      if (x.force.norm() > 1e-2 * x.weight && x.weight > 1e-6) {
        REQUIRE(p.breadth == Approx(x.breadth).margin(1e-8));
        REQUIRE(p.middle == Approx(x.middle).margin(1e-8));
        REQUIRE((loading_point(p) - loading_point(x)).norm() < 1e-6);
      }
    }
  }
  INFO(several << " of " << touching << " pairs touch in several places");
  CHECK(several > test::least(touching / 8));
  CHECK(worst < 1e-12);
  CHECK(worst_sums < 50);
}

TEST_CASE("convex polygons have one patch, pair_integral's to the last bit", "[patches]") {
  test::SeededRandom random(72);
  for (int i = 0; i < (test::long_run() ? 2000 : test::scaled(400)); ++i) {
    const Polygon a = samples::random_convex(random, random.integer(3, 12));
    const Polygon b = samples::random_convex(random, random.integer(3, 12));
    const Potential potential_a = make_potential(a), potential_b = make_potential(b);
    PlacedShapes pair;
    pair.add(potential_a);
    pair.add(potential_b);
    pair.place(0, 0, 0, random.uniform(0, 6));
    pair.place(1, 0, 0, random.uniform(0, 6));
    const Vec2 offset(random.uniform(-3, 3), random.uniform(-3, 3));
    EdgeWorkspace memory;
    const PairIntegral whole = pair_integral(pair.view(0), pair.view(1), offset, memory);
    test::PatchResult s;
    contact_patches(pair.view(0), pair.view(1), offset, workspace(), s.segments, s.patches);
    REQUIRE(s.patches.size() == (whole.touching() ? 1 : 0));
    if (!whole.touching()) {
      REQUIRE(s.segments.empty());
      continue;
    }
    const PairIntegral& p = s.patches[0];
    REQUIRE(p.force == whole.force);
    REQUIRE(p.moment_a == whole.moment_a);
    REQUIRE(p.moment_b == whole.moment_b);
    REQUIRE(p.centre == whole.centre);
    REQUIRE(p.depth == whole.depth);
    REQUIRE(p.breadth == whole.breadth);
    REQUIRE(p.middle == Approx(whole.middle).margin(1e-14));
    REQUIRE(worst_sum(s, whole, extent(a, b),
                      std::max(potential_a.steepest, potential_b.steepest)) < 50);
  }
}

TEST_CASE("degenerate pairs lose no run and split nothing that hangs together", "[patches]") {
  const std::vector<test::HardShape> pool = test::shapes(test::scaled(300) + 30);
  const bool all = test::long_run();
  constexpr double kWorthTheName = 1e-6;  // INT phi ds, m
  int touching = 0, several = 0, differ = 0;
  double worst_sums = 0;
  for (int i = 0; i < (all ? 1'000'000 : test::scaled(20'000)); ++i) {
    const auto [a, b, moved] = test::hard_pair(pool, static_cast<unsigned>(i));
    // Both turned alike: coincidences then hold up to round-off.
    const double turn = i % 2 ? i : 0;
    PlacedShapes placed;
    for (const Potential* p : {&a.potential, &b.potential}) {
      placed.place(placed.add(*p), 0, 0, turn);
    }
    const Vec2 from = a.polygon.origin() - moved.origin();
    const Vec2 offset(std::cos(turn) * from.x() - std::sin(turn) * from.y(),
                      std::sin(turn) * from.x() + std::cos(turn) * from.y());
    const PairIntegral pair =
        pair_integral(placed.view(0), placed.view(1), offset, workspace().edge);
    test::PatchResult s;
    contact_patches(placed.view(0), placed.view(1), offset, workspace(), s.segments, s.patches);
    REQUIRE(pair.touching() == !s.patches.empty());
    if (!pair.touching()) continue;
    ++touching;
    worst_sums =
        std::max(worst_sums, worst_sum(s, pair, extent(a.polygon, moved),
                                       std::max(a.potential.steepest, b.potential.steepest)));
    int found = 0;
    for (const PairIntegral& p : s.patches) found += p.weight > kWorthTheName;
    const auto components = [&](const Vec2& shift, double spin) {
      std::vector<Vec2> ring = moved.vertices();
      const Vec2 centre = samples::world_centroid(moved);
      for (Vec2& v : ring) v += Vec2(shift + cross(spin, Vec2(v - centre)));
      int count = 0;
      for (const PairIntegral& x :
           test::overlap_patches(a.polygon, a.potential, Polygon(ring), b.potential)) {
        count += x.weight > kWorthTheName;
      }
      return count;
    };
    const int expected = components(Vec2::Zero(), 0);
    several += expected > 1;
    if (found == expected) continue;
    // On the edge between two answers: that of a position nearby will do.
    ++differ;
    bool nearby = false;
    for (int k = 0; k < 16; ++k) {
      const double angle = M_PI * (k + .5) / 8;
      for (const double spin : {0., 4e-10, -4e-10}) {
        nearby |= components(1e-10 * Vec2(std::cos(angle), std::sin(angle)), spin) == found;
      }
    }
    if (!nearby) {
      FAIL_CHECK(found << " patches for " << expected << " components\n"
                       << test::as_line(std::to_string(i), a.polygon, moved));
    }
  }
  CHECK(worst_sums < 50);
  CHECK(several > test::least(touching / 20));
  if (all) {
    WARN(touching << " pairs touch, " << several << " in several places, " << differ
                  << " not in as many as the exact overlap; round-off of the sums at most "
                  << worst_sums << " units");
  }
}

TEST_CASE("swapping the polygons negates each patch's force to the last bit", "[patches]") {
  const std::vector<test::HardShape> pool = test::shapes(60);
  test::SeededRandom random(73);
  int patches = 0;
  for (int i = 0; i < test::scaled(5000); ++i) {
    const test::HardShape& a = pool[random.integer(0, 59)];
    const test::HardShape& b = pool[random.integer(0, 59)];
    const Polygon moved =
        samples::shifted(b.polygon, {random.uniform(-1, 1), random.uniform(-1, 1)});
    const test::PatchResult ab = test::edge_patches(a.polygon, a.potential, moved, b.potential);
    const test::PatchResult ba = test::edge_patches(moved, b.potential, a.polygon, a.potential);
    REQUIRE(ab.patches.size() == ba.patches.size());
    REQUIRE(ab.segments.size() == ba.segments.size());
    for (const PairIntegral& p : ab.patches) {
      ++patches;
      REQUIRE(std::any_of(ba.patches.begin(), ba.patches.end(), [&](const PairIntegral& q) {
        return p.force == -q.force && p.moment_a == q.moment_b && p.moment_b == q.moment_a &&
               p.weight == q.weight && p.own_length_a == q.own_length_b;
      }));
    }
  }
  CHECK(patches > test::least(test::scaled(2000)));
}

TEST_CASE("patches keep their identity from step to step", "[patches]") {
  struct Motion {
    Polygon moving, fixed;
    Vec2 from, to;  // of the centroid
    double turn;
  };
  const Motion motions[]{
      // A cross comes into the notch, turns and shifts; a star rolls over the teeth of a comb.
      {Polygon(test::turned(test::cross_ring(.1), .1)), notch(), {.45, 1.6}, {.55, .3}, .7},
      {Polygon(test::star_ring(7, .5)), Polygon(test::comb_ring(4)), {-.4, 3.6}, {7, 3.5}, -9},
      {Polygon(test::comb_ring(3)), Polygon(test::comb_ring(4)), {2.3, 4.4}, {4.7, 3.9}, .2},
  };
  for (const Motion& motion : motions) {
    const PotentialChoice choice;
    const Potential moving =
        translated(make_potential(motion.moving, choice), area_moments(motion.moving).centroid);
    const Potential fixed =
        translated(make_potential(motion.fixed, choice), area_moments(motion.fixed).centroid);
    const Vec2 stand = samples::world_centroid(motion.fixed);
    PlacedShapes placed;
    placed.add(moving);
    placed.add(fixed);
    placed.place(1, 0, 0, 0);
    constexpr int kSteps = 1000;
    test::PatchResult last, now;
    std::vector<double> table;
    int kept = 0, changes = 0, most = 0;
    for (int step = 0; step <= kSteps; ++step) {
      const double s = static_cast<double>(step) / kSteps;
      placed.place(0, 0, 0, s * motion.turn);
      const Vec2 offset = motion.from + s * (motion.to - motion.from) - stand;
      std::swap(last, now);
      contact_patches(placed.view(0), placed.view(1), offset, workspace(), now.segments,
                      now.patches);
      const int before = static_cast<int>(last.patches.size());
      const int after = static_cast<int>(now.patches.size());
      most = std::max(most, after);
      if (step == 0) continue;
      const std::vector<SegmentPlace> earlier(last.segments.begin(), last.segments.end());
      const std::vector<SegmentPlace> present(now.segments.begin(), now.segments.end());
      shared_length(earlier, before, present, after, table);
      if (before != after) {
        ++changes;
        continue;
      }
      // Every patch continues as one patch, which is near its earlier position.
      for (int i = 0; i < before; ++i) {
        int successors = 0, predecessors = 0;
        for (int j = 0; j < after; ++j) {
          successors += table[i * after + j] > 0;
          predecessors += table[j * after + i] > 0;
          if (table[i * after + j] > 0) {
            ++kept;
            CHECK((last.patches[i].centre - now.patches[j].centre).norm() < .1);
          }
        }
        INFO("step " << step << ", patch " << i << " of " << before);
        CHECK(successors == 1);
        CHECK(predecessors == 1);
      }
    }
    CHECK(most > 1);
    CHECK(changes > 1);
    CHECK(kept > 500);
  }
}

TEST_CASE("shared length", "[patches]") {
  const std::vector<SegmentPlace> before{
      {true, 0, 0, .1, .5, .8}, {true, 0, 1, .7, .9, .4}, {false, 2, 0, 0, 1, 3}};
  const std::vector<SegmentPlace> now{{true, 0, 0, .4, .8, .8},
                                      {true, 1, 0, .4, .8, .8},
                                      {false, 2, 1, .5, .5, 0},
                                      {false, 2, 1, .75, 1, .75}};
  std::vector<double> table;
  shared_length(before, 2, now, 2, table);
  REQUIRE(table.size() == 4);
  CHECK(table[0] == Approx(.2));  // merged: .4 to .5 of an edge of 2 m
  CHECK(table[2] == Approx(.2));
  CHECK(table[1] == Approx(.75));
  CHECK(table[3] == 0);
  shared_length(before, 2, std::vector<SegmentPlace>{now[2]}, 2, table);
  CHECK(table[1] > 0);  // without length, but inside
  shared_length({}, 0, now, 2, table);
  CHECK(table.empty());
}

TEST_CASE("patches of coordinates that are not finite", "[patches]") {
  const Potential potential = make_potential(notch());
  PlacedShapes placed;
  placed.add(potential);
  placed.add(potential);
  placed.place(0, 0, 0, 0);
  placed.place(1, 0, 0, std::nan(""));
  test::PatchResult s;
  contact_patches(placed.view(0), placed.view(1), {.1, .1}, workspace(), s.segments, s.patches);
  REQUIRE(s.patches.size() == 1);
  CHECK(s.patches[0].touching());
  CHECK(!std::isfinite(s.patches[0].weight));
  placed.place(1, 0, 0, 0);
  contact_patches(placed.view(0), placed.view(1), {std::nan(""), 0}, workspace(), s.segments,
                  s.patches);
  REQUIRE(s.patches.size() == 1);
  CHECK(s.patches[0].touching());
}

TEST_CASE("a polygon inside the other is one patch", "[patches]") {
  std::vector<Vec2> ring = test::turned(test::cross_ring(1), .3);
  for (Vec2& v : ring) v *= .2;
  const test::PatchResult inside = split(Polygon(ring), Polygon(test::cross_ring(3)));
  REQUIRE(inside.patches.size() == 1);
  CHECK(inside.segments.size() == 12);
  for (const BoundarySegment& segment : inside.segments)
    CHECK((segment.of_a && segment.from == 0 && segment.to == 1));
}

TEST_CASE("near edges are all that a pair needs, to the last bit", "[patches][near]") {
  test::SeededRandom random(91);
  int apart = 0, touching = 0, skipped = 0;
  const int pairs = test::long_run() ? 20'000 : test::scaled(1000);
  for (int i = 0; i < pairs; ++i) {
    const auto shape = [&] {
      return random.integer(0, 2) ? samples::random_star_shaped(random, random.integer(4, 70), .5)
                                  : samples::random_convex(random, random.integer(3, 8));
    };
    const Polygon a = shape(), b = shape();
    const auto about_centre = [](const Polygon& p, PotentialChoice::Field field) {
      return translated(make_potential(p, {.field = field}), area_moments(p).centroid);
    };
    const auto field = PotentialChoice::Field(random.integer(0, 1));
    const Potential potential_a = about_centre(a, field), potential_b = about_centre(b, field);
    PlacedShapes placed;
    placed.add(potential_a);
    placed.add(potential_b);
    double angle_a = random.uniform(0, 6), angle_b = random.uniform(0, 6);
    Vec2 offset(random.uniform(-2, 2), random.uniform(-2, 2));
    placed.place(0, 0, 0, angle_a);
    placed.place(1, 0, 0, angle_b);
    const double skin = random.integer(0, 1) ? random.uniform(0, .2) : 1e-3;
    NearEdgesWorkspace near_memory;
    NearEdges near = near_edges(placed.view(0), placed.view(1), offset, skin, near_memory);
    REQUIRE(near.skin > 0);
    // Bodies move by less than the skin.
    const double moves = .99 * near.skin / 3;
    const double direction = random.uniform(0, 6);
    offset += moves * Vec2(std::cos(direction), std::sin(direction));
    placed.place(0, 0, 0, angle_a + moves / placed.radius(0));
    placed.place(1, 0, 0, angle_b - moves / placed.radius(1));
    EdgeWorkspace memory;
    const PairIntegral whole = pair_integral(placed.view(0), placed.view(1), offset, memory);
    apart += near.none();
    touching += whole.touching();
    skipped += near.of_a != NearEdges::kAll && near.of_b != NearEdges::kAll;
    REQUIRE(!(near.none() && whole.touching()));
    if (!whole.touching()) continue;
    test::PatchResult s;
    const auto same = [&](const PairIntegral& p) {
      REQUIRE(p.force == whole.force);
      REQUIRE(p.moment_a == whole.moment_a);
      REQUIRE(p.moment_b == whole.moment_b);
      REQUIRE(p.weight == whole.weight);
      REQUIRE(p.centre == whole.centre);
      REQUIRE(p.depth == whole.depth);
      REQUIRE(p.breadth == whole.breadth);
      REQUIRE(p.middle == whole.middle);
      REQUIRE(p.own_length_a == whole.own_length_a);
      REQUIRE(p.own_length_b == whole.own_length_b);
      REQUIRE(p.inside_a == whole.inside_a);
      REQUIRE(p.inside_b == whole.inside_b);
    };
    same(pair_integral(placed.view(0), placed.view(1), offset, memory, near));
    same(contact_patches(placed.view(0), placed.view(1), offset, workspace(), s.segments, s.patches,
                         near));
    same(contact_patches(placed.view(0), placed.view(1), offset, workspace(), s.segments,
                         s.patches));
  }
  INFO(apart << " apart, " << touching << " touching, " << skipped << " with edges left out");
  CHECK(apart > test::least(pairs / 10));
  CHECK(touching > test::least(pairs / 10));
  CHECK(skipped > test::least(pairs / 10));
}
