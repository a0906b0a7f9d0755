// Bodies that fold onto themselves in motion: a strip folded onto itself, a ring that buckles flat,
// a C that closes on its ends, and a bent wire that is pressed solid.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cstdlib>

#include "lib/dynamics/unstable.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/dynamics/surface_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace folds {
namespace {

Model soft_model(double stiffness) {
  Model model = empty_model();
  model.materials = {{"rubber", 1000, {ElasticLaw::neo_hookean, Plane::strain, 1e6, .3}}};
  model.contact.normal_stiffness = stiffness;
  model.contact.self = true;
  return model;
}

// A strip of the length and width of `size`, laid along a curve: its middle line at s is `place`,
// its width goes along the left normal of `angle`.
template <class Curve>
Mesh along(const Vec2& size, const std::array<int, 2>& cells, ElementShape shape,
           const Curve& curve) {
  Mesh strip = rectangle_mesh(size, cells, {0, -size.y() / 2}, shape);
  for (Vec2& x : strip.nodes) {
    const auto [place, angle] = curve(x.x());
    x = place + x.y() * Vec2(-std::sin(angle), std::cos(angle));
  }
  reorder_along_curve(strip);
  return strip;
}

struct Fold {
  double error = 0;     // largest energy error, J
  double last = 0;      // energy error at the end, J
  double total = 0;     // largest sum of the energies, J
  double contact = 0;   // largest contact energy, J
  double momentum = 0;  // largest error, N s
  double penetration = 0;
  std::string what;
};

// With the default step, or with one that is chosen.
Fold run(const Model& model, std::optional<double> safety, double end) {
  TimeSettings time;
  time.end = end;
  time.element_safety = time.safety = safety;
  Simulation simulation(model, time, 1, 1);
  Fold result;
  try {
    while (simulation.state().time < end) {
      simulation.step();
      if (simulation.state().step % 5 != 0) continue;
      const Energies e = simulation.energies();
      const Momenta p = simulation.momenta();
      result.error = std::max(result.error, std::abs(e.total_error));
      result.last = std::abs(e.total_error);
      result.total = std::max(result.total, e.kinetic + e.strain + e.contact);
      result.contact = std::max(result.contact, e.contact);
      for (const double error : {p.x_error, p.y_error, p.angular_error}) {
        result.momentum = std::max(result.momentum, std::abs(error));
      }
    }
  } catch (const Unstable& error) {
    result.what = error.what();
  }
  result.penetration = simulation.extremes().penetration.value;
  return result;
}

ElementKind kind_of(ElementShape shape) {
  return shape == ElementShape::triangle ? ElementKind::tri3 : ElementKind::quad4;
}

// Adds a free body whose nodes start with the velocity v(x).
template <class Field>
void add_moving(Model& model, const char* name, const Mesh& mesh, ElementShape shape,
                const Field& v) {
  add(model, name, mesh, kind_of(shape), {0, 0});
  DeformableBody& body = model.deformables.back();
  body.displacement.assign(2 * mesh.nodes.size(), 0);
  for (const Vec2& x : mesh.nodes) {
    const Vec2 of_node = v(x);
    body.node_velocity.insert(body.node_velocity.end(), {of_node.x(), of_node.y()});
  }
}

// A ring with a gap, whose ends fly towards each other.
Model closing_c(double stiffness, ElementShape shape, double speed) {
  Model model = soft_model(stiffness);
  const double open = .3;
  const Mesh mesh = along({2 * M_PI - open, .3}, {60, 3}, shape, [&](double s) {
    const double a = open / 2 + s;
    return std::pair(Vec2(std::cos(a), std::sin(a)), a + M_PI / 2);
  });
  add_moving(model, "c", mesh, shape, [&](const Vec2& x) {
    return Vec2(0, x.x() > 0 ? -speed * x.x() * x.x() * x.y() : 0);
  });
  return model;
}

// A hairpin whose legs fly towards each other, the ends first.
Model folding_strip(double stiffness, ElementShape shape, double speed) {
  Model model = soft_model(stiffness);
  const double leg = 1, radius = .15;
  const Mesh mesh = along({2 * leg + M_PI * radius, .1}, {100, 4}, shape, [&](double s) {
    if (s < leg) return std::pair(Vec2(leg - s, radius), M_PI);
    const double a = (s - leg) / radius;
    if (a < M_PI) {
      return std::pair(Vec2(-radius * std::sin(a), radius * std::cos(a)), M_PI + a);
    }
    return std::pair(Vec2(s - leg - M_PI * radius, -radius), 2 * M_PI);
  });
  add_moving(model, "strip", mesh, shape, [&](const Vec2& x) {
    return Vec2(0, x.x() > 0 ? -speed * x.x() * std::copysign(1, x.y()) : 0);
  });
  return model;
}

// A ring that is squashed until its upper and lower halves meet.
Model flat_ring(double stiffness, ElementShape shape, double speed) {
  Model model = soft_model(stiffness);
  Mesh mesh = rectangle_mesh({2 * M_PI, .2}, {64, 3}, {0, 0}, shape);
  // The ends of the strip are one.
  std::vector<int> kept(mesh.nodes.size());
  std::vector<Vec2> nodes;
  for (size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec2 x = mesh.nodes[n];
    kept[n] = -1;
    if (x.x() < 2 * M_PI - 1e-9) {
      kept[n] = static_cast<int>(nodes.size());
      nodes.push_back(x);
    }
  }
  for (size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (kept[n] >= 0) continue;
    for (size_t k = 0; k < nodes.size(); ++k) {
      if (nodes[k].x() < 1e-9 && std::abs(nodes[k].y() - mesh.nodes[n].y()) < 1e-9) {
        kept[n] = static_cast<int>(k);
      }
    }
  }
  Mesh ring;
  for (const Vec2& x : nodes) {
    ring.nodes.push_back((1.1 - x.y()) * Vec2(std::cos(x.x()), .4 * std::sin(x.x())));
  }
  for (ElementIndex e = 0; e < mesh.element_count(); ++e) {
    std::vector<int> corners;
    for (const int n : mesh.element(e)) corners.push_back(kept[n]);
    ring.add_element(corners);
  }
  reorder_along_curve(ring);
  add_moving(model, "ring", ring, shape, [&](const Vec2& x) {
    return Vec2(0, -speed * std::copysign(std::max(0., 1 - x.x() * x.x()), x.y()));
  });
  return model;
}

// A wire bent to and fro, pressed solid between two plates.
Model bent_wire(double stiffness, ElementShape shape, double speed) {
  Model model = soft_model(stiffness);
  const double leg = 1, radius = .1;
  const double turn = M_PI * radius, part = leg + turn;
  const int turns = 4;
  const Mesh mesh = along({(turns + 1) * leg + turns * turn, .08}, {220, 3}, shape, [&](double s) {
    const int k = std::min(turns, static_cast<int>(s / part));
    const double u = s - k * part, y = 2 * radius * k;
    const double right = k % 2 == 0 ? 1 : -1, from = k % 2 == 0 ? 0 : leg;
    if (u <= leg) return std::pair(Vec2(from + right * u, y), right > 0 ? 0 : M_PI);
    const double a = (u - leg) / radius;
    return std::pair(
        Vec2(leg - from + right * radius * std::sin(a), y + radius * (1 - std::cos(a))),
        right > 0 ? a : M_PI - a);
  });
  const double height = 2 * radius * turns;
  for (const double side : {-1., 1.}) {
    RigidBody plate;
    plate.name = side < 0 ? "lower" : "upper";
    plate.motion = Motion::prescribed;
    const double y = side < 0 ? -.25 : height + .05;
    set_shape(plate, samples::block(-.5, y, leg + .5, y + .2), model);
    plate.history.velocity = {{0, {0, -side * speed}}};
    model.bodies.push_back(plate);
  }
  add(model, "wire", mesh, kind_of(shape), {0, 0});
  return model;
}

}  // namespace
}  // namespace folds

