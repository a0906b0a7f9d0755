// Straight skeletons and singular areas of polygons with holes.
#include <catch2/catch.hpp>

#include "geometry/polygon/segment.hpp"
#include "geometry/skeleton/cgal_skeleton.hpp"
#include "geometry/skeleton/exact_front.hpp"
#include "geometry/skeleton/singular_area.hpp"
#include "geometry/skeleton/skeletons.hpp"
#include "geometry/skeleton/wavefront.hpp"
#include "tests/geometry/skeleton/holed_polygons.hpp"
#include "tests/geometry/skeleton/lawful.hpp"
#include "tests/geometry/skeleton/motorcycle_roof.hpp"

using namespace apothem;

namespace {

using samples::Random;
using Ring = std::vector<Vec2>;

Ring face_ring(const Skeleton& skeleton, int face) {
  Ring ring;
  for (const int i : skeleton.faces[face]) ring.push_back(skeleton.nodes[i].point);
  return ring;
}

// The faces tile the polygon: a point inside lies in one of them, unless it lies on an arc, and one
// outside or in a hole in none. Returns the face, or -1.
int face_at(const Skeleton& skeleton, const Polygon& polygon, const Vec2& x) {
  int found = -1;
  int count = 0;
  for (int e = 0; e < polygon.size(); ++e) {
    if (side_of_ring(face_ring(skeleton, e), x - polygon.origin()) <= 0) continue;
    found = e;
    ++count;
  }
  REQUIRE(count == (side_of(polygon, x) > 0 ? 1 : 0));
  return found;
}

double height_over_edge(const Polygon& polygon, int e, const Vec2& x) {
  const Vec2 edge = polygon.after(e) - polygon[e];
  return apothem::cross(edge, x - polygon[e]) / edge.norm();
}

Vec2 random_point(Random& random, const Box& box) {
  const double x = random.uniform(box.x0, box.x1);
  return {x, random.uniform(box.y0, box.y1)};
}

// The largest difference between the roofs of two skeletons at random points and their summits.
double roof_difference(const Skeleton& p, const Skeleton& q, const Polygon& polygon,
                       Random& random) {
  double worst = std::abs(p.roof_height - q.roof_height);
  for (int k = 0; k < 20; ++k) {
    const Vec2 x = random_point(random, bounding_box(polygon));
    const int f = face_at(p, polygon, x), g = face_at(q, polygon, x);
    if (f < 0 || g < 0) continue;
    worst = std::max(worst,
                     std::abs(height_over_edge(polygon, f, x) - height_over_edge(polygon, g, x)));
  }
  return worst;
}

double perimeter_of(const SingularArea& area) {
  double sum = 0;
  for (const Ring& ring : rings_of(area.polygons)) {
    for (size_t i = 0; i < ring.size(); ++i) sum += (after(ring, i) - ring[i]).norm();
  }
  return sum;
}

SingularArea singular_at(const Polygon& polygon, double depth) {
  return singular_area(straight_skeleton(polygon), depth);
}

}  // namespace

TEST_CASE("around holes: the roof is that of the motorcycle graph", "[skeleton][holes]") {
  test::SeededRandom random(61);
  for (int i = 0; i < (test::long_run() ? 1000 : test::scaled(600)); ++i) {
    const Polygon polygon = test::random_drilled(random, random.integer(1, 20));
    INFO("polygon " << i << ": " << polygon.size() << " vertices, " << polygon.rings() << " rings");
    const Skeleton skeleton = test::lawful(polygon);
    const test::MotorcycleRoof reference(polygon);
    const Box box = bounding_box(polygon);
    double worst = 0;
    for (int k = 0; k < 50; ++k) {
      const Vec2 x = random_point(random, box);
      const int face = face_at(skeleton, polygon, x);
      if (face < 0) continue;
      const double error =
          std::abs(height_over_edge(polygon, face, x) - reference(x - polygon.origin()));
      worst = std::max(worst, error / box.extent());
    }
    CHECK(worst < 1e-12);
    // The summit, from all places that the skeleton knows.
    double summit = 0;
    for (size_t n = static_cast<size_t>(polygon.size()); n < skeleton.nodes.size(); ++n) {
      summit = std::max(summit, skeleton.nodes[n].height);
    }
    CHECK(skeleton.roof_height == summit);
  }
}

