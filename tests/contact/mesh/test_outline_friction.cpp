// Friction per boundary edge: momentum, objectivity, stick, slip, ledger.
#include <catch2/catch.hpp>

#include "lib/run/json_archive.hpp"
#include "tests/contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

void move_at_random(samples::Random& random, std::vector<double>& velocity) {
  for (double& v : velocity) v = random.uniform(-1, 1);
}

Vec2 friction_on(const Bodies& bodies, BodyIndex body) {
  return on_body(bodies.contacts->records(), body, &ContactRecord::tangential);
}
Vec2 normal_on(const Bodies& bodies, BodyIndex body) {
  return on_body(bodies.contacts->records(), body, &ContactRecord::normal);
}

}  // namespace

TEST_CASE("friction of outlines keeps linear and angular momentum", "[outline_friction][contact]") {
  test::SeededRandom random(31);
  double worst = 0;
  int pairs = 0;
  for (int i = 0; i < scaled(1000); ++i) {
    auto pair =
        random_pair(random, random.integer(3, 12), random.uniform(.3, 1.2), law_of(1, {.7, 2}));
    if (!pair) continue;
    ++pairs;
    const std::vector<double> normal = pair->node_force;
    move_at_random(random, pair->node_velocity);
    pair->update_friction(.01);
    const double size = spring_sum(*pair->contacts);
    REQUIRE(size > 0);
    const OutlineSurfaces& o = pair->contacts->surfaces().outlines();
    Vec2 sum = Vec2::Zero();
    double moment = 0, largest = 0;
    for (int k = 0; k < o.size(); ++k) {
      const size_t x = 2 * static_cast<size_t>(o.node[k]);
      const Vec2 friction = pair->on_node(o.node[k]) - Vec2(normal[x], normal[x + 1]);
      sum += friction;
      moment += cross(o.point(k), friction);
      largest = std::max(largest, friction.norm());
    }
    REQUIRE(largest > 0);
    worst = std::max(worst, sum.norm() / size);
    worst = std::max(worst, std::abs(moment) / size);
  }
  CHECK(pairs > 0);
  CAPTURE(worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("rigid motion of the pair as a whole is no slip", "[outline_friction][contact]") {
  test::SeededRandom random(32);
  for (int i = 0; i < scaled(200); ++i) {
    auto pair = random_pair(random, 8, .6, law_of(1, {10, 1}));
    if (!pair) continue;
    const OutlineSurfaces& o = pair->contacts->surfaces().outlines();
    const Vec2 drift(random.uniform(-1, 1), random.uniform(-1, 1));
    const double spin = random.uniform(-1, 1);
    for (int k = 0; k < o.size(); ++k) {
      const Vec2 at = drift + cross(spin, Vec2(o.x[k], o.y[k]));
      pair->node_velocity[2 * o.node[k]] = at.x(), pair->node_velocity[2 * o.node[k] + 1] = at.y();
    }
    pair->update_friction(1);
    REQUIRE_FALSE(pair->contacts->friction().springs().empty());
    double stiffest = 0;  // where pushes cancel a spring has hardly any stiffness
    for (const Spring& s : pair->contacts->friction().springs())
      stiffest = std::max(stiffest, s.stiffness);
    for (const Spring& s : pair->contacts->friction().springs())
      CHECK(std::abs(s.force) < 1e-13 * stiffest);
  }
}

TEST_CASE("a block dragged over a row of edges meets mu times the normal force",
          "[outline_friction][contact]") {
  const double d = .05, mu = .3, dt = 1e-3, speed = .5;
  OutlinePair pair(split(samples::block(-3, -1, 3, 0).vertices(), 30),
                   split(samples::block(-.5, -d, .5, 1 - d).vertices(), 7), .2, .2,
                   law_of(1, {mu, .6}));
  const size_t nodes_a = pair.a.size();
  std::vector<double>& v = pair.node_velocity;
  for (size_t i = 2 * nodes_a; i < v.size(); i += 2) v[i] = speed;
  double least = 1;
  for (int step = 0; step < 2000; ++step) {
    for (size_t i = 2 * nodes_a; i < v.size(); i += 2) pair.displacement[i] += dt * speed;
    pair.evaluate();
    pair.update_friction(dt);
    const double share = -friction_on(pair, 1).x() / (mu * normal_on(pair, 1).y());
    // At the ends the neighbourhoods reach around the corners, and hold a part of the flanks.
    CHECK(share <= 1.003);
    if (step > 1000) least = std::min(least, share);
  }
  CAPTURE(least);
  CHECK(least > .98);
  // What the drive has put in is lost or in the springs.
  CHECK(pair.contacts->friction_loss() > 0);
}

TEST_CASE("friction gives back no more than it was given", "[outline_friction][contact]") {
  // Prescribed motion, normal and tangential, that comes and goes: the work done on the springs is
  // their energy and the loss, and the loss never falls.
  const double dt = 1e-3;
  for (const double mu : {.05, .3, 100.}) {
    OutlinePair pair(split(samples::block(-3, -1, 3, 0).vertices(), 24),
                     {{-.5, .02}, {.1, -.03}, {.6, .01}, {.5, 1}, {-.5, 1}}, .2, .2,
                     law_of(1, {mu, .6}));
    const FrictionMemory& memory = pair.contacts->friction();
    const size_t first = 2 * pair.a.size();
    std::vector<double>& v = pair.node_velocity;
    double work = 0, loss = 0, size = 0;
    Vec2 before = Vec2::Zero();
    for (int step = 0; step < 4000; ++step) {
      const double t = step * dt;
      const double vx = .3 * std::cos(5 * t), vy = .05 * std::cos(9 * t + 1);
      for (size_t i = first; i < v.size(); i += 2) v[i] = vx, v[i + 1] = vy;
      for (size_t i = first; i < v.size(); ++i) pair.displacement[i] += dt * v[i];
      pair.evaluate();
      // Half the work by the force before, half by the force after the slip.
      pair.update_friction(dt);
      const Vec2 on = friction_on(pair, 1);
      work -= dt / 2 * (on + before).dot(Vec2(vx, vy));
      before = on;
      CHECK(memory.loss() >= loss - 1e-6 * size);
      loss = memory.loss();
      size = std::max({size, loss, memory.energy()});
    }
    CAPTURE(mu, work, loss, memory.energy());
    CHECK(size > 0);
    CHECK(std::abs(work - loss - memory.energy()) < 5e-3 * size);
  }
}

TEST_CASE("bodies without friction cost and feel none", "[outline_friction][contact]") {
  ContactLaw law = law_of(1, {.5, 1});  // of each material on itself
  law.rules = {{{{{false, 0}, {false, 1}}}, Friction{}}};
  samples::Random random(33);
  std::optional<OutlinePair> pair;
  while (!(pair = random_pair(random, 8, .6, law, {0, 1}))) {
  }
  const std::vector<double> normal = pair->node_force;
  move_at_random(random, pair->node_velocity);
  pair->update_friction(1);
  CHECK(pair->contacts->friction().springs().empty());
  CHECK(spring_sum(*pair->contacts) == 0);
  CHECK((pair->node_force == normal));
}

TEST_CASE("friction of a rigid body: memory restored, springs lost with the contact",
          "[outline_friction][contact]") {
  const double d = .02;
  const auto block_on_floor = [&] {
    Bodies bodies(law_of(1, {.5, .5}), .05);
    bodies.add_rigid(about_centre(samples::block(-2, -.5, 2, .5)), {.3, d - .5, 0});
    bodies.add_ring(split(samples::block(0, 0, 1, .5).vertices(), 4), .1);
    bodies.join();
    bodies.evaluate();
    return bodies;
  };
  Bodies bodies = block_on_floor();
  bodies.pose_rate = {1e-3, 0, 0};
  bodies.update_friction(1);
  const FrictionMemory& memory = bodies.contacts->friction();
  // Stick: both bodies in turn, k_s (l/r_t + l/r_c) times the slip along the faces of the floor and
  // the block's bottom. The block's sides count as far as they are near these and pressed with
  // them, less what their pushes cancel.
  double both = 0;
  for (const Spring& spring : memory.springs()) both += spring.stiffness;
  const double level = .5 * ((1 + 2 * d) / .5 + (1 - 2 * d) / .1);
  CHECK(both == Approx(level).epsilon(.005));
  const double along = -1e3 * friction_on(bodies, 0).x();
  CHECK(along == Approx(both).epsilon(.001));
  CHECK(bodies.on_rigid(0).force.x() == Approx(-1e-3 * along).epsilon(1e-10));
  CHECK(friction_on(bodies, 1).x() == Approx(1e-3 * along).epsilon(1e-10));
  CHECK(bodies.contacts->force_on(1).x() == Approx(1e-3 * along).epsilon(1e-10));
  // Moment about the world's origin: that of the rigid body is about its centre.
  const Resultant on_floor = bodies.on_rigid(0);
  double moment = on_floor.moment + cross(Vec2(bodies.pose[0], bodies.pose[1]), on_floor.force);
  const OutlineSurfaces& o = bodies.contacts->surfaces().outlines();
  for (int i = o.bodies[1].first; i < o.bodies[1].end; ++i) {
    moment += cross(o.point(i), bodies.on_node(o.node[i]));
  }
  CHECK(std::abs(moment) < 1e-15);

  JsonWriter writer;
  writer("contacts", *bodies.contacts);
  Bodies other = block_on_floor();
  const nlohmann::json json = writer.json();
  JsonLoader loader(json);
  loader("contacts", *other.contacts);
  other.pose_rate = bodies.pose_rate;
  other.contacts->refresh(other.kinematics());
  other.find_forces();
  CHECK((bodies.node_force == other.node_force));
  CHECK(other.on_rigid(0).moment == on_floor.moment);
  CHECK(other.contacts->friction_loss() == bodies.contacts->friction_loss());
  // The next step goes on where the springs are.
  Bodies twin = block_on_floor();
  twin.pose_rate = bodies.pose_rate;
  for (int step = 0; step < 2; ++step) twin.update_friction(1);
  other.update_friction(1);
  CHECK((other.node_force == twin.node_force));
  CHECK((other.rigid_force == twin.rigid_force));
  CHECK(other.contacts->friction_loss() == twin.contacts->friction_loss());

  const double energy = memory.energy();
  CHECK(energy == Approx(along * 1e-6 / 2).epsilon(1e-10));
  bodies.pose[1] = -.6;
  bodies.evaluate();
  bodies.pose_rate = {0, 0, 0};
  bodies.update_friction(1);
  CHECK(memory.springs().empty());
  CHECK(memory.loss() == Approx(energy).epsilon(1e-14));
  CHECK(memory.energy() == 0);
}
