// The dashpots of a step: the law of one by itself, and that many together take energy.
#include "lib/contact/law/dashpots.hpp"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <vector>

#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

constexpr double kHeavy = 1e30;  // N: never to be pulled

Dashpot between(const Vec2& normal, double rate, double pressed = kHeavy) {
  return {0, 1, normal, {Dashpot::Normal{rate, pressed, 1e9}}};
}

std::vector<double> forces_of(const Dashpots& dashpots, size_t coordinates) {
  std::vector<double> forces(coordinates, 0.);
  dashpots.add_forces(forces);
  return forces;
}

// Nodes that move along x on springs between them and dashpots beside these.
struct Chain {
  std::vector<double> mass;
  Eigen::MatrixXd directions;  // one row for each spring
  Eigen::VectorXd stiffness, rates;

  [[nodiscard]] Eigen::MatrixXd spring_matrix() const {
    return directions.transpose() * stiffness.asDiagonal() * directions;
  }
};

Chain random_chain(samples::Random& random) {
  Chain chain;
  const int n = random.integer(1, 6), count = random.integer(1, 2 * n + 1);
  for (int i = 0; i < n; ++i) chain.mass.push_back(std::pow(10, random.uniform(-1, 1)));
  chain.directions = Eigen::MatrixXd::Zero(count, n);
  chain.stiffness = Eigen::VectorXd::Zero(count);
  chain.rates = Eigen::VectorXd::Zero(count);
  const double common = std::pow(10, random.uniform(-2, 3.3));
  const bool one_ratio = random.integer(0, 1) == 1;
  for (int k = 0; k < count; ++k) {
    const int a = random.integer(0, n - 1), b = random.integer(0, n - 1);
    chain.directions(k, a) = 1;
    if (a != b && random.uniform(0, 1) < .8) chain.directions(k, b) = -1;
    if (random.uniform(0, 1) < .3)
      chain.directions(k, random.integer(0, n - 1)) += random.uniform(-2, 2);
    if (chain.directions.row(k).isZero()) chain.directions(k, a) = 1;
    chain.stiffness(k) = std::pow(10, random.uniform(-2, 2));
    double mobility = 0;
    for (int i = 0; i < n; ++i)
      mobility +=
          chain.directions(k, i) * chain.directions(k, i) / chain.mass[static_cast<size_t>(i)];
    const double ratio = one_ratio ? common : std::pow(10, random.uniform(-2, 3.3));
    chain.rates(k) = 2 * ratio * std::sqrt(chain.stiffness(k) / mobility);
  }
  return chain;
}

}  // namespace

TEST_CASE("a dashpot moves with f/c under a force that lasts, however strong it is", "[damping]") {
  for (const double rate : {.1, 1., 3., 1e3, 1e9}) {
    Dashpots dashpots(0);
    const std::vector<double> inverse_mass{.5, .5}, force{7, 0}, weight;
    std::vector<double> velocity{3, 0};
    const double dt = .1;
    for (int step = 0; step < 4000; ++step) {
      dashpots.clear();
      dashpots.add(between({1, 0}, rate));
      dashpots.add_node(0, {1, 0}, {0, 1});
      dashpots.solve({inverse_mass, velocity, force, force, weight}, dt);
      velocity[0] += dt * inverse_mass[0] * (force[0] + forces_of(dashpots, 2)[0]);
    }
    CHECK(velocity[0] == Approx(7 / rate).epsilon(1e-5));
  }
}

