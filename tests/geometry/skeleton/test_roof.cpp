// Contact of polygons that are not convex: the roof walk against the overlap polygon and the
// oracle.
#include <catch2/catch.hpp>

#include "geometry/exact/exact_integral.hpp"
#include "tests/geometry/nonconvex_pairs.hpp"

using namespace apothem;
using namespace apothem::samples;

TEST_CASE("the roof of known shapes", "[roof]") {
  const Potential cross = make_potential(test::cross_shape());
  CHECK(cross.steepest == Approx(2).epsilon(1e-14));  // roof height 1/2
  CHECK(cross.top == 1);
  const Potential circle = make_potential(
      test::cross_shape(), {.reference = PotentialChoice::Reference::inscribed_circle});
  CHECK(circle.steepest == Approx(std::sqrt(2.0)).epsilon(1e-14));  // inscribed radius sqrt(2)/2
  CHECK(circle.top == Approx(std::sqrt(.5)).epsilon(1e-14));
  const Polygon l = l_shape();
  CHECK(make_potential(l).steepest == Approx(2).epsilon(1e-14));
  CHECK(
      1 / make_potential(l, {.reference = PotentialChoice::Reference::inscribed_circle}).steepest ==
      Approx(2 - std::sqrt(2.0)).epsilon(1e-14));
}

// A cross has a second exact form: the convex envelopes of its two bars minus that of their common
// square. The roof walk is as fast (docs/verification.md) and serves every shape, so it is the only
// one in use; this proves them equal along lines, hence in every integral.
TEST_CASE("the roof of a cross is its two bars minus their common square", "[roof]") {
  const Polygon cross = test::cross_shape();
  const Potential phi = translated(make_potential(cross), -cross.origin());
  const Roof& roof = *phi.roof;
  std::vector<double> x, y;
  for (const Vec2& p : roof.points) {
    x.push_back(p.x());
    y.push_back(p.y());
  }
  const auto box = [](double half_width, double half_height, const Vec2& p) {
    const double h = std::min(half_width - std::abs(p.x()), half_height - std::abs(p.y()));
    return std::clamp(2 * h, 0.0, 1.0);  // over r = 1/2
  };
  const auto bars = [&](const Vec2& p) {
    return box(.5, 1.5, p) + box(1.5, .5, p) - box(.5, .5, p);
  };
  samples::Random random(42);
  RoofTrace<double> trace;
  int pieces = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec2 p(random.uniform(-2, 2), random.uniform(-2, 2));
    const Vec2 e = Vec2(random.uniform(-2, 2), random.uniform(-2, 2)) - p;
    trace.cross({&roof.arcs, cross.size(), static_cast<int>(x.size()), x.data(), y.data(),
                 roof.values.data()},
                p.x(), p.y(), e.x(), e.y());
    trace.pieces([&](double s1, double v1, double s2, double v2) {
      ++pieces;
      REQUIRE(std::abs(bars(p + s1 * e) - v1) < 1e-14);
      REQUIRE(std::abs(bars(p + s2 * e) - v2) < 1e-14);
      REQUIRE(std::abs(bars(p + (s1 + s2) / 2 * e) - (v1 + v2) / 2) < 1e-14);
    });
  }
  CHECK(pieces > 1000);
}

TEST_CASE("non-convex pairs: edge and overlap kernel against the oracle", "[roof]") {
  test::SeededRandom random(40);
  int touching = 0;
  for (const int kind : {0, 1, 2}) {  // roof, inscribed circle, capped
    for (int i = 0; i < test::scaled(100); ++i) {
      const Polygon a = samples::posed(test::any_shape(random),
                                       {random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2)},
                                       random.uniform(0, 6));
      const Polygon b = test::any_shape(random);
      PotentialChoice choice;
      if (kind == 1) choice.reference = PotentialChoice::Reference::inscribed_circle;
      if (kind == 2) choice = test::length_choice(.1);
      const PairResult x = exact_method(a, b, choice);
      touching += x.integral.weight > 0;
      test::check_against(test::edge(a, b, choice), x);
      test::check_against(test::overlap(a, b, choice), x);
    }
  }
  CHECK(touching > test::least(test::scaled(100)));
}

TEST_CASE("non-convex force is minus the gradient of the energy", "[roof]") {
  test::SeededRandom random(41);
  const double h = 1e-4;
  for (int i = 0; i < test::scaled(50); ++i) {
    const Polygon a = test::any_shape(random);
    const Polygon b = test::any_shape(random);
    const Vec2 x =
        samples::world_centroid(b) + Vec2(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
    const double angle = random.uniform(0, 6);
    const auto energy = [&](double dx, double dy, double turn) {
      return test::edge(posed(a, x + Vec2(dx, dy), angle + turn), b).volume.energy;
    };
    const PairIntegral pair = test::edge(posed(a, x, angle), b).integral;
    const double scale = std::max(pair.weight, 1e-2);
    REQUIRE(std::abs(pair.force.x() + (energy(h, 0, 0) - energy(-h, 0, 0)) / (2 * h)) <
            2e-5 * scale);
    REQUIRE(std::abs(pair.force.y() + (energy(0, h, 0) - energy(0, -h, 0)) / (2 * h)) <
            2e-5 * scale);
    REQUIRE(std::abs(pair.moment_a + (energy(0, 0, h) - energy(0, 0, -h)) / (2 * h)) <
            2e-5 * scale);
  }
}

TEST_CASE("work of non-convex contact on closed paths", "[roof][slow]") {
  test::check_closed_paths({});
}

TEST_CASE("swap and shift of non-convex pairs, to the last bit", "[roof]") {
  test::SeededRandom random(44);
  for (int i = 0; i < test::scaled(100); ++i) {
    const Polygon a = posed(test::any_shape(random), {random.uniform(-1, 1), random.uniform(-1, 1)},
                            random.uniform(0, 6));
    const Polygon b = test::any_shape(random);
    const PairIntegral ab = test::edge(a, b).integral;
    const PairIntegral ba = test::edge(b, a).integral;
    REQUIRE(ab.force == -ba.force);
    REQUIRE(ab.moment_a == ba.moment_b);
  }
}
