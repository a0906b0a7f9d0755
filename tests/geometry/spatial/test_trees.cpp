// The trees of boxes find what the plain search finds.
#include <catch2/catch.hpp>
#include <set>

#include "geometry/polygon/segment.hpp"
#include "geometry/spatial/edge_trees.hpp"
#include "geometry/spatial/point_tree.hpp"
#include "geometry/spatial/ring_tree.hpp"
#include "geometry/spatial/touching_circles.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

// Some of them on a lattice, so that many have equal coordinates.
std::vector<Vec2> random_points(test::SeededRandom& random, int n) {
  const bool lattice = random.integer(0, 1) == 1;
  std::vector<Vec2> points;
  for (int i = 0; i < n; ++i) {
    const Vec2 p(random.uniform(0, 5), random.uniform(0, 5));
    points.push_back(lattice ? Vec2(std::round(p.x()), std::round(p.y())) : p);
  }
  return points;
}

}  // namespace

TEST_CASE("the tree of points finds all points near a segment", "[boxes]") {
  test::SeededRandom random(91);
  for (int round = 0; round < test::scaled(500); ++round) {
    const std::vector<Vec2> points = random_points(random, random.integer(0, 200));
    const PointTree tree(points);
    const std::vector<Vec2> ends = random_points(random, 2);
    const Vec2 &a = ends[0], &b = ends[round % 5 == 0 ? 0 : 1];
    const double distance = random.integer(0, 2) * random.uniform(0, .5);
    const auto is_near = [&](int i) {
      return nearest_on_segment(points[i] - a, b - a).distance2 <= distance * distance;
    };
    std::set<int> expected, found;
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
      if (is_near(i)) expected.insert(i);
    }
    const bool any = tree.any_near(a, b, distance, [&](int i) {
      if (is_near(i)) found.insert(i);
      return false;
    });
    REQUIRE_FALSE(any);
    REQUIRE(found == expected);
    REQUIRE(tree.any_near(a, b, distance, is_near) == !expected.empty());
  }
}

TEST_CASE("the tree of a ring finds edges near a point, and counts those that a ray crosses",
          "[boxes]") {
  test::SeededRandom random(92);
  for (int round = 0; round < test::scaled(500); ++round) {
    const std::vector<Vec2> ring = random_points(random, random.integer(0, 200));
    const RingTree tree(ring);
    for (const Vec2& p : random_points(random, 20)) {
      const double distance = random.integer(0, 2) * random.uniform(0, .5);
      std::vector<int> expected, found;
      bool odd = false;
      for (int e = 0; e < static_cast<int>(ring.size()); ++e) {
        const Vec2 a = ring[e] - p, b = after(ring, e) - p;
        if (nearest_on_segment(-a, b - a).distance2 <= distance * distance) expected.push_back(e);
        if ((a.y() > 0) != (b.y() > 0) && (cross(a, b) > 0) == (b.y() > a.y())) odd = !odd;
      }
      const Box around = box_of(p, p).grown(distance);
      tree.each([&](const Box& box) { return !apart(box, around); },
                [&](int e) {
                  const Vec2 a = ring[e] - p, b = after(ring, e) - p;
                  const double off2 = nearest_on_segment(-a, b - a).distance2;
                  if (off2 <= distance * distance) found.push_back(e);
                });
      REQUIRE(found == expected);
      REQUIRE(tree.odd_crossings(p) == odd);
    }
  }
}

TEST_CASE("lines of a ring: runs are left out, or one line stands for them", "[boxes]") {
  test::SeededRandom random(93);
  for (int round = 0; round < test::scaled(500); ++round) {
    const std::vector<Vec2> ring = random_points(random, random.integer(0, 200));
    const RingTree tree(ring);
    const double left = random.uniform(0, 5), high = random.uniform(0, 5);
    const auto beside = [&](const Vec2& p) { return p.x() < left; };
    const auto above = [&](const Vec2& p) { return p.y() > high; };
    const auto judge = [&](const Box& box) {
      return box.x1 < left ? RunUse::none : box.y0 > high ? RunUse::whole : RunUse::edges;
    };
    size_t at = 0, lines = 0;  // the edge that comes next
    tree.each_line(judge, [&](size_t from, size_t to) {
      for (; at < from; ++at) {
        REQUIRE(beside(ring[at]));
        REQUIRE(beside(after(ring, at)));
      }
      REQUIRE(at == from);
      const size_t end = to > from ? to : ring.size();
      REQUIRE((to > from || to == 0));
      for (; end > from + 1 && at < end; ++at) {
        REQUIRE(above(ring[at]));
        REQUIRE(above(after(ring, at)));
      }
      at = end;
      ++lines;
    });
    for (; at < ring.size(); ++at) REQUIRE(beside(ring[at]));
    REQUIRE(lines <= ring.size());
  }
  // A ring with nothing to look at closely is one line, or none.
  std::vector<std::pair<size_t, size_t>> found;
  const RingTree tree(random_points(random, 100));
  tree.each_line([](const Box&) { return RunUse::whole; },
                 [&](size_t i, size_t j) { found.emplace_back(i, j); });
  CHECK(found == std::vector<std::pair<size_t, size_t>>{{0, 0}});
  tree.each_line([](const Box&) { return RunUse::none; }, [&](size_t, size_t) { FAIL(); });
}

