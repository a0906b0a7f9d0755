#include "geometry/skeleton/skeleton.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>

#include "tests/geometry/skeleton/lawful.hpp"
#include "tests/geometry/skeleton/motorcycle_roof.hpp"
#include "tests/public_rings.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::samples;
using test::MotorcycleRoof;

namespace {

using Ring = std::vector<Vec2>;

bool contains(const Ring& ring, const Vec2& x) {
  bool inside = false;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 a = ring[i] - x, b = ring[(i + 1) % ring.size()] - x;
    if ((a.y() > 0) != (b.y() > 0) && (apothem::cross(a, b) > 0) == (b.y() > a.y())) {
      inside = !inside;
    }
  }
  return inside;
}

// Height of the roof by the face that contains x; NaN between faces.
double roof(const Skeleton& skeleton, const Polygon& polygon, const Vec2& x) {
  const Ring ring = polygon.local_vertices();
  for (int e = 0; e < polygon.size(); ++e) {
    Ring face;
    for (const int i : skeleton.faces[e]) face.push_back(skeleton.nodes[i].point);
    if (!contains(face, x)) continue;
    const Vec2 edge = polygon.after(e) - polygon[e];
    return apothem::cross(edge, x - ring[e]) / edge.norm();
  }
  return std::nan("");
}

// Largest error of the roof at random points, relative to the polygon's size.
template <class Reference>
double roof_error(const Polygon& polygon, const Reference& reference, Random& random, int points) {
  const Skeleton skeleton = test::lawful(polygon);
  const Box box = bounding_box(polygon);
  double worst = 0;
  for (int i = 0; i < points; ++i) {
    const Vec2 x =
        Vec2(random.uniform(box.x0, box.x1), random.uniform(box.y0, box.y1)) - polygon.origin();
    const double height = roof(skeleton, polygon, x);
    if (std::isnan(height)) continue;
    worst = std::max(worst, std::abs(height - reference(x)) / box.extent());
  }
  return worst;
}

double envelope(const Polygon& polygon, const Vec2& x) {
  double lowest = std::numeric_limits<double>::infinity();
  for (int e = 0; e < polygon.size(); ++e) {
    const Vec2 edge = polygon.after(e) - polygon[e];
    lowest =
        std::min(lowest, apothem::cross(edge, x + polygon.origin() - polygon[e]) / edge.norm());
  }
  return lowest;
}

struct Variant {
  std::string name;
  double scale;
  Ring ring;
};

std::vector<Variant> variants(const Ring& ring) {
  std::vector<Variant> result{{"as given", 1, ring},         {"turned", 1, ring},
                              {"reflected", 1, ring},        {"scaled by 1e-6", 1e-6, ring},
                              {"scaled by 1e6", 1e6, ring},  {"shifted by 1e6", 1, ring},
                              {"started elsewhere", 1, ring}};
  for (Vec2& v : result[1].ring) v = turned(v, 1.2345);
  for (Vec2& v : result[2].ring) v.x() = -v.x();
  for (Vec2& v : result[3].ring) v *= 1e-6;
  for (Vec2& v : result[4].ring) v *= 1e6;
  for (Vec2& v : result[5].ring) v += Vec2(1e6, 1e6);
  std::rotate(result[6].ring.begin(), result[6].ring.begin() + static_cast<int>(ring.size()) / 3,
              result[6].ring.end());
  return result;
}

}  // namespace

