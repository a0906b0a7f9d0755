#include "geometry/polygon/canonical_pose.hpp"
#include "geometry/potential/inscribed_circle.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>

#include "tests/public_rings.hpp"
#include "tests/random_simple.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::samples;

namespace {

// The independent answer: distance to the boundary, negative outside, in local coordinates.
double depth(const std::vector<Vec2>& ring, const Vec2& x) {
  double least = HUGE_VAL;
  bool inside = false;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2& p = ring[i];
    const Vec2& q = ring[i + 1 == ring.size() ? 0 : i + 1];
    const Vec2 d = q - p;
    const double t = std::clamp((x - p).dot(d) / d.squaredNorm(), 0.0, 1.0);
    // The foot is measured from the nearer end: long edges then cost no digits.
    const Vec2 foot = t < .5 ? Vec2(x - p - t * d) : Vec2(x - q + (1 - t) * d);
    least = std::min(least, foot.norm());
    if ((p.y() > x.y()) != (q.y() > x.y())) {
      const double side = cross(d, x - p);
      if ((side > 0) == (q.y() > p.y())) inside = !inside;
    }
  }
  return inside ? least : -least;
}

double size_of(const Polygon& polygon) { return bounding_box(polygon).extent(); }

// Interval that holds the inradius: a grid, refined where the depth (1-Lipschitz) may still beat
// the best value found.
std::pair<double, double> brute_force(const Polygon& polygon, double resolution) {
  const std::vector<Vec2> ring = polygon.local_vertices();
  const Box box = bounding_box(polygon);
  const Vec2 low = Vec2(box.x0, box.y0) - polygon.origin();
  const double size = box.extent();
  double best = 0;
  std::vector<Vec2> centres, kept;
  std::vector<double> depths;
  int cells = 16;
  for (int i = 0; i < cells * cells; ++i) {
    centres.push_back(low + size / cells * Vec2(i % cells + .5, i / cells + .5));
  }
  double half = size / cells / 2;
  while (true) {
    depths.clear();
    for (const Vec2& c : centres) depths.push_back(depth(ring, c));
    best = std::max(best, *std::max_element(depths.begin(), depths.end()));
    if (half * M_SQRT2 < resolution * size) return {best, best + half * M_SQRT2};
    kept.clear();
    for (size_t i = 0; i < centres.size(); ++i) {
      if (depths[i] + half * M_SQRT2 < best) continue;
      for (const double x : {-half / 2, half / 2}) {
        for (const double y : {-half / 2, half / 2}) kept.push_back(centres[i] + Vec2(x, y));
      }
    }
    std::swap(centres, kept);
    half /= 2;
  }
}

// Every centre has the radius as its depth, and no better point is near.
void require_consistent(const Polygon& polygon, const InscribedCircle& circle) {
  const std::vector<Vec2> ring = polygon.local_vertices();
  const double size = size_of(polygon);
  REQUIRE(circle.radius > 0);
  REQUIRE_FALSE(circle.centres.empty());
  const double same = 2e-13 * circle.radius + 1e-14 * size;
  for (const Vec2& centre : circle.centres) {
    REQUIRE(std::abs(depth(ring, centre) - circle.radius) < same);
    for (const double step : {1e-2, 1e-4, 1e-6}) {
      for (int k = 0; k < 16; ++k) {
        const Vec2 u(std::cos(k * M_PI / 8), std::sin(k * M_PI / 8));
        REQUIRE(depth(ring, centre + step * circle.radius * u) < circle.radius + 1e-15 * size);
      }
    }
  }
}

InscribedCircle checked(const Polygon& polygon, double resolution = 1e-4) {
  const InscribedCircle circle = largest_inscribed_circle(polygon);
  require_consistent(polygon, circle);
  const auto [low, high] = brute_force(polygon, resolution);
  // The bounds themselves are rounded: symmetric shapes attain the upper one.
  const double rounding = 1e-14 * size_of(polygon);
  REQUIRE(circle.radius > low - rounding);
  REQUIRE(circle.radius < high + rounding);
  return circle;
}

