// Random and adversarial pairs without a single failure. APOTHEM_LONG=1 in the environment runs the
// million; each pair depends on its number alone, so a failing one can be repeated by itself.
#include <catch2/catch.hpp>
#include <map>

#include "geometry/overlap.hpp"
#include "pair_check.hpp"
#include "support.hpp"

using namespace apothem;

namespace {

using Ring = std::vector<Vec2>;

// Coordinates on this grid and below 8 in size: all moves along the grid are exact, so a shape's
// potential is computed once and serves it wherever it goes.
constexpr double kGrid = 0x1p-45;

double on_grid(double x, double grid) { return grid * std::round(x / grid); }

Ring turned(Ring ring, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec2& v : ring) v = Vec2(c * v.x() - s * v.y(), s * v.x() + c * v.y());
  return ring;
}

Ring star_shaped(samples::Random& random, int n, double inner) {
  Ring ring;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * (i + random.uniform(0, .9)) / n;
    ring.push_back(random.uniform(inner, 1) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

Ring cross(double arm) {
  const double a = .25, b = .25 + arm;
  return {{a, -b}, {a, -a}, {b, -a}, {b, a},   {a, a},   {a, b},
          {-a, b}, {-a, a}, {-b, a}, {-b, -a}, {-a, -a}, {-a, -b}};
}

Ring comb(int teeth) {
  Ring ring{{0, 0}, {2. * teeth - 1, 0}};
  for (int i = teeth - 1; i >= 0; --i) {
    ring.insert(ring.end(), {{2. * i + 1, 3}, {2. * i, 3}});
    if (i > 0) ring.insert(ring.end(), {{2. * i, 1}, {2. * i - 1, 1}});
  }
  for (Vec2& v : ring) v *= .25;
  return ring;
}

// Few distinct coordinates: every coincidence there is.
Ring lattice(samples::Random& random) {
  Ring ring;
  const int n = random.integer(3, 9);
  for (int i = 0; i < n; ++i)
    ring.emplace_back(random.integer(0, 4) / 4., random.integer(0, 4) / 4.);
  return ring;
}

Ring any_ring(samples::Random& random) {
  const double turn = random.integer(0, 1) ? random.uniform(0, 6) : 0;
  switch (random.integer(0, 9)) {
    case 0:
    case 1:
      return lattice(random);
    case 2:
      return turned(cross(random.integer(1, 4) * .25), turn);
    case 3:
      return turned(comb(random.integer(2, 3)), turn);
    case 4:  // needle
      return turned({{0, 0}, {1, 0}, {random.uniform(0, 1), std::pow(10, -random.uniform(1, 5))}},
                    turn);
    case 5:
      return turned({{0, 0}, {1, 0}, {1, .5}, {0, .5}}, turn);
    case 6: {  // nearly parallel to what is not turned
      const double angle = std::pow(10, -random.uniform(2, 12));
      return turned({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, angle);
    }
    case 7:
      return star_shaped(random, random.integer(5, 14), .3);
    case 8:
      return star_shaped(random, random.integer(3, 64), .99);
    default:
      return samples::random_convex(random, random.integer(3, 8)).vertices();
  }
}

struct Shape {
  Polygon polygon;
  Potential potential;
};

std::vector<Shape> shapes(int count) {
  samples::Random random(60);
  std::vector<Shape> result;
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

Vec2 point_of(samples::Random& random, const Polygon& polygon) {
  const int i = random.integer(0, polygon.size() - 1);
  const int place = random.integer(0, 3);
  const double s = place == 0 ? random.uniform(0, 1) : place == 1 ? .5 : 0;
  return polygon[i] + s * (polygon.after(i) - polygon[i]);
}

// Where b goes: anywhere, or a point of its boundary onto one of a's, or onto itself; then by as
// little as the grid allows, or not at all.
Vec2 move(samples::Random& random, const Polygon& a, const Polygon& b) {
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

}  // namespace

TEST_CASE("random and adversarial pairs", "[fuzz]") {
  const bool all = test::long_run();
  const std::vector<Shape> pool = shapes(all ? 600 : test::scaled(300) + 30);
  const int pairs = all ? 1'000'000 : test::scaled(20'000);
  int touching = 0;
  test::PairErrors worst;
  for (int i = 0; i < pairs; ++i) {
    samples::Random random(static_cast<unsigned>(i));
    const Shape& a = pool[random.integer(0, static_cast<int>(pool.size()) - 1)];
    const Shape& b =
        random.integer(0, 9) == 0 ? a : pool[random.integer(0, static_cast<int>(pool.size()) - 1)];
    const Polygon moved = samples::shifted(b.polygon, move(random, a.polygon, b.polygon));
    const test::PairCheck check = test::check_pair(a.polygon, a.potential, moved, b.potential);
    touching += check.touching;
    worst.force = std::max(worst.force, check.errors.force);
    worst.moment = std::max(worst.moment, check.errors.moment);
    worst.energy = std::max(worst.energy, check.errors.energy);
    worst.area = std::max(worst.area, check.errors.area);
    if (check.defect)
      FAIL_CHECK(*check.defect << "\n" << test::as_line(std::to_string(i), a.polygon, moved));
  }
  CHECK(touching > pairs / 3);
  if (all) {
    WARN(pairs << " pairs, " << touching << " of them overlap; round-off at most " << worst.force
               << " (force), " << worst.moment << " (moment), " << worst.energy << " (energy), "
               << worst.area << " (area) units");
  }
}
