// Dashpots in contacts: restitution, rest, ledgers.
#include <catch2/catch.hpp>
#include <cmath>

#include <fmt/format.h>

#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/archive/saved.hpp"
#include "tests/dynamics/surface_models.hpp"
#include "tests/shapes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace viscous {
namespace {

enum class Kind { rigid, quads, triangles, polygons };

Mesh block_mesh(const Vec2& corner, const Vec2& size, std::array<int, 2> cells, Kind kind) {
  if (kind == Kind::polygons) {
    const Polygon region({corner,
                          {corner.x() + size.x(), corner.y()},
                          corner + size,
                          {corner.x(), corner.y() + size.y()}});
    VoronoiOptions options;
    options.cells = cells[0] * cells[1];
    return mesh_of_cells(region, in_world(region, voronoi_mesh(region, options).mesh));
  }
  return rectangle_mesh(
      size, cells, corner,
      kind == Kind::triangles ? ElementShape::triangle : ElementShape::quadrilateral);
}

void add_block(Model& model, const char* name, const Vec2& corner, const Vec2& size, Kind kind,
               std::array<int, 2> cells, const Vec2& velocity = Vec2::Zero()) {
  if (kind == Kind::rigid) {
    RigidBody body;
    body.name = name;
    body.velocity = velocity;
    set_shape(body,
              samples::block(corner.x(), corner.y(), corner.x() + size.x(), corner.y() + size.y()),
              model);
    model.bodies.push_back(body);
    return;
  }
  add(model, name, block_mesh(corner, size, cells, kind),
      kind == Kind::quads       ? ElementKind::quad4
      : kind == Kind::triangles ? ElementKind::tri3
                                : ElementKind::polygon,
      velocity);
}

// Of a mass on a spring and a dashpot that cannot pull (T. Schwager and T. Poeschel, Granular
// Matter 9 (2007) 465-469, Eq. 21, for ratios below 1/sqrt(2)).
double restitution(double ratio) {
  const double damped = std::sqrt(1 - ratio * ratio);
  return std::exp(-ratio / damped *
                  (M_PI - std::atan(2 * ratio * damped / (1 - 2 * ratio * ratio))));
}

}  // namespace

TEST_CASE("a free impact rebounds as the ratio of damping promises", "[viscous]") {
  const Kind kind = GENERATE(Kind::rigid, Kind::quads);
  const ContactSurface surface = GENERATE(ContactSurface::body, ContactSurface::element);
  if (kind == Kind::rigid && surface == ContactSurface::element) return;
  for (const double ratio : {.05, .2, .5}) {
    CAPTURE(kind, surface, ratio);
    Model model = empty_model();
    model.contact.normal_stiffness = 2e6;  // the block is rigid beside its contact
    model.contact.damping = {ratio, ratio, 0};
    model.contact.surface = surface;
    if (surface == ContactSurface::element) {
      model.contact.distribution = ForceDistribution::resultant;
    }
    add_floor(model);
    add_block(model, "block", {-.5, 1e-4}, {1, 1}, kind, {2, 2}, {0, -.2});
    Simulation simulation(model, {.end = 10}, 1, 1);
    bool touched = false;
    while (!touched || simulation.counts().touching_now > 0) {
      simulation.step();
      touched = touched || simulation.counts().touching_now > 0;
    }
    // Of the mass centre.
    const double speed = simulation.momenta().y / (2000. * model.thickness);
    CHECK(speed / .2 == Approx(restitution(ratio)).margin(.012));
    const Energies e = simulation.energies();
    CHECK(std::abs(e.total_error) < .01 * e.damping_loss);
  }
}

