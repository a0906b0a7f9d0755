#include <catch2/catch.hpp>

#include "geometry/exact/exact_integral.hpp"
#include "geometry/integrals/placed_shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

// |x - y| <= 1e-13 max(|y|, scale): 13 significant digits.
void check_close(double x, double y, double scale = 0) {
  INFO(x << " against " << y);
  CHECK(std::abs(x - y) <= 1e-13 * std::max(std::abs(y), scale));
}

double inradius(const Polygon& p) { return inscribed_circle(p).radius; }

void check_bits(const PairIntegral& a, const PairIntegral& b) {
  CHECK(a.force == b.force);
  CHECK(a.moment_a == b.moment_a);
  CHECK(a.moment_b == b.moment_b);
  CHECK(a.weight == b.weight);
  CHECK(a.depth == b.depth);
}

}  // namespace

TEST_CASE("benchmark poses P1 and P5", "[edge]") {
  const Vec2 cq = samples::world_centroid(test::quad_q());
  const PairResult p1 =
      test::edge(samples::posed(test::triangle_t(), cq + Vec2(.45, .40), .7), test::quad_q());
  check_close(p1.integral.force.x(), .3660230920854565);
  check_close(p1.integral.force.y(), .3520624820420965);
  check_close(p1.integral.moment_a, .02410351352467215, .3);
  check_close(p1.integral.moment_b, -.03612239360943298, .3);
  check_close(p1.volume.energy, .06861197674728489);
  check_close(p1.integral.weight, .6383946685037358);
  CHECK(p1.integral.centre.x() == Approx(-.1287156659518).epsilon(1e-12));
  CHECK(p1.integral.centre.y() == Approx(-.2095957872006).epsilon(1e-12));
  const Vec2 point = loading_point(p1.integral);
  CHECK(point.x() == Approx(-.1386766678643).epsilon(1e-12));
  CHECK(point.y() == Approx(-.1992397938578).epsilon(1e-12));

  const Vec2 ct = samples::world_centroid(test::triangle_t());
  const Polygon c = samples::posed(Polygon({{0, 0}, {.8, .1}, {.2, .7}}), ct + Vec2(.35, .25), .5);
  const PairResult area = test::edge(c, test::triangle_t(), test::area_choice());
  check_close(area.integral.force.x(), .2300100729993399);
  check_close(area.integral.force.y(), .1752177043292752);
  check_close(area.integral.moment_a, .01477397292139132, .2);
  check_close(area.integral.moment_b, -.01859765118680267, .2);
  check_close(area.volume.energy, .02011669396422907);
  const PairResult distance = test::edge(c, test::triangle_t());
  check_close(distance.integral.force.x(), .2244694849955334);
  check_close(distance.integral.force.y(), .1728811222886112);
  check_close(distance.integral.moment_a, .01362652321407566, .2);
  check_close(distance.integral.moment_b, -.01801754476620625, .2);
  check_close(distance.volume.energy, .01953403199025133);
}

