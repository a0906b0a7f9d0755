// Modes of scenes against closed forms, dense algebra and runs in time.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "lib/dynamics/modes.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/select.hpp"
#include "tests/dynamics/surface_models.hpp"
#include "tests/fem/meshes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace vibration {
namespace {

constexpr double kYoung = 1e9, kDensity = 1000;

// A beam along y, x from 0 to its width, clamped at y = 0 unless it is free.
Model beam(double width, double length, int across, int along, ElementKind kind, bool clamped,
           double poisson = 0, Plane plane = Plane::stress) {
  Model model = empty_model();
  model.materials = {{"m", kDensity, {ElasticLaw::st_venant_kirchhoff, plane, kYoung, poisson}}};
  const ElementShape shape =
      kind == ElementKind::tri3 ? ElementShape::triangle : ElementShape::quadrilateral;
  add(model, "beam", rectangle_mesh({width, length}, {across, along}, {0, 0}, shape), kind, {0, 0});
  DeformableBody& body = model.deformables[0];
  if (clamped) body.supports = {{nodes_where(body.mesh, {.y = 0}), {true, true}, {}}};
  return model;
}

void press(Model& model, double length, double force) {
  DeformableBody& body = model.deformables[0];
  DeadLoad load{nodes_where(body.mesh, {.y = length}), {}, {{{0, 0}, {1, 1}}}};
  // Half the load of a node at the ends.
  const double part = force / static_cast<double>(load.nodes.size() - 1);
  for (const int node : load.nodes) {
    const double x = body.mesh.nodes[node].x();
    bool inner = false;
    for (const int other : load.nodes) inner = inner || body.mesh.nodes[other].x() < x - 1e-9;
    bool outer = false;
    for (const int other : load.nodes) outer = outer || body.mesh.nodes[other].x() > x + 1e-9;
    load.forces.emplace_back(0, -part * (inner && outer ? 1 : .5));
  }
  body.dead_loads = {load};
}

SceneModes modes_at_start(const Model& model, int count, bool settled = false) {
  TimeSettings time;
  time.end = 1;
  time.settled = settled;
  Simulation simulation(model, time, 1, 1);
  return modes_of(linearised(simulation).value(), count);
}

// By bisection.
template <class F>
double root(const F& f, double low, double high) {
  const bool rises = f(high) > 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return low;
}

// The lowest frequency of a clamped beam with shear and rotatory inertia, 1/s (T. C. Huang, J.
// Appl. Mech. 28 (1961), 579), shear factor 5/6.
double timoshenko(double width, double length, double poisson) {
  const double r2 = width * width / 12 / (length * length);
  const double s2 = r2 * 2 * (1 + poisson) / (5. / 6);
  const auto f = [&](double b) {
    const double wide = std::sqrt((r2 - s2) * (r2 - s2) + 4 / (b * b));
    const double a = std::sqrt((wide - (r2 + s2)) / 2), c = std::sqrt((wide + (r2 + s2)) / 2);
    return 2 + (b * b * (r2 - s2) * (r2 - s2) + 2) * std::cosh(b * a) * std::cos(b * c) -
           b * (r2 + s2) / std::sqrt(1 - b * b * r2 * s2) * std::sinh(b * a) * std::sin(b * c);
  };
  return root(f, 1, 4) * std::sqrt(r2 * kYoung / kDensity) / length;
}

// The lowest w^2 of a clamped beam under the end load P, which keeps its direction, in parts of
// that without load: EI w'''' + P w'' = m w^2 w by the determinant of the ends' conditions.
double loaded_beam(double share) {
  const double p = share * M_PI * M_PI / 4;  // P L^2 / EI
  const auto f = [&](double lambda) {        // w^2 m L^4 / EI
    const double wide = std::sqrt(p * p / 4 + lambda);
    const double a = std::sqrt(wide - p / 2), c = std::sqrt(wide + p / 2);  // cosh a x, cos c x
    // w = A (cosh ax - cos cx) + B (sinh ax - (a/c) sin cx)
    const double ch = std::cosh(a), sh = std::sinh(a), co = std::cos(c), si = std::sin(c);
    const double moment_a = a * a * ch + c * c * co, moment_b = a * a * sh + a * c * si;
    const double shear_a = a * a * a * sh - c * c * c * si + p * (a * sh + c * si);
    const double shear_b = a * a * a * ch + a * c * c * co + p * (a * ch - a * co);
    return moment_a * shear_b - moment_b * shear_a;
  };
  return root(f, 1e-9, 13) / std::pow(1.8751040687119611, 4);
}

}  // namespace
}  // namespace vibration