TEST_CASE("around holes: wavefront, CGAL and exact front find the same roof", "[skeleton][holes]") {
  test::SeededRandom random(62);
  for (int i = 0; i < test::scaled(150); ++i) {
    const Polygon polygon = i % 3 == 0
                                ? test::annulus(random.integer(3, 12), random.uniform(.2, .9), 1)
                                : test::random_drilled(random, random.integer(1, 12));
    INFO("polygon " << i << ": " << polygon.size() << " vertices, " << polygon.rings() << " rings");
    const Skeleton skeleton = test::lawful(polygon);
    const auto check = [&](std::optional<SkeletonParts> parts, const char* construction) {
      INFO(construction);
      REQUIRE(parts);
      for (Skeleton::Node& node : parts->nodes) node.point -= polygon.origin();
      const Skeleton other = assemble(std::move(*parts), polygon);
      CHECK(roof_difference(skeleton, other, polygon, random) < 1e-10);
      // One node more for each triangle, and two for each hole, where no events are tied.
      const size_t inner = skeleton.nodes.size() - static_cast<size_t>(polygon.size());
      if (i % 3 != 0) CHECK(inner == static_cast<size_t>(polygon.size() - 4 + 2 * polygon.rings()));
    };
    check(trace_wavefront(polygon, 1, {}), "wavefront");
    check(ask_cgal(rings_of(polygon), false, 60, {}).parts, "CGAL");
    if (i % 8 == 1) check(ask_cgal(rings_of(polygon), true, 60, {}).parts, "CGAL, exactly");
    std::optional<SkeletonParts> exact = exact_skeleton(polygon, {});
    REQUIRE(exact);
    for (Skeleton::Node& node : exact->nodes) node.point += polygon.origin();
    check(std::move(exact), "exact front");
  }
}

TEST_CASE("tied shapes with holes obey the laws, and their faces tile them", "[skeleton][holes]") {
  test::SeededRandom random(63);
  for (int i = 0; i < test::scaled(600); ++i) {
    const Polygon polygon = test::random_tied_with_holes(random, i);
    INFO("polygon " << i << ": " << polygon.size() << " vertices, " << polygon.rings() << " rings");
    const Skeleton skeleton = test::lawful(polygon);
    const Box box = bounding_box(polygon);
    for (int k = 0; k < 20; ++k) face_at(skeleton, polygon, random_point(random, box));
    // The mitred front is nowhere slower than the distance: no roof is higher than that.
    for (const Skeleton::Node& node : skeleton.nodes) {
      double depth = HUGE_VAL;
      for (int e = 0; e < polygon.size(); ++e) {
        const Vec2 a = polygon[e] - polygon.origin(), b = polygon.after(e) - polygon.origin();
        depth = std::min(depth, nearest_on_segment(node.point - a, b - a).distance2);
      }
      CHECK(node.height <= std::sqrt(depth) + 1e-12 * box.extent());
    }
  }
}

TEST_CASE("roof heights of rings, frames and plates are known by hand", "[skeleton][holes]") {
  for (const int n : {3, 4, 5, 7, 12, 100, 333}) {
    for (const double inner : {.1, .5, .93}) {
      for (const double angle : {0., .3}) {
        INFO(n << "-gon, " << inner << ", " << angle);
        const Skeleton skeleton = test::lawful(test::annulus(n, inner, angle));
        const double height = (1 - inner) * std::cos(M_PI / n) / 2;
        CHECK(std::abs(skeleton.roof_height - height) < 1e-14);
      }
    }
  }
  const Polygon frame(test::rectangle(0, 0, 20, 10), {test::rectangle(2, 3, 15, 5)});
  CHECK(test::lawful(frame).roof_height == 1.5);
  // Circles fit into the middle between four square holes, and roofs into their cross of corridors.
  const Polygon plate(test::rectangle(0, 0, 10, 10),
                      {test::rectangle(1, 1, 3, 3), test::rectangle(6, 1, 3, 3),
                       test::rectangle(6, 6, 3, 3), test::rectangle(1, 6, 3, 3)});
  CHECK(test::lawful(plate).roof_height == 1);
  // A diamond in a square: its corners hit the middles of the sides before the corners are left.
  const Polygon diamond(test::rectangle(0, 0, 8, 8), {{{4, 1}, {7, 4}, {4, 7}, {1, 4}}});
  const Skeleton skeleton = test::lawful(diamond);
  CHECK(std::abs(skeleton.roof_height - 5 / (2 + M_SQRT2)) < 1e-14);
}

TEST_CASE("big rings with big holes get a skeleton", "[skeleton][holes]") {
  test::SeededRandom random(64);
  const int n = std::max(200, test::scaled(2000));
  const double inner = .6;
  CHECK(std::abs(test::lawful(test::annulus(n, inner)).roof_height -
                 (1 - inner) * std::cos(M_PI / n) / 2) < 1e-13);
  const std::vector<Vec2> outer = samples::random_star_shaped(random, n, .9).vertices();
  std::vector<Vec2> hole = samples::random_star_shaped(random, n, .8).vertices();
  for (Vec2& v : hole) v *= .7;
  const Polygon ragged(outer, {hole});
  CHECK(test::lawful(ragged).attempts == 1);
  const Polygon coast(samples::coastline(random, n).vertices(), {});
  const Box box = bounding_box(coast);
  test::lawful(test::with_holes(coast.vertices(), 60, [&] {
    Ring ring = samples::coastline(random, 40).vertices();
    const Vec2 centre = random_point(random, box);
    for (Vec2& v : ring) v = centre + .05 * v;
    return ring;
  }));
}

