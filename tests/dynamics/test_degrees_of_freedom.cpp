// The coordinates of rigid bodies and nodes: which of them forces can move, how they move in a
// step, and their masses, momenta and energies against sums by hand.
#include "lib/dynamics/degrees_of_freedom.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "lib/fem/finite_elements.hpp"
#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

constexpr int kFree = 0, kHeld = 1, kFixed = 2, kDriven = 3;  // the rigid bodies
const Vec2 kGravity(.5, -9.81);

// One rigid body of each kind, and a mesh of which nodes are free, held and driven: node 0 in both
// coordinates, node 1 in y, node 2 driven in x.
Model mixed() {
  Model model = model_of(block({1, .5}, {2, 1}, ElementKind::quad4), rock());
  model.gravity = kGravity;
  for (const Motion motion : {Motion::free, Motion::free, Motion::fixed, Motion::prescribed}) {
    RigidBody body;
    body.name = "body " + std::to_string(model.bodies.size());
    body.motion = motion;
    const Vec2 place(3. * static_cast<double>(model.bodies.size()), -2);
    set_shape(body, samples::shifted(quad_q(), place), model);
    body.angle = .1;
    model.bodies.push_back(body);
  }
  model.bodies[kFree].velocity = {1, 2};
  model.bodies[kFree].spin = 3;
  model.bodies[kHeld].held = {true, false, true};
  model.bodies[kHeld].velocity = {0, -4};
  model.bodies[kDriven].history.velocity = {{0, {2, 0}}, {1, {4, 1}}};
  model.bodies[kDriven].history.spin = {{0, .5}};
  DeformableBody& mesh = model.deformables[0];
  mesh.velocity = {5, 6};
  mesh.spin = 7;
  mesh.supports = {{{0}, {true, true}, {}}, {{1}, {false, true}, {}}, {{2}, {true, false}, {}}};
  mesh.supports[2].motion.velocity = {{0, {-1, 9}}, {2, {-3, 9}}};
  return model;
}

std::vector<double> node_masses(const Model& model) {
  const DeformableBody& body = model.deformables[0];
  return FiniteElements(
             std::vector<ElementSet>{{body.element, &body.mesh, 0, rock().elastic, 2000, 1, 0}}, 1)
      .mass();
}

struct Mixed {
  Model model = mixed();
  std::vector<double> mass = node_masses(model);
  DegreesOfFreedom dofs{model, mass};
  State state = dofs.start();

  [[nodiscard]] size_t rigid(int body, int axis) const {
    return state.layout.rigid(body) + static_cast<size_t>(axis);
  }
  [[nodiscard]] size_t node(int node, int axis) const {
    return state.layout.node(node) + static_cast<size_t>(axis);
  }
  [[nodiscard]] std::vector<size_t> coordinates() const {
    std::vector<size_t> all(state.layout.size());
    for (size_t c = 0; c < all.size(); ++c) all[c] = c;
    return all;
  }
  // Those that forces cannot move.
  [[nodiscard]] std::vector<size_t> immovable() const {
    return {rigid(kHeld, 0),  rigid(kHeld, 2),   rigid(kFixed, 0),  rigid(kFixed, 1),
            rigid(kFixed, 2), rigid(kDriven, 0), rigid(kDriven, 1), rigid(kDriven, 2),
            node(0, 0),       node(0, 1),        node(1, 1),        node(2, 0)};
  }
  [[nodiscard]] bool moves(size_t coordinate) const {
    const std::vector<size_t> not_these = immovable();
    return std::find(not_these.begin(), not_these.end(), coordinate) == not_these.end();
  }
  // Anything, so that a wrong index shows.
  void scatter() {
    samples::Random random(3);
    for (std::vector<double>* values : {&state.x, &state.v, &state.f}) {
      for (double& value : *values) value = random.uniform(-1, 1);
    }
  }
};

}  // namespace

