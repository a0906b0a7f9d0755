// Contacts that begin or end within a step, at the steps that are chosen by default.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>

#include "apps/cases/impacts.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/dynamics/surface_models.hpp"
#include "tests/shapes.hpp"

using namespace apothem;
using test::Ring;

namespace {

void add_rigid(Model& model, const Ring& ring, const Vec2& velocity, double spin,
               Motion motion = Motion::free) {
  RigidBody body;
  body.name = std::to_string(model.bodies.size());
  body.motion = motion;
  set_shape(body, Polygon(ring), model);
  if (motion == Motion::free) body.velocity = velocity, body.spin = spin;
  model.bodies.push_back(body);
}

// The ring with its lowest vertex at a height.
Ring raised(Ring ring, double height) {
  double low = HUGE_VAL;
  for (const Vec2& p : ring) low = std::min(low, p.y());
  for (Vec2& p : ring) p.y() += height - low;
  return ring;
}

Model falling(const Ring& ring, double height, double sideways = 0, double spin = 0) {
  Model model = test::empty_model();
  test::add_floor(model);
  add_rigid(model, raised(ring, height), {sideways, -1}, spin);
  return model;
}

Model falling_mesh(ElementShape shape, double height) {
  Model model = test::empty_model();
  test::add_floor(model);
  test::add(model, "block", rectangle_mesh({1, 1}, {4, 4}, {-.5, height}, shape),
            shape == ElementShape::triangle ? ElementKind::tri3 : ElementKind::quad4, {0, -1});
  return model;
}

struct Bounce {
  double error = 0;     // after the separation, of the kinetic energy at the start
  double modified = 0;  // the same of Verlet's modified energy, with meshes
  double momentum = 0;  // N s
};

// E + h^2/12 v.K v - h^2/24 F.W F two steps ago, from the forces of five steps: with the
// fourth-order difference of them, K v = -dF/dt.
class ModifiedEnergy {
 public:
  // True if it is known.
  bool add(const Simulation& simulation) {
    const State& state = simulation.state();
    past_.push_back({state.f, state.v, simulation.energies().total_error});
    if (past_.size() > 5) past_.erase(past_.begin());
    return past_.size() == 5;
  }
  [[nodiscard]] double error(const Simulation& simulation) const {
    const double h = simulation.step_size();
    const Layout& layout = simulation.state().layout;
    double sum = 0;
    for (NodeIndex i = 0; i < layout.nodes; ++i) {
      for (size_t axis = 0; axis < 2; ++axis) {
        const size_t c = layout.node(i) + axis;
        const auto f = [&](size_t k) { return past_[k].f[c]; };
        const double slope = (8 * (f(3) - f(1)) - (f(4) - f(0))) / (12 * h);
        sum += -past_[2].v[c] * slope / 12 - f(2) * f(2) / simulation.node_mass()[i] / 24;
      }
    }
    return past_[2].error + h * h * sum;
  }

 private:
  struct Past {
    std::vector<double> f, v;
    double error;
  };
  std::vector<Past> past_;
};

Bounce bounce(const Model& model, const TimeSettings& time) {
  Simulation simulation(model, time, 1, 1);
  const double kinetic = simulation.energies().kinetic;
  const int rest = model.deformables.empty() ? 3 : 200;  // steps after the separation
  Bounce result;
  ModifiedEnergy modified;
  bool touched = false;
  for (int apart = 0; apart < rest && simulation.state().time < .2;) {
    simulation.step();
    const bool touching = simulation.counts().touching_now > 0;
    touched = touched || touching;
    if (touching || !touched) {
      apart = 0, modified = {};
      continue;
    }
    ++apart;
    result.error = std::max(result.error, std::abs(simulation.energies().total_error) / kinetic);
    if (modified.add(simulation)) {
      result.modified = std::max(result.modified, std::abs(modified.error(simulation)) / kinetic);
    }
  }
  REQUIRE(touched);
  const Momenta p = simulation.momenta();
  result.momentum = std::max({std::abs(p.x_error), std::abs(p.y_error), std::abs(p.angular_error)});
  return result;
}

// The worst of all phases: the height of the fall changes by parts of a step.
template <class ModelAt>
Bounce worst_phase(const ModelAt& model_at, TimeSettings time, int phases = 8) {
  const double height = .003;
  const double step = Simulation(model_at(height), time, 1, 1).step_size();
  time.fixed_step = step;
  Bounce worst;
  for (int i = 0; i < phases; ++i) {
    const Bounce b = bounce(model_at(height + (i + .37) / phases * step), time);
    worst.error = std::max(worst.error, b.error);
    worst.modified = std::max(worst.modified, b.modified);
    worst.momentum = std::max(worst.momentum, b.momentum);
  }
  return worst;
}

TimeSettings defaults() { return {.end = 1}; }

TimeSettings plain() { return {.end = 1, .onsets = false}; }

}  // namespace

