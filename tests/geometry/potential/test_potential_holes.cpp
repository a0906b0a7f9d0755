// Inscribed circles, potentials and point values of polygons with holes.
#include <catch2/catch.hpp>
#include <queue>

#include "geometry/polygon/convex_parts.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/segment.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "geometry/potential/point_values.hpp"
#include "geometry/potential/potentials.hpp"
#include "tests/geometry/skeleton/holed_polygons.hpp"

using namespace apothem;

namespace {

using samples::Random;

// The distance from the boundary, negative outside and in holes: by all edges.
double depth_between_rings(const Polygon& polygon, const Vec2& x) {
  double least = HUGE_VAL;
  bool inside = false;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 p = polygon[i] - x, d = polygon.after(i) - polygon[i];
    const double t = std::clamp(-p.dot(d) / d.squaredNorm(), 0., 1.);
    least = std::min(least, (p + t * d).norm());
    const Vec2 q = p + d;
    if ((p.y() > 0) != (q.y() > 0) && (apothem::cross(p, q) > 0) == (q.y() > p.y())) {
      inside = !inside;
    }
  }
  return inside ? least : -least;
}

// The largest depth, to `precision` of the size: squares that may hold a deeper point than is known
// are quartered, the best one first.
double deepest(const Polygon& polygon, double precision) {
  struct Square {
    Vec2 centre;
    double half, depth;
    [[nodiscard]] double most() const { return depth + half * M_SQRT2; }
    bool operator<(const Square& other) const { return most() < other.most(); }
  };
  const Box box = bounding_box(polygon);
  std::priority_queue<Square> open;
  double best = 0;
  const auto add = [&](const Vec2& centre, double half) {
    const double depth = depth_between_rings(polygon, centre);
    best = std::max(best, depth);
    open.push({centre, half, depth});
  };
  const double half = box.extent() / 2;
  add({(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2}, half);
  while (!open.empty() && open.top().most() > best + precision * box.extent()) {
    const Square square = open.top();
    open.pop();
    const double quarter = square.half / 2;
    for (const double x : {-quarter, quarter}) {
      for (const double y : {-quarter, quarter}) add(square.centre + Vec2(x, y), quarter);
    }
  }
  return best;
}

void check_circle(const Polygon& polygon, double precision) {
  const InscribedCircle circle = largest_inscribed_circle(polygon);
  const double size = bounding_box(polygon).extent();
  CHECK(std::abs(circle.radius - deepest(polygon, precision)) < 1.01 * precision * size);
  REQUIRE(!circle.centres.empty());
  for (const Vec2& centre : circle.centres) {
    CHECK(std::abs(depth_between_rings(polygon, polygon.origin() + centre) - circle.radius) <
          1e-13 * size);
  }
}

std::vector<PotentialChoice> choices_with_all_references() {
  std::vector<PotentialChoice> choices;
  for (const auto field : {PotentialChoice::Field::roof, PotentialChoice::Field::distance}) {
    for (const auto reference :
         {PotentialChoice::Reference::roof, PotentialChoice::Reference::inscribed_circle,
          PotentialChoice::Reference::length}) {
      choices.push_back({.field = field, .reference = reference, .length = .07});
    }
  }
  return choices;
}

}  // namespace

TEST_CASE("around holes: the largest circle is the one that quartered squares find",
          "[inscribed_circle][holes]") {
  test::SeededRandom random(71);
  for (int i = 0; i < (test::long_run() ? 1000 : test::scaled(400)); ++i) {
    const Polygon polygon = test::random_drilled(random, random.integer(1, 20));
    INFO("polygon " << i << ": " << polygon.size() << " vertices, " << polygon.rings() << " rings");
    check_circle(polygon, 1e-9);
  }
}

TEST_CASE("tied shapes with holes have the largest circle that quartered squares find",
          "[inscribed_circle][holes]") {
  test::SeededRandom random(72);
  for (int i = 0; i < test::scaled(400); ++i) {
    const Polygon polygon = test::random_tied_with_holes(random, i);
    INFO("polygon " << i << ": " << polygon.size() << " vertices, " << polygon.rings() << " rings");
    check_circle(polygon, 1e-3);  // corridors are full of centres
  }
}