TEST_CASE("a free bar vibrates as the chain of its lumped masses", "[vibration]") {
  constexpr int kCells = 20;
  constexpr double kLength = 3;
  const double h = kLength / kCells, c = std::sqrt(vibration::kYoung / vibration::kDensity);
  for (const ElementKind kind : {ElementKind::quad4, ElementKind::quad4_full}) {
    const Model model = vibration::beam(.1, kLength, 1, kCells, kind, false);
    const SceneModes all = vibration::modes_at_start(model, 1000);
    CHECK(all.rigid == 3);
    CHECK(all.unstable == 0);
    CHECK(all.modes.size() == 4 * (kCells + 1));
    for (int k = 1; k <= kCells; ++k) {
      const double w = 2 * c / h * std::sin(k * M_PI / (2 * kCells));
      double nearest = HUGE_VAL;
      for (const SceneMode& mode : all.modes) {
        nearest = std::min(nearest, std::abs(2 * M_PI * mode.frequency() / w - 1));
      }
      CAPTURE(k);
      CHECK(nearest < 1e-10);
    }
  }
}

TEST_CASE("the frequency of a clamped beam converges with the square of the mesh size",
          "[vibration]") {
  constexpr double kWidth = .5, kLength = 5, kPoisson = .2;
  const double exact = vibration::timoshenko(kWidth, kLength, kPoisson);
  // Bernoulli's beam, to which the shear adds a little.
  const double slender = std::pow(1.8751040687119611, 2) * kWidth / std::sqrt(12.) *
                         std::sqrt(vibration::kYoung / vibration::kDensity) / (kLength * kLength);
  CHECK(exact == Approx(slender).epsilon(.01));
  CHECK(exact < slender);
  const auto error = [&](ElementKind kind, int cells) {
    const SceneModes found = vibration::modes_at_start(
        vibration::beam(kWidth, kLength, cells, 10 * cells, kind, true, kPoisson), 1);
    return 2 * M_PI * found.modes[0].frequency() / exact - 1;
  };
  // Q4 does not lock: four cells across give what a beam of the plane has beyond Timoshenko's.
  const double four = error(ElementKind::quad4, 4), eight = error(ElementKind::quad4, 8);
  CHECK(std::abs(four) < 1e-3);
  CHECK(std::abs(four - eight) < 2e-5);
  for (const auto& [kind, most] :
       {std::pair(ElementKind::tri3, .08), std::pair(ElementKind::quad4_full, .02)}) {
    const double coarse = error(kind, 4) - eight, fine = error(kind, 8) - eight;
    CAPTURE(static_cast<int>(kind));
    CHECK(coarse < most);
    CHECK(fine > 0);
    CHECK(coarse / fine == Approx(4).epsilon(.05));
  }
}

TEST_CASE("a block that rests on a floor vibrates as on its contact springs", "[vibration]") {
  SeededRandom random(72);
  for (int n = 0; n < scaled(40); ++n) {
    const double width = random.uniform(.3, 2), height = random.uniform(.3, 2);
    const double mu = random.integer(0, 1) == 0 ? 0 : .5, ratio = random.uniform(.3, 1.2);
    Model model = empty_model();
    model.gravity = {0, -9.81};
    model.contact.normal_stiffness = 1e10;
    model.contact.friction = {mu, 0, ratio};
    model.thickness = random.uniform(.5, 2);
    const auto put = [&](const Polygon& polygon, Motion motion) {
      RigidBody body;
      body.name = motion == Motion::free ? "block" : "floor";
      body.motion = motion;
      set_shape(body, polygon, model);
      model.bodies.push_back(body);
    };
    put(samples::block(-3, -1, 3, 0), Motion::fixed);
    put(samples::block(-width / 2, 0, width / 2, height), Motion::free);
    const SceneModes found = vibration::modes_at_start(model, 3, true);
    const RigidBody& block = model.bodies[1];
    // Depth d gives k_n (1/r_a + 1/r_b) d per length.
    const double k =
        model.stiffness() * (block.potential.steepest + model.bodies[0].potential.steepest);
    const double k_y = k * width, k_t = mu > 0 ? ratio * k_y : 0, c = height / 2;
    const double weight = 9.81 * block.mass;
    Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero(), mass = stiffness;
    mass.diagonal() << block.mass, block.mass, block.inertia;
    stiffness << k_t, 0, k_t * c,  //
        0, k_y, 0,                 //
        k_t * c, 0, k * width * width * width / 12 + k_t * c * c - weight * c;
    const Eigen::Vector3d exact =
        Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d>(stiffness, mass).eigenvalues();
    CAPTURE(width, height, mu, ratio);
    CHECK(found.rigid == (mu > 0 ? 0 : 1));
    REQUIRE(found.modes.size() == 3);
    for (int i = found.rigid; i < 3; ++i) {
      CHECK(found.modes[static_cast<size_t>(i)].eigenvalue == Approx(exact[i]).epsilon(1e-5));
    }
  }
}

