#include "lib/contact/law/stiffness.hpp"

#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "apps/cases/samples.hpp"

using namespace apothem;

TEST_CASE("the rate of a body is the largest eigenvalue of its springs, and its bound is above it",
          "[contact]") {
  samples::Random random(17);
  for (int i = 0; i < 1000; ++i) {
    const double mass = std::pow(10, random.uniform(-3, 6));
    const std::array<double, 3> inverse_mass{1 / mass, random.integer(0, 3) > 0 ? 1 / mass : 0,
                                             random.integer(0, 3) > 0 ? 3 / mass : 0};
    BodyStiffness sum;
    Eigen::Matrix3d k = Eigen::Matrix3d::Zero();
    for (int j = random.integer(1, 5); j > 0; --j) {
      const double angle = random.uniform(0, 7), arm = random.uniform(-2, 2);
      const double size = std::pow(10, random.uniform(5, 9));
      BodyStiffness spring;
      spring.add(size / 2, std::cos(angle), std::sin(angle), arm);
      spring.tt += size / 10;
      sum.add(spring, 2);
      const Eigen::Vector3d g(std::cos(angle), std::sin(angle), arm);
      k += size * g * g.transpose();
      k(2, 2) += size / 5;
    }
    const Eigen::Vector3d w(inverse_mass[0], inverse_mass[1], inverse_mass[2]);
    const Eigen::Matrix3d scaled = w.cwiseSqrt().asDiagonal() * k * w.cwiseSqrt().asDiagonal();
    const double exact = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scaled).eigenvalues()[2];
    REQUIRE(rate_of(sum, inverse_mass) == Approx(exact).epsilon(1e-9));
    REQUIRE(rate_bound_of(sum, inverse_mass) >= exact * (1 - 1e-12));
    REQUIRE(rate_bound_of(sum, inverse_mass) < 2 * exact);
  }
}

TEST_CASE("contacts in different directions do not add, opposite ones do", "[contact]") {
  const std::array<double, 3> inverse_mass{.5, .5, 2};
  BodyStiffness across, opposite;
  across.add(3e6, 1, 0, 0);
  across.add(3e6, 0, 1, 0);
  opposite.add(3e6, 0, 1, 0);
  opposite.add(3e6, 0, -1, 0);
  CHECK(rate_of(across, inverse_mass) == Approx(1.5e6));
  CHECK(rate_of(opposite, inverse_mass) == Approx(3e6));
}

TEST_CASE("a strip has the stiffness of a landing on its whole side", "[contact]") {
  const std::array<double, 3> inverse_mass{.3, .3, 1.7};
  BodyStiffness strip;
  strip.add(1, 0, -1, .4);
  strip.tt += .6 * .6 / 12;
  CHECK(rate_of(strip, inverse_mass) ==
        Approx(strip_mobility(inverse_mass, .4, .6)).epsilon(1e-12));
}
