// Static scenes: equilibria found by dynamic relaxation.
#include <fmt/format.h>

#include <Eigen/QR>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <numbers>

#include "lib/dynamics/simulation.hpp"
#include "lib/mesh/half_disc_mesh.hpp"
#include "lib/mesh/mirror.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/reorder.hpp"
#include "lib/mesh/select.hpp"
#include "tests/fem/static_solution.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

constexpr double kYoung = 20e9;

DeformableBody block(const char* name, const Vec2& size, std::array<int, 2> cells,
                     const Vec2& origin) {
  DeformableBody body;
  body.name = name;
  body.mesh = rectangle_mesh(size, cells, origin, ElementShape::quadrilateral);
  return body;
}

Model model_of(std::vector<DeformableBody> bodies, const Elastic& elastic) {
  Model model;
  model.materials = {{"rock", 2000, elastic}};
  int nodes = 0;
  for (DeformableBody& body : bodies) {
    body.first_node = nodes;
    nodes += static_cast<int>(body.mesh.nodes.size());
  }
  model.deformables = std::move(bodies);
  return model;
}

// Rises from 0 to 1 over a time of 1.
const LoadHistory kRamp{{{0, 0}, {1, 1}}};

// A force on the nodes of a straight side, shared by length.
DeadLoad side_load(const DeformableBody& body, const Place& where, const Vec2& force) {
  DeadLoad load{{}, {}, kRamp};
  const std::vector<MeshEdge> edges = edges_where(body.mesh, where);
  double whole = 0;
  const auto length = [&](const MeshEdge& e) {
    return (body.mesh.nodes[e.nodes[1]] - body.mesh.nodes[e.nodes[0]]).norm();
  };
  for (const MeshEdge& e : edges) whole += length(e);
  for (const MeshEdge& e : edges) {
    for (const int node : e.nodes) {
      load.nodes.push_back(node);
      load.forces.emplace_back(length(e) / whole / 2 * force);
    }
  }
  return load;
}

TimeSettings statics(int load_steps) {
  TimeSettings time;
  time.end = 1;
  time.statics = true;
  time.load_steps = load_steps;
  return time;
}

}  // namespace

TEST_CASE("a static run finds the deflection of an independent code", "[equilibrium]") {
  for (const ElasticLaw law : {ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean}) {
    const Elastic elastic{law, Plane::stress, kYoung, .2};
    DeformableBody beam = block("beam", {4, 1}, {16, 4}, {0, 0});
    beam.supports = {{nodes_where(beam.mesh, {.x = 0}), {true, true}, {}}};
    beam.dead_loads = {side_load(beam, {.x = 4}, {0, -2e7})};
    const Model model = model_of({beam}, elastic);
    const Mesh& mesh = model.deformables[0].mesh;
    test::Supports supports(mesh);
    for (const int node : beam.supports[0].nodes) supports.fix(node);
    const test::Structure structure(beam.element, mesh, elastic);
    test::VectorXd load = test::VectorXd::Zero(structure.size());
    for (size_t i = 0; i < beam.dead_loads[0].nodes.size(); ++i) {
      load.segment<2>(2 * beam.dead_loads[0].nodes[i]) += beam.dead_loads[0].forces[i];
    }
    const test::VectorXd exact =
        solve_newton(structure, supports, load, solve_linear(structure, supports, load));
    for (const double tolerance : {1e-6, 1e-9}) {
      TimeSettings time = statics(2);
      time.tolerance = tolerance;
      Simulation simulation(model, time, 2, 1);
      simulation.balance(.5);
      const LoadStep step = simulation.balance(1);
      const std::vector<double>& u = simulation.state().x;  // of nodes only
      double worst = 0;
      for (size_t c = 0; c < u.size(); ++c) {
        worst = std::max(worst, std::abs(u[c] - exact[static_cast<ptrdiff_t>(c)]));
      }
      UNSCOPED_INFO("iterations " << step.iterations << ", error "
                                  << worst / exact.cwiseAbs().maxCoeff());
      CHECK(exact.cwiseAbs().maxCoeff() > .2);
      // Bending is softer than a cell by far: the error is larger than the residual.
      CHECK(worst < 100 * tolerance * exact.cwiseAbs().maxCoeff());
      CHECK(step.residual <= tolerance);
      // Loads from zero to these in two straight pieces.
      const Energies e = simulation.energies();
      CHECK(e.kinetic == 0);
      CHECK(e.external_work == Approx(e.strain).epsilon(.01));
    }
  }
}

