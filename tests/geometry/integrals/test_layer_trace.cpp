// phi along edges in the boundary layer of a polygon, against its whole roof or distance field.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "apps/cases/samples.hpp"
#include "geometry/integrals/contact_patches.hpp"
#include "tests/geometry/nonconvex_pairs.hpp"
#include "tests/support.hpp"

namespace apothem {
namespace {

using edge_detail::PlacedEdge;
using Field = PotentialChoice::Field;

constexpr std::uint64_t kAll = NearEdges::kAll;

Potential about_centre(const Polygon& polygon, Field field) {
  return translated(make_potential(polygon, {.field = field}), area_moments(polygon).centroid);
}

struct Total {
  double sum = 0, first = 0, length = 0, largest = 0;
};

Total total(const PlacedEdge& edge, double s0, double s1, const SegmentMoments<double>& moments) {
  return {moments.sum, moments.first, (s1 - s0) * std::hypot(edge.ex, edge.ey), moments.largest};
}

// The largest difference of an edge's integrals by the boundary layer from those by the whole
// potential; `shallow` counts the edges with segments in the layer. Where edges lie on each other,
// their lengths may count or not.
double difference(const PlacedPotential& x, const PlacedPotential& y, const Vec2& offset,
                  EdgeWorkspace& workspace, int& shallow, bool with_lengths) {
  LayerTrace& trace = workspace.layer_trace;
  trace.find(x, y, offset.x(), offset.y(), kAll, kAll);
  if (y.roof) workspace.nodes.place(y);
  double worst = 0;
  size_t r = 0, listed = 0;
  for (int e = 0; e < x.size; ++e) {
    const PlacedEdge edge(x, y, e, offset.x(), offset.y());
    Total here, all;
    const auto add = [&](Total& to, double s0, double s1, const SegmentMoments<double>& moments) {
      const Total part = total(edge, s0, s1, moments);
      to.sum += part.sum, to.first += part.first, to.length += part.length;
      to.largest = std::max(to.largest, part.largest);
    };
    edge_detail::walk_whole_potential(
        y, edge, workspace,
        [&](double s0, int, double s1, int, const SegmentMoments<double>& moments) {
          add(all, s0, s1, moments);
        });
    bool deep = false;
    if (listed < trace.edges().size() && trace.edges()[listed].index == e) {
      const LayerEdge& found = trace.edges()[listed++];
      deep = found.beyond_layer;
      if (!deep) shallow += found.segments_end > r;
      for (; r < found.segments_end; ++r) {
        const LayerSegment& segment = trace.segments()[r];
        add(here, segment.s0, segment.s1, segment.moments);
      }
    }
    if (deep) continue;
    const double length = with_lengths ? std::abs(here.length - all.length) : 0;
    worst = std::max({worst, std::abs(here.sum - all.sum), std::abs(here.first - all.first), length,
                      std::abs(here.largest - all.largest)});
  }
  return worst;
}

TEST_CASE("phi in the boundary layer is that of the whole potential", "[layer]") {
  test::SeededRandom random(17);
  EdgeWorkspace workspace;
  int shallow = 0;
  const int pairs = test::scaled(test::long_run() ? 4000 : 1000);
  for (int i = 0; i < pairs; ++i) {
    const Polygon a = test::any_shape(random), b = test::any_shape(random);
    const Field field = Field(random.integer(0, 1));
    const Potential potential_a = about_centre(a, field), potential_b = about_centre(b, field);
    PlacedShapes placed;
    placed.add(potential_a);
    placed.add(potential_b);
    placed.place(0, 0, 0, random.uniform(0, 6));
    placed.place(1, 0, 0, random.uniform(0, 6));
    const double direction = random.uniform(0, 6);
    const double apart = random.uniform(.3, 1) * (placed.radius(0) + placed.radius(1));
    const Vec2 offset = apart * Vec2(std::cos(direction), std::sin(direction));
    const PlacedPotential x = placed.view(0), y = placed.view(1);
    if (!y.convex()) REQUIRE(difference(x, y, offset, workspace, shallow, true) < 1e-12);
    if (!x.convex()) REQUIRE(difference(y, x, -offset, workspace, shallow, true) < 1e-12);
  }
  CHECK(shallow > test::least(pairs / 2));
}

// Edges on edges, vertices on edges and on vertices.
TEST_CASE("phi in the boundary layer where polygons lie on each other", "[layer]") {
  EdgeWorkspace workspace;
  int shallow = 0;
  const Polygon cross = samples::cross_of_squares(), l = samples::l_shape();
  for (const Field field : {Field::roof, Field::distance}) {
    const Potential of_cross = make_potential(cross, {.field = field});
    const Potential of_l = make_potential(l, {.field = field});
    PlacedShapes placed;
    placed.place(placed.add(of_cross), 0, 0, 0);
    placed.place(placed.add(of_l), 0, 0, 0);
    const PlacedPotential x = placed.view(0), y = placed.view(1);
    for (int i = -16; i <= 16; ++i) {
      for (int j = -16; j <= 16; ++j) {
        const Vec2 offset(.25 * i, .25 * j);
        REQUIRE(difference(x, y, offset, workspace, shallow, false) < 1e-14);
        REQUIRE(difference(y, x, -offset, workspace, shallow, false) < 1e-14);
      }
    }
  }
  CHECK(shallow > 1000);
}

TEST_CASE("cells of a cross", "[layer]") {
  const Polygon cross = samples::cross_of_squares();
  for (const Field field : {Field::roof, Field::distance}) {
    const BoundaryLayer cells = *make_potential(cross, {.field = field}).layer;
    int reflex = 0;
    for (int i = 0; i < cross.size(); ++i) {
      reflex += cells.reflex(i);
      // Half the breadth of an arm is the height of the roof; the reference length is the same.
      CHECK(cells.depth[i] == Approx(.99).epsilon(1e-9));
    }
    CHECK(reflex == 4);
    CHECK(cells.side[cross.size()] == cells.side[0]);
  }
}

TEST_CASE("cells at vertices that are almost straight are not used", "[layer]") {
  std::vector<Vec2> ring = samples::l_shape().vertices();
  const Vec2 middle = (ring[0] + ring[1]) / 2;
  ring.insert(ring.begin() + 1, middle);
  const Polygon polygon(ring);
  const Potential potential = make_potential(polygon, {.field = Field::distance});
  CHECK(potential.layer->depth[0] == 0);
  CHECK(potential.layer->depth[1] == 0);
  CHECK(potential.layer->depth[3] > 0);
  // Contact there is found all the same.
  PlacedShapes placed;
  placed.place(placed.add(potential), 0, 0, 0);
  const Potential of_cross =
      make_potential(samples::cross_of_squares(), {.field = Field::distance});
  placed.place(placed.add(of_cross), 0, 0, 0);
  EdgeWorkspace workspace;
  int shallow = 0;
  for (int i = -16; i <= 16; ++i) {
    const Vec2 offset(.25 * i, -.125 * i);
    REQUIRE(difference(placed.view(1), placed.view(0), offset, workspace, shallow, false) < 1e-14);
  }
}

// With other numbers of its vertices a cell is another lane of another pack.
TEST_CASE("the bits of a cell do not depend on its lane", "[layer]") {
  const std::vector<Vec2> ring = samples::cross_of_squares().vertices();
  test::SeededRandom random(18);
  const Potential other = make_potential(samples::cross_of_squares());
  for (const Field field : {Field::roof, Field::distance}) {
    for (int k = 0; k < test::scaled(test::long_run() ? 100 : 40); ++k) {
      const double turn_x = random.uniform(0, 6), turn_y = random.uniform(0, 6);
      const double direction = random.uniform(0, 6);
      const Vec2 between = random.uniform(2, 2.6) * Vec2(std::cos(direction), std::sin(direction));
      std::vector<LayerSegment> first;
      for (int shift = 0; shift < 12; ++shift) {
        std::vector<Vec2> turned = ring;
        std::rotate(turned.begin(), turned.begin() + shift, turned.end());
        const Polygon polygon(turned);
        // All coordinates are small whole numbers, so that this is exact.
        const Potential potential =
            translated(make_potential(polygon, {.field = field}), Vec2(1, 1) - polygon.origin());
        PlacedShapes placed;
        placed.place(placed.add(other), 0, 0, turn_x);
        placed.place(placed.add(potential), 0, 0, turn_y);
        LayerTrace trace;
        trace.find(placed.view(0), placed.view(1), between.x(), between.y(), kAll, kAll);
        if (shift == 0) first = trace.segments();
        REQUIRE(trace.segments().size() == first.size());
        for (size_t r = 0; r < first.size(); ++r) {
          const LayerSegment &p = first[r], &q = trace.segments()[r];
          REQUIRE((p.s0 == q.s0 && p.s1 == q.s1 && p.moments.sum == q.moments.sum &&
                   p.moments.first == q.moments.first && p.moments.largest == q.moments.largest));
        }
      }
    }
  }
}

}  // namespace
}  // namespace apothem
