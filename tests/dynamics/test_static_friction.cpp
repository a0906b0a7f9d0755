// Static runs with friction: what is pulled, pressed and sheared follows its load history, whatever
// path the relaxation takes within a load step.
#include <fmt/format.h>

#include <Eigen/QR>
#include <catch2/catch.hpp>
#include <numbers>

#include "lib/dynamics/unstable.hpp"
#include "lib/mesh/fill_mesh.hpp"
#include "lib/mesh/half_disc_mesh.hpp"
#include "lib/mesh/mirror.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/reorder.hpp"
#include "lib/mesh/select.hpp"
#include "tests/dynamics/friction_models.hpp"
#include "tests/fem/static_solution.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

constexpr double kModulus = 20e9;

TimeSettings load_steps(int count, double end, double tolerance = 1e-7) {
  TimeSettings time;
  time.end = end;
  time.statics = true;
  time.load_steps = count;
  time.tolerance = tolerance;
  return time;
}

void run_load_steps(Simulation& simulation, const TimeSettings& time, int from, int until) {
  for (int i = from; i <= until; ++i) simulation.balance(time.end * i / time.load_steps);
}

// A force on the nodes along a straight side, from 0 to its value over a time of 1.
DeadLoad on_side(const DeformableBody& body, const Place& where, const Vec2& force) {
  DeadLoad load{{}, {}, {{{0, 0}, {1, 1}}}};
  double whole = 0;
  const auto length = [&](const MeshEdge& e) {
    return (body.mesh.nodes[e.nodes[1]] - body.mesh.nodes[e.nodes[0]]).norm();
  };
  for (const MeshEdge& e : edges_where(body.mesh, where)) whole += length(e);
  for (const MeshEdge& e : edges_where(body.mesh, where)) {
    for (const int node : e.nodes) {
      load.nodes.push_back(node);
      load.forces.emplace_back(length(e) / whole / 2 * force);
    }
  }
  return load;
}

// Moves from time 1 on with this velocity.
MotionHistory then_along(const Vec2& first, const Vec2& velocity) {
  MotionHistory motion;
  motion.velocity = {{0, first}, {1, first}, {1 + 1e-9, velocity}};
  return motion;
}

void number_nodes(Model& model) {
  int nodes = 0;
  for (DeformableBody& body : model.deformables) {
    body.first_node = nodes;
    nodes += static_cast<int>(body.mesh.nodes.size());
  }
}

constexpr double kWeight = 1e7;  // N
constexpr double kPull = 12e-3;  // m
constexpr double kFriction = .5;