TEST_CASE("rigid bodies that land flat or nearly flat keep their energy in all phases of the step",
          "[onset]") {
  const Ring square{{-.5, -.5}, {.5, -.5}, {.5, .5}, {-.5, .5}};
  const Ring bar{{-1, -.25}, {1, -.25}, {1, .25}, {-1, .25}};
  for (const Ring& ring : {square, bar}) {
    for (const double tilt : {0., 1e-4, 3e-4, 1e-3, 3e-3, .01, .1}) {
      CAPTURE(ring.size(), tilt);
      const auto model = [&](double height) { return falling(test::turned(ring, tilt), height); };
      const Bounce b = worst_phase(model, defaults());
      CHECK(b.error < 1e-4);
      CHECK(b.momentum < 1e-11);
    }
  }
  const auto flat = [&](double height) { return falling(square, height); };
  CHECK(worst_phase(flat, plain()).error > 100 * worst_phase(flat, defaults()).error);
  for (const double spin : {.3, 1., 3.}) {
    const auto sliding = [&](double height) { return falling(square, height, .5, spin); };
    const auto wide = [&](double height) { return falling(bar, height, .5, spin); };
    CAPTURE(spin);
    CHECK(worst_phase(sliding, defaults()).error < 1e-4);
    CHECK(worst_phase(wide, defaults()).error < 1e-4);
  }
}

TEST_CASE("two vertices that leave in neighbouring steps are told apart", "[onset]") {
  // Free bodies, out of centre: one corner leaves a few hundredths of a step before the other one.
  const auto eccentric = [](double height) {
    Model model = test::empty_model();
    add_rigid(model, {{-1, -.3}, {1, -.3}, {1, .3}, {-1, .3}}, {0, .2}, 0);
    add_rigid(model, raised({{-.2, 0}, {.25, 0}, {.25, .4}, {-.2, .4}}, .3 + height), {.1, -1}, 0);
    return model;
  };
  // A bar that rocks from one end to the other one through its flat position, at the end of a step.
  const auto rocking = [](double height) {
    return falling(test::turned({{-1, -.25}, {1, -.25}, {1, .25}, {-1, .25}}, 3e-4), height);
  };
  CHECK(worst_phase(eccentric, defaults(), 48).error < 1e-5);
  CHECK(worst_phase(rocking, defaults(), 48).error < 1e-4);
  TimeSettings shorter = defaults();
  shorter.safety = .12;
  CHECK(worst_phase(rocking, shorter, 48).error < 1e-5);
}

TEST_CASE("damped feet that land and leave one after the other lose what the ledger says",
          "[onset]") {
  const Ring feet{{-.5, 0}, {-.3, 0}, {-.3, .3}, {.2, .3}, {.2, 0}, {.6, 0}, {.6, .6}, {-.5, .6}};
  const auto model_at = [&](double height) {
    Model model = falling(feet, height, 0, .1);
    model.contact.damping.normal = .1;
    return model;
  };
  const Bounce b = worst_phase(model_at, defaults());
  CHECK(b.error < 1e-4);
  CHECK(b.momentum < 1e-9);
}

