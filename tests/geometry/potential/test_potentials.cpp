#include "geometry/potential/potentials.hpp"

#include <catch2/catch.hpp>

#include "tests/geometry/nonconvex_pairs.hpp"

using namespace apothem;
using samples::Random;

namespace {

// How a copy is made of a polygon.
struct ShapeMotion {
  double angle = 0, scale = 1;
  Vec2 shift = Vec2::Zero();
  bool mirrored = false;
  int first = 0;  // vertex that becomes vertex 0
};

Polygon moved_copy(const Polygon& polygon, const ShapeMotion& m) {
  std::vector<Vec2> ring = polygon.vertices();
  std::rotate(ring.begin(), ring.begin() + m.first, ring.end());
  for (Vec2& v : ring) {
    v = m.scale * samples::turned(Vec2(v.x(), m.mirrored ? -v.y() : v.y()), m.angle) + m.shift;
  }
  return Polygon(ring);
}

ShapeMotion any_shape_motion(Random& random, int vertices) {
  return {random.uniform(0, 7), random.uniform(.1, 10),
          Vec2(random.uniform(-50, 50), random.uniform(-50, 50)), random.integer(0, 1) == 1,
          random.integer(0, vertices - 1)};
}

std::vector<Polygon> uneven_polygons() {
  Random random(5);
  std::vector<Polygon> shapes{test::cross_shape(), test::l_shape(), test::comb(3), test::spiral()};
  for (int i = 0; i < 8; ++i) {
    shapes.push_back(samples::random_star_shaped(random, 5 + i, .35));
    if (shapes.back().is_convex()) shapes.pop_back();
  }
  return shapes;
}

std::vector<const Polygon*> polygon_pointers(const std::vector<Polygon>& polygons) {
  std::vector<const Polygon*> result;
  for (const Polygon& p : polygons) result.push_back(&p);
  return result;
}

void require_same_potential(const Potential& a, const Potential& b) {
  REQUIRE(a.vertices == b.vertices);
  REQUIRE(a.gradients == b.gradients);
  REQUIRE(a.top == b.top);
  REQUIRE(a.top_points == b.top_points);
  REQUIRE(a.steepest == b.steepest);
  REQUIRE(a.roof.has_value() == b.roof.has_value());
  if (!a.roof) return;
  REQUIRE(a.roof->points == b.roof->points);
  REQUIRE(a.roof->values == b.roof->values);
  REQUIRE(a.roof->arcs == b.roof->arcs);
  REQUIRE(a.roof->faces == b.roof->faces);
}

}  // namespace

TEST_CASE("copies of a polygon are recognised, wherever they start", "[similar]") {
  test::SeededRandom random(17);
  for (const Polygon& shape : uneven_polygons()) {
    SimilarShapes shapes;
    REQUIRE_FALSE(shapes.add(shape));
    for (int i = 0; i < test::scaled(40); ++i) {
      const ShapeMotion m = any_shape_motion(random, shape.size());
      const Polygon copy = moved_copy(shape, m);
      const auto found = shapes.add(copy);
      REQUIRE(found);
      REQUIRE(found->index == 0);
      CHECK(found->map.scale() == Approx(m.scale).epsilon(1e-12));
      for (int v = 0; v < shape.size(); ++v) {
        const Vec2 image = copy.origin() + found->map(shape[v] - shape.origin());
        REQUIRE((image - copy[found->map.vertex(v)]).norm() <= 1e-12);
        // An edge joins the images of its ends.
        const int e = found->map.edge(v), next = v + 1 == shape.size() ? 0 : v + 1;
        REQUIRE(e == found->map.vertex(found->map.mirrored ? next : v));
      }
    }
  }
}

TEST_CASE("polygons that differ by more than the round-off of their coordinates are no copies",
          "[similar]") {
  const Polygon cross = test::cross_shape();
  const auto dented = [&](double by, const Vec2& shift) {
    std::vector<Vec2> ring = cross.vertices();
    ring[4].x() += by;
    for (Vec2& v : ring) v += shift;
    return Polygon(ring);
  };
  const auto is_copy = [&](const Polygon& polygon) {
    SimilarShapes shapes;
    shapes.add(cross);
    return shapes.add(polygon).has_value();
  };
  CHECK(is_copy(dented(0, {0, 0})));
  CHECK(is_copy(dented(0x1p-50, {0, 0})));
  for (const double by : {1e-13, 1e-11, 1e-9, 1e-3}) {
    CHECK_FALSE(is_copy(dented(by, {0, 0})));
    CHECK_FALSE(is_copy(dented(-by, {0, 0})));
  }
  // Far away, coordinates are coarser. Beyond 1e-11 of the size nothing counts as round-off.
  const Vec2 far(1000.1, 1000.7), farther(1e6 + .1, 1e6 + .7);
  CHECK(is_copy(dented(0, far)));
  CHECK_FALSE(is_copy(dented(1e-9, far)));
  CHECK_FALSE(is_copy(dented(1e-9, farther)));
  // A shape of other angles, and one of more vertices.
  CHECK_FALSE(is_copy(samples::cross_of_squares(1.5)));
  CHECK_FALSE(is_copy(test::star(6, .5)));
}

TEST_CASE("the first one of several copies is the original", "[similar]") {
  const Polygon cross = test::cross_shape(), l = test::l_shape();
  SimilarShapes shapes;
  CHECK_FALSE(shapes.add(l));
  CHECK_FALSE(shapes.add(cross));
  CHECK(shapes.add(moved_copy(cross, {.angle = 1, .scale = 3}))->index == 1);
  CHECK(shapes.add(moved_copy(l, {.angle = 2, .mirrored = true}))->index == 0);
  CHECK(shapes.add(moved_copy(cross, {.angle = 3}))->index == 1);
}