TEST_CASE("largest circles between rings are known by hand", "[inscribed_circle][holes]") {
  // In the corners of a frame, between both sides and the corner of the hole.
  const Polygon frame(test::rectangle(0, 0, 10, 10), {test::rectangle(2, 2, 6, 6)});
  const InscribedCircle in_frame = largest_inscribed_circle(frame);
  CHECK(in_frame.radius == Approx(2 * M_SQRT2 / (1 + M_SQRT2)).epsilon(1e-14));
  CHECK(in_frame.centres.size() == 4);
  // Between the sides of an annulus of regular polygons, at each of its corners.
  for (const int n : {3, 4, 6, 100}) {
    INFO(n);
    const double inner = .7, s = std::cos(M_PI / n);
    const InscribedCircle circle = largest_inscribed_circle(test::annulus(n, inner, .1));
    CHECK(circle.radius == Approx((1 - inner) * s / (1 + s)).epsilon(1e-13));
    CHECK(static_cast<int>(circle.centres.size()) == n);
  }
  // Many corners: the search that begins with a box.
  const int n = std::max(300, test::scaled(2000));
  const double s = std::cos(M_PI / n);
  CHECK(largest_inscribed_circle(test::annulus(n, .4, .1)).radius ==
        Approx(.6 * s / (1 + s)).epsilon(1e-11));
}

TEST_CASE("around holes: big outlines have the largest circle that quartered squares find",
          "[inscribed_circle][holes]") {
  test::SeededRandom random(73);
  for (int i = 0; i < test::scaled(12); ++i) {
    const std::vector<Vec2> outer = samples::coastline(random, 400).vertices();
    const Box box = box_of(outer);
    check_circle(test::with_holes(outer, random.integer(1, 30),
                                  [&] {
                                    std::vector<Vec2> hole =
                                        samples::coastline(random, 30).vertices();
                                    const double x = random.uniform(box.x0, box.x1);
                                    const Vec2 centre(x, random.uniform(box.y0, box.y1));
                                    for (Vec2& v : hole) v = centre + .1 * v;
                                    return hole;
                                  }),
                 1e-9);
  }
}

TEST_CASE("around holes: values at points are those of the distance by brute force",
          "[point_values][holes]") {
  test::SeededRandom random(74);
  for (int i = 0; i < test::scaled(120); ++i) {
    const Polygon polygon = test::random_drilled(random, random.integer(1, 12));
    const Box box = bounding_box(polygon);
    const double size = box.extent();
    for (const PotentialChoice& choice : choices_with_all_references()) {
      const Potential potential = make_potential(polygon, choice);
      const PointEvaluator at(polygon, potential);
      REQUIRE_FALSE(potential.layer);
      REQUIRE(potential.links);
      const auto phi = [&](const Vec2& x) { return at(x).phi; };
      for (int k = 0; k < 30; ++k) {
        const double px = random.uniform(box.x0, box.x1);
        const Vec2 x(px, random.uniform(box.y0, box.y1));
        const double depth = depth_between_rings(polygon, x);
        const PointValues values = at(x);
        INFO("polygon " << i << " at " << x.transpose());
        CHECK(values.side == (depth > 0 ? Side::inside : Side::outside));
        CHECK(std::abs(values.signed_distance + depth) < 1e-13 * size);
        if (depth < 0) {
          CHECK(values.phi == 0);
          continue;
        }
        const double slope = potential.steepest;
        if (choice.field == PotentialChoice::Field::distance) {
          CHECK(std::abs(values.phi - std::min(1., slope * depth)) < 1e-12 * slope * size);
        } else {
          CHECK(values.phi <= std::min(1., slope * depth) + 1e-12 * slope * size);
          CHECK(values.phi > 0);
        }
        // The gradient, where it does not jump.
        const double h = 1e-7 * size;
        const Vec2 gradient((phi(x + Vec2(h, 0)) - phi(x - Vec2(h, 0))) / (2 * h),
                            (phi(x + Vec2(0, h)) - phi(x - Vec2(0, h))) / (2 * h));
        const bool smooth = std::abs(gradient.norm() - slope) < 1e-5 * slope;
        if (depth > 2 * h && smooth) CHECK((values.gradient - gradient).norm() < 1e-4 * slope);
      }
      for (int v = 0; v < polygon.size(); ++v) {
        const PointValues values = at(polygon[v]);
        CHECK(values.side == Side::boundary);
        CHECK(values.phi == 0);
      }
    }
  }
}

