// The contact of polygons with holes: by the edge method, on the exact overlap, and from the
// definition.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/exact/exact_integral.hpp"
#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/penetration.hpp"
#include "geometry/potential/point_values.hpp"
#include "geometry/regions/boolean.hpp"
#include "tests/geometry/patches.hpp"
#include "tests/geometry/random_holed.hpp"
#include "tests/support.hpp"

using namespace apothem;
using samples::Random;

namespace {

constexpr double kPi = 3.14159265358979323846;

using Field = PotentialChoice::Field;
using Reference = PotentialChoice::Reference;

PotentialChoice own_reference(Field field) {
  return {.field = field,
          .reference = field == Field::roof ? Reference::roof : Reference::inscribed_circle};
}

// The number of random pairs: a thousand with APOTHEM_LONG.
int pairs(int count) { return test::long_run() ? 1000 : test::scaled(count); }

// A polygon with holes and another one, with or without, that overlaps it.
struct HoledPair {
  Polygon a, b;
};
HoledPair random_pair(Random& random) {
  const auto one = [&](int most) {
    const int holes = random.integer(0, most);
    const Polygon shape = holes > 0                   ? samples::random_holed(random, holes)
                          : random.integer(0, 1) == 0 ? samples::random_convex(random, 6)
                                                      : samples::random_star_shaped(random, 9, .3);
    return samples::posed(shape, {random.uniform(-1, 1), random.uniform(-1, 1)},
                          random.uniform(0, 2 * kPi));
  };
  const Polygon a =
      samples::posed(samples::random_holed(random, random.integer(1, 20)),
                     {random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0, 2 * kPi));
  return {a, samples::scaled(one(20), random.uniform(.2, 1.5))};
}

PairResult overlap_with_holes(const Polygon& a, const Polygon& b, const PotentialChoice& choice) {
  return overlap_method(a, make_potential(a, choice), b, make_potential(b, choice));
}

// A square frame: the square from -1 to 1 without the one from -1 + width to 1 - width.
Polygon frame(double width) {
  const double w = 1 - width;
  return Polygon({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {{{-w, -w}, {w, -w}, {w, w}, {-w, w}}});
}

void check_same(const PairResult& p, const PairResult& q, double accuracy) {
  const double size = accuracy * q.integral.weight;
  CHECK((p.integral.force - q.integral.force).norm() <= size);
  CHECK(std::abs(p.integral.moment_a - q.integral.moment_a) <= 4 * size);
  CHECK(std::abs(p.integral.moment_b - q.integral.moment_b) <= 4 * size);
  CHECK(std::abs(p.integral.weight - q.integral.weight) <= size);
  CHECK(std::abs(p.integral.own_length_a - q.integral.own_length_a) <= accuracy * 20);
  CHECK(std::abs(p.integral.own_length_b - q.integral.own_length_b) <= accuracy * 20);
  CHECK(std::abs(p.volume.energy - q.volume.energy) <= accuracy * 20);
  CHECK(std::abs(p.volume.overlap_area - q.volume.overlap_area) <= accuracy * 20);
}

// The integral of a sampled function over the overlap, by the midpoint rule with `count` points
// along each axis.
template <class F>
double sampled(const Polygon& a, const Polygon& b, int count, const F& f) {
  const Box box = bounding_box(a);
  const double dx = (box.x1 - box.x0) / count, dy = (box.y1 - box.y0) / count;
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const Vec2 p(box.x0 + (i + .5) * dx, box.y0 + (j + .5) * dy);
      if (side_of(a, p) > 0 && side_of(b, p) > 0) sum += f(p) * dx * dy;
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("edge method, exact overlap and 100 digits agree about polygons with holes") {
  test::SeededRandom random(20);
  for (int i = 0; i < pairs(400); ++i) {
    const HoledPair pair = random_pair(random);
    const PotentialChoice choice = own_reference(i % 2 == 0 ? Field::roof : Field::distance);
    const PairResult edge =
        edge_method(pair.a, make_potential(pair.a, choice), pair.b, make_potential(pair.b, choice));
    CAPTURE(i, edge.integral.weight, pair.a.rings(), pair.b.rings());
    const PairResult other = overlap_with_holes(pair.a, pair.b, choice);
    check_same(edge, other, 1e-12);
    const bool oracle = test::long_run() || i % 16 == 0 || i % 64 == 33;
    if (oracle) check_same(edge, exact_method(pair.a, pair.b, choice), 1e-12);
  }
}

TEST_CASE("the force on a polygon with holes is minus the gradient of the energy") {
  test::SeededRandom random(21);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < pairs(200); ++i) {
    const HoledPair pair = random_pair(random);
    const PotentialChoice choice = own_reference(i % 2 == 0 ? Field::roof : Field::distance);
    CAPTURE(i, pair.a.rings(), pair.b.rings());
    const PairIntegral force = test::edge(pair.a, pair.b, choice).integral;
    const auto energy = [&](const Polygon& a) {
      return test::edge(a, pair.b, choice).volume.energy;
    };
    const double scale = 1e-6 * (1 + force.weight);
    for (const Vec2& way : {Vec2(kStep, 0), Vec2(0, kStep)}) {
      const double change =
          energy(samples::shifted(pair.a, way)) - energy(samples::shifted(pair.a, -way));
      CHECK(std::abs(force.force.dot(way) / kStep + change / (2 * kStep)) <= scale);
    }
    const Vec2 centre = samples::world_centroid(pair.a);
    const double change = energy(samples::posed(pair.a, centre, kStep)) -
                          energy(samples::posed(pair.a, centre, -kStep));
    CHECK(std::abs(force.moment_a + change / (2 * kStep)) <= scale);
  }
}

TEST_CASE("the energy of polygons with holes is the integral of their potentials") {
  test::SeededRandom random(22);
  for (int i = 0; i < pairs(40); ++i) {
    const HoledPair pair = random_pair(random);
    const PotentialChoice choice = own_reference(i % 2 == 0 ? Field::roof : Field::distance);
    const Potential potential_a = make_potential(pair.a, choice);
    const Potential potential_b = make_potential(pair.b, choice);
    const PointEvaluator phi_a(pair.a, potential_a), phi_b(pair.b, potential_b);
    const double energy = test::edge(pair.a, pair.b, choice).volume.energy;
    const double sum =
        sampled(pair.a, pair.b, 200, [&](const Vec2& p) { return phi_a(p).phi + phi_b(p).phi; });
    CAPTURE(i, energy, sum);
    CHECK(std::abs(energy - sum) <= .004);
  }
}

TEST_CASE("swapped polygons with holes have opposite forces, bit for bit") {
  test::SeededRandom random(23);
  for (int i = 0; i < pairs(200); ++i) {
    const HoledPair pair = random_pair(random);
    const PotentialChoice choice = own_reference(i % 2 == 0 ? Field::roof : Field::distance);
    const PairIntegral ab = test::edge(pair.a, pair.b, choice).integral;
    const PairIntegral ba = test::edge(pair.b, pair.a, choice).integral;
    CHECK(ab.force == -ba.force);
    CHECK(ab.weight == ba.weight);
    CHECK(ab.own_length_a == ba.own_length_b);
  }
}

TEST_CASE("the patches of polygons with holes are the components of their overlap") {
  test::SeededRandom random(24);
  int several = 0, with_holes = 0;
  for (int i = 0; i < pairs(300); ++i) {
    const HoledPair pair = random_pair(random);
    const PotentialChoice choice = own_reference(i % 2 == 0 ? Field::roof : Field::distance);
    const Potential potential_a = make_potential(pair.a, choice);
    const Potential potential_b = make_potential(pair.b, choice);
    CAPTURE(i, pair.a.rings(), pair.b.rings());
    std::vector<PairIntegral> patches =
        test::edge_patches(pair.a, potential_a, pair.b, potential_b).patches;
    std::vector<PairIntegral> components =
        test::overlap_patches(pair.a, potential_a, pair.b, potential_b);
    for (const OverlapPolygon& part : overlap_polygons(pair.a, pair.b, Vec2::Zero())) {
      with_holes += part.holes.empty() ? 0 : 1;
    }
    several += components.size() > 1 ? 1 : 0;
    REQUIRE(patches.size() == components.size());
    const auto first = [](const PairIntegral& p, const PairIntegral& q) {
      return p.weight < q.weight;
    };
    std::ranges::sort(patches, first), std::ranges::sort(components, first);
    for (size_t k = 0; k < patches.size(); ++k) {
      const double size = 1e-12 * (1 + components[k].weight);
      CHECK((patches[k].force - components[k].force).norm() <= size);
      CHECK(std::abs(patches[k].moment_a - components[k].moment_a) <= 4 * size);
    }
  }
  CHECK(several > test::least(0));
  CHECK(with_holes > test::least(0));
}

TEST_CASE("the overlap of polygons with holes is that of Boolean operations") {
  test::SeededRandom random(25);
  for (int i = 0; i < pairs(200); ++i) {
    const HoledPair pair = random_pair(random);
    const double area = area_of(
        boolean_operation(rings_of(pair.a), rings_of(pair.b), BooleanOperation::intersection));
    const PairResult edge = test::edge(pair.a, pair.b, own_reference(Field::distance));
    CHECK(edge.volume.overlap_area == Approx(area).margin(1e-12));
  }
}

TEST_CASE("a bar in the hole of a frame touches nothing until it reaches a side") {
  const Polygon ring = frame(.25);
  for (const Field field : {Field::roof, Field::distance}) {
    const auto at = [&](double x) {
      return test::edge(ring, samples::block(x - .2, -.3, x + .2, .3), own_reference(field));
    };
    CHECK(at(0).integral.weight == 0);
    CHECK(at(.5).integral.weight == 0);
    CHECK(at(.55).integral.weight == 0);
    const double deep = .01;
    const PairResult touch = at(.55 + deep);
    // The frame's potential rises by 1 over half of its width, or over the radius of the circle in
    // a corner between its two outer sides and the inner vertex; that of the bar over .2. Within
    // `deep` of the ends of the bar's short side its potential belongs to the long sides.
    const double r = field == Field::roof ? .125 : .25 * std::sqrt(2) / (1 + std::sqrt(2));
    CHECK(std::abs(touch.integral.force.y()) < 1e-15);
    CHECK(touch.integral.force.x() == Approx(deep * (.6 / r + (.6 - deep) / .2)));
    CHECK(penetration(ring, samples::block(.35 + deep, -.3, .75 + deep, .3)) == Approx(deep));
  }
}

TEST_CASE("a frame and the same frame cut open far away press alike") {
  // The cut is on the left. The reference length is given, because the potential near the cut, and
  // with it the roof's height, is another one.
  constexpr double kCut = 1e-3, kWidth = .25, kInner = 1 - kWidth;
  const Polygon closed = frame(kWidth);
  const Polygon open({{-1, -1},
                      {1, -1},
                      {1, 1},
                      {-1, 1},
                      {-1, kCut},
                      {-kInner, kCut},
                      {-kInner, kInner},
                      {kInner, kInner},
                      {kInner, -kInner},
                      {-kInner, -kInner},
                      {-kInner, -kCut},
                      {-1, -kCut}});
  test::SeededRandom random(26);
  int touching = 0;
  for (int i = 0; i < pairs(400); ++i) {
    const Polygon shape =
        i % 3 == 0 ? samples::random_convex(random, 6) : samples::random_star_shaped(random, 9, .3);
    const Polygon block = samples::posed(samples::scaled(shape, random.uniform(.1, .4)),
                                         {random.uniform(.2, 1.2), random.uniform(-1.2, 1.2)},
                                         random.uniform(0, 2 * kPi));
    PotentialChoice choice = own_reference(i % 2 == 0 ? Field::roof : Field::distance);
    choice.reference = Reference::length;
    choice.length = .125;
    const Potential of_closed = make_potential(closed, choice);
    const Potential of_open = make_potential(open, choice);
    const Potential of_block = make_potential(block, choice);
    const PairResult one = edge_method(closed, of_closed, block, of_block);
    const PairResult other = edge_method(open, of_open, block, of_block);
    touching += one.integral.weight > 0 ? 1 : 0;
    const double size = 1e-13 * (1 + one.integral.weight);
    CHECK((one.integral.force - other.integral.force).norm() <= size);
    CHECK(std::abs(one.integral.moment_b - other.integral.moment_b) <= size);
    CHECK(std::abs(one.integral.weight - other.integral.weight) <= size);
    CHECK(std::abs(one.volume.energy - other.volume.energy) <= 1e-13);
    CHECK(std::abs(one.volume.overlap_area - other.volume.overlap_area) <= 1e-13);
    const test::PatchResult patches = test::edge_patches(closed, of_closed, block, of_block);
    const test::PatchResult of_cut = test::edge_patches(open, of_open, block, of_block);
    CHECK(patches.patches.size() == of_cut.patches.size());
  }
  CHECK(touching > test::least(0));
}