TEST_CASE("closed forms", "[edge]") {
  // Shallow depths lose eps/depth of their digits by nature (docs/theory.md, Normal contact); 1e-12
  // holds for these.
  for (const double d : {.2, .05, .01, .002}) {
    INFO("depth " << d);
    {
      const Polygon t = samples::block(-2, -1, 2, 0);
      const Polygon c = samples::block(-.5, -d, .5, 1 - d);
      const PairResult r = test::edge(c, t);
      const double rc = inradius(c), rt = inradius(t), w = 1;
      CHECK(r.integral.force.y() == Approx(d * (w / rt + (w - d) / rc)).epsilon(1e-12));
      CHECK(std::abs(r.integral.force.x()) < 1e-15);
      CHECK(r.volume.energy ==
            Approx(w * d * d / (2 * rt) + (w * d * d / 2 - d * d * d / 3) / rc).epsilon(1e-12));
      CHECK(r.volume.overlap_area == Approx(w * d).epsilon(1e-12));
      CHECK(r.integral.own_length_a == Approx(w + 2 * d).epsilon(1e-12));
      CHECK(r.integral.own_length_b == Approx(w).epsilon(1e-12));
      CHECK(r.integral.depth == Approx(d).epsilon(1e-12));
      CHECK(r.integral.breadth == Approx(w).epsilon(1e-12));
    }
    for (const double a : {M_PI / 6, M_PI / 3, .2}) {
      INFO("half-angle " << a);
      // Apex on apex; the overlap is a rhombus of height d.
      const Polygon c = samples::shifted(samples::wedge_down(a), {0, -d});
      const Polygon t = samples::wedge_up(a);
      const PairResult apex = test::edge(c, t);
      const double force =
          d * d * std::sin(a) * std::tan(a) * (1 / inradius(c) + 1 / inradius(t)) / 2;
      CHECK(apex.integral.force.y() == Approx(force).epsilon(1e-12));
      CHECK(apex.volume.energy == Approx(force * d / 3).epsilon(1e-12));
      CHECK(apex.integral.depth == Approx(d * std::sin(a)).epsilon(1e-12));
      const Polygon flat = samples::block(-3, -2, 3, 0);
      const PairResult on_flat = test::edge(c, flat);
      CHECK(on_flat.integral.force.y() ==
            Approx(d * d * std::tan(a) * (1 / inradius(flat) + std::sin(a) / inradius(c)))
                .epsilon(1e-12));
    }
  }
}

