#include <catch2/catch.hpp>

#include "tests/support.hpp"

using namespace apothem;

namespace {

double envelope(const Potential& potential, const Vec2& x) {
  double value = HUGE_VAL;
  for (int i = 0; i < potential.size(); ++i) {
    value = std::min(value, potential.gradients[i].dot(x - potential.vertices[i]));
  }
  return value;
}

Polygon regular(int n, double radius) {
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    ring.emplace_back(radius * std::cos(2 * M_PI * i / n), radius * std::sin(2 * M_PI * i / n));
  }
  return Polygon(ring);
}

}  // namespace

TEST_CASE("inscribed circles with known radius", "[potential]") {
  CHECK(inscribed_circle(test::quad_q()).radius == Approx(.428926743204019).epsilon(1e-14));
  CHECK(inscribed_circle(test::triangle_t()).radius == Approx(.291369751958836).epsilon(1e-14));
  for (const int n : {3, 4, 5, 64, 1000}) {
    INFO(n);
    const InscribedCircle circle = inscribed_circle(regular(n, 2));
    CHECK(circle.radius == Approx(2 * std::cos(M_PI / n)).epsilon(1e-13));
  }
  const InscribedCircle circle = inscribed_circle(Polygon({{0, 0}, {5, 0}, {5, 1}, {0, 1}}));
  CHECK(circle.radius == Approx(.5).epsilon(1e-15));
  REQUIRE(circle.centres.size() == 2);  // the ends of a segment
  CHECK(std::min(circle.centres[0].x(), circle.centres[1].x()) == Approx(.5).epsilon(1e-15));
  CHECK(std::max(circle.centres[0].x(), circle.centres[1].x()) == Approx(4.5).epsilon(1e-15));
  CHECK(inscribed_circle(Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}})).centres.size() == 1);
  // Vertices on straight edges, also one ulp off, change nothing.
  const double ulp = std::nextafter(0.0, 1.0);
  for (const double y : {0.0, -0x1p-53, -1e-300, -ulp}) {
    const Polygon p({{0, 0}, {.3, y}, {.7, y}, {1, 0}, {1, 1}, {.5, 1}, {0, 1}});
    CHECK(inscribed_circle(p).radius == Approx(.5).epsilon(1e-13));
  }
  // Nearly straight vertices, at every angle of the bevel and turned by any angle.
  samples::Random random(1);
  for (double h = 1e-3; h > 1e-18; h /= 10) {
    const Polygon p({{-.5, -.4},
                     {-.1, -.4 - h},
                     {.2, -.4 - .9 * h},
                     {.5, -.4},
                     {.5 + h, .1},
                     {.45, .5},
                     {-.5, .5}});
    for (int k = 0; k < 50; ++k) {
      const Polygon turned = samples::posed(p, {0, 0}, random.uniform(0, 6));
      if (!turned.is_convex()) continue;
      INFO("bevel " << h);
      REQUIRE(std::abs(inscribed_circle(turned).radius - .45) < h + 1e-15);
    }
  }
  // A sliver: radius = area / half perimeter for a triangle.
  const Polygon sliver({{0, 0}, {1e6, 0}, {5e5, 1}});
  CHECK(inscribed_circle(sliver).radius == Approx(5e5 / (1e6 + 1e-6)).epsilon(1e-9));
}

TEST_CASE("the inradius is the maximum of the envelope", "[potential]") {
  test::SeededRandom random(2);
  for (int i = 0; i < test::scaled(2000); ++i) {
    const Polygon polygon = samples::random_convex(random, random.integer(3, 12));
    const InscribedCircle circle = inscribed_circle(polygon);
    const Potential unit = make_potential(polygon, test::length_choice(1));
    for (const Vec2& centre : circle.centres) {
      REQUIRE(std::abs(envelope(unit, centre) - circle.radius) < 1e-14);
    }
    // No better point nearby or far: the envelope is concave, so a local check is enough.
    for (int k = 0; k < 16; ++k) {
      const Vec2 step = 1e-3 * Vec2(std::cos(k * M_PI / 8), std::sin(k * M_PI / 8));
      REQUIRE(envelope(unit, circle.centres[0] + step) <= circle.radius + 1e-15);
    }
  }
}

TEST_CASE("distance and area potential coincide on an equilateral triangle", "[potential]") {
  const Polygon triangle({{0, 0}, {1, 0}, {.5, std::sqrt(.75)}});
  const Potential d = make_potential(triangle);
  const Potential a = make_potential(triangle, test::area_choice());
  for (int i = 0; i < 3; ++i) CHECK((d.gradients[i] - a.gradients[i]).norm() < 1e-14);
  CHECK_FALSE(d.capped());
  CHECK_FALSE(a.capped());
  CHECK(make_potential(triangle, test::length_choice(.1)).capped());
}

TEST_CASE("what a potential cannot take is refused", "[potential]") {
  CHECK_THROWS_AS(make_potential(test::quad_q(), test::area_choice()), InvalidPolygon);
  // Below the resolution of double precision: refused, not a NaN.
  CHECK_THROWS_AS(make_potential(Polygon({{0, 0}, {1, 0}, {.5, 1e-300}})), InvalidPolygon);
}
