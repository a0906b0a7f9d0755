// The penetration of two polygons: how deep the boundary of one lies in the other.
#include "geometry/integrals/penetration.hpp"

#include <catch2/catch.hpp>

#include "geometry/exact/overlap.hpp"
#include "tests/geometry/nonconvex_pairs.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

const Polygon kU({{-1, -1}, {2, -1}, {2, 2}, {1, 2}, {1, 0}, {0, 0}, {0, 2}, {-1, 2}});

// Of every patch, in the order of contact_patches.
std::vector<double> of_patches(const Polygon& a, const Polygon& b) {
  const Potential potential_a = make_potential(a), potential_b = make_potential(b);
  PlacedShapes shapes;
  shapes.add(potential_a), shapes.add(potential_b);
  shapes.place(0, 0, 0, 0), shapes.place(1, 0, 0, 0);
  PatchWorkspace patch_workspace;
  PenetrationWorkspace workspace;
  std::vector<BoundarySegment> segments;
  std::vector<PairIntegral> patches;
  const Vec2 offset = a.origin() - b.origin();
  contact_patches(shapes.view(0), shapes.view(1), offset, patch_workspace, segments, patches);
  std::vector<double> deepest(patches.size());
  find_penetrations(shapes.view(0), shapes.view(1), offset, segments, workspace, deepest);
  return deepest;
}

double distance_from(const Polygon& polygon, const Vec2& p) {
  double nearest = HUGE_VAL;
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 edge = polygon.after(i) - polygon[i];
    const double along = std::clamp((p - polygon[i]).dot(edge) / edge.squaredNorm(), 0., 1.);
    nearest = std::min(nearest, (polygon[i] + along * edge - p).norm());
  }
  return nearest;
}

// By the exact overlap polygons and many points on their edges: too small by half a step at most.
struct Sampled {
  double largest = 0, step = 0;
};
Sampled sampled(const Polygon& a, const Polygon& b) {
  constexpr int kPoints = 200;
  Sampled result;
  for (const OverlapPolygon& overlap : overlap_polygons(a, b, Vec2::Zero())) {
    const size_t n = overlap.vertices.size();
    for (size_t i = 0; i < n; ++i) {
      const Vec2 from = overlap.vertices[i];
      const Vec2 along = overlap.vertices[i + 1 == n ? 0 : i + 1] - from;
      const Polygon& other = overlap.edges[i].edge_of_a >= 0 ? b : a;
      result.step = std::max(result.step, along.norm() / kPoints);
      for (int k = 0; k <= kPoints; ++k) {
        result.largest = std::max(result.largest, distance_from(other, from + k * along / kPoints));
      }
    }
  }
  return result;
}

}  // namespace

TEST_CASE("a penetration is how far a tip is in and how far faces have passed each other",
          "[penetration]") {
  for (const double d : {.1, 1e-3, 1e-6}) {
    CAPTURE(d);
    const Polygon floor = samples::block(-3, -2, 3, 0);
    CHECK(penetration(samples::block(-.5, -d, .5, 1), floor) == Approx(d).epsilon(1e-9));
    for (const double angle : {.2, M_PI / 4, 1.2}) {
      const Polygon tip = samples::shifted(samples::wedge_down(angle), {0, -d});
      CHECK(penetration(tip, floor) == Approx(d).epsilon(1e-9));
      CHECK(penetration(floor, tip) == Approx(d).epsilon(1e-9));
      // Apex on apex they separate by a shift at right angles to a face.
      CHECK(penetration(tip, samples::wedge_up(angle)) ==
            Approx(d * std::sin(angle)).epsilon(1e-9));
    }
  }
  CHECK(penetration(samples::block(0, 0, 1, 1), samples::block(2, 0, 3, 1)) == 0);
}

TEST_CASE("a block squeezed in a U is as deep as its two small overlaps", "[penetration]") {
  const double d = 1e-4;
  const Polygon block = samples::block(-d, .5, 1 + d, 1.5);
  CHECK(penetration(block, kU) == Approx(d).epsilon(1e-10));
  const std::vector<double> patches = of_patches(block, kU);
  REQUIRE(patches.size() == 2);
  for (const double deep : patches) CHECK(deep == Approx(d).epsilon(1e-10));
}

TEST_CASE("every patch has its own penetration", "[penetration]") {
  // A table with one leg longer than the other.
  const Polygon table(
      {{-1.5, -.03}, {-.5, -.03}, {-.5, 1}, {.5, 1}, {.5, -.01}, {1.5, -.01}, {1.5, 2}, {-1.5, 2}});
  std::vector<double> patches = of_patches(samples::block(-4, -2, 4, 0), table);
  std::sort(patches.begin(), patches.end());
  REQUIRE(patches.size() == 2);
  CHECK(patches[0] == Approx(.01).epsilon(1e-10));
  CHECK(patches[1] == Approx(.03).epsilon(1e-10));
}

