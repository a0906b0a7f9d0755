#include "geometry/contact_patches.hpp"

#include <catch2/catch.hpp>
#include <set>

#include "contact/placed_shapes.hpp"
#include "fuzz/hard_pairs.hpp"
#include "fuzz/pair_check.hpp"
#include "geometry/overlap.hpp"
#include "shapes.hpp"
#include "support.hpp"

using namespace apothem;

namespace {

PatchWorkspace& workspace() {
  static PatchWorkspace memory;
  return memory;
}

PatchResult split(const Polygon& a, const Polygon& b, const PotentialChoice& choice = {}) {
  return edge_patches(a, make_potential(a, choice), b, make_potential(b, choice));
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

// Every run in exactly one patch, every patch the sum of its runs, and all together the pair.
// Returns the largest difference in units of round-off: eps (size/r) own length, and size.
double worst_sum(const PatchResult& split, const PairIntegral& pair, double size, double steepest) {
  const double length = pair.own_length_a + pair.own_length_b;
  const double unit = 0x1p-52 * size * steepest * (length + size) * std::max(size, 1.0);
  double worst = 0;
  Sum all;
  double own_a = 0, own_b = 0;
  std::vector<Sum> by_run(split.patches.size());
  for (const BoundaryRun& run : split.runs) {
    REQUIRE(run.patch >= 0);
    REQUIRE(run.patch < static_cast<int>(split.patches.size()));
    REQUIRE(run.from >= 0);
    REQUIRE(run.from <= run.to);
    REQUIRE(run.to <= 1);
    REQUIRE(is_finite(run.start + run.end + run.force + run.centre));
    by_run[run.patch].add(run);
    (run.of_a ? own_a : own_b) += run.length;
  }
  for (size_t i = 0; i < split.patches.size(); ++i) {
    const PairIntegral& p = split.patches[i];
    REQUIRE(is_finite(p.force + p.centre));
    REQUIRE(std::isfinite(p.moment_a + p.moment_b + p.weight + p.penetration + p.breadth));
    Sum alone;
    alone.add(p);
    all.add(p);
    worst = std::max(worst, alone.difference(by_run[i]));
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
    const PatchResult s = split(cross, notch(), {.field = field});
    REQUIRE(s.patches.size() == 2);
    // Flat on flat: both potentials rise with slope 1/r from the sides in contact.
    const PairIntegral& p = s.patches[0];
    const PairIntegral& q = s.patches[1];
    CHECK(p.penetration == Approx(d).epsilon(1e-12));
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
  const PatchResult s = split(comb, other);
  CHECK(s.patches.size() == overlap_polygons(comb, other, Vec2::Zero()).size());
  CHECK(s.patches.size() == 7);
  for (const PairIntegral& p : s.patches) CHECK(p.breadth == Approx(1).epsilon(.1));
}

TEST_CASE("as many patches as components, each with Eq. 8 on its own", "[patches]") {
  test::Random random(71);
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
        return random.convex(random.integer(3, 8));
    }
  };
  int several = 0, touching = 0;
  double worst = 0, worst_sums = 0;
  while (touching < test::scaled(2000)) {
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
    const Polygon moved = test::shifted(b, {random.uniform(-3, 3), random.uniform(-3, 3)});
    const Potential potential_a = make_potential(a, choice);
    const Potential potential_b = make_potential(moved, choice);
    const std::vector<PairResult> exact = overlap_patches(a, potential_a, moved, potential_b);
    const PatchResult s = edge_patches(a, potential_a, moved, potential_b);
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
          exact.begin(), exact.end(), [&](const PairResult& x, const PairResult& y) {
            return (x.integral.centre - p.centre).norm() < (y.integral.centre - p.centre).norm();
          });
      REQUIRE(taken.insert(nearest - exact.begin()).second);
      const PairIntegral& x = nearest->integral;
      // Relative to the whole pair: the digits that a shallow patch cannot have are lost in the
      // coordinates.
      worst = std::max({worst, (p.force - x.force).norm() / pair.weight,
                        std::abs(p.moment_a - x.moment_a) / pair.weight,
                        std::abs(p.moment_b - x.moment_b) / pair.weight,
                        std::abs(p.weight - x.weight) / pair.weight});
      REQUIRE(std::abs(p.own_length_a - x.own_length_a) < 1e-10);
      REQUIRE(std::abs(p.own_length_b - x.own_length_b) < 1e-10);
      if (x.force.norm() > 1e-2 * x.weight && x.weight > 1e-6) {
        REQUIRE(p.penetration == Approx(x.penetration).margin(1e-8));
        REQUIRE(p.breadth == Approx(x.breadth).margin(1e-8));
        REQUIRE((loading_point(p) - loading_point(x)).norm() < 1e-6);
      }
    }
  }
  INFO(several << " of " << touching << " pairs touch in several places");
  CHECK(several > touching / 4);
  CHECK(worst < 1e-12);
  CHECK(worst_sums < 50);
  WARN(several << " several; worst " << worst << ", sums " << worst_sums << " units");
}