TEST_CASE("the trees of a polygon's edges leave out none that is within reach of a segment",
          "[boxes]") {
  test::SeededRandom random(94);
  int left_out = 0;
  for (int round = 0; round < test::scaled(400); ++round) {
    std::vector<Vec2> points;
    RingLinks links;
    for (int ring = 0; ring < 2; ++ring) {
      const std::vector<Vec2> more = random_points(random, random.integer(3, 120));
      points.insert(points.end(), more.begin(), more.end());
      links.add(static_cast<int>(more.size()));
    }
    const int n = static_cast<int>(points.size());
    std::vector<double> x, y;
    for (const Vec2& p : points) x.push_back(p.x()), y.push_back(p.y());
    const EdgeTrees trees(x.data(), y.data(), n, &links);
    const std::vector<Vec2> ends = random_points(random, 2);
    const Vec2 &a = ends[0], &b = ends[1];
    const double reach = random.uniform(0, 1);
    std::set<int> found;
    trees.each_near_first(
        a, b, [&] { return reach; }, [&](int e) { found.insert(e); });
    for (int e = 0; e < n; ++e) {
      const Vec2 &p = points[e], &q = points[next(&links, e, n)];
      const double of_ends = std::sqrt(std::min(nearest_on_segment(p - a, b - a).distance2,
                                                nearest_on_segment(q - a, b - a).distance2));
      if (of_ends < reach) REQUIRE(found.count(e) == 1);
    }
    left_out += n - static_cast<int>(found.size());
  }
  CHECK(left_out > test::least(100));
}

TEST_CASE("runs of edges come in the order of their boxes", "[boxes]") {
  test::SeededRandom random(95);
  int narrow = 0;
  for (int round = 0; round < test::scaled(400); ++round) {
    // Some are long and thin teeth, around which slabs are narrow.
    const std::vector<Vec2> ring = round % 20 == 0
                                       ? samples::star(random.integer(300, 600), .3).vertices()
                                       : random_points(random, random.integer(3, 200));
    RingTree tree(ring);
    tree.add_slabs();
    const Box around = box_of(ring).grown(.5);
    const Vec2 p(random.uniform(around.x0, around.x1), random.uniform(around.y0, around.y1));
    const double reach = random.uniform(0, 2);
    const SegmentDistance distance(p, p);
    const auto measure = [&](const Box& box) { return distance.least(box); };
    double last = 0;
    const auto counts = [&](const Box& box, const Slab& slab, double least) {
      CHECK(least >= last);
      last = least;
      narrow += slab.high - slab.low < .2 * box.extent();
      return distance.least(box, slab) <= reach;
    };
    std::set<int> found;
    std::vector<RingTree::Run> memory;
    tree.each_in_order(
        measure, counts, [&](int e) { found.insert(e); }, memory);
    for (int e = 0; e < tree.size(); ++e) {
      const Vec2 a = ring[e] - p, b = after(ring, e) - p;
      const double off = std::sqrt(nearest_on_segment(-a, b - a).distance2);
      if (off < reach * (1 - 1e-12)) REQUIRE(found.count(e) == 1);
    }
  }
  CHECK(narrow > test::least(100));
}

TEST_CASE("what is inside circles that touch two features is not left out", "[boxes]") {
  test::SeededRandom random(96);
  int left_out = 0;
  for (int round = 0; round < test::scaled(2000); ++round) {
    // Circles that touch the x axis at u, and the point p or the line n . x = d.
    const Vec2 p(random.uniform(-2, 2), std::exp(random.uniform(-5, 1)));
    const double angle = random.uniform(.1, 3), d = random.uniform(-2, 2);
    const Vec2 n(std::sin(angle), -std::cos(angle));  // points into the wedge
    const bool point = random.integer(0, 1) == 0;
    const auto circle = [&](double u) {
      const double r =
          point ? (Vec2(u, 0) - p).squaredNorm() / (2 * p.y()) : (n.x() * u - d) / (1 - n.y());
      const Vec2 centre(u, r);
      return TouchingCircle{centre, r, Vec2(u, 0), point ? p : Vec2(centre - r * n)};
    };
    double u0 = random.uniform(-2, 2), u1 = random.uniform(-2, 2);
    if (!point) {  // the side on which the circles are in front of both lines
      const double corner = d / n.x();
      u0 = corner + std::abs(u0), u1 = corner + std::abs(u1);
    }
    const TouchingCircles circles(circle(u0), circle(u1), 1e-12);
    for (int k = 0; k < 20; ++k) {
      const double share = random.uniform(0, 1), around = random.uniform(0, 2 * M_PI);
      const TouchingCircle one = circle(u0 + share * (u1 - u0));
      const Vec2 inside = one.centre + one.radius * random.uniform(.5, 1) *
                                           Vec2(std::cos(around), std::sin(around));
      const double size = std::exp(random.uniform(-8, 0));
      const Vec2 corner = inside - size * Vec2(random.uniform(0, 1), random.uniform(0, 1));
      const Box box{corner.x(), corner.y(), corner.x() + size, corner.y() + size};
      const double side = random.uniform(0, 2 * M_PI);
      const Vec2 normal(std::cos(side), std::sin(side));
      const double low = normal.dot(inside) - size * random.uniform(0, 1);
      REQUIRE(circles.meets(box, {}));
      REQUIRE(circles.meets(box, {normal, low, low + size}));
      // Beside all of the circles, and behind the axis.
      CHECK_FALSE(circles.meets({box.x0, -1, box.x1, -1e-9}, {}));
      left_out += !circles.meets(box, {normal, low + 1, low + 1 + size});
    }
  }
  CHECK(left_out > test::least(100));
}
