// Friction per boundary edge: momentum, objectivity, stick, slip, ledger.
#include <catch2/catch.hpp>

#include "apothem/contact/deformable_friction.hpp"
#include "contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

DeformableFriction friction_of_two(double mu, double stiffness) {
  return DeformableFriction({{0, 0}, 1, {{mu, stiffness}}});
}

std::vector<double> random_velocities(samples::Random& random, size_t n) {
  std::vector<double> v(n);
  for (double& x : v) x = random.uniform(-1, 1);
  return v;
}

double spring_sum(const DeformableFriction& friction) {
  double sum = 0;
  for (const EdgeSlip& s : friction.memory().slips) sum += std::abs(s.spring);
  return sum;
}

}  // namespace

TEST_CASE("friction keeps linear and angular momentum", "[deformable_friction]") {
  samples::Random random(31);
  double worst = 0;
  int pairs = 0;
  for (int i = 0; i < scaled(1000); ++i) {
    const auto pair = random_pair(random, random.integer(3, 12), random.uniform(.3, 1.2));
    if (!pair) continue;
    ++pairs;
    DeformableFriction friction = friction_of_two(.7, 2);
    friction.update(pair->contact, random_velocities(random, pair->force.size()), {}, .01);
    const auto a = friction.resultant(pair->contact, 0);
    const auto b = friction.resultant(pair->contact, 1);
    const double size = spring_sum(friction);
    REQUIRE(size > 0);
    worst = std::max(worst, (a.force + b.force).norm() / size);
    worst = std::max(worst, std::abs(a.moment + b.moment) / size);
  }
  CHECK(pairs > 0);
  CAPTURE(worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("rigid motion of the pair as a whole is no slip", "[deformable_friction]") {
  samples::Random random(32);
  for (int i = 0; i < scaled(200); ++i) {
    const auto pair = random_pair(random, 8, .6);
    if (!pair) continue;
    const Outlines& o = pair->contact.outlines();
    const Vec2 drift(random.uniform(-1, 1), random.uniform(-1, 1));
    const double spin = random.uniform(-1, 1);
    std::vector<double> v(pair->force.size());
    for (int k = 0; k < o.size(); ++k) {
      const Vec2 at = drift + cross(spin, Vec2(o.x[k], o.y[k]));
      v[2 * o.node[k]] = at.x(), v[2 * o.node[k] + 1] = at.y();
    }
    DeformableFriction friction = friction_of_two(10, 1);
    friction.update(pair->contact, v, {}, 1);
    for (const EdgeSlip& s : friction.memory().slips)
      CHECK(std::abs(s.spring) < 1e-13 * s.stiffness);
  }
}

TEST_CASE("a block dragged over a row of edges meets mu times the normal force",
          "[deformable_friction]") {
  const double d = .05, mu = .3, dt = 1e-3, speed = .5;
  OutlinePair pair(split(samples::block(-3, -1, 3, 0).vertices(), 30),
                   split(samples::block(-.5, -d, .5, 1 - d).vertices(), 7), .2, .2);
  DeformableFriction friction = friction_of_two(mu, .6);
  const size_t nodes_a = pair.a.size();
  std::vector<double> v(pair.force.size());
  for (size_t i = 2 * nodes_a; i < v.size(); i += 2) v[i] = speed;
  double least = 1;
  for (int step = 0; step < 2000; ++step) {
    for (size_t i = 2 * nodes_a; i < v.size(); i += 2) pair.displacement[i] += dt * speed;
    pair.evaluate();
    friction.update(pair.contact, v, {}, dt);
    const auto on_block = friction.resultant(pair.contact, 1);
    const double share = -on_block.force.x() / (mu * pair.contact.resultant(1).force.y());
    CHECK(share <= 1 + 1e-12);
    if (step > 1000) least = std::min(least, share);
  }
  CAPTURE(least);
  CHECK(least > .98);
  // What the drive has put in is lost or in the springs.
  CHECK(friction.memory().friction_loss > 0);
}

TEST_CASE("friction gives back no more than it was given", "[deformable_friction]") {
  // Prescribed motion, normal and tangential, that comes and goes: the work done on the springs is
  // their energy and the loss, and the loss never falls.
  const double dt = 1e-3;
  for (const double mu : {.05, .3, 100.}) {
    OutlinePair pair(split(samples::block(-3, -1, 3, 0).vertices(), 24),
                     {{-.5, .02}, {.1, -.03}, {.6, .01}, {.5, 1}, {-.5, 1}}, .2, .2);
    DeformableFriction friction = friction_of_two(mu, .6);
    const size_t first = 2 * pair.a.size();
    std::vector<double> v(pair.force.size());
    double work = 0, loss = 0, size = 0;
    Vec2 before = Vec2::Zero();
    for (int step = 0; step < 4000; ++step) {
      const double t = step * dt;
      const double vx = .3 * std::cos(5 * t), vy = .05 * std::cos(9 * t + 1);
      for (size_t i = first; i < v.size(); i += 2) v[i] = vx, v[i + 1] = vy;
      for (size_t i = first; i < v.size(); ++i) pair.displacement[i] += dt * v[i];
      pair.evaluate();
      // Half the work by the force before, half by the force after the slip.
      friction.update(pair.contact, v, {}, dt);
      const auto on = friction.resultant(pair.contact, 1);
      work -= dt / 2 * (on.force + before).dot(Vec2(vx, vy));
      before = on.force;
      CHECK(friction.memory().friction_loss >= loss - 1e-6 * size);
      loss = friction.memory().friction_loss;
      size = std::max({size, loss, friction.memory().energy});
    }
    CAPTURE(mu, work, loss, friction.memory().energy);
    CHECK(size > 0);
    CHECK(std::abs(work - loss - friction.memory().energy) < 5e-3 * size);
  }
}

TEST_CASE("bodies without friction cost and feel none", "[deformable_friction]") {
  samples::Random random(33);
  std::optional<OutlinePair> pair;
  while (!(pair = random_pair(random, 8, .6))) {
  }
  DeformableFriction friction({{0, 1}, 2, {{.5, 1}, {0, 0}, {0, 0}, {.5, 1}}});
  friction.update(pair->contact, random_velocities(random, pair->force.size()), {}, 1);
  CHECK(friction.memory().slips.empty());
  CHECK(spring_sum(friction) == 0);
}

TEST_CASE("friction of a rigid body: memory restored, springs lost with the contact",
          "[deformable_friction]") {
  const double d = .02;
  DeformableContact contact(1, 1, .05, 1);
  add_ring(contact, split(samples::block(0, 0, 1, .5).vertices(), 4), 0, .1);
  contact.add_rigid(samples::block(-2, -.5, 2, .5).vertices(), 0, .5);
  const std::vector<double> u(32), still(32);
  std::vector<double> position{.3, d - .5, 0};
  contact.update(u, position);
  contact.evaluate();
  DeformableFriction friction = friction_of_two(.5, .5);
  friction.update(contact, still, std::vector<double>{1e-3, 0, 0}, 1);
  // Stick: both bodies in turn, k_s (l/r_t + l/r_c) times the slip along the faces of the floor and
  // the block's bottom; its sides do not slip along themselves.
  const auto on_floor = friction.resultant(contact, 1);
  double both = 0;
  for (const EdgeSlip& slip : friction.memory().slips) both += slip.stiffness;
  const double along = .5 * ((1 + 2 * d) / .5 + (1 - 2 * d) / .1);
  CHECK(both == Approx(along + .5 * 2 * d / .1));
  CHECK(on_floor.force.x() == Approx(-1e-3 * along).epsilon(1e-10));
  const auto on_block = friction.resultant(contact, 0);
  CHECK(on_block.force.x() == Approx(1e-3 * along).epsilon(1e-10));
  // Moment about the world's origin: that of the rigid body is about its centre.
  const double moment =
      on_floor.moment + position[0] * on_floor.force.y() - position[1] * on_floor.force.x();
  CHECK(std::abs(moment + on_block.moment) < 1e-15);

  DeformableFriction other = friction_of_two(.5, .5);
  other.restore(friction.memory());
  other.update(contact, still, std::vector<double>{1e-3, 0, 0}, 0);
  std::vector<double> forces(32), again(32);
  friction.add_forces(contact, forces);
  other.add_forces(contact, again);
  CHECK((forces == again));
  CHECK(other.resultant(contact, 1).moment == on_floor.moment);
  CHECK(other.memory().friction_loss == friction.memory().friction_loss);

  const double energy = friction.memory().energy;
  CHECK(energy == Approx(along * 1e-6 / 2).epsilon(1e-10));
  position[1] = -.6;
  contact.update(u, position);
  contact.evaluate();
  friction.update(contact, still, std::vector<double>{0, 0, 0}, 1);
  CHECK(friction.memory().slips.empty());
  CHECK(friction.memory().friction_loss == Approx(energy).epsilon(1e-14));
  CHECK(friction.memory().energy == 0);
}