// Two upright bars of width 1 and a thinner one between them.
Polygon h_shape() {
  return Polygon({{0, 0},
                  {1, 0},
                  {1, 2},
                  {3, 2},
                  {3, 0},
                  {4, 0},
                  {4, 5},
                  {3, 5},
                  {3, 2.5},
                  {1, 2.5},
                  {1, 5},
                  {0, 5}});
}

// Two corridors of width 1 over a floor of thickness .25.
Polygon u_shape() {
  return Polygon({{0, 0}, {4, 0}, {4, 4}, {3, 4}, {3, .25}, {1, .25}, {1, 4}, {0, 4}});
}

// As many centres as expected, each near one of these points.
void check_centres(const Polygon& polygon, const InscribedCircle& circle,
                   const std::vector<Vec2>& expected, double tolerance) {
  REQUIRE(circle.centres.size() == expected.size());
  for (const Vec2& e : expected) {
    double nearest = HUGE_VAL;
    for (const Vec2& c : circle.centres) {
      nearest = std::min(nearest, (polygon.origin() + c - e).norm());
    }
    INFO(e.transpose());
    CHECK(nearest < tolerance);
  }
}

}  // namespace

TEST_CASE("largest circles with known radius", "[inscribed_circle]") {
  const Polygon cross = cross_of_squares();
  const InscribedCircle in_cross = checked(cross);
  CHECK(in_cross.radius == Approx(M_SQRT1_2).epsilon(1e-15));
  check_centres(cross, in_cross, {{0, 0}}, 1e-14);
  const InscribedCircle in_l = checked(l_shape(3));
  CHECK(in_l.radius == Approx(2 - M_SQRT2).epsilon(1e-15));
  check_centres(l_shape(3), in_l, {{in_l.radius, in_l.radius}}, 1e-14);
  for (const int tips : {3, 5, 16, 100, 500}) {
    INFO(tips);
    const InscribedCircle in_star = largest_inscribed_circle(star(tips, .4));
    require_consistent(star(tips, .4), in_star);
    // It touches the notches.
    CHECK(in_star.radius == Approx(.4).epsilon(1e-14));
  }
  // A convex polygon: the same answer as the convex function.
  CHECK(largest_inscribed_circle(test::quad_q()).radius ==
        inscribed_circle(CanonicalPose(test::quad_q()).polygon()).radius);
}

TEST_CASE("circles that are not unique", "[inscribed_circle]") {
  const InscribedCircle in_u = checked(u_shape(), 1e-3);
  CHECK(in_u.radius == Approx(.5).epsilon(1e-13));
  // The lower ends: the corners at (1, .25) and (3, .25) lie in the walls.
  check_centres(u_shape(), in_u, {{.5, .5}, {.5, 3.5}, {3.5, .5}, {3.5, 3.5}}, 1e-12);

  // Beside the thinner bar of the H the circles grow: two isolated centres.
  const InscribedCircle in_h = checked(h_shape(), 1e-3);
  CHECK(in_h.radius > .5);
  check_centres(h_shape(), in_h, {{in_h.radius, 2.25}, {4 - in_h.radius, 2.25}}, 1e-13);

  // A corridor with straight vertices and steps of an ulp in its walls stays one corridor.
  for (const double step : {0.0, 0x1p-53}) {
    const Polygon l(
        {{0, 0}, {3, step}, {5, 0}, {10, 0}, {10, 1}, {7, 1}, {2, 1 + step}, {0, 1}, {.4, .5}});
    const InscribedCircle circle = largest_inscribed_circle(l);
    require_consistent(l, circle);
    CHECK(circle.centres.size() == 2);
    CHECK(circle.radius == Approx(.5).epsilon(1e-13));
  }
  std::vector<Vec2> walls;  // many straight vertices, each rounded
  for (int i = 0; i <= 300; ++i) walls.emplace_back(.24 * i / 300, .32 * i / 300);
  for (int i = 300; i >= 0; --i) walls.emplace_back(.24 * i / 300 - .008, .32 * i / 300 + .006);
  const InscribedCircle circle = largest_inscribed_circle(Polygon(walls));
  CHECK(circle.radius == Approx(.005).epsilon(1e-13));
  CHECK(circle.centres.size() == 2);
  CHECK((circle.centres.front() - circle.centres.back()).norm() == Approx(.39).epsilon(1e-12));
}