TEST_CASE("a rigid impact rebounds alike wherever it begins within a step", "[viscous]") {
  const double ratio = GENERATE(.05, .2, .5);
  for (int phase = 0; phase < 8; ++phase) {
    Model model = empty_model();
    model.contact.normal_stiffness = 2e6;
    model.contact.damping = {ratio, ratio, 0};
    add_floor(model);
    const double speed = .2;
    Model first = model;
    add_block(first, "block", {-.5, 1e-4}, {1, 1}, Kind::rigid, {1, 1});
    const double way = speed * Simulation(first, {.end = 10}, 1, 1).step_size();
    add_block(model, "block", {-.5, 1e-4 + phase / 8. * way}, {1, 1}, Kind::rigid, {1, 1},
              {0, -speed});
    Simulation simulation(model, {.end = 10}, 1, 1);
    bool touched = false;
    while (!touched || simulation.counts().touching_now > 0) {
      simulation.step();
      touched = touched || simulation.counts().touching_now > 0;
    }
    CAPTURE(ratio, phase);
    CHECK(simulation.momenta().y / (2000. * model.thickness * speed) ==
          Approx(restitution(ratio)).margin(.02));
  }
}

TEST_CASE("a contact that ends and begins again beside another one is damped as a new one",
          "[viscous]") {
  // Two feet: the left one stands all the time, the right one is dropped on the floor.
  for (const bool both : {false, true}) {
    Model model = empty_model();
    model.contact.normal_stiffness = 2e6;
    model.contact.damping = {.2, .2, 0};
    model.gravity = {0, -9.81};
    add_floor(model);
    RigidBody table;
    table.name = "table";
    set_shape(table,
              Polygon({{0, 0}, {.2, 0}, {.2, .3}, {.8, .3}, {.8, 0}, {1, 0}, {1, .5}, {0, .5}}),
              model);
    table.spin = both ? 0 : .05;
    model.bodies.push_back(table);
    Simulation simulation(model, {.end = 2}, 1, 1);
    while (simulation.state().time < 2) simulation.step();
    const Energies e = simulation.energies();
    CAPTURE(both, e.kinetic, e.damping_loss, e.total_error);
    CHECK(e.kinetic < 1e-9);
    CHECK(std::abs(e.total_error) < .02 * e.damping_loss);
    for (const ContactRecord& c : simulation.contacts()) {
      CHECK(c.damping.norm() < 1e-6 * c.normal.norm());
    }
  }
}

TEST_CASE("what should stick rests on a slope, and slides beyond its limit", "[viscous][slow]") {
  const Kind kind = GENERATE(Kind::rigid, Kind::quads, Kind::triangles, Kind::polygons);
  const bool slides = GENERATE(false, true);
  CAPTURE(kind, slides);
  Model model = empty_model();
  model.materials[0].elastic.young = 2e8;
  model.contact.normal_stiffness = 2e8;
  const double angle = M_PI / 9;
  model.contact.friction = {std::tan(angle) / (slides ? 1.1 : .9), 1.2e8};
  model.contact.damping = {.2, .2, .1};
  model.gravity = {9.81 * std::sin(angle), -9.81 * std::cos(angle)};
  add_floor(model);
  add_block(model, "block", {-.25, 0}, {.5, .5}, kind, {4, 4});
  const double end = 1;
  Simulation simulation(model, {.end = end}, 1, 1);
  const auto momentum = [&] { return simulation.momenta().x / (2000. * .25 * model.thickness); };
  while (simulation.state().time < end / 2) simulation.step();
  const double before = momentum(), since = simulation.state().time;
  while (simulation.state().time < end) simulation.step();
  if (slides) {
    const double expected = 9.81 * std::sin(angle) * (1 - 1 / 1.1);
    CHECK((momentum() - before) / (simulation.state().time - since) ==
          Approx(expected).epsilon(.02));
  } else {
    if (long_run()) {
      fmt::print("{}: rest {:.1e} m/s\n", static_cast<int>(kind), std::abs(momentum()));
    }
    CHECK(std::abs(momentum()) < 1e-6);
    CHECK(simulation.energies().kinetic < 1e-9);
  }
}