TEST_CASE("convex polygons have one patch, pair_integral's to the last bit", "[patches]") {
  test::Random random(72);
  PlacedShapes shapes;
  for (int i = 0; i < test::scaled(2000); ++i) {
    const Polygon a = random.convex(random.integer(3, 12));
    const Polygon b = random.convex(random.integer(3, 12));
    const Potential potential_a = make_potential(a), potential_b = make_potential(b);
    PlacedShapes pair;
    pair.add(potential_a);
    pair.add(potential_b);
    pair.place(0, 0, 0, random.uniform(0, 6));
    pair.place(1, 0, 0, random.uniform(0, 6));
    const Vec2 offset(random.uniform(-3, 3), random.uniform(-3, 3));
    EdgeWorkspace memory;
    const PairIntegral whole = pair_integral(pair.view(0), pair.view(1), offset, memory);
    PatchResult s;
    contact_patches(pair.view(0), pair.view(1), offset, workspace(), s.runs, s.patches);
    REQUIRE(s.patches.size() == (whole.touching() ? 1 : 0));
    if (!whole.touching()) {
      REQUIRE(s.runs.empty());
      continue;
    }
    const PairIntegral& p = s.patches[0];
    REQUIRE(p.force == whole.force);
    REQUIRE(p.moment_a == whole.moment_a);
    REQUIRE(p.moment_b == whole.moment_b);
    REQUIRE(p.centre == whole.centre);
    REQUIRE(p.penetration == whole.penetration);
    REQUIRE(p.breadth == whole.breadth);
    REQUIRE(worst_sum(s, whole, extent(a, b),
                      std::max(potential_a.steepest, potential_b.steepest)) < 50);
  }
}

TEST_CASE("degenerate pairs lose no run and split nothing that hangs together", "[patches]") {
  const std::vector<test::Shape> pool = test::shapes(test::scaled(300) + 30);
  constexpr double kWorthTheName = 1e-6;  // INT phi ds, m
  int touching = 0, several = 0, differ = 0, wrong = 0;
  double worst_sums = 0;
  for (int i = 0; i < test::scaled(20000); ++i) {
    const auto [a, b, moved] = test::hard_pair(pool, static_cast<unsigned>(i));
    const PairIntegral pair = edge_method(a.polygon, a.potential, moved, b.potential).integral;
    const PatchResult s = edge_patches(a.polygon, a.potential, moved, b.potential);
    REQUIRE(pair.touching() == !s.patches.empty());
    if (!pair.touching()) continue;
    ++touching;
    worst_sums =
        std::max(worst_sums, worst_sum(s, pair, extent(a.polygon, moved),
                                       std::max(a.potential.steepest, b.potential.steepest)));
    int found = 0;
    for (const PairIntegral& p : s.patches) found += p.weight > kWorthTheName;
    const auto components = [&](const Vec2& shift) {
      int count = 0;
      for (const PairResult& x :
           overlap_patches(a.polygon, a.potential, test::shifted(moved, shift), b.potential)) {
        count += x.integral.weight > kWorthTheName;
      }
      return count;
    };
    const int expected = components(Vec2::Zero());
    several += expected > 1;
    if (found == expected) continue;
    // On the edge between two answers: that of a position nearby will do.
    ++differ;
    bool nearby = false;
    for (int k = 0; k < 16; ++k) {
      const double angle = M_PI * (k + .5) / 8;
      nearby |= components(1e-10 * Vec2(std::cos(angle), std::sin(angle))) == found;
    }
    if (!nearby) {
      ++wrong;
      FAIL_CHECK(found << " patches for " << expected << " components\n"
                       << test::as_line(std::to_string(i), a.polygon, moved));
    }
  }
  WARN(touching << " touching, " << several << " several, " << differ << " differ, sums "
                << worst_sums);
}
