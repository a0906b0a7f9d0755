// Newton's method: the tangents that it needs, equilibria that relaxation does not find, and those
// that are unstable.
#include <catch2/catch.hpp>
#include <cmath>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/fem/finite_elements.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/select.hpp"
#include "tests/dynamics/surface_models.hpp"
#include "tests/fem/meshes.hpp"
#include "tests/shapes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace newton {
namespace {

std::vector<std::vector<double>> matrix(const Tangent& tangent, size_t size) {
  std::vector<std::vector<double>> k(size, std::vector<double>(size, 0));
  for (const Tangent::Entry& e : tangent.entries()) {
    k[static_cast<size_t>(e.row)][static_cast<size_t>(e.column)] += e.value;
  }
  return k;
}

// A slender strut of n x m cells, clamped below, pressed from above by P/P_c of Euler's load.
Model strut(double share, double imperfection, ElementKind element = ElementKind::quad4) {
  constexpr double kYoung = 1e9, kWidth = .1, kHeight = 2;
  Model model = empty_model();
  model.materials = {{"m", 1000, {ElasticLaw::st_venant_kirchhoff, Plane::stress, kYoung, 0}}};
  DeformableBody body;
  body.name = "strut";
  body.element = element;
  body.mesh = rectangle_mesh({kWidth, kHeight}, {2, 40}, {0, 0}, ElementShape::quadrilateral);
  for (Vec2& node : body.mesh.nodes) {
    node.x() += imperfection * (1 - std::cos(M_PI * node.y() / (2 * kHeight)));
  }
  body.supports = {{nodes_where(body.mesh, {.y = 0}), {true, true}, {}}};
  const double euler = M_PI * M_PI * kYoung * std::pow(kWidth, 3) / 12 / std::pow(2 * kHeight, 2);
  DeadLoad load{nodes_where(body.mesh, {.y = kHeight}), {}, {{{0, 0}, {1, 1}}}};
  for (size_t i = 0; i < load.nodes.size(); ++i) {
    load.forces.emplace_back(0, -share * euler / static_cast<double>(load.nodes.size()));
  }
  body.dead_loads = {load};
  model.deformables.push_back(body);
  return model;
}

LoadStep pressed(const Model& model, double* aside = nullptr) {
  TimeSettings time;
  time.statics = true;
  time.load_steps = 4;
  Simulation simulation(model, time, 1, 1);
  LoadStep step;
  for (int i = 1; i <= 4; ++i) step = simulation.balance(i / 4.);
  if (aside) {
    *aside = 0;
    for (NodeIndex n = 0; n < static_cast<NodeIndex>(model.deformables[0].mesh.nodes.size()); ++n) {
      *aside = std::max(*aside, std::abs(simulation.state().node(n).x()));
    }
  }
  return step;
}

// Blocks piled at random on a floor, each a little above the one below it.
Model pile(samples::Random& random, int blocks, double stiffness, double friction) {
  Model model = empty_model();
  model.materials = {{"stone", 2000}};
  model.gravity = {0, -9.81};
  model.contact.normal_stiffness = stiffness;
  model.contact.friction = {friction, 0, 1};
  const auto put = [&](const Polygon& polygon, Motion motion) {
    RigidBody body;
    body.name = std::to_string(model.bodies.size());
    body.motion = motion;
    set_shape(body, polygon, model);
    model.bodies.push_back(body);
  };
  put(samples::block(-5, -1, 5, 0), Motion::fixed);
  double y = 0;
  for (int i = 0; i < blocks; ++i) {
    const double half = random.uniform(.3, .5), height = random.uniform(.2, .6);
    // Without friction only what stands upright stays.
    const double x = friction > 0 ? random.uniform(-.1, .1) : 0;
    put(samples::block(x - half, y, x + half, y + height), Motion::free);
    y += height;
  }
  return model;
}

}  // namespace
}  // namespace newton