TEST_CASE("bodies that touch when a run starts keep their energy", "[onset]") {
  const Ring square{{-.5, -.5}, {.5, -.5}, {.5, .5}, {-.5, .5}};
  for (const double height : {0., 1e-17, -1e-17}) {
    CAPTURE(height);
    CHECK(bounce(falling(square, height), defaults()).error < 1e-5);
    CHECK(bounce(falling_mesh(ElementShape::quadrilateral, height), defaults()).modified < 1e-5);
  }
}

TEST_CASE("rigid polygons of any shape keep their energy in all phases of the step", "[onset]") {
  test::SeededRandom random(71);
  for (int i = 0; i < test::scaled(20); ++i) {
    const Ring ring = test::random_polygon(random, random.integer(3, 9)).vertices();
    const double spin = random.uniform(-1, 1);
    CAPTURE(i);
    const auto model = [&](double height) { return falling(ring, height, .2, spin); };
    const Bounce b = worst_phase(model, defaults(), 4);
    CHECK(b.error < 1e-4);
    CHECK(b.momentum < 1e-9);
  }
  const auto crosses = [](double height) {
    Model model = test::empty_model();
    const Ring lower = test::turned(test::cross_ring(.3), .2);
    add_rigid(model, lower, {0, 0}, .3);
    double top = -HUGE_VAL;
    for (const Vec2& p : lower) top = std::max(top, p.y());
    Ring other = raised(test::turned(test::cross_ring(.3), .7), top + height);
    for (Vec2& p : other) p.x() += .05;
    add_rigid(model, other, {.1, -1}, -.8);
    return model;
  };
  CHECK(worst_phase(crosses, defaults(), 4).error < 1e-4);
}

TEST_CASE("meshed blocks that land flat keep the modified energy", "[onset]") {
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    CAPTURE(static_cast<int>(shape));
    const auto model = [&](double height) { return falling_mesh(shape, height); };
    const Bounce corrected = worst_phase(model, defaults(), 4);
    const Bounce before = worst_phase(model, plain(), 4);
    CAPTURE(corrected.modified, before.modified, corrected.error, before.error);
    CHECK(corrected.modified < 1e-5);
    CHECK(before.modified > 50 * corrected.modified);
    CHECK(corrected.error < before.error);
    CHECK(corrected.momentum < 1e-9);
  }
}

TEST_CASE("the error of a gas per impact falls by a factor of 20 and more", "[onset]") {
  const auto run = [](bool onsets) {
    Model model = test::empty_model();
    model.contact.normal_stiffness = 2e9;
    const double side = 6.4;
    const auto wall = [&](double x0, double y0, double x1, double y1) {
      add_rigid(model, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, Vec2::Zero(), 0, Motion::fixed);
    };
    wall(-1, -1, side + 1, 0), wall(-1, side, side + 1, side + 1);
    wall(-1, 0, 0, side), wall(side, 0, side + 1, side);
    samples::Random random(5);  // the same cases always: the bound is a measured one
    for (int i = 0; i < 16; ++i) {
      Ring ring;
      const int n = random.integer(4, 8);
      for (int k = 0; k < n; ++k) {
        const double angle = 2 * M_PI * (k + random.uniform(0, .6)) / n;
        ring.emplace_back(.8 + 1.6 * (i % 4) + .5 * std::cos(angle),
                          .8 + 1.6 * (i / 4) + .5 * std::sin(angle));
      }
      add_rigid(model, ring, {random.uniform(-2, 2), random.uniform(-2, 2)}, random.uniform(-1, 1));
    }
    Simulation simulation(model, {.end = 1e3, .safety = .1, .onsets = onsets}, 1, 1);
    const double of_body = simulation.energies().kinetic / 16;
    return samples::error_per_impact(simulation, test::scaled(300), of_body);
  };
  const double corrected = run(true), before = run(false);
  CAPTURE(corrected, before);
  CHECK(corrected < before / 20);
}