TEST_CASE("the largest circle agrees with brute force", "[inscribed_circle][slow]") {
  checked(scaled(comb(12, 8, 1), .1), 1e-3);
  checked(spiral(4, 50, .1, .05));
  checked(star(7, .2));
  test::SeededRandom random(1);
  for (int i = 0; i < test::scaled(300); ++i) {
    const Polygon polygon = random_simple(random, random.integer(4, 40));
    INFO("polygon " << i);
    checked(polygon);
  }
}

TEST_CASE("the largest circle does not depend on the position", "[inscribed_circle]") {
  test::SeededRandom random(2);
  std::vector<Polygon> polygons{cross_of_squares(),
                                l_shape(3),
                                h_shape(),
                                u_shape(),
                                star(9, .3),
                                comb(8, 8, 1),
                                spiral(3, 20, .1, .05),
                                random_simple(random, 30)};
  for (size_t i = 0; i < polygons.size(); ++i) {
    INFO("polygon " << i);
    const Polygon& polygon = polygons[i];
    const InscribedCircle circle = largest_inscribed_circle(polygon);
    const double size = size_of(polygon);
    for (int k = 0; k < test::scaled(100); ++k) {
      const double angle = random.uniform(0, 2 * M_PI);
      const Eigen::Matrix2d turn =
          (Eigen::Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle))
              .finished();
      for (const auto& [factor, shift] :
           {std::pair(1.0, 0.0), std::pair(1e-6, 0.0), std::pair(1e6, 0.0), std::pair(1.0, 1e6)}) {
        const Polygon moved = mapped(polygon, [&, f = factor, s = shift](const Vec2& v) -> Vec2 {
          return f * (turn * v) + Vec2(s, -s);
        });
        const InscribedCircle other = largest_inscribed_circle(moved);
        // The shifted coordinates are rounded to 1e-16 of the shift.
        const double rounding = 1e-15 * size + 2e-16 * shift;
        INFO("angle " << angle << ", factor " << factor << ", shift " << shift);
        REQUIRE(std::abs(other.radius / factor - circle.radius) < 4 * rounding);
        if (shift != 0) continue;  // such rounding makes one of equal circles the largest
        REQUIRE(other.centres.size() == circle.centres.size());
        for (const Vec2& c : circle.centres) {
          double nearest = HUGE_VAL;
          for (const Vec2& o : other.centres) {
            nearest = std::min(nearest, (turn.transpose() * o / factor - c).norm());
          }
          REQUIRE(nearest < 1e-11 * size);
        }
      }
    }
  }
}

TEST_CASE("thin and far polygons", "[inscribed_circle]") {
  // A bent corridor of aspect 1e6, turned: radius 2 - sqrt(2) of its width at the bend.
  for (const double angle : {0.0, .3, 1.1}) {
    const double w = 1e-6;
    const Polygon thin = mapped(Polygon({{0, 0}, {1, 0}, {1, w}, {w, w}, {w, 1}, {0, 1}}),
                                [&](const Vec2& v) -> Vec2 {
                                  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(),
                                          std::sin(angle) * v.x() + std::cos(angle) * v.y()};
                                });
    const InscribedCircle circle = largest_inscribed_circle(thin);
    require_consistent(thin, circle);
    CHECK(std::abs(circle.radius - (2 - M_SQRT2) * w) < 1e-15);
  }
  for (const double far : {1e6, 1e9}) {
    const Polygon moved = shifted(cross_of_squares(), {far, -far});
    CHECK(largest_inscribed_circle(moved).radius == Approx(M_SQRT1_2).epsilon(1e-15));
  }
  CHECK_THROWS_AS(
      largest_inscribed_circle(Polygon({{0, 0}, {1, 0}, {1, 1e-300}, {.5, 5e-301}, {0, 1e-300}})),
      InvalidPolygon);
}