TEST_CASE("a dashpot takes the energy of the exact law in the order of the step", "[damping]") {
  // m v' = -c v from 1 m/s for one second.
  const auto left = [](int steps) {
    Dashpots dashpots(0);
    const std::vector<double> inverse_mass{1, 1}, none{0, 0}, weight;
    std::vector<double> velocity{1, 0};
    for (int i = 0; i < steps; ++i) {
      dashpots.clear();
      dashpots.add(between({1, 0}, 2));
      dashpots.add_node(0, {1, 0}, {0, 1});
      dashpots.solve({inverse_mass, velocity, none, none, weight}, 1. / steps);
      velocity[0] += forces_of(dashpots, 2)[0] / steps;
    }
    return velocity[0];
  };
  const double exact = std::exp(-2.);
  CHECK(std::abs(left(10) - exact) < 2e-3);
  CHECK(std::abs(left(20) - exact) < .26 * std::abs(left(10) - exact));
}

TEST_CASE("many dashpots on one body stop it and do not throw it back", "[damping]") {
  // Each of them alone takes less than the body has.
  const int count = GENERATE(1, 4, 30);
  const bool on_rail = GENERATE(false, true);
  Dashpots dashpots(1);
  const double w = on_rail ? 0 : 2;
  const std::vector<double> inverse_mass{w, w, 0}, velocity{3, -4, 0}, none(3, 0.), weight;
  const Vec2 direction(.6, -.8);
  std::vector<Dashpots::Motion::Rail> rails;
  if (on_rail) rails.push_back({0, direction, 2, 0});
  for (int i = 0; i < count; ++i) {
    dashpots.add(between(-direction, 9, 100));
    dashpots.add_point(0, Vec2(.1 * i, 0), -direction, {0, 0});
  }
  dashpots.solve({inverse_mass, velocity, none, none, weight, rails}, .1);
  const Vec2 change = 2 * .1 * Vec2(forces_of(dashpots, 3).data());
  const double after = (Vec2(3, -4) + change).dot(direction);
  // The midpoint rule where that is exact enough, else the implicit one.
  const double x = .1 * 9 * 2 * count, theta = x > 2 ? 1 - 1 / x : .5;
  // Fifty sweeps do not solve for thirty of them.
  CHECK(after ==
        Approx(5 * (1 - (1 - theta) * x) / (1 + theta * x)).margin(count < 10 ? 1e-3 : .25));
  CHECK(after > -1e-4);
  CHECK(std::abs(cross(change, direction)) < 1e-12);
}

TEST_CASE("what a dashpot does across a rail is held by it, and takes no energy", "[damping]") {
  Dashpots dashpots(1);
  const std::vector<double> inverse_mass(3, 0.), velocity{0, -2, 0}, none(3, 0.), weight;
  const std::vector<Dashpots::Motion::Rail> rails{{0, Vec2(0, -1), .5, .25}};
  const Vec2 normal(.6, .8);
  dashpots.add(between(normal, 7, 100));
  dashpots.add_point(0, {0, 0}, normal, {0, 0});
  dashpots.solve({inverse_mass, velocity, none, none, weight, rails}, .1);
  // Along the rail: g = 0.8, and the speed becomes 2 + 0.25 - 0.8 J/2.
  const double part = 1 + .7 / 2 * .64 / 2;
  const double impulse = .7 * .8 * (2 + .25 / 2) / part;
  CHECK(dashpots.normal_force(0) == Approx(impulse / .1).epsilon(1e-6));
  CHECK(forces_of(dashpots, 3)[0] == Approx(.6 * impulse / .1).epsilon(1e-6));
  CHECK(forces_of(dashpots, 3)[1] == Approx(.8 * impulse / .1).epsilon(1e-6));
  // Half of the step at the speed before.
  CHECK(dashpots.lost_before() == Approx(.8 * impulse * 2 / 2).epsilon(1e-6));
}