TEST_CASE("modes of mixed assemblies are those of dense algebra, and carry all mass",
          "[vibration]") {
  SeededRandom random(73);
  for (int n = 0; n < scaled(16); ++n) {
    Model model = empty_model();
    model.materials[0].elastic.young = 1e8;
    model.gravity = {0, -9.81};
    model.contact.normal_stiffness = 1e8;
    model.contact.friction = {random.integer(0, 1) == 0 ? 0 : .6, 0, .8};
    add_floor(model);
    double y = 0;
    const int blocks = random.integer(1, 3), meshed = random.integer(0, blocks);
    for (int i = 0; i <= blocks; ++i) {
      const double half = random.uniform(.6, .8) - .1 * i, height = random.uniform(.3, .5);
      if (i == meshed) {
        add(model, "mesh",
            rectangle_mesh({2 * half, height}, {7, 3}, {-half, y}, ElementShape::quadrilateral),
            random.integer(0, 1) == 0 ? ElementKind::quad4 : ElementKind::quad4_full, {0, 0});
      } else {
        RigidBody body;
        body.name = std::to_string(i);
        set_shape(body, samples::block(-half, y, half, y + height), model);
        model.bodies.push_back(body);
      }
      y += height;
    }
    TimeSettings time;
    time.end = 1;
    time.settled = true;
    Simulation simulation(model, time, 1, 1);
    const Linearised scene = linearised(simulation).value();
    CHECK(scene.contacts == blocks + 1);
    CHECK(scene.touching.empty());
    CHECK(scene.unbalanced < 1e-6);
    const auto size = static_cast<Eigen::Index>(scene.system.mass.size());
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(size, size);
    for (const Tangent::Entry& e : scene.tangent.entries()) k(e.row, e.column) += e.value;
    std::vector<int> which;
    Eigen::VectorXd root(size);
    for (Eigen::Index c = 0; c < size; ++c) {
      if (scene.system.moves[static_cast<size_t>(c)]) which.push_back(static_cast<int>(c));
      root[c] = std::sqrt(scene.system.mass[static_cast<size_t>(c)]);
    }
    const Eigen::MatrixXd half = root.cwiseInverse().asDiagonal() * ((k + k.transpose()) / 2) *
                                 root.cwiseInverse().asDiagonal();
    const Eigen::VectorXd exact =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(half(which, which)).eigenvalues();
    CAPTURE(n, blocks, meshed);
    for (const int count : {2, 1000}) {  // by sparse algebra where the mesh is large enough, or all
      const SceneModes found = modes_of(scene, count);
      CHECK(found.coordinates == static_cast<int>(which.size()));
      CHECK(found.unstable + found.rigid <= blocks + 1);  // what slides without friction
      std::array<double, 2> share{};
      for (size_t i = 0; i < found.modes.size(); ++i) {
        const SceneMode& mode = found.modes[i];
        // Of many unstable ones the first two are there.
        const size_t left_out =
            mode.kind == ModeKind::unstable ? 0 : std::max(0, found.unstable - count);
        const double off = mode.eigenvalue - exact[static_cast<Eigen::Index>(i + left_out)];
        const double error = std::abs(off) / exact[exact.size() - 1];
        CHECK(error < 1e-13);
        for (const size_t axis : {0, 1}) share[axis] += mode.share[axis];
      }
      if (count < 1000) continue;
      for (const size_t axis : {0, 1}) CHECK(share[axis] == Approx(1).epsilon(1e-10));
    }
  }
}

