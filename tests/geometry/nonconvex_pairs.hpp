// Polygons that are not convex and what their contact is held to, for the tests of both fields.
#pragma once

#include <array>
#include <catch2/catch.hpp>

#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/placed_shapes.hpp"
#include "tests/support.hpp"

namespace apothem::test {

using samples::l_shape;
using samples::Random;
using samples::star;

inline Polygon cross_shape() { return samples::cross_of_squares(); }
inline Polygon comb(int teeth) { return samples::scaled(samples::comb(teeth), .4); }

inline Polygon any_shape(Random& random) {
  switch (random.integer(0, 4)) {
    case 0:
      return cross_shape();
    case 1:
      return star(random.integer(3, 7), random.uniform(.3, .6));
    case 2:
      return comb(random.integer(2, 4));
    case 3:
      return samples::random_convex(random, random.integer(3, 8));
    default:
      return samples::random_star_shaped(random, random.integer(4, 12), .35);
  }
}

// A band of width .4, wound up with gaps of the same width.
inline Polygon spiral() {
  std::vector<Vec2> ring{{0, 0}, {5, 0}, {5, 5}, {0, 5}, {0, 2}, {3, 2},
                         {3, 3}, {1, 3}, {1, 4}, {4, 4}, {4, 1}, {0, 1}};
  for (Vec2& v : ring) v *= .4;
  return Polygon(ring);
}

inline PairResult overlap(const Polygon& a, const Polygon& b, const PotentialChoice& choice) {
  return overlap_method(a, make_potential(a, choice), b, make_potential(b, choice));
}

inline void check_against(const PairResult& r, const PairResult& x) {
  const double tolerance =
      std::max(1e-13, 1e-15 / std::max(x.integral.depth, 1e-6)) * std::max(x.integral.weight, 1e-3);
  REQUIRE((r.integral.force - x.integral.force).norm() <= tolerance);
  REQUIRE(std::abs(r.integral.moment_a - x.integral.moment_a) <= 3 * tolerance);
  REQUIRE(std::abs(r.integral.moment_b - x.integral.moment_b) <= 3 * tolerance);
  REQUIRE(std::abs(r.integral.own_length_a - x.integral.own_length_a) <= 1e-9);
  REQUIRE(std::abs(r.volume.energy - x.volume.energy) <= 1e-13);
  REQUIRE(std::abs(r.volume.overlap_area - x.volume.overlap_area) <= 1e-13);
  REQUIRE(std::abs(r.integral.largest_phi - x.integral.largest_phi) <= 1e-10);
}

// Largest work of a pair on twenty random closed paths over that of its absolute power, with
// Gauss's three points in every step: a corner that passes an edge bends the force.
inline double closed_path_work(const Polygon& a, const Polygon& b, const PotentialChoice& choice,
                               int steps) {
  const Potential potential_a = translated(make_potential(a, choice), area_moments(a).centroid);
  const Potential potential_b = translated(make_potential(b, choice), area_moments(b).centroid);
  PlacedShapes shapes;
  shapes.add(potential_a);
  shapes.add(potential_b);
  shapes.place(1, 0, 0, 0);
  EdgeWorkspace workspace;
  double worst = 0;
  test::SeededRandom random(43);
  for (int loop = 0; loop < scaled(20); ++loop) {
    double c[5];
    for (double& x : c) x = random.uniform(0, 1);
    const auto pose = [&](double s) {
      return std::array{.9 + (.1 + .1 * c[0]) * std::cos(s + 6 * c[1]),
                        .5 + (.1 + .1 * c[2]) * std::sin(s),
                        6 * c[3] + .3 * c[4] * std::sin(s + 1)};
    };
    const auto power = [&](double s) {
      const auto p = pose(s);
      shapes.place(0, p[0], p[1], p[2]);
      const PairIntegral f = pair_integral(shapes.view(0), shapes.view(1), {p[0], p[1]}, workspace);
      return -f.force.x() * (.1 + .1 * c[0]) * std::sin(s + 6 * c[1]) +
             f.force.y() * (.1 + .1 * c[2]) * std::cos(s) +
             f.moment_a * .3 * c[4] * std::cos(s + 1);
    };
    const double h = 2 * M_PI / steps, gauss = std::sqrt(.15);
    double work = 0, path = 0;
    for (int i = 0; i < steps; ++i) {
      const double middle = (i + .5) * h;
      const double dw =
          h / 18 *
          (5 * power(middle - gauss * h) + 8 * power(middle) + 5 * power(middle + gauss * h));
      work += dw;
      path += std::abs(dw);
    }
    if (path > 0) worst = std::max(worst, std::abs(work) / path);
  }
  return worst;
}

// Crosses, stars and combs on closed paths, held to the limits of convex pairs.
inline void check_closed_paths(const PotentialChoice& choice) {
  for (const auto& [a, b] : {std::pair(cross_shape(), cross_shape()),
                             std::pair(star(5, .45), star(6, .5)), std::pair(comb(3), comb(2))}) {
    for (const auto& [steps, limit] :
         {std::pair(800, 2e-6), std::pair(3200, 4e-8), std::pair(12800, 1e-9)}) {
      const double worst = closed_path_work(a, b, choice, steps);
      INFO(steps << " steps: " << worst);
      CHECK(worst < limit);
    }
  }
}

}  // namespace apothem::test