TEST_CASE("a contact does not pull, and friction with its dashpot obeys Coulomb", "[damping]") {
  Dashpots dashpots(1);
  const std::vector<double> inverse_mass{1, 1, 2, 1, 1}, none(5, 0.), weight;
  const std::vector<double> velocity{0, 5, 0, 0, 0};  // it leaves the node
  const double dt = .01;
  Dashpot contact{0, 1, Vec2(0, 1), {Dashpot::Normal{1e6, 30, 1e9}}, 1e6};
  contact.limit.coefficient = .4;
  contact.spring = 5;
  dashpots.add(contact);
  dashpots.add_point(0, {0, -1}, {0, 1}, {-1, 0});
  dashpots.add_node(0, {0, -1}, {1, 0});
  dashpots.solve({inverse_mass, velocity, none, none, weight}, dt);
  CHECK(dashpots.normal_force(0) == Approx(-30));
  CHECK(dashpots.tangential_force(0) == Approx(-5));  // nothing is pressed

  std::vector<double> sliding{4, -1, 0, 0, 0};  // it approaches and slides
  dashpots.solve({inverse_mass, sliding, none, none, weight}, dt);
  const double push = dashpots.normal_force(0);
  CHECK(push > 0);
  CHECK(dashpots.tangential_force(0) + 5 == Approx(.4 * (30 + push)));
  // The sum of the forces vanishes, and so does that of their moments about the node.
  const std::vector<double> f = forces_of(dashpots, 5);
  CHECK(f[0] + f[3] == Approx(0).margin(1e-12));
  CHECK(f[1] + f[4] == Approx(0).margin(1e-12));
}

TEST_CASE("a dashpot takes what its points take, none of which pulls", "[damping]") {
  SeededRandom random(19);
  for (int i = 0; i < scaled(400); ++i) {
    // The dashpot moves a mass that it acts on, and its two sides part.
    const double deepest = random.uniform(.1, 3), mean = deepest * random.uniform(.5, 1);
    const double plateau = random.integer(0, 2) / 2. * random.uniform(0, 1);
    const double stiffness = random.uniform(.1, 10), time = std::pow(10, random.uniform(-2, 1));
    const double mobility = std::pow(10, random.uniform(-3, 2)), parts = random.uniform(-1, 6);
    const double rate = stiffness * time, pressed = stiffness * mean;
    const Dashpot::Normal dashpot = Dashpot::Normal::of(rate, pressed, stiffness, deepest, plateau);
    CAPTURE(i, deepest, mean, plateau, stiffness, time, mobility, parts);
    REQUIRE(dashpot.depth == Approx(deepest));
    // Its points: some have the largest depth, those of the others are spread evenly.
    constexpr int kPoints = 2000;
    std::vector<double> depths;
    double sum = 0;
    for (int k = 0; k < kPoints; ++k) {
      const double even = dashpot.least + (k + .5) / kPoints * (1 - dashpot.least);
      depths.push_back(deepest * even);
      sum += dashpot.level * deepest + (1 - dashpot.level) * depths.back();
    }
    CHECK(sum / kPoints == Approx(mean));
    CHECK(dashpot.level <= plateau);
    const auto by_points = [&](double u) {
      double force = -dashpot.level * std::min(time * u, deepest);
      for (const double depth : depths) {
        force -= (1 - dashpot.level) / kPoints * std::min(time * u, depth);
      }
      return stiffness * force;
    };
    double low = -pressed, high = 2 * rate;
    for (int n = 0; n < 50; ++n) {
      const double middle = (low + high) / 2;
      (by_points(parts + mobility * middle) > middle ? low : high) = middle;
    }
    const double part = 1 + rate * mobility;
    CHECK(dashpot.push(-rate * parts / part, pressed, 1 - 1 / part) ==
          Approx(low).margin(1e-5 * pressed));
  }
}