namespace folds {
namespace {

void check_fold(const char* name, Model (*make)(double, ElementShape, double), double speed,
                double end) {
  if (kSanitized) {  // under the sanitizers only the first steps
    CHECK(run(make(1e6, ElementShape::triangle, speed), {}, end / 20).what.empty());
    return;
  }
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    for (const double stiffness : {1e6, 1e7}) {
      const Model model = make(stiffness, shape, speed);
      const Fold coarse = run(model, .2, end), fine = run(model, .05, end);
      CAPTURE(name, stiffness, coarse.what, fine.what);
      if (std::getenv("APOTHEM_PRINT")) {
        fmt::print(
            "{} {} k={:.0e}: {:.2e} {:.2e} last {:.2e} {:.2e} of {:.3g}, contact {:.2g}, p {:.1e}, "
            "depth {:.3g}\n",
            name, shape == ElementShape::triangle ? "T3" : "Q4", stiffness,
            coarse.error / coarse.total, fine.error / fine.total, coarse.last / coarse.total,
            fine.last / fine.total, coarse.total, coarse.contact, coarse.momentum,
            coarse.penetration);
      }
      CHECK(coarse.what.empty());
      CHECK(coarse.contact > .005 * coarse.total);
      CHECK(coarse.error / coarse.total < 1e-3);  // on the way, as velocity Verlet has it
      // Where the parts of the body have come apart again; those of the wire are still pressed.
      CHECK(coarse.last / coarse.total < (model.bodies.empty() ? 1e-4 : 5e-4));
      CHECK(coarse.error / fine.error > 6);
      CHECK(coarse.momentum < 1e-9);
    }
  }
}

}  // namespace