TEST_CASE("the skeleton of a copy is the one it would get by itself", "[similar][skeleton]") {
  test::SeededRandom random(23);
  for (const Polygon& shape : uneven_polygons()) {
    const Skeleton original = straight_skeleton(shape);
    for (int i = 0; i < test::scaled(10); ++i) {
      const ShapeMotion m = any_shape_motion(random, shape.size());
      const Polygon copy = moved_copy(shape, m);
      SimilarShapes shapes;
      shapes.add(shape);
      const auto found = shapes.add(copy);
      REQUIRE(found);
      const auto image = copied_skeleton(original, found->map, copy);
      REQUIRE(image);
      CHECK_FALSE(broken_law(*image, copy));
      const Skeleton own = straight_skeleton(copy);
      REQUIRE(image->nodes.size() == original.nodes.size());
      const double size = bounding_box(copy).extent();
      CHECK(std::abs(image->roof_height - own.roof_height) <= 1e-13 * size);
      const std::vector<Vec2> local = copy.local_vertices();
      for (int v = 0; v < copy.size(); ++v) REQUIRE(image->nodes[v].point == local[v]);
      for (const Skeleton::Node& node : own.nodes) {
        double nearest = HUGE_VAL;
        for (const Skeleton::Node& other : image->nodes) {
          nearest = std::min(
              nearest, std::hypot((node.point - other.point).norm(), node.height - other.height));
        }
        // As exact as the vertices are: coordinates of up to 50 m have an ulp of 7e-15 m.
        CHECK(nearest <= 1e-12 * std::max(1., size));
      }
    }
  }
}

TEST_CASE("forces of copies agree with those of polygons that have their own skeletons",
          "[similar]") {
  using Field = PotentialChoice::Field;
  test::SeededRandom random(31);
  const std::vector<Polygon> shapes = uneven_polygons();
  for (const PotentialChoice& choice :
       {PotentialChoice{},
        PotentialChoice{.reference = PotentialChoice::Reference::inscribed_circle},
        PotentialChoice{.field = Field::distance}}) {
    int touching = 0;
    for (int i = 0; i < test::scaled(60); ++i) {
      const Polygon& shape = shapes[random.integer(0, static_cast<int>(shapes.size()) - 1)];
      ShapeMotion ma = any_shape_motion(random, shape.size()),
                  mb = any_shape_motion(random, shape.size());
      ma.shift *= .01, mb.shift = ma.shift + Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
      ma.scale = random.uniform(.8, 1.2), mb.scale = random.uniform(.8, 1.2);
      const std::vector<Polygon> list{shape, moved_copy(shape, ma), moved_copy(shape, mb)};
      const Potentials potentials(polygon_pointers(list), choice, 1);
      REQUIRE(potentials.distinct() == 1);
      const Polygon &a = list[1], &b = list[2];
      const Potential of_a = potentials.make(1), of_b = potentials.make(2);
      const PairResult shared = edge_method(a, of_a, b, of_b);
      const PairResult own =
          edge_method(a, make_potential(a, choice), b, make_potential(b, choice));
      if (own.integral.weight == 0) {
        REQUIRE(shared.integral.weight == 0);
        continue;
      }
      ++touching;
      const double tolerance = 1e-14 * own.integral.weight;
      REQUIRE((shared.integral.force - own.integral.force).norm() <= tolerance);
      REQUIRE(std::abs(shared.integral.moment_a - own.integral.moment_a) <= 5 * tolerance);
      REQUIRE(std::abs(shared.integral.moment_b - own.integral.moment_b) <= 5 * tolerance);
      REQUIRE(std::abs(shared.volume.energy - own.volume.energy) <= 1e-12);
      // What acts on one acts on the other: the pair in the other order.
      const PairResult back = edge_method(b, of_b, a, of_a);
      REQUIRE((shared.integral.force + back.integral.force).norm() <= tolerance);
    }
    CHECK(touching > test::least(test::scaled(60) / 4));
  }
}

TEST_CASE("potentials have the same bits for any number of helper processes", "[similar]") {
  Random random(41);
  std::vector<Polygon> list;
  const std::vector<Polygon> shapes = uneven_polygons();
  for (int i = 0; i < 60; ++i) {
    const Polygon& shape = shapes[static_cast<size_t>(i) % shapes.size()];
    list.push_back(moved_copy(shape, any_shape_motion(random, shape.size())));
    list.push_back(samples::random_star_shaped(random, 9, .3));
    list.push_back(samples::random_convex(random, 5));
  }
  const Potentials one(polygon_pointers(list), {}, 1), three(polygon_pointers(list), {}, 3);
  CHECK(one.distinct() <= shapes.size() + 60);
  CHECK(one.distinct() == three.distinct());
  for (size_t i = 0; i < list.size(); ++i) {
    require_same_potential(one.make(i), three.make(i));
    // An original, and what has no skeleton, is as if it stood alone.
    if (i < shapes.size() || i % 3 != 0)
      require_same_potential(one.make(i), make_potential(list[i]));
  }
}

TEST_CASE("a polygon without a potential does not harm the others", "[similar]") {
  const std::vector<Polygon> list{test::cross_shape(), Polygon({{0, 0}, {1, 0}, {.5, 1e-300}}),
                                  moved_copy(test::cross_shape(), {.angle = 1})};
  const Potentials potentials(polygon_pointers(list), {}, 2);
  CHECK(potentials.distinct() == 1);
  CHECK(potentials.make(0).roof);
  CHECK_THROWS_AS(potentials.make(1), InvalidPolygon);
  CHECK(potentials.make(2).roof);
}