TEST_CASE("the tangent of elements is the derivative of their forces", "[newton]") {
  SeededRandom random(5);
  for (const ElementKind kind :
       {ElementKind::tri3, ElementKind::quad4, ElementKind::quad4_full, ElementKind::polygon}) {
    for (const ElasticLaw law : {ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean}) {
      for (const Plane plane : {Plane::stress, Plane::strain}) {
        const Mesh quads = distorted(quad_grid(3, 2, 1.5, 1), .2);
        const Mesh mesh = kind == ElementKind::tri3      ? triangles(quads)
                          : kind == ElementKind::polygon ? voronoi_cells(6, 1.5, 1)
                                                         : quads;
        // With damping: the nodes have moved from u0 to u in one step.
        const double span = random.integer(0, 1) == 0 ? 0 : .01, beta = span > 0 ? .02 : 0;
        const ElementSet set{kind, &mesh, 0, {law, plane, 1e5, .3}, 1000, .7, beta};
        FiniteElements elements({&set, 1}, 1);
        const size_t size = 2 * mesh.nodes.size();
        std::vector<double> u(size), u0(size), v(span > 0 ? size : 0), f(size), moved(size);
        for (double& x : u) x = random.uniform(-.05, .05);
        for (size_t i = 0; i < size; ++i) u0[i] = u[i] + random.uniform(-.01, .01);
        const auto find_forces = [&](std::vector<double>& forces) {
          for (size_t i = 0; i < v.size(); ++i) v[i] = (u[i] - u0[i]) / span;
          elements.force(u, v, forces, span / 2);
        };
        find_forces(f);
        Tangent tangent;
        elements.add_tangent(u, 0, tangent, v, span);
        const auto k = newton::matrix(tangent, size);
        std::vector<std::vector<double>> differences(size, std::vector<double>(size));
        for (size_t j = 0; j < size; ++j) {
          constexpr double kStep = 1e-6;
          const double middle = u[j];
          u[j] = middle + kStep;
          find_forces(f);
          u[j] = middle - kStep;
          find_forces(moved);
          u[j] = middle;
          for (size_t i = 0; i < size; ++i) differences[i][j] = (moved[i] - f[i]) / (2 * kStep);
        }
        double worst = 0, largest = 0, skew = 0;
        for (size_t i = 0; i < size; ++i) {
          for (size_t j = 0; j < size; ++j) {
            const double symmetric =
                span > 0 ? (differences[i][j] + differences[j][i]) / 2 : differences[i][j];
            worst = std::max(worst, std::abs(k[i][j] - symmetric));
            largest = std::max(largest, std::abs(k[i][j]));
            skew = std::max(skew, std::abs(k[i][j] - k[j][i]));
          }
        }
        CAPTURE(static_cast<int>(kind), static_cast<int>(law), static_cast<int>(plane));
        CHECK(worst < 1e-8 * largest);
        CHECK(skew < 1e-13 * largest);
      }
    }
  }
}