TEST_CASE("dashpots keep the momenta and never pull", "[viscous]") {
  const Kind kind = GENERATE(Kind::rigid, Kind::triangles);
  Model model = empty_model();
  model.contact.friction = {.4, 1.2e10};
  model.contact.damping = {.3, .3, .1};
  add_block(model, "a", {-.5, -.5}, {1, 1}, kind, {4, 4}, {1, .2});
  add_block(model, "b", {.51, -.2}, {1, 1}, kind, {4, 4}, {-1, 0});
  Simulation simulation(model, {.end = 1}, 1, 1);
  while (simulation.state().time < .05) {
    simulation.step();
    for (const ContactRecord& c : simulation.contacts()) {
      CHECK((c.normal + c.damping).dot(c.normal) > -1e-9 * c.normal.squaredNorm());
    }
  }
  CHECK(simulation.counts().touching_pairs > 0);
  const Momenta p = simulation.momenta();
  for (const double error : {p.x_error, p.y_error, p.angular_error}) {
    CHECK(std::abs(error) < 1e-11 * 2000);
  }
  const Energies e = simulation.energies();
  CHECK(e.damping_loss > 0);
  CHECK(std::abs(e.total_error) < 5e-3 * e.damping_loss);
}

TEST_CASE("dashpots go on bit for bit after a pause", "[viscous]") {
  const Kind kind = GENERATE(Kind::rigid, Kind::triangles);
  const ContactSurface surface = GENERATE(ContactSurface::body, ContactSurface::element);
  Model model = empty_model();
  model.contact.surface = surface;
  if (surface == ContactSurface::element) model.contact.distribution = ForceDistribution::resultant;
  model.contact.friction = {.4, 1.2e10};
  model.contact.damping = {.3, .3, .1};
  add_block(model, "a", {-.5, -.5}, {1, 1}, kind, {2, 2}, {1, .2});
  add_block(model, "b", {.5001, -.2}, {1, 1}, Kind::quads, {2, 2}, {-1, 0});
  Simulation first(model, {.end = 1}, 1, 1);
  while (first.energies().damping_loss == 0) first.step();
  for (int i = 0; i < 5; ++i) first.step();
  Simulation second(model, {.end = 1}, 1, 2);
  test::restore(second, test::saved(first));
  for (int i = 0; i < 20; ++i) first.step(), second.step();
  CHECK(first.state().x == second.state().x);
  CHECK(first.energies().damping_loss == second.energies().damping_loss);
}

TEST_CASE("stiffness, friction and damping of a pair", "[viscous]") {
  // Two equal blocks land on two floors; what is said of the one pair changes nothing of the other.
  Model model = empty_model();
  model.contact.normal_stiffness = 2e6;
  model.materials.push_back(model.materials[0]);
  model.materials[1].name = "soft";
  ContactRule rule{{{{false, 0}, {false, 1}}}};
  rule.normal_stiffness = 5e5;
  rule.damping = ContactDamping{.2, 0, 0};
  model.contact.rules = {rule};
  add_floor(model);
  add_block(model, "plain", {-2, 1e-4}, {1, 1}, Kind::rigid, {}, {0, -.2});
  add_block(model, "soft", {1, 1e-4}, {1, 1}, Kind::rigid, {}, {0, -.2});
  model.bodies[2].material = 1;
  Simulation simulation(model, {.end = 1, .safety = .02}, 1, 1);
  double start[2] = {0, 0}, time[2] = {0, 0};
  while (time[0] == 0 || time[1] == 0) {
    simulation.step();
    for (int i = 0; i < 2; ++i) {
      const bool touches = std::ranges::any_of(
          simulation.contacts(), [&](const ContactRecord& c) { return c.b == i + 1; });
      if (touches && start[i] == 0) start[i] = simulation.state().time;
      if (!touches && start[i] > 0 && time[i] == 0) time[i] = simulation.state().time - start[i];
    }
  }
  CHECK(simulation.state().pose_rate(1)[1] / .2 == Approx(1).epsilon(1e-3));
  CHECK(simulation.state().pose_rate(2)[1] / .2 == Approx(restitution(.2)).epsilon(.01));
  // Half a period: pi/omega, and with damping a little less than twice that.
  const double stiffness = 2e6 * 2 / .5, omega = std::sqrt(stiffness / 2000);
  CHECK(time[0] == Approx(M_PI / omega).epsilon(.03));
  CHECK(time[1] > 1.5 * time[0]);
}

}  // namespace viscous
