// Families of polygons that tests, benchmarks and the accuracy command share, and ways to move
// them. All lengths in m; the same arguments and seed give the same polygon everywhere.
#pragma once

#include <cstdint>
#include <random>

#include "apothem/geometry/polygon/polygon.hpp"

namespace apothem::samples {

/// Random numbers with the same sequence on every platform (the standard's distributions have
/// none).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double a, double b) {
    return a + (b - a) * std::ldexp(static_cast<double>(engine_() >> 11), -53);
  }
  int integer(int a, int b) {
    return a + static_cast<int>(engine_() % static_cast<std::uint64_t>(b - a + 1));
  }

 private:
  std::mt19937_64 engine_;
};

Polygon block(double x0, double y0, double x1, double y1);
/// Isosceles triangle with legs of length 1 and its apex, at 0, up or down.
Polygon wedge_up(double half_angle);
Polygon wedge_down(double half_angle);
/// Triangle from 0 along x.
Polygon needle(double length, double width);
/// Inscribed in the unit circle.
Polygon regular(int n);
/// Cross about 0: a unit square with four arms of width 1. Roof height 1/2 if the arms are not
/// short.
Polygon cross_of_squares(double arm = 1);
/// Two bars of width 1 from the corner at 0.
Polygon l_shape(double leg = 2);
/// Tips on the unit circle, notches at radius `inner`.
Polygon star(int tips, double inner);
/// Teeth and gaps of width 1 on a bar of thickness 1 from 0 along x; each tooth is longer than its
/// left neighbour by `growth`.
Polygon comb(int teeth, double length = 2, double growth = 0);
/// Archimedean band about 0 with pitch 1, wider by `widening` after every turn.
Polygon spiral(double turns, int edges_per_turn, double width = .4, double widening = 0);

/// Quadrilateral in the unit circle, its corners up to .4 rad off a square's.
Polygon random_quad(Random& random);
/// n points on a stretched and turned unit circle; area above .05.
Polygon random_convex(Random& random, int n);
/// Star-shaped about 0: radii from `inner` to 1 at random angles.
Polygon random_star_shaped(Random& random, int n, double inner);
/// A loop through n random points of the unit square, uncrossed.
Polygon random_simple(Random& random, int n);

/// The polygon with every vertex v at map(v). Throws InvalidPolygon if it is not simple any more.
template <class Map>
Polygon mapped(const Polygon& polygon, const Map& map) {
  std::vector<Vec2> ring = polygon.vertices();
  for (Vec2& v : ring) v = map(v);
  return Polygon(ring);
}
Polygon shifted(const Polygon& polygon, const Vec2& by);
/// About 0, by an angle in rad.
Vec2 turned(const Vec2& v, double angle);
Polygon turned(const Polygon& polygon, double angle);
/// About 0.
Polygon scaled(const Polygon& polygon, double factor);
/// Turned about its centroid, with the centroid at `centre`.
Polygon posed(const Polygon& polygon, const Vec2& centre, double angle);
/// Centroid in world coordinates.
Vec2 world_centroid(const Polygon& polygon);

}  // namespace apothem::samples