TEST_CASE("roof heights known by hand, in every variant", "[skeleton]") {
  struct Known {
    std::string name;
    Ring ring;
    double height;
  };
  const std::vector<Known> shapes{
      {"cross", cross_of_squares().vertices(), .5},
      {"L", l_shape().vertices(), .5},
      {"rectangle", {{0, 0}, {3, 0}, {3, 1}, {0, 1}}, .5},
      {"rectangle with straight vertices",
       {{0, 0}, {.5, 0}, {1, 0}, {2, 0}, {3, 0}, {3, .5}, {3, 1}, {2, 1}, {1, 1}, {0, 1}},
       .5},
      {"1000-gon", regular(1000).vertices(), std::cos(M_PI / 1000)},
      {"comb", samples::comb(6).vertices(), .5},
      {"sliver", {{0, 0}, {1, 0}, {1, 1e-6}, {0, 1e-6}}, 5e-7},
      {"triangle 3 4 5", {{0, 0}, {4, 0}, {0, 3}}, 1}};
  for (const Known& shape : shapes) {
    for (const Variant& variant : variants(shape.ring)) {
      INFO(shape.name << ", " << variant.name);
      const Polygon polygon(variant.ring);
      const Skeleton skeleton = test::lawful(polygon);
      const double coarse = variant.name == "shifted by 1e6" ? 1e-9 : 1e-12;
      CHECK(std::abs(skeleton.roof_height / variant.scale - shape.height) < coarse);
    }
  }
}

TEST_CASE("stars, combs, spirals, slivers and many sides pass the laws", "[skeleton][slow]") {
  for (const Polygon& polygon :
       {star(5, .4), star(17, .9), star(8, .1), samples::comb(3, 3), samples::comb(20, 3),
        spiral(1, 12), spiral(4, 12), regular(1000), Polygon({{0, 0}, {1, 0}, {.3, 1e-6}})}) {
    const Ring ring = polygon.vertices();
    for (const Variant& variant : variants(ring)) {
      INFO(ring.size() << " vertices, " << variant.name);
      test::lawful(Polygon(variant.ring));
    }
  }
}

TEST_CASE("convex: the roof is the lower envelope of the edges' lines", "[skeleton]") {
  test::SeededRandom random(1);
  for (int i = 0; i < test::scaled(300); ++i) {
    const Polygon polygon = random_convex(random, random.integer(3, 40));
    const auto reference = [&](const Vec2& x) { return envelope(polygon, x); };
    CHECK(roof_error(polygon, reference, random, 100) < 1e-12);
  }
  const Polygon round = regular(1000);
  const auto reference = [&](const Vec2& x) { return envelope(round, x); };
  CHECK(roof_error(round, reference, random, test::scaled(1000)) < 1e-12);
}

TEST_CASE("any shape: the roof is that of the motorcycle graph", "[skeleton]") {
  test::SeededRandom random(2);
  for (int i = 0; i < test::scaled(500); ++i) {
    const Polygon polygon =
        random_star_shaped(random, random.integer(4, 30), random.uniform(.1, 1));
    INFO("polygon " << i << " with " << polygon.size() << " vertices");
    CHECK(roof_error(polygon, MotorcycleRoof(polygon), random, 100) < 1e-12);
  }
}

TEST_CASE("known shapes: the roof is that of the motorcycle graph at 10 000 points", "[skeleton]") {
  test::SeededRandom random(3);
  const std::vector<std::pair<std::string, Polygon>> shapes{
      {"cross", cross_of_squares()},
      {"L", l_shape()},
      {"star of 5", turned(star(5, .4), .3)},
      {"star of 40", turned(star(40, .7), .3)},
      {"comb of 8", turned(samples::comb(8), .3)},
      {"spiral of 3", turned(spiral(3, 12), .3)},
      {"bent sliver of aspect 1e6",
       turned(Polygon({{0, 0}, {1, 0}, {1, 1e-6}, {.4, 5e-7}, {0, 1e-6}}), .3)}};
  for (const auto& [name, polygon] : shapes) {
    INFO(name);
    CHECK(roof_error(polygon, MotorcycleRoof(polygon), random, test::scaled(10000)) < 1e-12);
  }
}

// Arms around a regular polygon: all their ridges end at once.
Polygon equal_arms(int arms, double length) {
  Ring ring;
  for (int i = 0; i < arms; ++i) {
    const double angle = 2 * M_PI * i / arms, half = M_PI / arms;
    const Vec2 out = length * Vec2(std::cos(angle), std::sin(angle));
    const Vec2 corner(std::cos(angle - half), std::sin(angle - half));
    const Vec2 other(std::cos(angle + half), std::sin(angle + half));
    ring.insert(ring.end(), {corner, corner + out, other + out});
  }
  return Polygon(ring);
}

