// Bodies of finite elements in motion: free flight, vibration, damping of the material.
#include <catch2/catch.hpp>
#include <numbers>

#include "lib/dynamics/unstable.hpp"
#include "lib/fem/spectrum.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/mesh/reorder.hpp"
#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("a spinning free body keeps energy and momenta over 100 turns", "[deformable][slow]") {
  for (const ElementKind kind :
       {ElementKind::tri3, ElementKind::quad4, ElementKind::quad4_full, ElementKind::polygon}) {
    DeformableBody body = block({1, .5}, {8, 4}, kind);
    body.velocity = {3, -2};
    body.spin = 200;
    const Model model = model_of(body, rock());
    TimeSettings time;
    time.end = 200 * std::numbers::pi / body.spin;
    Simulation simulation(model, time, 10, 1);
    const Energies before = simulation.energies();
    // The centrifugal load comes at once: the body pulses, and Verlet's energy with it.
    double early = 0, late = 0;
    while (simulation.state().time < time.end) {
      simulation.step();
      if (simulation.state().step % 50 != 0) continue;
      const double error = std::abs(simulation.energies().total_error) / before.kinetic;
      if (simulation.state().time < .1 * time.end) early = std::max(early, error);
      if (simulation.state().time > .9 * time.end) late = std::max(late, error);
    }
    const Momenta p = simulation.momenta();
    INFO(static_cast<int>(kind));
    CHECK(early < 1e-5);
    CHECK(late < 1.05 * early);
    CHECK(std::abs(p.x_error) < 1e-10 * std::abs(p.x));
    CHECK(std::abs(p.angular_error) < 1e-10 * std::abs(p.angular));
  }
}

namespace {

constexpr std::array kKinds{ElementKind::tri3, ElementKind::quad4, ElementKind::quad4_full,
                            ElementKind::polygon};

// Inner nodes moved at random, by up to a share of the cell size.
void distort(Mesh& mesh, double by, std::uint64_t seed) {
  samples::Random random(seed);
  const Boundary outline = boundary(mesh);
  std::vector<bool> outer(mesh.nodes.size(), false);
  for (const int node : outline.loops[0].nodes) outer[node] = true;
  for (size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec2 move(random.uniform(-by, by), random.uniform(-by, by));
    if (!outer[i]) mesh.nodes[i] += move;
  }
}

// Clamped at x = 0, hit by a velocity across that grows towards the tip.
Model vibrating_beam(double speed, const Material& material) {
  DeformableBody body = block({2, .2}, {20, 2}, ElementKind::quad4);
  body.supports = {{nodes_at(body.mesh, 0), {true, true}, {}}};
  body.velocity = {0, speed};
  return model_of(std::move(body), material);
}

double worst_error(const Model& model, double step, double end) {
  TimeSettings time;
  time.end = end;
  time.fixed_step = step;
  Simulation simulation(model, time, 1, 1);
  const double energy = simulation.energies().kinetic;
  double worst = 0;
  while (simulation.state().time < end) {
    simulation.step();
    if (simulation.state().step % 7 == 0) {
      worst = std::max(worst, std::abs(simulation.energies().total_error));
    }
  }
  return worst / energy;
}

}  // namespace

TEST_CASE("the highest frequency is that of a long power iteration", "[deformable]") {
  for (const ElementKind kind : kKinds) {
    DeformableBody body = block({1, 1}, {6, 6}, kind);
    distort(body.mesh, .05, 3);
    const Elastic e = rock().elastic;
    FiniteElements elements(std::vector<ElementSet>{{kind, &body.mesh, 0, e, 2000, 1, 0}}, 1);
    std::vector<double> inverse_mass;
    for (const double m : elements.mass()) inverse_mass.insert(inverse_mass.end(), 2, 1 / m);
    std::vector<double> u(inverse_mass.size(), 0);
    const double found = largest_eigenvalue(elements, u, inverse_mass);
    // u <- M^-1 K u by the force itself, small enough to be linear.
    samples::Random random(1);
    std::vector<double> v(u.size()), f(u.size());
    for (double& x : v) x = random.uniform(-1e-9, 1e-9);
    double ratio = 0;
    for (int step = 0; step < 4000; ++step) {
      elements.force(v, u, f);
      double up = 0, down = 0, size = 0;
      for (size_t c = 0; c < v.size(); ++c) {
        up -= v[c] * f[c];
        down += v[c] * v[c] / inverse_mass[c];
        f[c] *= -inverse_mass[c];
        size = std::max(size, std::abs(f[c]));
      }
      ratio = up / down;
      for (size_t c = 0; c < v.size(); ++c) v[c] = 1e-9 * f[c] / size;
    }
    INFO(static_cast<int>(kind));
    CHECK(found >= ratio * (1 - 1e-4));
    CHECK(found < ratio * 1.01);
  }
}