// A block of 1 m x 0.1 m on a floor 1 m thick, pressed with a weight and pulled at its right side.
Model pulled_block(double spring) {
  Model model;
  model.materials = {
      {"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::strain, kModulus, .2}}};
  model.contact.normal_stiffness = 10 * kModulus;
  model.contact.friction = {kFriction, spring};
  add(model, "floor", samples::block(-2, -1, 3, 0), Motion::fixed);
  DeformableBody block;
  block.name = "block";
  block.mesh = rectangle_mesh({1, .1}, {20, 2}, {0, 0}, ElementShape::quadrilateral);
  block.supports = {{nodes_where(block.mesh, {.x = 1}), {true, false}, {}}};
  block.supports[0].motion = then_along({0, 0}, {kPull, 0});
  block.dead_loads = {on_side(block, {.y = .1}, {0, -kWeight})};
  model.deformables = {block};
  return model;
}

}  // namespace

TEST_CASE("a block is pulled until it slides", "[static_friction]") {
  constexpr double kSpring = 2e7;
  const Model model = pulled_block(kSpring);
  const TimeSettings time = load_steps(24, 2);
  Simulation simulation(model, time, 24, 1);
  run_load_steps(simulation, time, 1, 12);
  CHECK(simulation.contact_forces()[1].fy == Approx(kWeight).epsilon(1e-5));
  const double before = simulation.contact_forces()[1].fx;
  // Edges of the block slide on the floor and those of the floor on the block: the springs of both
  // lie under a rod.
  const double springs = kSpring * (1 / .5 + 1 / .025), rod = kModulus / (1 - .04) * .1;
  const double theory = std::sqrt(springs * rod) * std::tanh(std::sqrt(springs / rod));
  run_load_steps(simulation, time, 13, 14);
  const double pull = (before - simulation.contact_forces()[1].fx) / (kPull / 6);
  INFO("stiffness " << pull << " of " << theory << ", springs alone " << springs);
  CHECK(pull == Approx(theory).epsilon(.01));
  CHECK(theory < .9 * springs);
  run_load_steps(simulation, time, 15, 22);
  CHECK(-simulation.contact_forces()[1].fx == Approx(kFriction * kWeight).epsilon(1e-5));
  const double lost = simulation.energies().friction_loss;
  run_load_steps(simulation, time, 23, 24);
  CHECK(-simulation.contact_forces()[1].fx == Approx(kFriction * kWeight).epsilon(1e-5));
  const Energies e = simulation.energies();
  CHECK(e.friction_loss - lost == Approx(kFriction * kWeight * kPull / 6).epsilon(1e-4));
  CHECK(std::abs(e.total_error) < .01 * e.friction_loss);
  CHECK(e.kinetic == 0);
}

TEST_CASE("the path of the relaxation leaves no trace in the springs", "[static_friction]") {
  const Model model = pulled_block(2e9);
  const TimeSettings time = load_steps(8, 2, 1e-9);
  Simulation simulation(model, time, 8, 1);
  run_load_steps(simulation, time, 1, 5);
  const auto springs = [&] {
    std::vector<double> forces;
    for (const ContactRecord& r : simulation.contacts()) forces.push_back(r.tangential.x());
    return forces;
  };
  const auto traction = [&] {
    std::vector<double> all;
    for (const SurfaceRecord& s : simulation.surfaces()) all.push_back(s.traction);
    return all;
  };
  const std::vector<double> forces = springs(), tractions = traction();
  const double lost = simulation.energies().friction_loss;
  // Stopped on the way, all is as it was; and a load step without any change changes nothing.
  const double now = simulation.state().time;
  const State state = simulation.state();
  int looks = 0;
  CHECK_FALSE(simulation.balance(2, [&] { return ++looks == 1; }).complete);
  CHECK(simulation.state().x == state.x);
  CHECK(traction() == tractions);
  CHECK(simulation.energies().friction_loss == lost);
  simulation.balance(now);
  double largest = 0;
  for (const double t : tractions) largest = std::max(largest, std::abs(t));
  CHECK(largest > 0);
  for (size_t i = 0; i < tractions.size(); ++i) {
    CHECK(std::abs(traction()[i] - tractions[i]) < 1e-6 * largest);
  }
  CHECK(springs()[0] == Approx(forces[0]).epsilon(1e-6));
  CHECK(std::abs(simulation.energies().friction_loss - lost) < 1e-6 * std::abs(lost));
}

namespace {

// A wedge of that slope under a block that is held aside and bears a load: the force that drives
// the wedge in, over the load.
double driving_force(double slope, double coefficient, bool rigid_block) {
  const double t = std::tan(slope);
  Model model;
  model.materials = {
      {"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::strain, kModulus, .2}}};
  model.contact.normal_stiffness = 5 * kModulus;
  model.contact.friction = {coefficient, 5 * kModulus};
  add(model, "floor", samples::block(-1, -1, 2, 0), Motion::fixed);
  const Polygon upper({{.3, .4 - .3 * t}, {.8, .4 - .8 * t}, {.8, 1}, {.3, 1}});
  constexpr double kLoad = 1e6;
  if (rigid_block) {
    add(model, "block", upper);
    model.bodies[1].held = {true, false, true};
    model.gravity = {0, -kLoad / model.bodies[1].mass};
    model.gravity_history.points = {{0, 0}, {1, 1}};
    model.materials.push_back(model.materials[0]);
    model.materials[1].density = 1e-3;  // of the wedge, which has no weight
  }
  DeformableBody wedge;
  wedge.name = "wedge";
  wedge.mesh = fill_mesh(Polygon({{0, 0}, {1, 0}, {1, .4 - t}, {0, .4}}), {}, .1,
                         ElementShape::quadrilateral);
  wedge.supports = {{nodes_where(wedge.mesh, {.x = 0}), {true, false}, {}}};
  wedge.supports[0].motion = then_along({0, 0}, {6e-4, 0});
  wedge.material = rigid_block ? 1 : 0;
  model.deformables = {wedge};
  if (!rigid_block) {
    DeformableBody block;
    block.name = "block";
    block.mesh = fill_mesh(upper, {}, .1, ElementShape::quadrilateral);
    block.supports = {{nodes_where(block.mesh, {.x = .8}), {true, false}, {}}};
    block.dead_loads = {on_side(block, {.y = 1}, {0, -kLoad})};
    model.deformables.push_back(block);
  }
  number_nodes(model);
  const TimeSettings time = load_steps(16, 2);
  Simulation simulation(model, time, 16, 1);
  run_load_steps(simulation, time, 1, 15);
  const size_t number = model.bodies.size();
  const double almost = simulation.contact_forces()[number].fx;
  run_load_steps(simulation, time, 16, 16);
  const double last = simulation.contact_forces()[number].fx;
  CHECK(last == Approx(almost).epsilon(1e-3));  // it slides
  return -last / kLoad;
}

}  // namespace

TEST_CASE("the force that drives a wedge", "[static_friction]") {
  for (const auto& [slope, coefficient] : {std::pair(.2, .3), std::pair(.1, .6)}) {
    const double theory = std::tan(slope + std::atan(coefficient)) + coefficient;
    for (const bool rigid : {false, true}) {
      INFO("slope " << slope << (rigid ? ", rigid block" : ""));
      CHECK(driving_force(slope, coefficient, rigid) == Approx(theory).epsilon(.002));
    }
  }
}

namespace {

// Cattaneo (1938) and Mindlin (1949): two equal cylinders, pressed and then sheared. Tractions are
// means over two neighbouring edges: that is what a node feels.
struct Sheared {
  double load_ratio;     // T / (mu N)
  double stick, theory;  // half-width of the zone without slip over that of the contact
  double traction;       // root mean square error over that of theory's traction
  double pressure;       // the same
  std::int64_t iterations;
};

// Integral of sqrt(1 - x^2/a^2) from 0.
double ellipse(double x, double a) {
  const double s = std::clamp(x / a, -1., 1.);
  return a / 2 * (s * std::sqrt(1 - s * s) + std::asin(s));
}

// Half discs of radius 1. `pressed`: about the half-width, over the radius; `cells` over it;
// `sheared`: the displacement aside, over that across.
Sheared cylinders(double pressed, int cells, double coefficient, double sheared, int steps) {
  const Elastic elastic{ElasticLaw::st_venant_kirchhoff, Plane::strain, kModulus, .2};
  const double modulus = kModulus / 2 / (1 - elastic.poisson * elastic.poisson);
  constexpr double kRadius = .5;  // of both together
  const double depth = pressed * pressed * (2 * std::log(4 / pressed) - 1) / 2;
  DeformableBody upper, lower;
  upper.name = "upper";
  upper.mesh =
      half_disc_mesh({0, 0}, 1, {1.5 * pressed, 3 * cells / 2}, ElementShape::quadrilateral);
  lower.name = "lower";
  lower.mesh = upper.mesh;
  mirror(lower.mesh, 1, 0);
  for (DeformableBody* body : {&upper, &lower}) reorder_along_curve(body->mesh);
  lower.supports = {{nodes_where(lower.mesh, {.y = -1}), {true, true}, {}}};
  upper.supports = {{nodes_where(upper.mesh, {.y = 1}), {true, true}, {}}};
  upper.supports[0].motion = then_along({0, -depth}, {sheared * depth, 0});
  Model model;
  model.materials = {{"rock", 2000, elastic}};
  model.contact.normal_stiffness = 10 * kModulus;
  model.contact.friction = {coefficient, kModulus};
  model.deformables = {lower, upper};
  number_nodes(model);
  const TimeSettings time = load_steps(2 * steps, 2, 1e-6);
  Simulation simulation(model, time, 2 * steps, 1);
  Sheared result{};
  for (int i = 1; i <= 2 * steps; ++i) {
    result.iterations += simulation.balance(2. * i / (2 * steps)).iterations;
  }
  const BodyForce on = simulation.contact_forces()[0];  // on the lower one
  const double normal = -on.fy, shear = on.fx;
  result.load_ratio = shear / (coefficient * normal);
  result.theory = std::sqrt(1 - result.load_ratio);
  const double a = std::sqrt(4 * normal * kRadius / (std::numbers::pi * modulus));
  const double peak = std::sqrt(normal * modulus / (std::numbers::pi * kRadius));
  const double c = result.theory * a;
  struct Edge {
    double from, to, pressure, traction;
  };
  std::vector<Edge> edges;
  double centre = 0;
  for (const SurfaceRecord& s : simulation.surfaces()) {
    if (s.body != 0 || s.from.y() < -.1) continue;  // of the straight side
    const auto [left, right] = std::minmax(s.from.x(), s.to.x());
    edges.push_back({left, right, s.pressure, std::abs(s.traction)});
    centre += s.pressure * (right - left) * (left + right) / 2 / normal;
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& e, const Edge& f) { return e.from < f.from; });
  double error[2]{}, size[2]{};
  std::vector<std::pair<double, double>> points;
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    const Edge &e = edges[i], &f = edges[i + 1];
    const double x = e.from - centre, y = f.to - centre;
    const auto both = [&](double of_e, double of_f) {
      return (of_e * (e.to - e.from) + of_f * (f.to - f.from)) / (y - x);
    };
    const auto mean = [&](double half) { return (ellipse(y, half) - ellipse(x, half)) / (y - x); };
    const double p = both(e.pressure, f.pressure), q = both(e.traction, f.traction);
    const double exact_p = peak * mean(a);
    const double exact_q = coefficient * (exact_p - peak * result.theory * mean(c));
    error[0] += (p - exact_p) * (p - exact_p), size[0] += exact_p * exact_p;
    error[1] += (q - exact_q) * (q - exact_q), size[1] += exact_q * exact_q;
    // What is missing to slip is an ellipse over the zone that sticks.
    const double missing = coefficient * p - q, place = e.to - centre;
    if (missing > .2 * coefficient * peak * result.theory) {
      points.emplace_back(place * place, missing * missing);
    }
  }
  result.pressure = std::sqrt(error[0] / size[0]);
  result.traction = std::sqrt(error[1] / size[1]);
  MatrixXd line(points.size(), 2);
  VectorXd height(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<ptrdiff_t>(i);
    line.row(row) << 1, points[i].first;
    height[row] = points[i].second;
  }
  const VectorXd fit = line.colPivHouseholderQr().solve(height);
  result.stick = std::sqrt(-fit[0] / fit[1]) / a;
  return result;
}

}  // namespace

TEST_CASE("Cattaneo and Mindlin: two cylinders, pressed and sheared", "[static_friction][slow]") {
  struct Case {
    double pressed;
    int cells;
    double sheared;
    double stick, traction;  // errors
    bool lengthy;
  };
  for (const Case& c : {Case{.025, 10, .2, .02, .05, false}, Case{.0125, 25, .1, .01, .03, true},
                        Case{.0125, 25, .2, .01, .03, true}}) {
    if (c.lengthy && !long_run()) continue;
    const int cells = test::kSanitized ? 3 : c.cells;
    const Sheared found = cylinders(c.pressed, cells, .3, c.sheared, c.lengthy ? 6 : 3);
    if (test::kSanitized) continue;  // too coarse to compare
    const std::string text = fmt::format(
        "a/R {}, {} cells over a: T/(mu N) {:.4f}, c/a {:.4f} of {:.4f}, error of q {:.4f}, of p "
        "{:.4f}, {} steps of relaxation\n",
        2 * c.pressed, c.cells, found.load_ratio, found.stick, found.theory, found.traction,
        found.pressure, found.iterations);
    if (long_run()) fmt::print("{}", text);
    INFO(text);
    CHECK(found.load_ratio > .3);
    CHECK(found.load_ratio < .9);
    CHECK(found.stick == Approx(found.theory).epsilon(c.stick));
    CHECK(found.traction < c.traction);
  }
}

namespace {

// A stone on a soft meshed block on a floor, or on a rigid block.
Model stone_on_block(bool meshed) {
  Model model = make_model(.5, 5e7);
  model.contact.normal_stiffness = 5e7;
  model.materials[0].elastic = {ElasticLaw::st_venant_kirchhoff, Plane::strain, 2e7, .2};
  model.gravity = {0, -kG};
  add(model, "floor", samples::block(-2, -1, 3, 0), Motion::fixed);
  add(model, "stone", Polygon({{.2, .5}, {.7, .5}, {.6, .9}, {.3, .9}}));
  if (!meshed) {
    add(model, "block", samples::block(0, 0, 1, .5));
    return model;
  }
  DeformableBody block;
  block.name = "block";
  block.mesh = rectangle_mesh({1, .5}, {10, 5}, {0, 0}, ElementShape::quadrilateral);
  model.deformables = {block};
  return model;
}

}  // namespace

TEST_CASE("free rigid bodies are in equilibrium in static runs", "[static_friction]") {
  for (const bool meshed : {false, true}) {
    INFO((meshed ? "on a mesh" : "rigid bodies alone"));
    Model model = stone_on_block(meshed);
    model.gravity_history.points = {{0, 0}, {1, 1}};
    model.gravity = {-1, -kG};  // on a slope
    const TimeSettings time = load_steps(4, 1, 1e-8);
    Simulation simulation(model, time, 4, 1);
    run_load_steps(simulation, time, 1, 4);
    const RigidBody& stone = model.bodies[1];
    const Eigen::Vector3d on = simulation.state().force(1);
    CHECK(on[0] == Approx(stone.mass).epsilon(1e-5));
    CHECK(on[1] == Approx(stone.mass * kG).epsilon(1e-6));
    CHECK(std::abs(on[2]) < 1e-6 * stone.mass * kG);
    const double all = stone.mass + 2500 * .5;
    CHECK(simulation.state().force(0)[0] == Approx(-all).epsilon(1e-5));
    CHECK(simulation.state().force(0)[1] == Approx(-all * kG).epsilon(1e-6));
    CHECK(simulation.energies().kinetic == 0);
    CHECK(std::abs(simulation.energies().total_error) < .02 * simulation.energies().contact);
  }
}

TEST_CASE("a body that a prescribed one moves is as balanced as the tolerance says",
          "[static_friction][slow]") {
  for (const bool turns : {true, false}) {
    Model tilted;
    tilted.materials = stone_on_block(true).materials;
    tilted.contact.normal_stiffness = 1e7;
    tilted.contact.friction = {.5, 8e6};
    tilted.gravity = {0, -kG};
    RigidBody floor;
    floor.name = "floor";
    floor.motion = Motion::prescribed;
    set_shape(floor, samples::block(-1, -.3, 1, 0), tilted);
    if (turns) {
      floor.history.spin = {{0, 0}, {.5, .6}, {1, 0}};
      floor.pivot = {-1, .15};
    } else {
      floor.history.velocity = {{0, {2, 3}}};
    }
    tilted.bodies = {floor};
    DeformableBody block;
    block.name = "block";
    block.mesh = rectangle_mesh({.3, .2}, {6, 4}, {-.15, 0}, ElementShape::quadrilateral);
    tilted.deformables = {block};
    number_nodes(tilted);
    Simulation simulation(tilted, load_steps(20, 1, 1e-6), 20, 1);
    const double weight = .3 * .2 * tilted.materials[0].density * kG;
    for (int i = 1; i <= 20; ++i) {
      const LoadStep step = simulation.balance(i / 20.);
      const BodyForce on = simulation.contact_forces()[1];
      CAPTURE(turns, i, on.fx, on.fy, step.imbalance);
      // The sum of its forces is the weight and the contact force.
      CHECK(std::hypot(on.fx, on.fy - weight) < 2.5e-6 * weight);
    }
  }
}

TEST_CASE("bodies with a mesh start settled", "[static_friction]") {
  const Model model = stone_on_block(true);
  TimeSettings time;
  time.end = .02;
  time.settled = true;
  Simulation simulation(model, time, 1, 1);
  const std::vector<double> start = simulation.state().x;
  const Energies before = simulation.energies();
  CHECK(before.strain > 0);
  CHECK(before.total_error == 0);
  CHECK(simulation.state().force(1)[1] == Approx(model.bodies[1].mass * kG).epsilon(1e-6));
  CHECK(simulation.contact_forces()[1].friction > 0);
  while (simulation.state().time < time.end * (1 - 1e-9)) simulation.step();
  for (size_t c = 0; c < start.size(); ++c) {
    CHECK(std::abs(simulation.state().x[c] - start[c]) < 1e-9);
  }
  CHECK(simulation.energies().kinetic < 1e-12 * before.strain);
  CHECK(std::abs(simulation.energies().total_error) < 1e-9 * before.strain);
}