TEST_CASE("bodies start where the scene puts them, with its velocities", "[dofs]") {
  const Mixed m;
  CHECK(m.state.layout.rigid_bodies == 4);
  CHECK(m.state.layout.nodes == 6);
  CHECK(m.dofs.layout().size() == m.state.layout.size());
  for (int i = 0; i < 4; ++i) {
    const Vec2& place = m.model.bodies[i].position;
    CHECK(m.state.pose(i) == Eigen::Vector3d(place.x(), place.y(), .1));
  }
  CHECK(m.state.pose_rate(kFree) == Eigen::Vector3d(1, 2, 3));
  CHECK(m.state.pose_rate(kHeld) == Eigen::Vector3d(0, -4, 0));
  CHECK(m.state.pose_rate(kFixed) == Eigen::Vector3d::Zero());
  CHECK(m.state.pose_rate(kDriven) == Eigen::Vector3d(2, 0, .5));
  const std::vector<Vec2>& nodes = m.model.deformables[0].mesh.nodes;
  const Vec2 centre(.5, .25);
  for (int i = 0; i < 6; ++i) {
    CHECK(m.state.node(i) == Vec2::Zero());
    Vec2 v = Vec2(5, 6) + cross(7, Vec2(nodes[i] - centre));
    if (i == 0) v = Vec2::Zero();
    if (i == 1) v.y() = 0;
    if (i == 2) v.x() = -1;
    CHECK((m.state.node_velocity(i) - v).norm() < 1e-14);
  }
}

TEST_CASE("forces move free coordinates only", "[dofs]") {
  const Mixed m;
  for (const size_t c : m.coordinates()) {
    CAPTURE(c);
    CHECK(m.dofs.can_move(c) == m.moves(c));
    CHECK(m.dofs.mass(c) > 0);
    CHECK(m.dofs.inverse_mass()[c] == (m.moves(c) ? 1 / m.dofs.mass(c) : 0));
  }
  for (int i = 0; i < 4; ++i) {
    CHECK(m.dofs.mass(m.rigid(i, 0)) == m.model.bodies[i].mass);
    CHECK(m.dofs.mass(m.rigid(i, 1)) == m.model.bodies[i].mass);
    CHECK(m.dofs.mass(m.rigid(i, 2)) == m.model.bodies[i].inertia);
  }
  for (int i = 0; i < 6; ++i) {
    CHECK(m.dofs.mass(m.node(i, 0)) == m.mass[i]);
    CHECK(m.dofs.mass(m.node(i, 1)) == m.mass[i]);
  }
  const std::vector<double> free = m.dofs.free_node_mass();
  REQUIRE(free.size() == 6);
  CHECK(free[0] == 0);
  for (int i = 1; i < 6; ++i) CHECK(free[i] == m.mass[i]);
}

TEST_CASE("a kick changes velocities by force over mass and gravity", "[dofs]") {
  Mixed m;
  m.scatter();
  const State before = m.state;
  const double h = .125;
  m.dofs.kick(m.state, h);
  CHECK(m.state.x == before.x);
  CHECK(m.state.f == before.f);
  const size_t rigid = m.state.layout.node(0);
  for (const size_t c : m.coordinates()) {
    CAPTURE(c);
    const size_t axis = c < rigid ? c % 3 : (c - rigid) % 2;
    const double gravity = axis < 2 ? kGravity[static_cast<int>(axis)] : 0;
    const double gain = m.moves(c) ? h * (before.f[c] / m.dofs.mass(c) + gravity) : 0;
    CHECK(m.state.v[c] - before.v[c] == Approx(gain).margin(1e-15));
  }
}

TEST_CASE("without gravity a kick is by forces alone", "[dofs]") {
  Model model = mixed();
  model.gravity = Vec2::Zero();
  const std::vector<double> mass = node_masses(model);
  const DegreesOfFreedom dofs(model, mass);
  CHECK(dofs.acceleration().empty());
  CHECK(dofs.weight().empty());
  State state = dofs.start();
  const std::vector<double> before = state.v;
  dofs.kick(state, 1);
  CHECK(state.v == before);
  CHECK(dofs.gravity_energy(state) == 0);
  CHECK(dofs.weight_sum(state).y == 0);
}

