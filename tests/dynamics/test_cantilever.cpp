// The paper's cantilever under a ramped load (Figs. 22-24) against CalculiX, for all elements.
// APOTHEM_LONG=1 adds the finer meshes and prints the table of docs/verification.md.
#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "lib/dynamics/simulation.hpp"
#include "lib/mesh/locate.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/reorder.hpp"
#include "lib/mesh/select.hpp"
#include "lib/output/history.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

struct Curve {
  std::vector<double> time, deflection;
};

double at(const Curve& c, double t) {
  const auto i = static_cast<size_t>(std::lower_bound(c.time.begin(), c.time.end(), t - 1e-9) -
                                     c.time.begin());
  return c.deflection.at(i);
}

// Deepest point after the load is full, and the mean period of the vibration.
struct Swing {
  double peak = 0, period = 0;
};
Swing swing(const Curve& c) {
  Swing s;
  std::vector<double> minima;
  for (size_t i = 1; i + 1 < c.time.size(); ++i) {
    const double a = c.deflection[i - 1], b = c.deflection[i], d = c.deflection[i + 1];
    if (c.time[i] < .5 || c.time[i] > 1.495 || !(b < a && b <= d)) continue;
    const double step = c.time[i + 1] - c.time[i];
    const double shift = (a - d) / (2 * (a - 2 * b + d));  // of the parabola through the three
    minima.push_back(c.time[i] + shift * step);
    s.peak = std::min(s.peak, b - (a - d) * shift / 4);
  }
  s.period = (minima.back() - minima.front()) / static_cast<double>(minima.size() - 1);
  return s;
}

Curve cantilever(ElementKind kind, double h) {
  DeformableBody body;
  body.name = "beam";
  body.element = kind;
  const int high = static_cast<int>(std::lround(1 / h));
  body.mesh = rectangle_mesh(
      {10, 1}, {10 * high, high}, {0, 0},
      kind == ElementKind::tri3 ? ElementShape::triangle : ElementShape::quadrilateral);
  reorder_along_curve(body.mesh);
  body.supports = {{nodes_where(body.mesh, {.x = 0.}), {true, true}, {}}};
  body.dead_loads = {
      {nodes_where(body.mesh, {.nearest = Vec2(9.8, 1)}), {{0, -1.5e7}}, {{{0, 0}, {.5, 1}}}}};
  const MeshPoint tip = *find_point(body.mesh, {10, .5});
  const std::span<const int> found = body.mesh.element(tip.element);
  const std::vector<int> corners(found.begin(), found.end());
  Model model;
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::stress, 20e9, .2}}};
  model.deformables = {std::move(body)};
  TimeSettings time;
  time.end = 1.5;
  const int rows = 1200;
  Simulation simulation(model, time, rows, 1);
  Curve curve;
  for (int row = 0; row <= rows; ++row) {
    while (simulation.state().time < row * 1.5 / rows - 1e-9) simulation.step();
    curve.time.push_back(simulation.state().time);
    double uy = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
      uy += tip.weights[i] * simulation.state().node(corners[i]).y();
    }
    curve.deflection.push_back(uy);
  }
  return curve;
}

}  // namespace

TEST_CASE("cantilever under a ramped load: all elements against CalculiX", "[deformable]") {
  const HistoryTable table =
      read_history(test::kSource + "/data/reference/cantilever_plane_stress_calculix.csv");
  const Curve reference{*table.column("t"), *table.column("uy_mid")};
  const Swing goal = swing(reference);
  // What an independent explicit code reaches at .5, 1 and 1.5 s, m (data/reference/README.md).
  struct Case {
    ElementKind kind;
    const char* name;
    double h;
    double errors[3];
  };
  const Case cases[]{
      {ElementKind::tri3, "T3", .2, {.18, .14, .66}},
      {ElementKind::quad4_full, "Q4-full", .2, {.037, .059, .125}},
      {ElementKind::quad4, "Q4", .2, {.0105, .0095, .014}},
      {ElementKind::polygon, "polygon", .2, {.0105, .0095, .014}},
      {ElementKind::tri3, "T3", .1, {.038, .067, .165}},
      {ElementKind::quad4_full, "Q4-full", .1, {.007, .015, .028}},
      {ElementKind::quad4, "Q4", .1, {.0005, .001, .0015}},
      {ElementKind::polygon, "polygon", .1, {.0005, .001, .0015}},
      {ElementKind::tri3, "T3", .05, {.009, .020, .039}},
      {ElementKind::quad4_full, "Q4-full", .05, {.002, .004, .007}},
      {ElementKind::quad4, "Q4", .05, {.0005, .0008, .001}},
      {ElementKind::polygon, "polygon", .05, {.0005, .0008, .001}},
  };
  for (const Case& c : cases) {
    if (!test::long_run() && (c.h < .2 || test::scaled(50) < 50)) continue;
    const Curve curve = cantilever(c.kind, c.h);
    const Swing found = swing(curve);
    if (test::long_run()) {
      fmt::print("| {} | {} | {:+.4f} / {:+.4f} / {:+.4f} | {:+.2f} % | {:+.2f} % |\n", c.name, c.h,
                 at(curve, .5) - at(reference, .5), at(curve, 1) - at(reference, 1),
                 at(curve, 1.5) - at(reference, 1.5), 100 * (found.peak / goal.peak - 1),
                 100 * (found.period / goal.period - 1));
    }
    INFO(c.name << " " << c.h);
    for (int k = 0; k < 3; ++k) {
      const double t = .5 * (k + 1);
      CHECK(std::abs(at(curve, t) - at(reference, t)) < 1.05 * c.errors[k]);
    }
  }
}
