// Shared by the tests: random polygons, poses, and where the project's files are.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "geometry/edge_integral.hpp"
#include "geometry/polygon.hpp"
#include "geometry/potential.hpp"

namespace apothem::test {

inline const std::string kSource = APOTHEM_SOURCE;    // the project's folder
inline const std::string kProgram = APOTHEM_PROGRAM;  // the program under test

/// Fewer random cases under the sanitizers, which are 20 times slower.
inline int scaled(int cases) { return std::max(1, cases / APOTHEM_TEST_DIVISOR); }

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double a, double b) { return a + (b - a) * std::ldexp(engine_() >> 11, -53); }
  int integer(int a, int b) {
    return a + static_cast<int>(engine_() % static_cast<unsigned>(b - a + 1));
  }

  /// Convex polygon of size about 1 with n vertices: points of a stretched and turned circle.
  Polygon convex(int n) {
    while (true) {
      std::vector<double> angles(n);
      for (double& a : angles) a = uniform(0, 2 * M_PI);
      std::sort(angles.begin(), angles.end());
      const double stretch = uniform(0.3, 1);
      const double turn = uniform(0, 2 * M_PI);
      std::vector<Vec2> ring;
      for (const double a : angles) {
        const Vec2 p(std::cos(a), stretch * std::sin(a));
        ring.emplace_back(std::cos(turn) * p.x() - std::sin(turn) * p.y(),
                          std::sin(turn) * p.x() + std::cos(turn) * p.y());
      }
      try {
        Polygon polygon(ring);
        if (polygon.is_convex() && area_moments(polygon).area > 0.05) return polygon;
      } catch (const InvalidPolygon&) {
        // two equal angles: try again
      }
    }
  }

 private:
  std::mt19937_64 engine_;
};

/// The polygon turned about its centroid, with the centroid at `centre`.
inline Polygon posed(const Polygon& polygon, const Vec2& centre, double angle) {
  const Vec2 centroid = area_moments(polygon).centroid;
  std::vector<Vec2> ring;
  for (const Vec2& v : polygon.local_vertices()) {
    const Vec2 d = v - centroid;
    ring.emplace_back(centre.x() + std::cos(angle) * d.x() - std::sin(angle) * d.y(),
                      centre.y() + std::sin(angle) * d.x() + std::cos(angle) * d.y());
  }
  return Polygon(ring);
}

inline Polygon shifted(const Polygon& polygon, const Vec2& by) {
  std::vector<Vec2> ring = polygon.vertices();
  for (Vec2& v : ring) v += by;
  return Polygon(ring);
}

inline Vec2 world_centroid(const Polygon& p) { return p.origin() + area_moments(p).centroid; }

inline PairResult edge(const Polygon& a, const Polygon& b, const PotentialChoice& choice = {}) {
  return edge_method(a, make_potential(a, choice), b, make_potential(b, choice));
}

inline PotentialChoice area_choice() { return {.kind = PotentialChoice::Kind::area}; }
inline PotentialChoice length_choice(double length) {
  return {.reference = PotentialChoice::Reference::length, .length = length};
}

/// The polygons of the benchmarks.
inline Polygon quad_q() { return Polygon({{0, 0}, {1.2, .1}, {1, .8}, {.2, 1}}); }
inline Polygon triangle_t() { return Polygon({{0, 0}, {1, 0}, {.3, .9}}); }

}  // namespace apothem::test