namespace {

// One block on another, cells of 1/10 on cells of 1/6, pressed with p = young / 1000; largest error
// of the stress away from the sides and the interface, of p.
double patch_error(double stiffness) {
  const double p = kYoung / 1000;
  DeformableBody lower = block("lower", {1, .5}, {6, 4}, {0, 0});
  DeformableBody upper = block("upper", {1, .5}, {10, 5}, {0, .5});
  lower.supports = {{nodes_where(lower.mesh, {.y = 0}), {false, true}, {}},
                    {nodes_where(lower.mesh, {.nearest = Vec2(.5, 0)}), {true, true}, {}}};
  upper.supports = {{nodes_where(upper.mesh, {.nearest = Vec2(.5, 1)}), {true, false}, {}}};
  upper.dead_loads = {side_load(upper, {.y = 1}, {0, -p})};
  Model model =
      model_of({lower, upper}, {ElasticLaw::st_venant_kirchhoff, Plane::strain, kYoung, .2});
  model.contact.normal_stiffness = stiffness * kYoung;
  TimeSettings time = statics(1);
  time.tolerance = 1e-9;
  Simulation simulation(model, time, 1, 1);
  simulation.balance(1);
  const std::vector<BodyForce> forces = simulation.contact_forces();
  CHECK(std::abs(forces[1].fy - p) < 1e-5 * p);
  CHECK(std::abs(forces[0].fy + p) < 1e-5 * p);
  const std::vector<CauchyStress> stresses = simulation.stresses();
  // The load is dead, and the blocks grow wider under it.
  const auto side = [&](double x) {
    const int node = nodes_where(upper.mesh, {.nearest = Vec2(x, 1)})[0];
    return simulation.state().node(model.deformables[1].first_node + node).x();
  };
  const double stress = p / (1 + side(1) - side(0));
  double worst = 0;
  size_t element = 0;
  for (const DeformableBody& body : model.deformables) {
    for (int e = 0; e < body.mesh.element_count(); ++e, ++element) {
      Vec2 centre = Vec2::Zero();
      for (const int node : body.mesh.element(e)) centre += body.mesh.nodes[node] / 4;
      const double error = std::abs(stresses[element].yy + stress) / p;
      if (std::abs(centre.x() - .5) < .3 && std::abs(centre.y() - .5) > .15) {
        worst = std::max(worst, error);
      }
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("a strip folded flat and pressed: uniform pressure", "[equilibrium][self_contact]") {
  // Two legs of 13.5 m on each other, one end joined. Where they part there is a hole, whose effect
  // dies out along the legs. The nodes of the upper leg do not lie on those of the lower one.
  const double p = kYoung / 1000;
  const Mesh whole = rectangle_mesh({16, 2}, {64, 8}, {0, 0}, ElementShape::quadrilateral);
  Mesh mesh;
  mesh.nodes = whole.nodes;
  std::vector<int> upper(whole.nodes.size());
  for (size_t n = 0; n < whole.nodes.size(); ++n) {
    const Vec2 x = whole.nodes[n];
    upper[n] = static_cast<int>(n);
    if (std::abs(x.y() - 1) > 1e-9 || x.x() < 2.5 - 1e-9) continue;
    upper[n] = static_cast<int>(mesh.nodes.size());
    mesh.nodes.emplace_back(x.x() + (x.x() > 2.6 && x.x() < 15.9 ? .1 : 0), 1);
  }
  std::vector<Vec2> centres;
  for (int e = 0; e < whole.element_count(); ++e) {
    Vec2 centre = Vec2::Zero();
    for (const int n : whole.element(e)) centre += whole.nodes[n] / 4;
    if (centre.x() > 2 && centre.x() < 2.5 && std::abs(centre.y() - 1) < .25) continue;
    std::vector<int> corners;
    for (const int n : whole.element(e)) corners.push_back(centre.y() > 1 ? upper[n] : n);
    mesh.add_element(corners);
    centres.push_back(centre);
  }
  // The node in the middle of the hole belongs to nothing.
  std::vector<int> number(mesh.nodes.size(), -1);
  std::vector<Vec2> nodes;
  for (int& n : mesh.corners) {
    if (number[n] < 0) {
      number[n] = static_cast<int>(nodes.size());
      nodes.push_back(mesh.nodes[n]);
    }
    n = number[n];
  }
  mesh.nodes = nodes;
  for (const double stiffness : {1., 10.}) {
    DeformableBody strip;
    strip.name = "strip";
    strip.mesh = mesh;
    strip.supports = {{nodes_where(mesh, {.y = 0}), {false, true}, {}},
                      {nodes_where(mesh, {.nearest = Vec2(0, 0)}), {true, true}, {}}};
    strip.dead_loads = {side_load(strip, {.y = 2}, {0, -16 * p})};
    Model model = model_of({strip}, {ElasticLaw::st_venant_kirchhoff, Plane::strain, kYoung, .2});
    model.contact.normal_stiffness = stiffness * kYoung;
    model.contact.self = true;
    TimeSettings time = statics(1);
    time.tolerance = 1e-9;
    Simulation simulation(model, time, 1, 1);
    simulation.balance(1);
    const auto u_at = [&](double x) {
      return simulation.state().node(nodes_where(mesh, {.nearest = Vec2(x, 2)})[0]).x();
    };
    const double stress = p / (1 + (u_at(15) - u_at(12)) / 3);
    const std::vector<CauchyStress> stresses = simulation.stresses();
    double worst = 0;
    for (size_t e = 0; e < centres.size(); ++e) {
      if (centres[e].x() < 12 || centres[e].x() > 15 || std::abs(centres[e].y() - 1) < .3) continue;
      worst = std::max(worst, std::abs(stresses[e].yy + stress) / p);
    }
    CAPTURE(stiffness, worst);
    if (std::getenv("APOTHEM_PRINT")) fmt::print("folded strip: {:.2e}\n", worst);
    CHECK(worst < (stiffness > 1 ? 5e-5 : 2e-4));
  }
}

TEST_CASE("a block pressed on one of other cells: uniform pressure", "[equilibrium]") {
  CHECK(patch_error(1) < 2e-4);
  CHECK(patch_error(10) < 1e-5);
}

namespace {

struct Hertz {
  double peak, half_width;  // of theory's
  double balance;           // contact force / load - 1
  std::int64_t iterations;  // of all load steps
};

// Two equal half discs of radius 1, 1/R = 1/1 + 1/1, pressed until theory's half-width is b.
Hertz hertz(double b_over_radius, int cells, double stiffness) {
  const Elastic elastic{ElasticLaw::st_venant_kirchhoff, Plane::strain, kYoung, .2};
  const double modulus = kYoung / 2 / (1 - elastic.poisson * elastic.poisson);
  const double radius = .5, b = b_over_radius * radius;
  const double force = std::numbers::pi * modulus * b * b / (4 * radius);
  const double peak = std::sqrt(force * modulus / (std::numbers::pi * radius));
  DeformableBody upper, lower;
  upper.name = "upper";
  upper.mesh = half_disc_mesh({0, 0}, 1, {1.5 * b, 3 * cells / 2}, ElementShape::quadrilateral);
  lower.name = "lower";
  lower.mesh = upper.mesh;
  mirror(lower.mesh, 1, 0);
  for (DeformableBody* body : {&upper, &lower}) reorder_along_curve(body->mesh);
  lower.supports = {{nodes_where(lower.mesh, {.y = -1}), {true, true}, {}}};
  upper.supports = {{nodes_where(upper.mesh, {.y = 1}), {true, false}, {}}};
  upper.dead_loads = {side_load(upper, {.y = 1}, {0, -force})};
  Model model = model_of({lower, upper}, elastic);
  model.contact.normal_stiffness = stiffness * kYoung;
  constexpr int kSteps = 4;
  Simulation simulation(model, statics(kSteps), kSteps, 1);
  Hertz result{};
  for (int i = 1; i <= kSteps; ++i) {
    result.iterations += simulation.balance(static_cast<double>(i) / kSteps).iterations;
  }
  result.balance = simulation.contact_forces()[1].fy / force - 1;
  // p^2 = p0^2 (1 - x^2/b^2) is a straight line in x^2; where it ends, fitted to the edges with
  // more than a fifth of the peak.
  std::vector<std::pair<double, double>> points;
  for (const SurfaceRecord& s : simulation.surfaces()) {
    const double p = s.pressure / peak, x = (s.from.x() + s.to.x()) / 2 / b;
    result.peak = std::max(result.peak, p);
    if (p > .2) points.emplace_back(x * x, p * p);
  }
  test::MatrixXd line(points.size(), 2);
  test::VectorXd height(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<ptrdiff_t>(i);
    line.row(row) << 1, points[i].first;
    height[row] = points[i].second;
  }
  const test::VectorXd fit = line.colPivHouseholderQr().solve(height);
  result.half_width = std::sqrt(-fit[0] / fit[1]);
  return result;
}

}  // namespace

TEST_CASE("Hertz: two half discs", "[equilibrium][slow]") {
  struct Case {
    double b_over_radius;
    int cells;  // over the half-width
    double stiffness;
    double peak, half_width;  // errors
    bool lengthy;
  };
  const Case cases[]{
      {.05, 10, 1, .012, .015, false}, {.05, 20, 1, .012, .015, true},
      {.05, 20, 10, .012, .015, true}, {.025, 20, 10, .006, .0075, true},
      {.1, 10, 1, .02, .02, true},
  };
  for (const Case& c : cases) {
    if (c.lengthy && !test::long_run()) continue;
    const Hertz found = hertz(c.b_over_radius, test::kSanitized ? 4 : c.cells, c.stiffness);
    if (test::kSanitized) continue;  // too coarse to compare
    INFO("b/R " << c.b_over_radius << ", cells " << c.cells << ", k/E " << c.stiffness);
    CAPTURE(found.peak, found.half_width, found.balance, found.iterations);
    CHECK(std::abs(found.peak - 1) < c.peak);
    CHECK(std::abs(found.half_width - 1) < c.half_width);
    CHECK(std::abs(found.balance) < 1e-5);
  }
}
