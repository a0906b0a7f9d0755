// Shapes that the tests of skeletons, singular areas and pictures share.
#pragma once

#include <cmath>
#include <vector>

#include "support.hpp"

namespace apothem::test {

using Ring = std::vector<Vec2>;

/// A unit square with four arms; five unit squares by default.
inline Ring cross_ring(double arm = 1) {
  const double a = .5, b = .5 + arm;
  return {{a, -b}, {a, -a}, {b, -a}, {b, a},   {a, a},   {a, b},
          {-a, b}, {-a, a}, {-b, a}, {-b, -a}, {-a, -a}, {-a, -b}};
}

inline Ring l_ring() { return {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}; }

inline Ring star_ring(int points, double inner) {
  Ring ring;
  for (int i = 0; i < 2 * points; ++i) {
    const double r = i % 2 == 0 ? 1 : inner;
    ring.emplace_back(r * std::cos(M_PI * i / points), r * std::sin(M_PI * i / points));
  }
  return ring;
}

inline Ring comb_ring(int teeth) {
  Ring ring{{0, -1}, {2. * teeth - 1, -1}};
  for (int i = teeth - 1; i >= 0; --i) {
    ring.insert(ring.end(), {{2. * i + 1, 3}, {2. * i, 3}});
    if (i > 0) ring.insert(ring.end(), {{2. * i, 0}, {2. * i - 1, 0}});
  }
  return ring;
}

inline Ring spiral_ring(int windings) {
  Ring ring;
  const int n = 12 * windings;
  for (int i = 0; i <= n; ++i) {
    const double angle = M_PI * i / 6, r = 1 + angle / (2 * M_PI);
    ring.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  for (int i = n; i >= 0; --i) {
    const double angle = M_PI * i / 6, r = .6 + angle / (2 * M_PI);
    ring.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return ring;
}

inline Ring regular_ring(int n) {
  Ring ring;
  for (int i = 0; i < n; ++i) {
    ring.emplace_back(std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n));
  }
  return ring;
}

inline Ring turned(Ring ring, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec2& v : ring) v = Vec2(c * v.x() - s * v.y(), s * v.x() + c * v.y());
  return ring;
}

// Outline around a random centre, more or less spiky; almost always in general position.
inline Polygon random_polygon(Random& random, int n) {
  while (true) {
    std::vector<double> angles(n);
    for (double& a : angles) a = random.uniform(0, 2 * M_PI);
    std::sort(angles.begin(), angles.end());
    const double depth = random.uniform(0, .9);
    Ring ring;
    for (const double a : angles) {
      const double r = 1 - random.uniform(0, depth);
      ring.emplace_back(r * std::cos(a), r * std::sin(a));
    }
    try {
      return Polygon(ring);
    } catch (const InvalidPolygon&) {
      // a gap of more than half a turn: try again
    }
  }
}

}  // namespace apothem::test
