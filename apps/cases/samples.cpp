#include "apps/cases/samples.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"

namespace apothem::samples {
namespace {

Vec2 polar(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

// Calls make() until it gives a valid polygon that accept() takes.
template <class Make, class Accept>
Polygon first_valid(const Make& make, const Accept& accept) {
  while (true) {
    try {
      Polygon polygon(make());
      if (accept(polygon)) return polygon;
    } catch (const InvalidPolygon&) {
      // Two angles are equal, or a gap exceeds half a turn: try the next one.
    }
  }
}

std::vector<double> sorted_angles(Random& random, int n) {
  std::vector<double> angles(n);
  for (double& a : angles) a = random.uniform(0, 2 * M_PI);
  std::ranges::sort(angles);
  return angles;
}

}  // namespace

Polygon block(double x0, double y0, double x1, double y1) {
  return Polygon({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
}

Polygon wedge_up(double half_angle) {
  const double x = std::sin(half_angle);
  const double y = std::cos(half_angle);
  return Polygon({{0, 0}, {-x, -y}, {x, -y}});
}

Polygon wedge_down(double half_angle) {
  const double x = std::sin(half_angle);
  const double y = std::cos(half_angle);
  return Polygon({{0, 0}, {x, y}, {-x, y}});
}

Polygon needle(double length, double width) {
  return Polygon({{0, -width / 2}, {length, 0}, {0, width / 2}});
}

Polygon regular(int n) {
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) ring.push_back(polar(1, 2 * M_PI * i / n));
  return Polygon(ring);
}

Polygon cross_of_squares(double arm) {
  const double a = .5;
  const double b = .5 + arm;
  return Polygon({{a, -b},
                  {a, -a},
                  {b, -a},
                  {b, a},
                  {a, a},
                  {a, b},
                  {-a, b},
                  {-a, a},
                  {-b, a},
                  {-b, -a},
                  {-a, -a},
                  {-a, -b}});
}

Polygon l_shape(double leg) {
  return Polygon({{0, 0}, {leg, 0}, {leg, 1}, {1, 1}, {1, leg}, {0, leg}});
}

Polygon star(int tips, double inner) {
  std::vector<Vec2> ring;
  for (int i = 0; i < 2 * tips; ++i) ring.push_back(polar(i % 2 == 0 ? 1 : inner, M_PI * i / tips));
  return Polygon(ring);
}

Polygon comb(int teeth, double length, double growth) {
  std::vector<Vec2> ring{{0, 0}, {2.0 * teeth - 1, 0}};
  for (int i = teeth - 1; i >= 0; --i) {
    const double top = 1 + length + growth * i;
    ring.insert(ring.end(), {{2.0 * i + 1, top}, {2.0 * i, top}});
    if (i > 0) ring.insert(ring.end(), {{2.0 * i, 1}, {2.0 * i - 1, 1}});
  }
  return Polygon(ring);
}

Polygon gear(int teeth) {
  const double pitch = 2 * M_PI / teeth, root = 1 - .6 * std::min(pitch, 1.);
  std::vector<Vec2> ring;
  for (int i = 0; i < teeth; ++i) {
    ring.push_back(polar(root, pitch * (i - .25)));
    ring.push_back(polar(1, pitch * (i - .12)));
    ring.push_back(polar(1, pitch * (i + .12)));
    ring.push_back(polar(root, pitch * (i + .25)));
  }
  return Polygon(ring);
}

Polygon staircase(int steps) {
  std::vector<Vec2> ring;
  for (double i = 0; i < steps; ++i) ring.insert(ring.end(), {{i, i - 3}, {i + 1, i - 3}});
  for (double i = steps; i > 0; --i) ring.insert(ring.end(), {{i, i + 2}, {i - 1, i + 2}});
  return Polygon(ring);
}

Polygon spiral(double turns, int edges_per_turn, double width, double widening) {
  std::vector<Vec2> ring, inner;
  const int n = static_cast<int>(std::lround(turns * edges_per_turn));
  for (int i = 0; i <= n; ++i) {
    const double turn = static_cast<double>(i) / edges_per_turn;
    ring.push_back(polar(1 + turn, 2 * M_PI * turn));
    inner.push_back(polar(1 + turn - (width + widening * turn), 2 * M_PI * turn));
  }
  ring.insert(ring.end(), inner.rbegin(), inner.rend());
  return Polygon(ring);
}

Polygon random_quad(Random& random) {
  const double start = random.uniform(0, 2 * M_PI);
  std::vector<Vec2> ring;
  for (int i = 0; i < 4; ++i) {
    ring.push_back(polar(1, start + i * M_PI / 2 + random.uniform(-.4, .4)));
  }
  return Polygon(ring);
}

Polygon random_convex(Random& random, int n) {
  return first_valid(
      [&] {
        const std::vector<double> angles = sorted_angles(random, n);
        const double stretch = random.uniform(.3, 1);
        const double turn = random.uniform(0, 2 * M_PI);
        std::vector<Vec2> ring;
        for (const double a : angles) {
          ring.push_back(turned(Vec2(std::cos(a), stretch * std::sin(a)), turn));
        }
        return ring;
      },
      [](const Polygon& p) { return p.is_convex() && area_moments(p).area > .05; });
}

Polygon random_star_shaped(Random& random, int n, double inner) {
  return first_valid(
      [&] {
        std::vector<Vec2> ring;
        for (const double a : sorted_angles(random, n)) {
          ring.push_back(polar(random.uniform(inner, 1), a));
        }
        return ring;
      },
      [](const Polygon& p) { return area_moments(p).area > .05; });
}

Polygon coastline(Random& random, int n) {
  std::vector<Vec2> ring = regular(6).vertices();
  while (static_cast<int>(ring.size()) < n) {
    const size_t bends = std::min(ring.size(), static_cast<size_t>(n) - ring.size());
    std::vector<Vec2> bent;
    for (size_t i = 0; i < ring.size(); ++i) {
      bent.push_back(ring[i]);
      if (i >= bends) continue;
      const Vec2 side = after(ring, i) - ring[i];
      const double height = random.uniform(-.15, .15);
      bent.push_back(ring[i] + side / 2 + height * Vec2(-side.y(), side.x()));
    }
    ring = std::move(bent);
  }
  return Polygon(std::move(ring));
}

Polygon skyline(Random& random, int n) {
  std::vector<Vec2> below, above;
  for (int i = 0; i < n / 4; ++i) {
    // A height that differs from the one before, which would leave a repeated vertex.
    const auto height = [&](const std::vector<Vec2>& line, int sign) {
      int h = random.integer(5, 40);
      if (!line.empty() && line.back().y() == sign * h) ++h;
      return sign * h;
    };
    const double bottom = height(below, -1);
    const double top = height(above, 1);
    for (const int x : {i, i + 1}) {
      below.emplace_back(x, bottom);
      above.emplace_back(x, top);
    }
  }
  below.insert(below.end(), above.rbegin(), above.rend());
  return Polygon(std::move(below));
}

Polygon shifted(const Polygon& polygon, const Vec2& by) {
  return mapped(polygon, [&](const Vec2& v) -> Vec2 { return v + by; });
}

Vec2 turned(const Vec2& v, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

Polygon turned(const Polygon& polygon, double angle) {
  return mapped(polygon, [&](const Vec2& v) { return turned(v, angle); });
}

Polygon scaled(const Polygon& polygon, double factor) {
  return mapped(polygon, [&](const Vec2& v) -> Vec2 { return factor * v; });
}

Polygon posed(const Polygon& polygon, const Vec2& centre, double angle) {
  const Vec2 centroid = area_moments(polygon).centroid;
  const Vec2 origin = polygon.origin();
  return mapped(polygon, [&](const Vec2& v) -> Vec2 {
    return centre + turned((v - origin) - centroid, angle);
  });
}

Vec2 world_centroid(const Polygon& polygon) {
  return polygon.origin() + area_moments(polygon).centroid;
}

}  // namespace apothem::samples