TEST_CASE("a drift moves what forces can move, and leads driven coordinates to their goal",
          "[dofs]") {
  Mixed m;
  m.scatter();
  const double dt = .25;
  // Wherever rounding has left it, a driven coordinate arrives where its motion says.
  m.dofs.place_driven(m.state);
  m.state.time = dt;
  const State before = m.state;
  m.dofs.steer(m.state, dt);
  m.dofs.drift(m.state, dt);
  for (const size_t c : m.coordinates()) {
    CAPTURE(c);
    if (m.moves(c)) CHECK(m.state.x[c] == Approx(before.x[c] + dt * before.v[c]).epsilon(1e-15));
  }
  CHECK(m.state.pose(kFixed) == before.pose(kFixed));
  CHECK(m.state.x[m.rigid(kHeld, 0)] == before.x[m.rigid(kHeld, 0)]);
  CHECK(m.state.x[m.rigid(kHeld, 2)] == before.x[m.rigid(kHeld, 2)]);
  // From 2 to 2.5 in x, and from 0 to .25 in y, within the quarter of a second.
  const Vec2& start = m.model.bodies[kDriven].position;
  CHECK(m.state.pose(kDriven)[0] == Approx(start.x() + dt * 2.25).epsilon(1e-15));
  CHECK(m.state.pose(kDriven)[1] == Approx(start.y() + dt * .125).epsilon(1e-15));
  CHECK(m.state.pose(kDriven)[2] == Approx(.1 + dt * .5).epsilon(1e-15));
  CHECK(m.state.node(2).x() == Approx(-dt * 1.125).epsilon(1e-15));
  // On the way their velocity is the mean one; at the end it is that of the motion.
  CHECK(m.state.pose_rate(kDriven)[0] == Approx(2.25).epsilon(1e-13));
  CHECK(m.state.node_velocity(2).x() == Approx(-1.125).epsilon(1e-13));
  m.dofs.follow(m.state);
  CHECK(m.state.pose_rate(kDriven)[0] == 2.5);
  CHECK(m.state.pose_rate(kDriven)[1] == .25);
  CHECK(m.state.pose_rate(kDriven)[2] == .5);
  CHECK(m.state.node_velocity(2).x() == -1.25);
}

TEST_CASE("driven coordinates are those with a motion, and no others", "[dofs]") {
  Mixed m;
  const std::vector<DegreesOfFreedom::Driven>& driven = m.dofs.driven();
  REQUIRE(driven.size() == 4);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(driven[axis].coordinate == m.rigid(kDriven, axis));
    CHECK(driven[axis].axis == axis);
  }
  CHECK(driven[3].coordinate == m.node(2, 0));
  CHECK(driven[3].axis == 0);
  // Moves of a whole load step: the motion from one time to another.
  m.state.time = .5;
  m.dofs.plan_moves(m.state, 1);
  CHECK(driven[0].move == Approx(.5 * 3.5).epsilon(1e-14));
  CHECK(driven[1].move == Approx(.5 * .75).epsilon(1e-14));
  CHECK(driven[2].move == Approx(.25).epsilon(1e-14));
  CHECK(driven[3].move == Approx(-.5 * 1.75).epsilon(1e-14));
}

TEST_CASE("a million steps at constant velocity arrive where one would", "[dofs]") {
  Mixed m;
  const int steps = scaled(1000000);
  const double dt = .1 / 3;
  const Eigen::Vector3d start = m.state.pose(kFree);
  for (int i = 0; i < steps; ++i) m.dofs.drift(m.state, dt);
  for (int k = 0; k < 3; ++k) {
    const long double there =
        start[k] + static_cast<long double>(steps) * dt * m.state.pose_rate(kFree)[k];
    CHECK(std::abs(static_cast<double>(m.state.pose(kFree)[k] - there)) < 1e-15 * double(there));
  }
}