TEST_CASE("every simple ring of a folder has its circle", "[inscribed_circle]") {
  const std::vector<test::PublicRing> rings = test::public_rings(100'000);
  if (rings.empty()) return;
  int found = 0;
  int thin = 0;
  for (const auto& [name, line, ring] : rings) {
    std::optional<Polygon> polygon;
    try {
      polygon.emplace(ring);
    } catch (const InvalidPolygon&) {
      continue;
    }
    INFO(name);
    const double size = size_of(*polygon);
    try {
      const InscribedCircle circle = largest_inscribed_circle(*polygon);
      require_consistent(*polygon, circle);
      const auto [low, high] = brute_force(*polygon, 2e-3);
      REQUIRE(circle.radius > low - 1e-14 * size);
      REQUIRE(circle.radius < high + 1e-14 * size);
      ++found;
    } catch (const InvalidPolygon&) {
      REQUIRE(area_moments(*polygon).area < 1e-14 * size * size);
      ++thin;
    }
  }
  CHECK(found > 0);
  WARN(found << " circles, " << thin << " polygons refused as thinner than double precision");
}

TEST_CASE("convex polygons of many edges: the same circle as by clipping", "[inscribed_circle]") {
  test::SeededRandom random(11);
  for (int i = 0; i < test::scaled(30); ++i) {
    const Polygon polygon = samples::random_convex(random, random.integer(101, 250));
    const InscribedCircle circle = largest_inscribed_circle(polygon);
    const InscribedCircle clipped = inscribed_circle(polygon);
    CHECK(std::abs(circle.radius - clipped.radius) < 1e-13 * clipped.radius);
    CHECK(circle.centres.size() == 1);
    CHECK((circle.centres[0] - clipped.centres[0]).norm() < 1e-6 * clipped.radius);
  }
  std::vector<Vec2> stadium;  // round ends of 100 edges each, 3 apart
  for (int i = 0; i <= 200; ++i) {
    const double angle = M_PI * ((i <= 100 ? i : i - 1) / 100. - .5);
    stadium.emplace_back((i <= 100 ? 3 : 0) + std::cos(angle), std::sin(angle));
  }
  stadium.emplace_back(0, -1);
  const InscribedCircle circle = largest_inscribed_circle(Polygon(stadium));
  CHECK(std::abs(circle.radius - 1) < 1e-14);
  REQUIRE(circle.centres.size() == 2);
  // Its ends are as deep below the first edge of the round as below the straight one.
  const double length = 3 - 2 * std::tan(M_PI / 400);
  CHECK(std::abs((circle.centres[1] - circle.centres[0]).norm() - length) < 1e-9);
}

TEST_CASE("many vertices on the edges change nothing", "[inscribed]") {
  const auto divided = [](const Polygon& polygon, int parts) {
    std::vector<Vec2> ring;
    for (int i = 0; i < polygon.size(); ++i) {
      for (int k = 0; k < parts; ++k) {
        ring.push_back(polygon[i] + double(k) / parts * (polygon.after(i) - polygon[i]));
      }
    }
    return Polygon(ring);
  };
  for (const double angle : {0., .3}) {
    for (const Polygon& shape : {h_shape(), u_shape(), l_shape(), cross_of_squares(), star(7, .4),
                                 comb(4, 9), spiral(2, 12), needle(1, .001)}) {
      const Polygon polygon = turned(shape, angle);
      const Polygon big = divided(polygon, 1 + 400 / polygon.size());
      const InscribedCircle few = largest_inscribed_circle(polygon);
      const InscribedCircle many = largest_inscribed_circle(big);
      INFO(polygon.size() << " and " << big.size() << " vertices, turned by " << angle);
      require_consistent(big, many);
      CHECK(std::abs(many.radius - few.radius) < 1e-13 * size_of(polygon));
      CHECK(many.centres.size() == few.centres.size());
    }
  }
}

TEST_CASE("big combs, stars and coastlines have the largest circles that brute force finds",
          "[inscribed]") {
  test::SeededRandom random(21);
  const int n = std::max(300, test::scaled(2000));
  checked(coastline(random, n));
  checked(turned(skyline(random, n), .2));
  checked(star(n / 2, .5));
  // One circle between each two neighbouring teeth, which touches the bar and two corners.
  for (const double angle : {0., .3}) {
    const InscribedCircle circle = largest_inscribed_circle(turned(comb(n / 4, 9), angle));
    CHECK(circle.radius == Approx(.625).epsilon(1e-12));
    CHECK(static_cast<int>(circle.centres.size()) == n / 4 - 2);
  }
}