TEST_CASE("force and moments are minus the gradient of the energy", "[edge]") {
  test::SeededRandom random(4);
  const double h = 1e-4;
  for (const int kind : {0, 1, 2}) {  // distance, capped distance, area
    for (int i = 0; i < test::scaled(300); ++i) {
      const Polygon a = samples::random_convex(random, kind == 2 ? 3 : random.integer(3, 12));
      const Polygon b = samples::random_convex(random, kind == 2 ? 3 : random.integer(3, 12));
      const PotentialChoice choice =
          kind == 0   ? PotentialChoice{}
          : kind == 1 ? test::length_choice(.4 * std::min(inradius(a), inradius(b)))
                      : test::area_choice();
      const Vec2 x(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
      const double angle = random.uniform(0, 6);
      const Vec2 centre = samples::world_centroid(b);
      const auto energy = [&](double dx, double dy, double turn) {
        return test::edge(samples::posed(a, centre + x + Vec2(dx, dy), angle + turn), b, choice)
            .volume.energy;
      };
      // Fourth-order difference: E is piecewise cubic, so only its kinks limit the agreement.
      const auto slope = [&](double dx, double dy, double turn) {
        return (8 * (energy(h * dx, h * dy, h * turn) - energy(-h * dx, -h * dy, -h * turn)) -
                (energy(2 * h * dx, 2 * h * dy, 2 * h * turn) -
                 energy(-2 * h * dx, -2 * h * dy, -2 * h * turn))) /
               (12 * h);
      };
      const PairIntegral pair =
          test::edge(samples::posed(a, centre + x, angle), b, choice).integral;
      const double scale = std::max(pair.weight, 1e-3);
      REQUIRE(std::abs(pair.force.x() + slope(1, 0, 0)) < 2e-7 * scale);
      REQUIRE(std::abs(pair.force.y() + slope(0, 1, 0)) < 2e-7 * scale);
      REQUIRE(std::abs(pair.moment_a + slope(0, 0, 1)) < 2e-7 * scale);
      // Moment balance ties the other moment to these.
      REQUIRE(std::abs(pair.moment_a + pair.moment_b + cross(x, pair.force)) < 1e-14 * scale * 10);
    }
  }
}

// Most lines of a polygon with many sides have no face over the overlap, and are left out.
TEST_CASE("the energy of many-sided polygons is that of 100 digits", "[edge]") {
  test::SeededRandom random(141);
  int shallow = 0, deep = 0;
  for (int i = 0; i < test::scaled(80); ++i) {
    const auto polygon = [&] {
      const int corners = random.integer(3, i % 8 == 0 ? 150 : 24);
      const Polygon shape = random.integer(0, 3) == 0 ? samples::regular(corners)
                                                      : samples::random_convex(random, corners);
      return samples::turned(shape, random.uniform(0, 6.3));
    };
    const Polygon a = polygon(), other = polygon();
    const double angle = random.uniform(0, 6.3);
    const Vec2 way(std::cos(angle), std::sin(angle));
    const Box of_a = bounding_box(a), of_b = bounding_box(other);
    const Vec2 centres(of_a.x0 + of_a.x1 - of_b.x0 - of_b.x1,
                       of_a.y0 + of_a.y1 - of_b.y0 - of_b.y1);
    // A touch, an overlap or one polygon within the other.
    const double reach = (of_a.extent() + of_b.extent()) / 2 * random.uniform(0, 1);
    const Polygon b = samples::shifted(other, centres / 2 + reach * way);
    // A given length limits the potential.
    const PotentialChoice choice =
        i % 3 == 0 ? test::length_choice(random.uniform(.02, .5)) : PotentialChoice{};
    INFO("pair " << i << ": " << a.size() << " and " << b.size() << " corners");
    const PairResult exact = exact_method(a, b, choice);
    const double energy = test::edge(a, b, choice).volume.energy;
    CHECK(std::abs(energy - exact.volume.energy) <=
          1e-13 * exact.integral.weight * (of_a.extent() + of_b.extent()));
    if (energy > 0) ++(exact.volume.overlap_area < .1 ? shallow : deep);
  }
  if (test::kSanitized) return;
  CHECK(deep > 2);
  // Few of the pairs only touch, and of a share of them perhaps none.
  if (test::long_run()) CHECK(shallow > 2);
}

TEST_CASE("work along closed paths", "[edge]") {
  test::SeededRandom random(5);
  const Polygon t = test::quad_q();
  const Vec2 centre = samples::world_centroid(t);
  for (const auto& [steps, limit] :
       {std::pair(800, 2e-6), std::pair(3200, 4e-8), std::pair(12800, 1e-9)}) {
    double worst = 0;
    for (int loop = 0; loop < test::scaled(20); ++loop) {
      double c[6];
      for (double& x : c) x = random.uniform(0, 1);
      const auto pose = [&](double s, double& x, double& y, double& angle) {
        x = .45 + (.05 + .1 * c[0]) * std::cos(s + 6 * c[1]);
        y = .40 + (.05 + .1 * c[2]) * std::sin(s);
        angle = 6 * c[3] + .3 * c[4] * std::sin(s + 6 * c[5]);
      };
      double work = 0, path = 0;
      for (int i = 0; i < steps; ++i) {
        double x0, y0, a0, x1, y1, a1, x, y, a;
        pose(2 * M_PI * i / steps, x0, y0, a0);
        pose(2 * M_PI * (i + 1) / steps, x1, y1, a1);
        pose(2 * M_PI * (i + .5) / steps, x, y, a);
        const PairIntegral p =
            test::edge(samples::posed(test::triangle_t(), centre + Vec2(x, y), a), t).integral;
        const double dw =
            p.force.x() * (x1 - x0) + p.force.y() * (y1 - y0) + p.moment_a * (a1 - a0);
        work += dw;
        path += std::abs(dw);
      }
      worst = std::max(worst, std::abs(work) / path);
    }
    INFO(steps << " steps");
    CHECK(worst < limit);
  }
}

TEST_CASE("swapping the bodies negates the force to the last bit", "[edge]") {
  test::SeededRandom random(6);
  for (int i = 0; i < test::scaled(20000); ++i) {
    const Polygon a = samples::random_convex(random, random.integer(3, 12));
    const Polygon b = samples::shifted(samples::random_convex(random, random.integer(3, 12)),
                                       {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)});
    const PairIntegral ab = test::edge(a, b).integral;
    const PairIntegral ba = test::edge(b, a).integral;
    REQUIRE(ab.force == -ba.force);
    REQUIRE(ab.moment_a == ba.moment_b);
    REQUIRE(ab.moment_b == ba.moment_a);
    REQUIRE(ab.weight == ba.weight);
    REQUIRE(ab.own_length_a == ba.own_length_b);
  }
}