TEST_CASE("a C that closes on its ends keeps energy and momenta", "[self_contact]") {
  check_fold("c", closing_c, 4, .2);
}
TEST_CASE("a strip folded onto itself keeps energy and momenta", "[self_contact]") {
  check_fold("strip", folding_strip, 3, .15);
}
TEST_CASE("a ring squashed flat keeps energy and momenta", "[self_contact]") {
  check_fold("ring", flat_ring, 5, .2);
}
TEST_CASE("a bent wire pressed solid keeps energy and momenta", "[self_contact]") {
  check_fold("wire", bent_wire, 4, .055);
}

TEST_CASE("friction and dashpots of a body with itself keep momenta and close the ledger",
          "[self_contact]") {
  Model model = folding_strip(1e6, ElementShape::quadrilateral, 3);
  // The legs slide along each other as well.
  DeformableBody& strip = model.deformables.back();
  for (size_t n = 0; n < strip.mesh.nodes.size(); ++n) {
    strip.node_velocity[2 * n] += .8 * strip.mesh.nodes[n].x() * strip.mesh.nodes[n].y();
  }
  model.contact.friction = {.3, 6e5};
  model.contact.damping = {.2, .2, .05};
  Simulation simulation(model, {.end = .15}, 1, 1);
  const double end = kSanitized ? .01 : .15;
  while (simulation.state().time < end) simulation.step();
  const Momenta p = simulation.momenta();
  for (const double error : {p.x_error, p.y_error, p.angular_error}) CHECK(std::abs(error) < 1e-9);
  const Energies e = simulation.energies();
  const double total = e.kinetic + e.strain + e.contact + e.damping_loss + e.friction_loss;
  CAPTURE(e.friction_loss / total, e.damping_loss / total, e.total_error / total);
  CHECK(std::abs(e.total_error) < 1e-4 * total);
  if (end < .15) return;
  CHECK(e.friction_loss > 1e-5 * total);
  CHECK(e.damping_loss > 1e-3 * total);
}

}  // namespace folds