TEST_CASE("turned shapes of equal arms always get a skeleton", "[skeleton]") {
  test::SeededRandom random(4);
  int retried = 0;
  const int cases = test::long_run() ? 20000 : test::scaled(400);
  for (int i = 0; i < cases; ++i) {
    const double angle = random.uniform(0, 2 * M_PI);
    if (i % 4 == 0) {
      test::lawful(turned(equal_arms(random.integer(3, 9), random.uniform(.2, 3)), angle));
    } else if (i % 4 == 1) {
      test::lawful(turned(star(random.integer(3, 12), random.uniform(.1, .9)), angle));
    } else {
      const double arm = i % 4 == 2 ? 1 : random.uniform(.2, 3);
      const Skeleton skeleton = test::lawful(turned(cross_of_squares(arm), angle));
      if (skeleton.attempts > 1) ++retried;
      CHECK(std::abs(skeleton.roof_height - .5) < 1e-12);
    }
  }
  if (test::long_run()) WARN(retried << " crosses needed more than one attempt");
  CHECK(retried < std::max(2, cases / 10));
}

TEST_CASE("the same skeleton, whatever lies about in memory", "[skeleton]") {
  test::SeededRandom random(44);
  std::vector<std::vector<char>> litter;
  for (int i = 0; i < test::scaled(100); ++i) {
    const Polygon polygon = turned(cross_of_squares(), random.uniform(0, 6));
    const Skeleton first = test::lawful(polygon);
    for (int repeat = 0; repeat < 5; ++repeat) {
      for (int k = 0; k < 30; ++k) litter.emplace_back(random.integer(16, 2000));
      for (int k = 0; k < 20; ++k) {
        std::swap(litter[random.integer(0, static_cast<int>(litter.size()) - 1)], litter.back());
        litter.pop_back();
      }
      const Skeleton again = straight_skeleton(polygon);
      REQUIRE(again.faces == first.faces);
      for (size_t n = 0; n < first.nodes.size(); ++n) {
        REQUIRE(again.nodes[n].point == first.nodes[n].point);
        REQUIRE(again.nodes[n].height == first.nodes[n].height);
      }
    }
  }
}

TEST_CASE("a wrong skeleton breaks a law", "[skeleton]") {
  const Polygon polygon = l_shape();
  const Skeleton good = test::lawful(polygon);
  const auto broken = [&](auto spoil) {
    Skeleton bad = good;
    spoil(bad);
    return broken_law(bad, polygon).has_value();
  };
  CHECK(broken([](Skeleton& s) { s.nodes.back().height *= 1 + 1e-6; }));
  CHECK(broken([](Skeleton& s) { s.nodes.back().point.x() += 1e-6; }));
  CHECK(broken([](Skeleton& s) { s.nodes.back().point.x() = std::nan(""); }));
  CHECK(broken([](Skeleton& s) { s.nodes[0].point.x() = 1e-6; }));
  CHECK(broken([](Skeleton& s) { s.faces[0].pop_back(); }));
  CHECK(broken([](Skeleton& s) { std::swap(s.faces[0], s.faces[1]); }));
  CHECK(broken([](Skeleton& s) { s.arcs.pop_back(); }));
  CHECK(broken([](Skeleton& s) { std::swap(s.arcs.back().left, s.arcs.back().right); }));
  CHECK(broken([](Skeleton& s) { s.faces[2][2] = 1000; }));
  CHECK(broken([](Skeleton& s) { s.roof_height = 1; }));
  CHECK(broken_law(good, cross_of_squares()).has_value());
}

TEST_CASE("every public ring gets a skeleton", "[skeleton]") {
  for (const auto& [name, line, ring] : test::public_rings(2500)) {  // minutes
    for (const Variant& variant : variants(ring)) {
      INFO(name << ", " << variant.name);
      std::optional<Polygon> polygon;
      try {
        polygon.emplace(variant.ring);
      } catch (const InvalidPolygon&) {
        continue;
      }
      test::lawful(*polygon);
    }
  }
}