TEST_CASE("representable shifts change no bit", "[edge]") {
  test::SeededRandom random(7);
  // Coordinates on a grid of 2^-20, so that shifts up to 2^30 are exact.
  const auto on_grid = [&](const Polygon& p) {
    std::vector<Vec2> ring = p.vertices();
    for (Vec2& v : ring)
      v = Vec2(std::ldexp(std::round(std::ldexp(v.x(), 20)), -20),
               std::ldexp(std::round(std::ldexp(v.y(), 20)), -20));
    return Polygon(ring);
  };
  for (int i = 0; i < test::scaled(2000); ++i) {
    const Polygon a = on_grid(samples::random_convex(random, random.integer(3, 8)));
    const Polygon b = on_grid(samples::shifted(samples::random_convex(random, random.integer(3, 8)),
                                               {random.uniform(-1, 1), random.uniform(-1, 1)}));
    if (!a.is_convex() || !b.is_convex()) continue;
    const PairIntegral here = test::edge(a, b).integral;
    for (const Vec2& shift : {Vec2(1e6, -3e6), Vec2(1e9, 1e9), Vec2(0.5, 1024)}) {
      check_bits(test::edge(samples::shifted(a, shift), samples::shifted(b, shift)).integral, here);
    }
  }
}

TEST_CASE("the contact stiffness stays below its bound", "[edge]") {
  test::SeededRandom random(8);
  const double h = 1e-6;
  double closest = 0;
  for (int i = 0; i < test::scaled(5000); ++i) {
    const Polygon a = samples::random_convex(random, random.integer(3, 8));
    const Polygon b = samples::random_convex(random, random.integer(3, 8));
    const Vec2 x(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
    const double direction = random.uniform(0, 7);
    const Vec2 e(std::cos(direction), std::sin(direction));
    const PairIntegral pair = test::edge(samples::shifted(a, x), b).integral;
    if (!pair.touching()) continue;
    const Vec2 change = test::edge(samples::shifted(a, x + h * e), b).integral.force -
                        test::edge(samples::shifted(a, x - h * e), b).integral.force;
    const double bound = pair.own_length_a / inradius(b) + pair.own_length_b / inradius(a);
    REQUIRE(change.norm() / (2 * h) <= bound * (1 + 1e-3) + 1e-3);
    closest = std::max(closest, change.norm() / (2 * h) / bound);
  }
  // A bound that is never approached would be useless.
  if (!test::kSanitized) CHECK(closest > .5);
}

TEST_CASE("NaN never passes as no contact", "[edge]") {
  const Potential p = make_potential(test::quad_q());
  const double x[] = {0, 1.2, std::nan(""), .2, 0};
  const double y[] = {0, .1, .8, 1, 0};
  double gx[4], gy[4];
  for (int i = 0; i < 4; ++i) gx[i] = p.gradients[i].x(), gy[i] = p.gradients[i].y();
  const PlacedPotential broken{x, y, gx, gy, 4, false};
  EdgeWorkspace workspace;
  CHECK(pair_integral(broken, broken, {.1, .1}, workspace).touching());
  const double fine_x[] = {0, 1.2, 1, .2, 0};
  const PlacedPotential fine{fine_x, y, gx, gy, 4, false};
  CHECK(pair_integral(fine, broken, {.1, .1}, workspace).touching());
  CHECK(pair_integral(fine, fine, {.1, std::nan("")}, workspace).touching());
}
