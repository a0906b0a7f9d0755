// Private header: families of polygons for tests, benchmarks and the accuracy command, and
// functions that move them. All lengths are in m. The same arguments and seed give the same polygon
// on every platform.
#pragma once

#include <cstdint>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/random_numbers.hpp"

namespace apothem::samples {

/// Random numbers for samples.
class Random : public RandomNumbers {
 public:
  using RandomNumbers::RandomNumbers;
  /// Uniform in {a, ..., b}.
  int integer(int a, int b) {
    return a + static_cast<int>(generator_() % static_cast<std::uint64_t>(b - a + 1));
  }
};

/// Rectangle with edges parallel to the axes.
Polygon block(double x0, double y0, double x1, double y1);
/// Isosceles triangle with legs of length 1 and its apex at the origin, which points up or down.
/// `half_angle` is half the angle at the apex, rad.
Polygon wedge_up(double half_angle);
Polygon wedge_down(double half_angle);
/// Slender triangle that starts at the origin and extends along x.
Polygon needle(double length, double width);
/// Regular polygon with n vertices on the unit circle.
Polygon regular(int n);
/// Cross about the origin: a unit square with four arms of width 1 and length `arm`. The roof
/// height is 1/2 if the arms are not short.
Polygon cross_of_squares(double arm = 1);
/// Two bars of width 1 and length `leg` that meet at the corner at the origin.
Polygon l_shape(double leg = 2);
/// Star with `tips` vertices on the unit circle and as many at the radius `inner` between them.
Polygon star(int tips, double inner);
/// Teeth of width 1 with gaps of width 1 on a bar of thickness 1 that extends from the origin along
/// x. The first tooth is `length` long, and each further one is longer than its left neighbour by
/// `growth`.
Polygon comb(int teeth, double length = 2, double growth = 0);
/// Teeth with sloping sides around a circle, whose tips have the radius 1. There are 4 vertices for
/// each.
Polygon gear(int teeth);
/// Band along a diagonal whose two borders are steps of width and height 1.
Polygon staircase(int steps);
/// Band along an Archimedean spiral about the origin, with pitch 1. Its width grows by `widening`
/// with each turn.
Polygon spiral(double turns, int edges_per_turn, double width = .4, double widening = 0);

/// Quadrilateral with vertices on the unit circle, up to 0.4 rad away from those of a square.
Polygon random_quad(Random& random);
/// Polygon of n points on the unit circle, stretched and turned. The area is above 0.05 m^2.
Polygon random_convex(Random& random, int n);
/// Star-shaped about the origin: n radii from `inner` to 1 at random angles.
Polygon random_star_shaped(Random& random, int n, double inner);

/// A hexagon whose edges are divided and bent at their middles again and again, like a coastline,
/// until there are n vertices.
Polygon coastline(Random& random, int n);
/// Columns of width 1 and random whole heights above and below a line: n / 4 of them.
Polygon skyline(Random& random, int n);

/// The polygon with each vertex v moved to map(v). Throws InvalidPolygon if the result is not
/// simple.
template <class Map>
Polygon mapped(const Polygon& polygon, const Map& map) {
  Rings rings = rings_of(polygon);
  for (std::vector<Vec2>& ring : rings) {
    for (Vec2& v : ring) v = map(v);
  }
  return Polygon(polygon_of_rings(rings));
}
/// Moved by a vector.
Polygon shifted(const Polygon& polygon, const Vec2& by);
/// Turned about the origin by an angle in rad.
Vec2 turned(const Vec2& v, double angle);
/// Turned about the origin by an angle in rad.
Polygon turned(const Polygon& polygon, double angle);
/// Scaled about the origin.
Polygon scaled(const Polygon& polygon, double factor);
/// Turned about its centroid by an angle in rad, with the centroid moved to `centre`.
Polygon posed(const Polygon& polygon, const Vec2& centre, double angle);
/// Centroid in the coordinates of the input (not relative to the polygon's origin).
Vec2 world_centroid(const Polygon& polygon);

}  // namespace apothem::samples