TEST_CASE("a strut under load vibrates more slowly, buckles at Euler's load and is unstable beyond",
          "[vibration]") {
  constexpr double kWidth = .05, kLength = 2, kPoisson = .3;
  const double modulus = vibration::kYoung / (1 - kPoisson * kPoisson);
  const double rigidity = modulus * kWidth * kWidth * kWidth / 12;
  const double euler = M_PI * M_PI * rigidity / (4 * kLength * kLength);
  double unloaded = 0;
  for (const double share : {1e-6, .5, .9, 1.01}) {
    Model model =
        vibration::beam(kWidth, kLength, 2, 80, ElementKind::quad4, true, kPoisson, Plane::strain);
    vibration::press(model, kLength, share * euler);
    TimeSettings time;
    time.statics = true;
    time.end = 1;
    time.load_steps = 2;
    Simulation simulation(model, time, 1, 1);
    const Linearised start = linearised(simulation).value();
    for (const double t : {.5, 1.}) simulation.balance(t);
    const Linearised end = linearised(simulation).value();
    const SceneModes found = modes_of(end, 3);
    CAPTURE(share);
    REQUIRE(found.modes.size() == 3);
    CHECK(found.rigid == 0);
    if (share < .1) unloaded = found.modes[0].eigenvalue;
    if (share < 1) {
      CHECK(found.unstable == 0);
      CHECK(found.modes[0].eigenvalue / unloaded ==
            Approx(vibration::loaded_beam(share)).margin(2e-3));
    } else {
      CHECK(found.unstable == 1);
      CHECK(found.modes[0].kind == ModeKind::unstable);
      CHECK(found.modes[0].growth_rate() > 0);
      CHECK(found.modes[0].frequency() == 0);
    }
    if (share < .1) continue;
    const SceneModes buckling = buckling_of(start, end, 2);
    REQUIRE(buckling.modes.size() == 2);
    CHECK(share * buckling.modes[0].eigenvalue == Approx(1).epsilon(2e-3));
    CHECK(share * buckling.modes[1].eigenvalue == Approx(9).epsilon(1e-2));
  }
}

TEST_CASE("a run that starts in a mode oscillates with its frequency", "[vibration]") {
  constexpr double kLength = 2;
  Model model = vibration::beam(.4, kLength, 2, 10, ElementKind::quad4, true, .2);
  const SceneModes found = vibration::modes_at_start(model, 3);
  for (const SceneMode& mode : found.modes) {
    double largest = 0;
    for (const double u : mode.shape) largest = std::max(largest, std::abs(u));
    model.deformables[0].displacement.clear();
    for (const double u : mode.shape) {
      model.deformables[0].displacement.push_back(1e-7 * kLength * u / largest);
    }
    model.deformables[0].node_velocity.assign(mode.shape.size(), 0);
    TimeSettings time;
    time.end = 1.1 * mode.period();
    time.element_safety = .2;
    Simulation simulation(model, time, 1, 1);
    // Half a period: where the generalised velocity changes its sign.
    const auto rate = [&] {
      double sum = 0;
      for (size_t c = 0; c < mode.shape.size(); ++c) {
        sum += simulation.degrees_of_freedom().mass(c) * mode.shape[c] * simulation.state().v[c];
      }
      return sum;
    };
    double before = 0, at = 0, now = 0;
    while (!(now > 0)) {
      before = now, at = simulation.state().time;
      simulation.step();
      now = rate();
      REQUIRE(simulation.state().time < .6 * mode.period());
    }
    const double half = at + (simulation.state().time - at) * before / (before - now);
    CHECK(2 * half == Approx(mode.period()).epsilon(1e-3));
  }
}

TEST_CASE("contacts that touch without pressing are named, and keep nothing", "[vibration]") {
  Model model = empty_model();
  add_floor(model);
  RigidBody block;
  block.name = "block";
  set_shape(block, samples::block(0, 0, 1, 1), model);
  model.bodies.push_back(block);
  TimeSettings time;
  time.end = 1;
  Simulation simulation(model, time, 1, 1);
  const Linearised scene = linearised(simulation).value();
  CHECK(scene.contacts == 0);
  REQUIRE(scene.touching.size() == 1);
  CHECK(scene.touching[0].a == 0);
  CHECK(scene.touching[0].b == 1);
  CHECK(modes_of(scene, 3).rigid == 3);
}

TEST_CASE("friction at its limit counts as sticking", "[vibration]") {
  // A block that slides on a slope in a settled start, and the same one at rest.
  std::vector<SceneModes> found;
  for (const double speed : {0., 1.}) {
    Model model = empty_model();
    model.contact.normal_stiffness = 1e9;
    model.contact.friction = {.2, 0, .8};
    model.gravity = {9.81 * .2 * (speed > 0 ? 1 : .5), -9.81};
    add_floor(model);
    RigidBody block;
    block.name = "block";
    set_shape(block, samples::block(0, 0, 1, 1), model);
    block.velocity = {speed, 0};
    model.bodies.push_back(block);
    found.push_back(vibration::modes_at_start(model, 3, true));
  }
  for (size_t i = 0; i < 3; ++i) {
    CHECK(found[0].rigid == 0);
    CHECK(found[1].rigid == 0);
    CHECK(found[1].modes[i].eigenvalue == Approx(found[0].modes[i].eigenvalue).epsilon(1e-3));
  }
}