TEST_CASE("around holes: every potential is 1 at its reference and highest where it says",
          "[potential][holes]") {
  test::SeededRandom random(75);
  for (int i = 0; i < test::scaled(100); ++i) {
    const Polygon polygon = i % 2 == 0 ? test::random_drilled(random, random.integer(1, 12))
                                       : test::random_tied_with_holes(random, i / 2);
    const double roof = straight_skeleton(polygon).roof_height;
    const double inradius = largest_inscribed_circle(polygon).radius;
    for (const PotentialChoice& choice : choices_with_all_references()) {
      const Potential potential = make_potential(polygon, choice);
      const double reference = choice.reference == PotentialChoice::Reference::roof ? roof
                               : choice.reference == PotentialChoice::Reference::length
                                   ? choice.length
                                   : inradius;
      INFO("polygon " << i);
      CHECK(potential.steepest == Approx(1 / reference).epsilon(1e-14));
      const bool of_roof = choice.field == PotentialChoice::Field::roof;
      CHECK(potential.top == Approx((of_roof ? roof : inradius) / reference).epsilon(1e-12));
      CHECK(potential.roof.has_value() == of_roof);
      CHECK(potential.distance.has_value() == !of_roof);
      REQUIRE(!potential.top_points.empty());
      const PointEvaluator at(polygon, potential);
      for (const Vec2& p : potential.top_points) {
        CHECK(at(polygon.origin() + p).phi == Approx(std::min(1., potential.top)).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("a thousand equal rings share one skeleton", "[potential][holes]") {
  test::SeededRandom random(76);
  std::vector<Polygon> rings;
  const int count = std::max(20, test::scaled(1000));
  for (int i = 0; i < count; ++i) {
    Rings ring = rings_of(test::annulus(24, .6, random.uniform(0, 7)));
    const Vec2 shift(random.uniform(-9, 9), random.uniform(-9, 9));
    for (std::vector<Vec2>& part : ring) {
      for (Vec2& v : part) v += shift;
      std::rotate(part.begin(), part.begin() + random.integer(0, 23), part.end());
    }
    rings.push_back(test::polygon_of(ring));
  }
  std::vector<const Polygon*> all;
  for (const Polygon& p : rings) all.push_back(&p);
  const Potentials potentials(all, {}, 1);
  CHECK(potentials.distinct() == 1);
  for (size_t i = 0; i < all.size(); ++i) {
    const Potential potential = potentials.make(i);
    REQUIRE(potential.roof);
    CHECK(potential.steepest == Approx(2 / (.4 * std::cos(M_PI / 24))).epsilon(1e-12));
  }
}

TEST_CASE("around holes: convex parts tile the polygon", "[convex_parts][holes]") {
  test::SeededRandom random(77);
  for (int i = 0; i < test::scaled(400); ++i) {
    const Polygon polygon = i % 2 == 0 ? test::random_drilled(random, random.integer(1, 20))
                                       : test::random_tied_with_holes(random, i / 2);
    INFO("polygon " << i);
    double area = 0;
    for (const std::vector<int>& part : convex_parts(polygon)) {
      std::vector<Vec2> ring;
      for (const int v : part) ring.push_back(polygon[v]);
      CHECK(smallest_turn(ring) >= 0);
      area += ring_area(ring);
    }
    CHECK(area == Approx(area_moments(polygon).area).epsilon(1e-12));
  }
}
