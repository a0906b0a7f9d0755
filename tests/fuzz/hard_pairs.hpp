// Random and adversarial polygons and pairs: coincidences of every kind, and as near to them as the
// numbers go.
#pragma once

#include "tests/shapes.hpp"
#include "tests/support.hpp"

namespace apothem::test {

// Coordinates on this grid and below 8 in size: all moves along the grid are exact, so a shape's
// potential is computed once and serves it wherever it goes.
inline constexpr double kGrid = 0x1p-45;

inline double on_grid(double x, double grid) { return grid * std::round(x / grid); }

using samples::Random;

inline Ring turned(const Polygon& polygon, double angle) {
  return samples::turned(polygon, angle).vertices();
}

// Few distinct coordinates: every coincidence there is.
inline Ring lattice(Random& random) {
  Ring ring;
  const int n = random.integer(3, 9);
  for (int i = 0; i < n; ++i)
    ring.emplace_back(random.integer(0, 4) / 4., random.integer(0, 4) / 4.);
  return ring;
}

inline Ring any_ring(Random& random) {
  const double turn = random.integer(0, 1) ? random.uniform(0, 6) : 0;
  switch (random.integer(0, 9)) {
    case 0:
    case 1:
      return lattice(random);
    case 2:
      return turned(samples::scaled(samples::cross_of_squares(.5 * random.integer(1, 4)), .5),
                    turn);
    case 3:
      return turned(samples::scaled(samples::comb(random.integer(2, 3)), .25), turn);
    case 4:  // needle
      return turned(
          Polygon({{0, 0}, {1, 0}, {random.uniform(0, 1), std::pow(10, -random.uniform(1, 5))}}),
          turn);
    case 5:
      return turned(samples::block(0, 0, 1, .5), turn);
    case 6:  // nearly parallel to what is not turned
      return turned(samples::block(0, 0, 1, 1), std::pow(10, -random.uniform(2, 12)));
    case 7:
      return samples::random_star_shaped(random, random.integer(5, 14), .3).vertices();
    case 8:
      return samples::random_star_shaped(random, random.integer(3, 64), .99).vertices();
    default:
      return samples::random_convex(random, random.integer(3, 8)).vertices();
  }
}

struct HardShape {
  Polygon polygon;
  Potential potential;
};

inline std::vector<HardShape> shapes(int count) {
  Random random(60);
  std::vector<HardShape> result;
  while (static_cast<int>(result.size()) < count) {
    Ring ring = any_ring(random);
    for (Vec2& v : ring) v = Vec2(on_grid(v.x(), kGrid), on_grid(v.y(), kGrid));
    try {
      const Polygon polygon(ring);
      result.push_back({polygon, make_potential(polygon)});
    } catch (const InvalidPolygon&) {
      // a ring of the lattice that crosses itself
    }
  }
  return result;
}

inline Vec2 point_of(Random& random, const Polygon& polygon) {
  const int i = random.integer(0, polygon.size() - 1);
  const int place = random.integer(0, 3);
  const double s = place == 0 ? random.uniform(0, 1) : place == 1 ? .5 : 0;
  return polygon[i] + s * (polygon.after(i) - polygon[i]);
}

// Where b goes: anywhere, or a point of its boundary onto one of a's, or onto itself; then by as
// little as the grid allows, or not at all.
inline Vec2 move(Random& random, const Polygon& a, const Polygon& b) {
  Vec2 shift(random.uniform(-1, 1), random.uniform(-1, 1));
  const int kind = random.integer(0, 5);
  if (kind > 0) shift = point_of(random, a) - point_of(random, b);
  if (kind == 5) shift.setZero();
  if (random.integer(0, 2) > 0) {
    const double step = kGrid * std::exp2(random.integer(0, 40));
    shift += step * Vec2(random.integer(-2, 2), random.integer(-2, 2));
  }
  return {on_grid(shift.x(), kGrid), on_grid(shift.y(), kGrid)};
}

/// Depends on the pool and the number alone.
struct AdversarialPair {
  const HardShape& a;
  const HardShape& b;
  Polygon moved;  ///< b where it stands
};
inline AdversarialPair hard_pair(const std::vector<HardShape>& pool, unsigned number) {
  Random random(number);
  const HardShape& a = pool[random.integer(0, static_cast<int>(pool.size()) - 1)];
  const HardShape& b =
      random.integer(0, 9) == 0 ? a : pool[random.integer(0, static_cast<int>(pool.size()) - 1)];
  return {a, b, samples::shifted(b.polygon, move(random, a.polygon, b.polygon))};
}

}  // namespace apothem::test
