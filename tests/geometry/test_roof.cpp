// Contact of polygons that are not convex: the roof walk against the overlap polygon and the
// oracle.
#include <array>
#include <catch2/catch.hpp>

#include "contact/placed_shapes.hpp"
#include "geometry/exact_integral.hpp"
#include "geometry/overlap.hpp"
#include "support.hpp"

using namespace apothem;

namespace {

Polygon cross_shape(double arm = 1) {  // five unit squares
  const double a = .5, b = .5 + arm;
  return Polygon({{-a, -b},
                  {a, -b},
                  {a, -a},
                  {b, -a},
                  {b, a},
                  {a, a},
                  {a, b},
                  {-a, b},
                  {-a, a},
                  {-b, a},
                  {-b, -a},
                  {-a, -a}});
}

Polygon star(int points, double inner) {
  std::vector<Vec2> ring;
  for (int i = 0; i < 2 * points; ++i) {
    const double r = i % 2 ? inner : 1, angle = M_PI * i / points;
    ring.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return Polygon(ring);
}

Polygon comb(int teeth) {
  std::vector<Vec2> ring{{0, 0}, {2.0 * teeth - 1, 0}};
  for (int i = teeth - 1; i >= 0; --i) {
    ring.insert(ring.end(), {{2.0 * i + 1, 3}, {2.0 * i, 3}});
    if (i > 0) ring.insert(ring.end(), {{2.0 * i, 1}, {2.0 * i - 1, 1}});
  }
  for (Vec2& v : ring) v *= .4;
  return Polygon(ring);
}

// Star-shaped about 0, in general not convex.
Polygon blob(test::Random& random, int n) {
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * (i + random.uniform(0, .9)) / n;
    ring.push_back(random.uniform(.35, 1) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return Polygon(ring);
}

Polygon any_shape(test::Random& random) {
  switch (random.integer(0, 4)) {
    case 0:
      return cross_shape();
    case 1:
      return star(random.integer(3, 7), random.uniform(.3, .6));
    case 2:
      return comb(random.integer(2, 4));
    case 3:
      return random.convex(random.integer(3, 8));
    default:
      return blob(random, random.integer(4, 12));
  }
}

PairResult overlap(const Polygon& a, const Polygon& b, const PotentialChoice& choice) {
  return overlap_method(a, make_potential(a, choice), b, make_potential(b, choice));
}

void check_against(const PairResult& r, const PairResult& x) {
  const double tolerance = std::max(1e-13, 1e-15 / std::max(x.integral.penetration, 1e-6)) *
                           std::max(x.integral.weight, 1e-3);
  REQUIRE((r.integral.force - x.integral.force).norm() <= tolerance);
  REQUIRE(std::abs(r.integral.moment_a - x.integral.moment_a) <= 3 * tolerance);
  REQUIRE(std::abs(r.integral.moment_b - x.integral.moment_b) <= 3 * tolerance);
  REQUIRE(std::abs(r.integral.own_length_a - x.integral.own_length_a) <= 1e-9);
  REQUIRE(std::abs(r.volume.energy - x.volume.energy) <= 1e-13);
  REQUIRE(std::abs(r.volume.overlap_area - x.volume.overlap_area) <= 1e-13);
  REQUIRE(std::abs(r.integral.largest_phi - x.integral.largest_phi) <= 1e-10);
}

}  // namespace

TEST_CASE("the roof of known shapes", "[roof]") {
  const Potential cross = make_potential(cross_shape());
  CHECK(cross.steepest == Approx(2).epsilon(1e-14));  // roof height 1/2
  CHECK(cross.top == 1);
  const Potential circle =
      make_potential(cross_shape(), {.reference = PotentialChoice::Reference::inscribed_circle});
  CHECK(circle.steepest == Approx(std::sqrt(2.0)).epsilon(1e-14));  // inscribed radius sqrt(2)/2
  CHECK(circle.top == Approx(std::sqrt(.5)).epsilon(1e-14));
  const Polygon l({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  CHECK(make_potential(l).steepest == Approx(2).epsilon(1e-14));
  CHECK(
      1 / make_potential(l, {.reference = PotentialChoice::Reference::inscribed_circle}).steepest ==
      Approx(2 - std::sqrt(2.0)).epsilon(1e-14));
}

// A cross has a second exact form: the convex envelopes of its two bars minus that of their common
// square. The roof walk is as fast (docs/verification.md) and serves every shape, so it is the only
// one in use; this proves them equal along lines, hence in every integral.
TEST_CASE("the roof of a cross is its two bars minus their common square", "[roof]") {
  const Polygon cross = cross_shape();
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
  test::Random random(42);
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
  test::Random random(40);
  int touching = 0;
  for (const int kind : {0, 1, 2}) {  // roof, inscribed circle, capped
    for (int i = 0; i < test::scaled(100); ++i) {
      const Polygon a =
          test::posed(any_shape(random), {random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2)},
                      random.uniform(0, 6));
      const Polygon b = any_shape(random);
      PotentialChoice choice;
      if (kind == 1) choice.reference = PotentialChoice::Reference::inscribed_circle;
      if (kind == 2) choice = test::length_choice(.1);
      const PairResult x = exact_method(a, b, choice);
      touching += x.integral.weight > 0;
      check_against(test::edge(a, b, choice), x);
      check_against(overlap(a, b, choice), x);
    }
  }
  CHECK(touching > test::scaled(100));
}

TEST_CASE("non-convex force is minus the gradient of the energy", "[roof]") {
  test::Random random(41);
  const double h = 1e-4;
  for (int i = 0; i < test::scaled(50); ++i) {
    const Polygon a = any_shape(random);
    const Polygon b = any_shape(random);
    const Vec2 x =
        test::world_centroid(b) + Vec2(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
    const double angle = random.uniform(0, 6);
    const auto energy = [&](double dx, double dy, double turn) {
      return test::edge(test::posed(a, x + Vec2(dx, dy), angle + turn), b).volume.energy;
    };
    const PairIntegral pair = test::edge(test::posed(a, x, angle), b).integral;
    const double scale = std::max(pair.weight, 1e-2);
    REQUIRE(std::abs(pair.force.x() + (energy(h, 0, 0) - energy(-h, 0, 0)) / (2 * h)) <
            2e-5 * scale);
    REQUIRE(std::abs(pair.force.y() + (energy(0, h, 0) - energy(0, -h, 0)) / (2 * h)) <
            2e-5 * scale);
    REQUIRE(std::abs(pair.moment_a + (energy(0, 0, h) - energy(0, 0, -h)) / (2 * h)) <
            2e-5 * scale);
  }
}

TEST_CASE("work of non-convex contact on closed paths", "[roof]") {
  for (const auto& [a, b] : {std::pair(cross_shape(), cross_shape()),
                             std::pair(star(5, .45), star(6, .5)), std::pair(comb(3), comb(2))}) {
    const Potential potential_a = translated(make_potential(a), area_moments(a).centroid);
    const Potential potential_b = translated(make_potential(b), area_moments(b).centroid);
    PlacedShapes shapes;
    shapes.add(potential_a);
    shapes.add(potential_b);
    shapes.place(1, 0, 0, 0);
    EdgeWorkspace workspace;
    for (const auto& [steps, limit] :
         {std::pair(800, 2e-6), std::pair(3200, 4e-8), std::pair(12800, 1e-9)}) {
      double worst = 0;
      test::Random random(43);
      for (int loop = 0; loop < test::scaled(20); ++loop) {
        double c[5];
        for (double& x : c) x = random.uniform(0, 1);
        const auto pose = [&](double s) {
          return std::array{.9 + (.1 + .1 * c[0]) * std::cos(s + 6 * c[1]),
                            .5 + (.1 + .1 * c[2]) * std::sin(s),
                            6 * c[3] + .3 * c[4] * std::sin(s + 1)};
        };
        const auto power = [&](double s) {
          const auto p = pose(s);
          shapes.place(0, p[0], p[1], p[2]);
          const PairIntegral f =
              pair_integral(shapes.view(0), shapes.view(1), {p[0], p[1]}, workspace);
          return -f.force.x() * (.1 + .1 * c[0]) * std::sin(s + 6 * c[1]) +
                 f.force.y() * (.1 + .1 * c[2]) * std::cos(s) +
                 f.moment_a * .3 * c[4] * std::cos(s + 1);
        };
        // Gauss's three points in every step: a corner that passes an edge bends the force.
        const double h = 2 * M_PI / steps, gauss = std::sqrt(.15);
        double work = 0, path = 0;
        for (int i = 0; i < steps; ++i) {
          const double middle = (i + .5) * h;
          const double dw =
              h / 18 *
              (5 * power(middle - gauss * h) + 8 * power(middle) + 5 * power(middle + gauss * h));
          work += dw;
          path += std::abs(dw);
        }
        if (path > 0) worst = std::max(worst, std::abs(work) / path);
      }
      INFO(steps << " steps: " << worst);
      CHECK(worst < limit);
    }
  }
}

TEST_CASE("swap and shift of non-convex pairs, to the last bit", "[roof]") {
  test::Random random(44);
  for (int i = 0; i < test::scaled(100); ++i) {
    const Polygon a = test::posed(any_shape(random), {random.uniform(-1, 1), random.uniform(-1, 1)},
                                  random.uniform(0, 6));
    const Polygon b = any_shape(random);
    const PairIntegral ab = test::edge(a, b).integral;
    const PairIntegral ba = test::edge(b, a).integral;
    REQUIRE(ab.force == -ba.force);
    REQUIRE(ab.moment_a == ba.moment_b);
  }
}