TEST_CASE("kinetic energy is the sum of m v^2/2 over what forces can move", "[dofs]") {
  Mixed m;
  m.scatter();
  double sum = 0;
  for (const size_t c : m.coordinates()) {
    if (m.moves(c)) sum += m.dofs.mass(c) * m.state.v[c] * m.state.v[c] / 2;
  }
  CHECK(m.dofs.kinetic(m.state) == Approx(sum).epsilon(1e-14));
  CHECK(sum > 0);
}

TEST_CASE("momentum is the sum over bodies and nodes by hand", "[dofs]") {
  Mixed m;
  m.scatter();
  const auto free = [&](size_t c) { return m.moves(c) ? m.dofs.mass(c) * m.state.v[c] : 0; };
  Vec2 sum = Vec2::Zero();
  double angular = 0;
  for (int i = 0; i < 4; ++i) {
    const Vec2 p(free(m.rigid(i, 0)), free(m.rigid(i, 1)));
    sum += p;
    angular += cross(Vec2(m.state.pose(i).head<2>()), p) + free(m.rigid(i, 2));
  }
  for (int i = 0; i < 6; ++i) {
    const Vec2 p(free(m.node(i, 0)), free(m.node(i, 1)));
    sum += p;
    angular += cross(Vec2(m.model.deformables[0].mesh.nodes[i] + m.state.node(i)), p);
  }
  const Impulse found = m.dofs.momentum(m.state);
  CHECK(found.x == Approx(sum.x()).epsilon(1e-13));
  CHECK(found.y == Approx(sum.y()).epsilon(1e-13));
  CHECK(found.angular == Approx(angular).epsilon(1e-13));
}

TEST_CASE("an impulse on a coordinate turns about the origin of the model", "[dofs]") {
  Mixed m;
  m.scatter();
  const double j = 2.5;
  for (int i = 0; i < 4; ++i) {
    const Vec2 place = m.state.pose(i).head<2>();
    const Impulse x = m.dofs.impulse(m.state, m.rigid(i, 0), j);
    CHECK(x.x == j);
    CHECK(x.y == 0);
    CHECK(x.angular == -place.y() * j);
    const Impulse y = m.dofs.impulse(m.state, m.rigid(i, 1), j);
    CHECK(y.x == 0);
    CHECK(y.y == j);
    CHECK(y.angular == place.x() * j);
    const Impulse turn = m.dofs.impulse(m.state, m.rigid(i, 2), j);
    CHECK(turn.x == 0);
    CHECK(turn.y == 0);
    CHECK(turn.angular == j);
  }
  for (int i = 0; i < 6; ++i) {
    const Vec2 place = m.model.deformables[0].mesh.nodes[i] + m.state.node(i);
    const Impulse x = m.dofs.impulse(m.state, m.node(i, 0), j);
    CHECK(x.x == j);
    CHECK(x.y == 0);
    CHECK(x.angular == -place.y() * j);
    const Impulse y = m.dofs.impulse(m.state, m.node(i, 1), j);
    CHECK(y.x == 0);
    CHECK(y.y == j);
    CHECK(y.angular == place.x() * j);
  }
}

TEST_CASE("bodies that are slowed down give off energy and momentum", "[dofs]") {
  const double rest = .75;
  // All bodies, the rigid ones, and nodes from the second one on, so that some are left over.
  for (const auto& [from, to] : {std::pair(0, 24), std::pair(0, 12), std::pair(14, 24)}) {
    Mixed m;
    m.scatter();
    const State before = m.state;
    const auto first = static_cast<size_t>(from), end = static_cast<size_t>(to);
    const DegreesOfFreedom::Braked lost = m.dofs.brake(m.state, first, end, rest);
    double energy = 0;
    Impulse impulse;
    for (size_t c = 0; c < before.v.size(); ++c) {
      const bool slowed = c >= first && c < end && m.dofs.can_move(c);
      CHECK(m.state.v[c] == (slowed ? rest * before.v[c] : before.v[c]));
      if (!slowed) continue;
      const double change = m.state.v[c] - before.v[c];
      energy -= m.dofs.mass(c) * change * (before.v[c] + m.state.v[c]) / 2;
      impulse.add(m.dofs.impulse(before, c, m.dofs.mass(c) * change));
    }
    CHECK(lost.energy == Approx(energy).epsilon(1e-13));
    CHECK(lost.impulse.x == Approx(impulse.x).epsilon(1e-13));
    CHECK(lost.impulse.y == Approx(impulse.y).epsilon(1e-13));
    CHECK(lost.impulse.angular == Approx(impulse.angular).epsilon(1e-13));
  }
}