TEST_CASE("a wrong skeleton of a polygon with a hole breaks a law", "[skeleton][holes]") {
  const Polygon polygon(test::rectangle(0, 0, 20, 10), {test::rectangle(2, 3, 15, 5)});
  const Skeleton good = test::lawful(polygon);
  const auto broken = [&](auto spoil) {
    Skeleton bad = good;
    spoil(bad);
    return broken_law(bad, polygon).has_value();
  };
  CHECK(broken([](Skeleton& s) { s.nodes.back().height += 1e-6; }));
  CHECK(broken([](Skeleton& s) { s.nodes.back().point.x() += 1e-6; }));
  CHECK(broken([](Skeleton& s) { s.arcs.pop_back(); }));
  CHECK(broken([](Skeleton& s) { std::swap(s.faces[0], s.faces[5]); }));
  CHECK(broken([](Skeleton& s) { std::swap(s.arcs.back().left, s.arcs.back().right); }));
  CHECK(broken_law(good, Polygon(test::rectangle(0, 0, 20, 10))).has_value());
  const Polygon full(test::rectangle(0, 0, 20, 10));
  CHECK(broken_law(straight_skeleton(full), polygon).has_value());
}

TEST_CASE("a copy of a polygon with holes gets the image of its skeleton", "[skeleton][holes]") {
  test::SeededRandom random(65);
  for (int i = 0; i < test::scaled(200); ++i) {
    const Polygon polygon = test::random_drilled(random, random.integer(1, 8));
    Rings rings = rings_of(polygon);
    const bool mirrored = random.integer(0, 1) == 1;
    const double angle = random.uniform(0, 7), scale = random.uniform(.1, 10);
    const Vec2 shift(random.uniform(-9, 9), random.uniform(-9, 9));
    for (Ring& ring : rings) {
      std::rotate(ring.begin(), ring.begin() + random.integer(0, 2), ring.end());
      for (Vec2& v : ring) {
        v = scale * samples::turned(Vec2(v.x(), mirrored ? -v.y() : v.y()), angle) + shift;
      }
    }
    std::rotate(rings.begin() + 1, rings.begin() + random.integer(1, polygon.rings() - 1),
                rings.end());
    const Polygon copy = test::polygon_of(rings);
    SimilarShapes shapes;
    REQUIRE_FALSE(shapes.add(polygon));
    const auto found = shapes.add(copy);
    INFO("polygon " << i << ": " << polygon.size() << " vertices, " << polygon.rings() << " rings");
    REQUIRE(found);
    std::set<int> images;
    for (int v = 0; v < polygon.size(); ++v) {
      const int image = found->map.vertex(v);
      images.insert(image);
      const Vec2 place = copy.origin() + found->map(polygon[v] - polygon.origin());
      REQUIRE((place - copy[image]).norm() < 1e-12 * scale);
      REQUIRE(found->map.edge(v) == found->map.vertex(found->map.mirrored ? polygon.next(v) : v));
    }
    REQUIRE(static_cast<int>(images.size()) == polygon.size());
    const Skeleton original = straight_skeleton(polygon);
    const std::optional<Skeleton> image = copied_skeleton(original, found->map, copy);
    REQUIRE(image);
    CHECK(std::abs(image->roof_height - original.roof_height * scale) < 1e-13 * scale);
    CHECK(roof_difference(*image, straight_skeleton(copy), copy, random) < 1e-12 * scale);
  }
}

TEST_CASE("polygons that differ in one hole are no copies", "[skeleton][holes]") {
  const auto plate = [](double x, double y, double by) {
    return Polygon(test::rectangle(0, 0, 8, 6),
                   {test::rectangle(1, 1, 2, 2), {{x, y}, {x + 1 + by, y}, {x, y + 1}}});
  };
  SimilarShapes shapes;
  CHECK_FALSE(shapes.add(plate(5, 2, 0)));
  CHECK_FALSE(shapes.add(plate(5, 3, 0)));
  CHECK_FALSE(shapes.add(plate(5, 2, 1e-6)));
  CHECK(shapes.add(plate(5, 2, 0))->index == 0);
}

