#include "lib/output/potential_map.hpp"

#include <catch2/catch.hpp>

#include "lib/output/potential_figure.hpp"

using namespace apothem;

namespace {

const std::vector<Vec2> kTriangle{{0, 0}, {1, 0}, {.3, .9}};
const std::vector<Vec2> kQuad{{3, 7}, {4.2, 7.1}, {4, 7.8}, {3.2, 8}};  // away from zero
const std::vector<Vec2> kCross{{1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {2, 2},
                               {2, 3}, {1, 3}, {1, 2}, {0, 2}, {0, 1}, {1, 1}};

double area(const std::vector<Vec2>& ring) {
  double twice = 0;
  for (size_t i = 0; i < ring.size(); ++i) twice += cross(ring[i], ring[(i + 1) % ring.size()]);
  return twice / 2;
}

double distance_to_edge(const std::vector<Vec2>& ring, size_t edge, const Vec2& x) {
  const Vec2 d = ring[(edge + 1) % ring.size()] - ring[edge];
  return cross(d, x - ring[edge]) / d.norm();
}

PotentialChoice length(double r) {
  PotentialChoice choice;
  choice.reference = PotentialChoice::Reference::length;
  choice.length = r;
  return choice;
}

}  // namespace

TEST_CASE("the parts of a potential tile the polygon", "[potential_map]") {
  const auto check = [](const std::vector<Vec2>& ring, MapKind kind, size_t parts) {
    const PotentialMap map = potential_map(Polygon(ring), kind);
    CHECK(map.pieces.size() == parts);
    double sum = 0;
    for (const PotentialPiece& piece : map.pieces) sum += area(piece.ring);
    CHECK(sum == Approx(area(ring)).epsilon(1e-13));
    for (const PotentialPiece& piece : map.pieces) {
      for (const Vec2& p : piece.ring) CHECK(piece.phi(p) > -1e-12);
    }
  };
  check(kTriangle, MapKind::distance, 3);
  check(kTriangle, MapKind::area, 3);
  check(kQuad, MapKind::distance, 4);
  check(kQuad, MapKind::area_smallest, 4);
  check(kQuad, MapKind::area_sectors, 4);
  check(kQuad, MapKind::area_halves, 6);
  check(kCross, MapKind::distance, 12);
}

TEST_CASE("values of the potentials", "[potential_map]") {
  const double r = .291369751958836;
  const PotentialMap distance = potential_map(Polygon(kTriangle), MapKind::distance);
  const PotentialMap by_area = potential_map(Polygon(kTriangle), MapKind::area);
  CHECK(distance.reference == Approx(r).epsilon(1e-14));
  for (const Vec2& x : {Vec2(.4, .1), Vec2(.2, .3), Vec2(.7, .2), Vec2(.45, .6)}) {
    double depth = 1e9, share = 1e9;
    for (size_t e = 0; e < 3; ++e) {
      const double h = distance_to_edge(kTriangle, e, x);
      const double side = (kTriangle[(e + 1) % 3] - kTriangle[e]).norm();
      depth = std::min(depth, h / r);
      share = std::min(share, 3 * .5 * side * h / .45);
    }
    CHECK(phi_at(distance, x) == Approx(depth).epsilon(1e-13));
    CHECK(phi_at(by_area, x) == Approx(share).epsilon(1e-13));
  }
  CHECK(largest_phi(distance) == Approx(1).epsilon(1e-13));
  CHECK(largest_jump(distance) < 1e-13);

  // The sectors of a quadrilateral meet with different values at the centroid.
  const PotentialMap sectors = potential_map(Polygon(kQuad), MapKind::area_sectors);
  CHECK(largest_jump(sectors) == Approx(1 - .8651441753171858).epsilon(1e-12));
  CHECK(largest_jump(potential_map(Polygon(kQuad), MapKind::area_smallest)) < 1e-12);

  const PotentialMap cross = potential_map(Polygon(kCross), MapKind::distance);
  CHECK(cross.reference == Approx(.5).epsilon(1e-14));
  CHECK(phi_at(cross, {1.5, .25}) == Approx(.5).epsilon(1e-13));
  CHECK(phi_at(cross, {1.25, 1.5}) == Approx(1).epsilon(1e-13));
}

TEST_CASE("a plateau is the singular area", "[potential_map]") {
  const PotentialMap map =
      potential_map(Polygon(std::vector<Vec2>{{0, 0}, {1.6, 0}, {1.6, 1}, {0, 1}}),
                    MapKind::distance, length(.25));
  REQUIRE(map.singular);
  CHECK(map.singular->area() == Approx(1.1 * .5).epsilon(1e-14));
  CHECK(phi_at(map, {.8, .4}) == 1);
  CHECK(phi_at(map, {.8, .1}) == Approx(.4).epsilon(1e-14));
  CHECK(map.singular->polygons.at(0).outer.at(0).x() > 0);  // in the polygon's own coordinates
}

TEST_CASE("potentials of shapes that they are not made for are refused", "[potential_map]") {
  CHECK_THROWS_AS(potential_map(Polygon(kQuad), MapKind::area), InvalidPolygon);
  CHECK_THROWS_AS(potential_map(Polygon(kTriangle), MapKind::area_halves), InvalidPolygon);
  CHECK_THROWS_AS(potential_map(Polygon(kCross), MapKind::area_sectors), InvalidPolygon);
}

TEST_CASE("potentials side by side become a picture", "[potential_map]") {
  PotentialFigure figure{"two", {{"panel", {}}}};
  figure.panels[0].maps.push_back(
      {"distance", potential_map(Polygon(kQuad), MapKind::distance), {{"p", {3.5, 7.5}}}});
  figure.panels[0].maps.push_back({"cross", potential_map(Polygon(kCross), MapKind::distance), {}});
  CHECK(draw_potentials(figure, PictureFormat::png).starts_with("\x89PNG"));
  const std::string svg = draw_potentials(figure, PictureFormat::svg);
  CHECK(svg.find("<svg") != std::string::npos);
  CHECK(svg.size() < 400000);
}