TEST_CASE("what holds a coordinate takes the force on it", "[dofs]") {
  Mixed m;
  m.scatter();
  const double h = .125;
  Impulse sum{1, 2, 3};
  m.dofs.add_reactions(m.state, h, sum);
  Impulse expected{1, 2, 3};
  for (const size_t c : m.immovable()) {
    expected.add(m.dofs.impulse(m.state, c, -h * m.state.f[c]));
  }
  CHECK(sum.x == Approx(expected.x).epsilon(1e-14));
  CHECK(sum.y == Approx(expected.y).epsilon(1e-14));
  CHECK(sum.angular == Approx(expected.angular).epsilon(1e-14));
}

TEST_CASE("weight and its potential energy are those of what forces can move", "[dofs]") {
  Mixed m;
  CHECK(m.dofs.gravity_energy(m.state) == 0);
  const State start = m.state;
  m.scatter();
  Vec2 force = Vec2::Zero();
  double torque = 0, energy = 0;
  const auto add = [&](size_t first, const Vec2& place) {
    Vec2 weight = Vec2::Zero();
    for (int axis = 0; axis < 2; ++axis) {
      const size_t c = first + static_cast<size_t>(axis);
      if (m.moves(c)) weight[axis] = m.dofs.mass(c) * kGravity[axis];
      energy -= weight[axis] * (m.state.x[c] - start.x[c]);
    }
    force += weight;
    torque += cross(place, weight);
  };
  for (int i = 0; i < 4; ++i) add(m.rigid(i, 0), m.state.pose(i).head<2>());
  for (int i = 0; i < 6; ++i) {
    add(m.node(i, 0), m.model.deformables[0].mesh.nodes[i] + m.state.node(i));
  }
  const Impulse found = m.dofs.weight_sum(m.state);
  CHECK(found.x == Approx(force.x()).epsilon(1e-13));
  CHECK(found.y == Approx(force.y()).epsilon(1e-13));
  CHECK(found.angular == Approx(torque).epsilon(1e-12));
  CHECK(m.dofs.gravity_energy(m.state) == Approx(energy).epsilon(1e-12));
  REQUIRE(m.dofs.weight().size() == m.state.layout.size());
  for (const size_t c : m.coordinates()) {
    if (!m.moves(c)) CHECK(m.dofs.weight()[c] == 0);
  }
}

TEST_CASE("the torque of gravity is a sum over all bodies, the same for any number of threads",
          "[degrees_of_freedom][parallel]") {
  Model model;
  model.materials = {{"rock", 2000}};
  model.gravity = kGravity;
  RigidBody body;
  set_shape(body, quad_q(), model);
  for (const int count : {1, 63, 64, 65, 40000}) {
    CAPTURE(count);
    while (static_cast<int>(model.bodies.size()) < count) {
      const double k = static_cast<double>(model.bodies.size());
      body.position = {std::sin(k), 1e3 * std::cos(k * k)};
      model.bodies.push_back(body);
    }
    double torque = 0, size = 0;
    for (const RigidBody& b : model.bodies) {
      const Vec2 weight = b.mass * kGravity;
      torque += b.position.x() * weight.y() - b.position.y() * weight.x();
      size += b.position.norm() * weight.norm();
    }
    double one = 0;
    for (const int threads : {1, 2, 3, 7}) {
      const DegreesOfFreedom dofs(model, {}, threads);
      const Impulse sum = dofs.weight_sum(dofs.start());
      CHECK(std::abs(sum.angular - torque) < 1e-12 * size);
      CHECK(sum.x == Approx(count * body.mass * kGravity.x()));
      if (threads == 1) one = sum.angular;
      CHECK(sum.angular == one);
    }
  }
}
