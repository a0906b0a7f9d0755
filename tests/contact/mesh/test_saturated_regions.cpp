// Outlines deeper in each other than their collars: energy against the definition of the depth at
// points, forces against the energy, momenta, and bodies inside each other.
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/contact/depth_fields.hpp"
#include "tests/contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

double depth_of(const OutlinePair& pair, BodyIndex body) {
  return pair.contacts->surfaces().outlines().bodies[body].depth;
}

// Two outlines anywhere.
OutlinePair random_overlap(samples::Random& random) {
  const auto outline = [&] {
    const int n = random.integer(3, 10);
    return random.integer(0, 3) == 0 ? samples::random_convex(random, n).vertices()
                                     : samples::random_star_shaped(random, n, .5).vertices();
  };
  const std::vector<Vec2> a = outline();
  std::vector<Vec2> b = outline();
  const double size = random.integer(0, 2) == 0 ? random.uniform(.1, .5) : 1;
  const Vec2 step(random.uniform(-1, 1), random.uniform(-1, 1));
  for (Vec2& v : b) v = size * v + step;
  return {a, b, random.uniform(.02, 1), random.uniform(.02, 1)};
}

}  // namespace

TEST_CASE("beyond the collar: the energy is that of the depth at all points", "[plateau]") {
  test::SeededRandom random(31);
  double worst = 0, worst_kernel = 0;
  for (int i = 0; i < scaled(150); ++i) {
    const OutlinePair pair = random_overlap(random);
    // Any depth of the collar, sound or not.
    const double h = random.uniform(.01, 1.5);
    const double closed = closed_form(NumberRing<double>(pair.a), NumberRing<double>(pair.b), h);
    const double exact = by_points(pair.a, pair.b, h);
    worst = std::max(worst, std::abs(closed - exact) / std::max(h, std::abs(exact)));
    // What the kernel has, with its depths.
    const double energy = by_points(pair.b, pair.a, depth_of(pair, 0)) / pair.reference_a +
                          by_points(pair.a, pair.b, depth_of(pair, 1)) / pair.reference_b;
    worst_kernel = std::max(worst_kernel, std::abs(pair.contacts->energy() - energy) /
                                              std::max(1e-3, std::abs(energy)));
  }
  CAPTURE(worst, worst_kernel);
  CHECK(worst < 1e-11);
  CHECK(worst_kernel < 1e-11);
}

TEST_CASE("beyond the collar: nodal forces are the gradient of the energy, and momenta balance",
          "[plateau]") {
  samples::Random random(32);  // the same cases always: the bound is a measured one
  double worst = 0, worst_balance = 0;
  int deep = 0;
  for (int i = 0; i < scaled(400); ++i) {
    const OutlinePair pair = random_overlap(random);
    const double size = pair.largest_force();
    if (!(size > 0)) continue;
    if (largest_relative_depth(*pair.contacts) > 1) ++deep;
    NumberRing<Complex> a(pair.a), b(pair.b);
    size_t k = 0;
    for (NumberRing<Complex>* ring : {&a, &b}) {
      for (size_t j = 0; j < ring->size(); ++j) {
        for (Complex* z : {&ring->x[j], &ring->y[j]}) {
          z->imag(1e-40);
          const Complex energy = closed_form(b, a, depth_of(pair, 0)) / pair.reference_a +
                                 closed_form(a, b, depth_of(pair, 1)) / pair.reference_b;
          worst = std::max(worst, std::abs(energy.imag() / 1e-40 + pair.node_force[k++]) / size);
          z->imag(0);
        }
      }
    }
    const Resultant on_a = pair.on(0), on_b = pair.on(1);
    worst_balance = std::max({worst_balance, (on_a.force + on_b.force).norm() / size,
                              std::abs(on_a.moment + on_b.moment) / size});
  }
  CAPTURE(worst, worst_balance, deep);
  CHECK(deep > least(scaled(100)));
  CHECK(worst < 1e-12);
  CHECK(worst_balance < 1e-12);
}