TEST_CASE("singular areas of a frame: frames, then its ridges, then nothing", "[singular][holes]") {
  const Polygon frame(test::rectangle(0, 0, 10, 10), {test::rectangle(3, 3, 4, 4)});
  const SingularArea area = singular_at(frame, 1);
  REQUIRE(area.polygons.size() == 1);
  CHECK(area.polygons[0].holes.size() == 1);
  CHECK(area.area() == Approx(64 - 36).epsilon(1e-14));
  const SingularArea ridges = singular_at(frame, 1.5);
  CHECK(ridges.kind() == SingularArea::Kind::segment);
  CHECK(ridges.segments.size() == 4);
  CHECK(singular_at(frame, 1.6).kind() == SingularArea::Kind::none);
  // Beside the hole on one side only.
  const Polygon uneven(test::rectangle(0, 0, 10, 10), {test::rectangle(1, 3, 4, 4)});
  const SingularArea open = singular_at(uneven, 1);
  REQUIRE(open.polygons.size() == 1);
  CHECK(open.polygons[0].holes.empty());
  CHECK(open.area() == Approx(64 - 30).epsilon(1e-14));
  // Below the ridge between the hole and the outer ring, the hole is surrounded.
  const SingularArea closed = singular_at(uneven, .25);
  REQUIRE(closed.polygons.size() == 1);
  CHECK(closed.polygons[0].holes.size() == 1);
  // Two holes close to each other become one.
  const Polygon pair(test::rectangle(0, 0, 20, 10),
                     {test::rectangle(4, 4, 5, 2), test::rectangle(10, 4, 5, 2)});
  CHECK(singular_at(pair, .4).polygons.at(0).holes.size() == 2);
  CHECK(singular_at(pair, .6).polygons.at(0).holes.size() == 1);
}

TEST_CASE("a level that passes a saddle divides the ring around a hole in simple rings",
          "[singular][holes]") {
  // The tip of the hole meets the upper side at the depth 1.
  const double down = 1 + std::sqrt(5.);
  const Polygon polygon(test::rectangle(0, 0, 20, 20),
                        {{{10, 20 - down}, {8, 16 - down}, {8, 6}, {12, 6}, {12, 16 - down}}});
  const Skeleton skeleton = test::lawful(polygon);
  for (const double depth : {.999, 1., 1.001}) {
    INFO(depth);
    const SingularArea area = singular_area(skeleton, depth);
    REQUIRE(area.polygons.size() == 1);
    const PolygonWithHoles& part = area.polygons[0];
    CHECK(part.holes.size() == (depth > 1 ? 0 : 1));
    for (const Ring& ring : rings_of(part)) {
      std::set<std::pair<double, double>> corners;
      for (const Vec2& v : ring) corners.emplace(v.x(), v.y());
      CHECK(corners.size() == ring.size());
    }
    const double area_at_saddle = singular_area(skeleton, 1).area();
    CHECK(area.area() == Approx(area_at_saddle + (1 - depth) * perimeter_of(area)).margin(1e-3));
  }
}

TEST_CASE("singular areas around holes are level, nested and shrink by their perimeter",
          "[singular][holes]") {
  test::SeededRandom random(66);
  for (int i = 0; i < test::scaled(200); ++i) {
    const Polygon polygon = test::random_drilled(random, random.integer(1, 10));
    INFO("polygon " << i << ": " << polygon.size() << " vertices, " << polygon.rings() << " rings");
    const Skeleton skeleton = straight_skeleton(polygon);
    const double size = bounding_box(polygon).extent();
    const Box box = bounding_box(polygon);
    for (const double share : {.05, .2, .4, .6, .8, .95}) {
      const double r = share * skeleton.roof_height;
      const SingularArea area = singular_area(skeleton, r);
      REQUIRE(!area.polygons.empty());
      int holes = 0;
      for (const PolygonWithHoles& part : area.polygons) {
        CHECK(ring_area(part.outer) > 0);
        holes += static_cast<int>(part.holes.size());
        for (const Ring& hole : part.holes) {
          CHECK(ring_area(hole) < 0);
          CHECK(side_of_ring(part.outer, hole[0]) >= 0);
        }
      }
      CHECK(holes < polygon.rings());
      // A point is in it if the roof is higher there.
      for (int k = 0; k < 20; ++k) {
        const Vec2 x = random_point(random, box);
        const int face = face_at(skeleton, polygon, x);
        const double height = face < 0 ? 0 : height_over_edge(polygon, face, x);
        if (std::abs(height - r) < 1e-12 * size) continue;
        bool inside = false;
        for (const Ring& ring : rings_of(area.polygons)) {
          if (side_of_ring(ring, x - polygon.origin()) > 0) inside = !inside;
        }
        CHECK(inside == (height > r));
      }
      const double step = 1e-6 * skeleton.roof_height;
      const double slope =
          (singular_area(skeleton, r + step).area() - singular_area(skeleton, r - step).area()) /
          (2 * step);
      CHECK(std::abs(slope + perimeter_of(area)) < 1e-4 * perimeter_of(area));
    }
  }
}