// With APOTHEM_LONG the table in docs/verification.md: the worst error of 16 phases at three parts
// of the stability limit, as velocity Verlet takes the steps and corrected, the time of a bounce,
// and the worst of 48 phases at the step that is chosen by default.
TEST_CASE("work and precision of one bounce", "[onset]") {
  if (!test::long_run()) return;
  const Ring square{{-.5, -.5}, {.5, -.5}, {.5, .5}, {-.5, .5}};
  const Ring bar{{-1, -.25}, {1, -.25}, {1, .25}, {-1, .25}};
  const auto tilted = [](const Ring& ring, double tilt) {
    return [=](double height) { return falling(test::turned(ring, tilt), height); };
  };
  const auto row = [](const std::string& name, const auto& model) {
    fmt::print("{}:", name);
    for (const bool onsets : {false, true}) {
      fmt::print(" {}", onsets ? "corrected" : "plain");
      for (const double safety : {.1, .2, .4}) {
        const TimeSettings time{
            .end = 1, .safety = safety, .element_safety = safety, .onsets = onsets};
        const auto start = std::chrono::steady_clock::now();
        const Bounce b = worst_phase(model, time, 16);
        const std::chrono::duration<double, std::micro> spent =
            std::chrono::steady_clock::now() - start;
        fmt::print(" {:.1e}", b.error);
        if (b.modified > 0) fmt::print(" (modified {:.1e})", b.modified);
        fmt::print(" in {:.0f} us", spent.count() / 16);
      }
    }
    fmt::print(" default {:.1e}\n", worst_phase(model, defaults(), 48).error);
  };
  row("square, flat", tilted(square, 0));
  for (const double tilt : {1e-4, 3e-4, 1e-3, .01, .1}) {
    row(fmt::format("square, tilt {:g}", tilt), tilted(square, tilt));
  }
  for (const double tilt : {1e-4, 3e-4, 1e-3}) {
    row(fmt::format("bar of 4 : 1, tilt {:g}", tilt), tilted(bar, tilt));
  }
  row("square that slides and turns",
      [&](double height) { return falling(square, height, .5, .3); });
  row("square, flat, damping ratio .3", [&](double height) {
    Model model = falling(square, height);
    model.contact.damping.normal = .3;
    return model;
  });
  row("star of 7 points", [&](double height) { return falling(test::star_ring(7, .5), height); });
  for (const ElementShape shape : {ElementShape::quadrilateral, ElementShape::triangle}) {
    row(shape == ElementShape::triangle ? "block of 4 x 4 cells, T3, flat"
                                        : "block of 4 x 4 cells, Q4, flat",
        [=](double height) { return falling_mesh(shape, height); });
  }
}

TEST_CASE("swapping the bodies of an onset swaps what happens to them, to the last bit",
          "[onset]") {
  const Ring square{{-.5, -.5}, {.5, -.5}, {.5, .5}, {-.5, .5}};
  const auto run = [&](bool swapped) {
    Model model = test::empty_model();
    const Ring lower = test::turned(square, .001);
    const Ring upper = raised(test::cross_ring(.4), .503);
    if (swapped) add_rigid(model, upper, {.1, -1}, .2);
    add_rigid(model, lower, {0, 0}, -.1);
    if (!swapped) add_rigid(model, upper, {.1, -1}, .2);
    Simulation simulation(model, defaults(), 1, 1);
    bool touched = false;
    for (int i = 0; i < 400; ++i) {
      simulation.step();
      touched = touched || simulation.counts().touching_now > 0;
    }
    CHECK(touched);
    CHECK(simulation.counts().touching_now == 0);
    const State& s = simulation.state();
    return std::array{Eigen::Vector3d(s.pose_rate(swapped ? 1 : 0)),
                      Eigen::Vector3d(s.pose_rate(swapped ? 0 : 1))};
  };
  const auto once = run(false), twice = run(true);
  for (size_t i = 0; i < 2; ++i) CHECK((once[i] - twice[i]).norm() == 0);
}
