#include <catch2/catch.hpp>

#include "geometry/polygon/predicates.hpp"
#include "tests/support.hpp"

using namespace apothem;
using Ring = std::vector<Vec2>;

namespace {

int bad_vertex(const Ring& ring) {
  try {
    const Polygon polygon(ring);
  } catch (const InvalidPolygon& error) {
    INFO(error.what());
    return error.vertex();
  }
  return -1;
}

}  // namespace

TEST_CASE("a simple polygon is accepted and made counter-clockwise", "[polygon]") {
  const Polygon ccw({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  const Polygon cw({{0, 0}, {0, 1}, {2, 1}, {2, 0}});
  CHECK(ccw.vertices() == cw.vertices());
  CHECK(cw.input_index(0) == 0);
  CHECK(cw.input_index(1) == 3);
  CHECK(ccw.input_index(1) == 1);
  CHECK(Polygon({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {0, 1}}).size() == 5);  // straight vertex
}

TEST_CASE("a bad ring is refused and the vertex is named", "[polygon]") {
  const double nan = std::nan("");
  CHECK(bad_vertex({}) == 0);
  CHECK(bad_vertex({{0, 0}, {1, 0}}) == 1);
  CHECK(bad_vertex({{0, 0}, {1, nan}, {0, 1}}) == 1);
  CHECK(bad_vertex({{0, 0}, {1, 0}, {HUGE_VAL, 1}}) == 2);
  CHECK(bad_vertex({{0, 0}, {2, 0}, {1, 0}, {1, 1}}) == 1);          // spike
  CHECK(bad_vertex({{0, 0}, {1, 0}, {2, 0}}) >= 0);                  // no area
  CHECK(bad_vertex({{0, 0}, {1, 1}, {1, 0}, {0, 1}}) == 2);          // bow tie: edges 0 and 2
  CHECK(bad_vertex({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}) == 3);  // vertex 3 on edge 0
  CHECK(bad_vertex({{0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}) == 4);  // pinch
  CHECK(bad_vertex({{5, 5}, {5, 5}, {5, 5}}) >= 0);
}

TEST_CASE("equal neighbours are merged, and errors name vertices as they were given", "[polygon]") {
  const Polygon closed({{0, 0}, {1, 0}, {1, 0}, {1, 0}, {0, 1}, {0, 0}, {0, 0}});
  CHECK(closed.vertices() == std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}});
  CHECK(closed.input_index(2) == 4);
  CHECK(closed.input_edge(0) == 0);
  CHECK(closed.input_edge(1) == 3);  // edges 1 and 2 have no length
  CHECK(closed.input_edge(2) == 4);
  const Polygon clockwise({{0, 0}, {0, 0}, {0, 1}, {1, 0}, {1, 0}});
  CHECK(clockwise.vertices() == closed.vertices());
  CHECK(clockwise.input_index(1) == 3);
  CHECK(clockwise.input_edge(0) == 4);
  CHECK(clockwise.input_edge(1) == 2);
  CHECK(clockwise.input_edge(2) == 1);
  CHECK(bad_vertex({{0, 0}, {0, 0}, {1, 0}, {1, 0}}) == 2);                          // two vertices
  CHECK(bad_vertex({{0, 0}, {0, 0}, {2, 0}, {1, 0}, {1, 1}}) == 2);                  // spike
  CHECK(bad_vertex({{0, 0}, {0, 0}, {1, 1}, {1, 0}, {0, 1}}) == 3);                  // bow tie
  CHECK(bad_vertex({{0, 0}, {0, 0}, {2, 2}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}) == 5);  // pinch
}

TEST_CASE("simplicity is decided exactly", "[polygon]") {
  // A vertex one ulp to either side of an edge of the ring.
  const double on = 0.1;
  const double below = std::nextafter(on, 0.0);
  const double above = std::nextafter(on, 1.0);
  CHECK(bad_vertex({{0, on}, {4, on}, {4, 4}, {2, above}, {0, 4}}) == -1);
  CHECK(bad_vertex({{0, on}, {4, on}, {4, 4}, {2, on}, {0, 4}}) >= 0);
  CHECK(bad_vertex({{0, on}, {4, on}, {4, 4}, {2, below}, {0, 4}}) >= 0);
}

TEST_CASE("orientation obeys its laws on nearly collinear points", "[predicates]") {
  test::SeededRandom random(1);
  int zero = 0;
  for (int i = 0; i < test::scaled(20000); ++i) {
    const Vec2 a(random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec2 b(random.uniform(-1, 1), random.uniform(-1, 1));
    Vec2 c = a + random.integer(-3, 3) * (b - a);
    if (random.integer(0, 1)) c.x() = std::nextafter(c.x(), 10.0);
    const int o = orientation(a, b, c);
    zero += o == 0;
    REQUIRE(o == orientation(b, c, a));
    REQUIRE(o == -orientation(b, a, c));
    REQUIRE(segments_meet(a, b, b, c));
  }
  CHECK(zero > 0);
  const double tiny = 0x1p-52;
  CHECK(orientation({0, 0}, {1, 1}, {2, 2 + 2 * tiny}) == 1);
  CHECK(orientation({12, 12}, {24, 24}, {0.5 + tiny, 0.5}) == -1);
  CHECK_FALSE(segments_meet({0, 0}, {1, 1}, {2, 2}, {3, 3}));
  CHECK(segments_meet({0, 0}, {2, 2}, {1, 1}, {3, 3}));
}

TEST_CASE("area, centroid and second moment", "[polygon]") {
  const AreaMoments q = area_moments(test::quad_q());
  CHECK(q.area == Approx(.85).epsilon(1e-14));
  CHECK(q.centroid.x() == Approx(.568627450980392).epsilon(1e-14));
  CHECK(q.centroid.y() == Approx(.448235294117647).epsilon(1e-14));
  CHECK(q.polar == Approx(.125169084967320).epsilon(1e-13));
  const AreaMoments t = area_moments(test::triangle_t());
  CHECK(t.area == Approx(.45).epsilon(1e-14));
  CHECK(t.polar == Approx(.04).epsilon(1e-14));
  // Non-convex, and far from the origin: an L of three unit squares.
  const Polygon l({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  for (const double offset : {0.0, 1e6, 1e9}) {
    const AreaMoments m = area_moments(samples::shifted(l, {offset, -offset}));
    CHECK(m.area == 3);
    CHECK(m.centroid.x() == Approx(5.0 / 6).epsilon(1e-15));
    CHECK(m.polar == Approx(3.0 / 6 + 4.0 / 3).epsilon(1e-14));  // 3 squares + parallel axes
  }
}