TEST_CASE("in a narrow notch the distance counts, not the height of the roof", "[penetration]") {
  // A V with a half-angle of 0.1 in the top of a block; a thinner wedge reaches .02 below its tip.
  const double tangent = std::tan(.1);
  const Polygon notched({{-2, -2}, {2, -2}, {2, 1}, {tangent, 1}, {0, 0}, {-tangent, 1}, {-2, 1}});
  const Polygon wedge({{0, -.02}, {.05, 1}, {-.05, 1}});
  CHECK(penetration(wedge, notched) == Approx(.02).epsilon(1e-10));
  CHECK(edge(wedge, notched).integral.depth < .003);
}

TEST_CASE("penetrations agree with many points on the exact overlap", "[penetration]") {
  test::SeededRandom random(1203);
  int touching = 0;
  for (int i = 0; i < scaled(300); ++i) {
    const Polygon a = random.integer(0, 1) ? random_polygon(random, random.integer(4, 12))
                                           : samples::random_convex(random, random.integer(3, 9));
    const Polygon b = samples::shifted(random_polygon(random, random.integer(4, 12)),
                                       {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)});
    const double found = penetration(a, b);
    const Sampled many = sampled(a, b);
    touching += found > 0;
    CHECK(found >= many.largest - 1e-12);
    CHECK(found <= many.largest + many.step);
    CHECK(penetration(b, a) == Approx(found).epsilon(1e-11));
    // It does not depend on where the polygons are.
    const Vec2 far(1 << 20, -(1 << 20));
    CHECK(penetration(samples::shifted(a, far), samples::shifted(b, far)) ==
          Approx(found).margin(1e-9));
  }
  CHECK(touching > least(scaled(300) / 3));
}

TEST_CASE("what the potential measures bounds the penetration from both sides", "[penetration]") {
  test::SeededRandom random(1204);
  using Field = PotentialChoice::Field;
  double closest = 0;  // to the upper bound, where that is above the lower one
  for (int i = 0; i < scaled(200); ++i) {
    const bool area = i % 4 == 3;
    const int corners = area ? 3 : random.integer(4, 12);
    const PotentialChoice choice =
        area ? area_choice() : PotentialChoice{.field = i % 4 == 2 ? Field::distance : Field::roof};
    const auto any = [&] {
      return area ? samples::random_convex(random, 3) : random_polygon(random, corners);
    };
    const Polygon a = any();
    const Polygon b =
        samples::shifted(any(), {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)});
    const PairIntegral pair = edge(a, b, choice).integral;
    const double found = penetration(a, b), depth = pair.depth;
    const double ratio =
        std::max(depth_ratio(make_potential(a, choice)), depth_ratio(make_potential(b, choice)));
    CHECK(depth <= found * (1 + 1e-9));
    if (pair.largest_phi < 1) CHECK(found <= depth * ratio * (1 + 1e-9));  // 1 is phi's limit
    if (choice.field == Field::distance) CHECK(ratio == 1);
    if (pair.largest_phi < 1 && depth > 0 && ratio > 1)
      closest = std::max(closest, found / (depth * ratio));
  }
  if (!test::kSanitized) CHECK(closest > .7);
  CHECK(depth_ratio(make_potential(quad_q())) == 1);
  // Faces at a right reflex angle end at its bisector.
  CHECK(depth_ratio(make_potential(Polygon(l_ring()))) == Approx(std::sqrt(2)));
}

TEST_CASE("the largest distance along a segment is found wherever it is", "[penetration]") {
  test::SeededRandom random(1205);
  for (int i = 0; i < scaled(200); ++i) {
    BoundaryDistance boundary;
    for (int k = random.integer(1, 12); k > 0; --k) {
      boundary.add({random.uniform(-1, 1), random.uniform(-1, 1)},
                   {random.uniform(-1, 1), random.uniform(-1, 1)});
    }
    const Vec2 p(random.uniform(-1, 1), random.uniform(-1, 1));
    const Vec2 q(random.uniform(-1, 1), random.uniform(-1, 1));
    const double found = boundary.largest(p, q);
    double most = 0;
    constexpr int kPoints = 1000;
    for (int k = 0; k <= kPoints; ++k) {
      most = std::max(most, boundary.at(p + k * (q - p) / kPoints));
    }
    CHECK(found >= most - 0x1p-51);  // the points are rounded, with coordinates of up to 1
    CHECK(found <= most + (q - p).norm() / kPoints);
    CHECK(boundary.largest(p, q, 2 * found) == 2 * found);
    CHECK(boundary.largest(p, q, .99 * found) == Approx(found).epsilon(1e-11));
  }
  BoundaryDistance none;
  CHECK(none.largest({0, 0}, {1, 0}, .5) == .5);
}