TEST_CASE("a step above the limit of the elements is refused, one below is stable",
          "[deformable]") {
  const Model model = vibrating_beam(1e-3, rock());
  TimeSettings time;
  time.end = .02;
  const double limit = Simulation(model, time, 1, 1).step_choice().stability;
  time.fixed_step = 1.001 * limit;
  CHECK_THROWS_AS(Simulation(model, time, 1, 1), Unrunnable);
  CHECK(worst_error(model, .99 * limit, .02) < .3);
}

TEST_CASE("energy of a large vibration: order 2, no drift over 1e5 steps", "[deformable]") {
  const Model model = vibrating_beam(60, rock());
  TimeSettings time;
  time.end = .02;
  const double limit = Simulation(model, time, 1, 1).step_choice().stability;
  const double coarse = worst_error(model, .6 * limit, .02);
  const double fine = worst_error(model, .3 * limit, .02);
  CHECK(coarse < 2e-3);
  CHECK(coarse / fine > 3.5);
  CHECK(coarse / fine < 4.6);

  // Mean error of each tenth of 1e5 steps: it stays where it is. Fewer steps are no mean.
  if (test::kSanitized) return;
  const Model gentle = vibrating_beam(5, rock());
  const int tenth = 10000;
  time.end = 10 * tenth * .6 * limit;
  time.fixed_step = .6 * limit;
  Simulation simulation(gentle, time, 1, 1);
  const double energy = simulation.energies().kinetic;
  std::vector<double> means;
  for (int part = 0; part < 10; ++part) {
    double sum = 0;
    for (int i = 0; i < tenth; ++i) {
      simulation.step();
      if (i % 10 == 0) sum += simulation.energies().total_error / energy;
    }
    means.push_back(sum / (tenth / 10.));
  }
  const auto [least, most] = std::minmax_element(means.begin(), means.end());
  CHECK(*most - *least < 2e-5);
}

TEST_CASE("Rayleigh damping: decay of a bar, and the ledger closes", "[deformable]") {
  Material material = rock();
  material.elastic.poisson = 0;
  material.mass_damping = 40;
  material.stiffness_damping = 4e-6;
  DeformableBody body = block({1, .1}, {40, 4}, ElementKind::quad4);
  body.supports = {{nodes_at(body.mesh, 0), {true, true}, {}}};
  const int tip = nodes_where(body.mesh, {.nearest = Vec2(1, .05)})[0];
  const double w = M_PI / 2 * std::sqrt(20e9 / 2000);
  Model model = model_of(std::move(body), material);
  model.deformables[0].velocity = {1e-3, 0};
  TimeSettings time;
  time.end = 20 * 2 * M_PI / w;
  const double limit = Simulation(model, time, 1, 1).step_choice().stability;
  double errors[2], late = 0, early = 0;
  for (const int k : {0, 1}) {
    time.fixed_step = (k == 0 ? .5 : .25) * limit;
    Simulation simulation(model, time, 1, 1);
    const double energy = simulation.energies().kinetic;
    errors[k] = early = late = 0;
    while (simulation.state().time < time.end) {
      simulation.step();
      const double t = simulation.state().time * w / (2 * M_PI);
      const double u = std::abs(simulation.state().node(tip).x());
      if (t > 4 && t < 5) early = std::max(early, u);
      if (t > 14 && t < 15) late = std::max(late, u);
      if (simulation.state().step % 10 == 0) {
        errors[k] = std::max(errors[k], std::abs(simulation.energies().total_error) / energy);
      }
    }
  }
  CHECK(errors[0] < 1e-3);
  CHECK(errors[0] / errors[1] > 3.3);
  const double ratio = material.mass_damping / (2 * w) + material.stiffness_damping * w / 2;
  CHECK(late / early == Approx(std::exp(-ratio * 2 * M_PI * 10)).epsilon(.03));
}

TEST_CASE("a steady rotation is not damped", "[deformable]") {
  for (const ElementKind kind : kKinds) {
    INFO(static_cast<int>(kind));
    DeformableBody body = block({1, .5}, {4, 2}, kind);
    body.spin = 50;
    Model model = model_of(body, rock());
    model.materials[0].elastic.young = 1e7;
    model.materials[0].stiffness_damping = 2e-3;
    TimeSettings time;
    time.end = 2;
    Simulation simulation(model, time, 1, 1);
    while (simulation.state().time < 1) simulation.step();
    const double lost = simulation.energies().damping_loss;
    CHECK(lost > 0);  // by the oscillations at the start
    while (simulation.state().time < 2) simulation.step();
    CHECK(std::abs(simulation.energies().damping_loss - lost) < 1e-9 * lost);
  }
}

TEST_CASE("threads change no bit", "[deformable]") {
  DeformableBody body = block({2, 1}, {70, 35}, ElementKind::quad4);
  reorder_along_curve(body.mesh);
  body.velocity = {1, 2};
  body.spin = 500;
  const Model model = model_of(std::move(body), rock());
  TimeSettings time;
  time.end = 1;
  std::vector<double> serial;
  for (const int threads : {1, 2, 3, 4}) {
    Simulation simulation(model, time, 1, threads);
    for (int i = 0; i < 50; ++i) simulation.step();
    if (threads == 1) serial = simulation.state().x;
    CHECK((simulation.state().x == serial));
  }
}