TEST_CASE("dashpots at corners and at flats that part take energy", "[damping]") {
  SeededRandom random(23);
  for (int i = 0; i < scaled(2000); ++i) {
    const Chain chain = random_chain(random);
    std::vector<double> inverse_mass, velocity;
    for (const double m : chain.mass) {
      inverse_mass.insert(inverse_mass.end(), {1 / m, 1 / m});
      velocity.insert(velocity.end(), {random.uniform(-1, 1), 0});
    }
    const std::vector<double> none(velocity.size()), weight;
    const double dt = std::pow(10, random.uniform(-3, 1));
    Dashpots dashpots(0);
    for (Eigen::Index d = 0; d < chain.rates.size(); ++d) {
      const double pressed = std::pow(10, random.uniform(-3, 1)) / dt;
      dashpots.add({0,
                    1,
                    {1, 0},
                    {Dashpot::Normal::of(chain.rates(d), pressed, pressed, random.uniform(1, 2),
                                         random.uniform(0, 1))}});
      for (size_t c = 0; c < chain.mass.size(); ++c) {
        dashpots.add_node(static_cast<NodeIndex>(c),
                          {chain.directions(d, static_cast<Eigen::Index>(c)), 0}, {0, 0});
      }
    }
    dashpots.solve({inverse_mass, velocity, none, none, weight}, dt);
    const std::vector<double> force = forces_of(dashpots, velocity.size());
    double before = 0, behind = 0;
    for (size_t c = 0; c < velocity.size(); ++c) {
      const double next = velocity[c] + dt * inverse_mass[c] * force[c];
      before += velocity[c] * velocity[c] / inverse_mass[c],
          behind += next * next / inverse_mass[c];
    }
    CAPTURE(i, dt);
    CHECK(behind < before * (1 + 1e-5));
  }
}

TEST_CASE("chains of masses with dashpots of any strength do not grow", "[damping]") {
  // So much presses that the dashpots are content with one pass.
  samples::Random random(5);
  for (int i = 0; i < 300; ++i) {
    CAPTURE(i);
    const Chain chain = random_chain(random);
    const auto n = static_cast<Eigen::Index>(chain.mass.size());
    const Eigen::VectorXd mass = Eigen::Map<const Eigen::VectorXd>(chain.mass.data(), n);
    const Eigen::VectorXd root = mass.cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd k = chain.spring_matrix();
    const Eigen::MatrixXd scaled = root.asDiagonal() * k * root.asDiagonal();
    const double fastest =
        std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().maxCoeff());
    const double dt = random.uniform(.05, .95) * 2 / fastest;
    std::vector<double> inverse_mass, velocity(2 * chain.mass.size()), force(velocity.size());
    for (const double m : chain.mass) inverse_mass.insert(inverse_mass.end(), {1 / m, 1 / m});
    const std::vector<double> weight;
    // What a step makes of the places and of the velocities half a step before.
    Eigen::MatrixXd map(2 * n, 2 * n);
    for (Eigen::Index column = 0; column < 2 * n; ++column) {
      Eigen::VectorXd x = Eigen::VectorXd::Unit(2 * n, column).head(n);
      Eigen::VectorXd v = Eigen::VectorXd::Unit(2 * n, column).tail(n);
      const Eigen::VectorXd f = -k * x;
      for (Eigen::Index c = 0; c < n; ++c) {
        velocity[2 * static_cast<size_t>(c)] = v(c);
        force[2 * static_cast<size_t>(c)] = f(c);
      }
      Dashpots dashpots(0);
      for (Eigen::Index d = 0; d < chain.rates.size(); ++d) {
        dashpots.add({0, 1, {1, 0}, {Dashpot::Normal{chain.rates(d), kHeavy, 1e9}}});
        for (Eigen::Index c = 0; c < n; ++c) {
          dashpots.add_node(static_cast<NodeIndex>(c), {chain.directions(d, c), 0}, {0, 0});
        }
      }
      dashpots.solve({inverse_mass, velocity, force, force, weight}, dt);
      const std::vector<double> damping = forces_of(dashpots, force.size());
      for (Eigen::Index c = 0; c < n; ++c) {
        const auto at = 2 * static_cast<size_t>(c);
        v(c) += dt * inverse_mass[at] * (force[at] + damping[at]);
      }
      x += dt * v;
      map.col(column) << x, v;
    }
    CHECK(map.eigenvalues().cwiseAbs().maxCoeff() < 1 + 1e-6);
  }
}