TEST_CASE("the tangent of contact is the derivative of its forces", "[newton]") {
  SeededRandom random(6);
  int compared = 0, off = 0;
  for (int n = 0; n < scaled(120); ++n) {
    Model model = empty_model();
    const double mu = random.integer(0, 1) == 0 ? 0 : .3;
    model.contact.normal_stiffness = 1e7;
    model.contact.friction = {mu, 0, 1};
    // Bodies that overlap by a few per cent of their size: polygons, or polygons and meshes.
    const bool meshed = random.integer(0, 1) == 0;
    RigidBody lower;
    lower.name = "lower";
    set_shape(lower,
              meshed || random.integer(0, 1) == 0
                  ? samples::block(-1, -1, 1, 0)
                  : samples::posed(samples::star(7, .6), {0, -.75}, .1),
              model);
    model.bodies.push_back(lower);
    // Within the collar of the disc: what a saturated region adds is not in the tangent.
    const Vec2 place(random.uniform(-.2, .2),
                     meshed ? random.uniform(.49, .499) : random.uniform(.4, .45));
    if (meshed) {
      add(model, "upper", disc(place, Shape::triangles), ElementKind::tri3, {0, 0});
    } else {
      RigidBody upper;
      upper.name = "upper";
      set_shape(upper, samples::posed(samples::random_star_shaped(random, 8, .4), place, 0), model);
      model.bodies.push_back(upper);
    }
    const FiniteElements elements(std::vector<ElementSet>{}, 1);
    std::vector<double> node_mass;
    for (const DeformableBody& body : model.deformables)
      node_mass.resize(body.mesh.nodes.size(), 1);
    const DegreesOfFreedom dofs(model, node_mass);
    State state = dofs.start();
    State start = state;
    ContactTerm contact(model, dofs, state, 1);
    std::vector<double> slip(state.x.size()), lambda(model.bodies.size());
    PhaseTimer clock;
    const auto force = [&]() {
      std::ranges::fill(state.f, 0.);
      for (size_t c = 0; c < slip.size(); ++c) slip[c] = state.x[c] - start.x[c];
      contact.add_forces({state, slip, 1, lambda, clock, 0, true, true, {}});
      return state.f;
    };
    for (double& x : state.x) x += random.uniform(-1e-3, 1e-3);
    try {
      if (random.integer(0, 1) == 0) {
        // Springs that have been loaded before.
        for (double& s : slip) s = random.uniform(-1e-3, 1e-3);
        contact.add_forces({state, slip, 1, lambda, clock, 0, false, true, {}});
        start = state;
        for (double& x : state.x) x += random.uniform(-1e-3, 1e-3);
      }
      static_cast<void>(force());
    } catch (const Unstable&) {
      continue;  // as deep as the potentials reach
    }
    Tangent tangent;
    REQUIRE(contact.add_tangent(state, tangent));
    const size_t size = state.x.size();
    const auto k = newton::matrix(tangent, size);
    double largest = 0;
    for (const auto& row : k) {
      for (const double entry : row) largest = std::max(largest, std::abs(entry));
    }
    if (largest == 0) continue;
    for (size_t j = 0; j < size; ++j) {
      constexpr double kStep = 1e-8;
      const double middle = state.x[j];
      state.x[j] = middle + kStep;
      const std::vector<double> plus = force();
      state.x[j] = middle - kStep;
      const std::vector<double> minus = force();
      state.x[j] = middle;
      for (size_t i = 0; i < size; ++i) {
        const double difference = -(plus[i] - minus[i]) / (2 * kStep);
        if (k[i][j] == 0 && difference == 0) continue;
        ++compared;
        // Within a difference a vertex may cross an edge, or a spring begin to slide.
        off += std::abs(k[i][j] - difference) > 1e-4 * largest;
      }
    }
  }
  CAPTURE(compared, off);
  CHECK(compared > least(20 * scaled(120)));
  CHECK(100 * off <= compared);
}

TEST_CASE("a strut is stable below Euler's load and unstable above it", "[newton]") {
  for (const ElementKind element : {ElementKind::quad4, ElementKind::polygon}) {
    CHECK(newton::pressed(newton::strut(.98, 0, element)).negative_pivots == 0);
    CHECK(newton::pressed(newton::strut(1.05, 0, element)).negative_pivots == 1);
    CHECK(newton::pressed(newton::strut(10, 0, element)).negative_pivots == 2);  // the next: 9 P_c
  }
}

TEST_CASE("a strut with an imperfection bends as the linear theory of second order says",
          "[newton]") {
  for (const double share : {.3, .6, .9}) {
    constexpr double kImperfection = 1e-3;
    double aside = 0;
    const LoadStep step = newton::pressed(newton::strut(share, kImperfection), &aside);
    CAPTURE(share, aside);
    CHECK(step.negative_pivots == 0);
    CHECK(step.residual < 1e-10);
    // The first mode grows by P/(P_c - P); shear and the mesh change P_c by less than a per cent.
    const double expected = kImperfection * share / (1 - share);
    CHECK(std::abs(aside / expected - 1) < .01 / (1 - share));
  }
}

TEST_CASE("piles settle at any stiffness, with friction and without", "[newton]") {
  SeededRandom random(7);
  for (const double stiffness : {1e7, 1e9, 1e11, 1e13}) {
    for (const double friction : {0., .3, 1.5}) {
      const Model model = newton::pile(random, kSanitized ? 3 : 8, stiffness, friction);
      CAPTURE(stiffness, friction);
      Simulation simulation(model, {.end = 1, .settled = true}, 1, 1);
      for (size_t i = 1; i < model.bodies.size(); ++i) {
        const double weight = model.bodies[i].mass * 9.81;
        const auto force = simulation.state().force(static_cast<RigidIndex>(i));
        // Two units in the last place of a position of 4 m are 1.8e-15 m. The stiffness of a
        // contact is k_n times its length over both inradii, about 6 k_n here.
        const double allowed = 1e-6 * weight + 1e-14 * stiffness;
        CHECK(std::abs(force[1] - weight) < allowed);
        CHECK(std::abs(force[0]) < allowed);
      }
    }
  }
}
