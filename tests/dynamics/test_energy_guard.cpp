// The energy guard: quiet while energy arrives, and not deceived by it.
#include "apothem/dynamics/energy_guard.hpp"

#include <catch2/catch.hpp>

#include "apothem/dynamics/simulation.hpp"
#include "mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

Energies present(double energy, double error) { return {.kinetic = energy, .total_error = error}; }

RigidBody rigid(const Model& model, const std::string& name, const Polygon& polygon,
                Motion motion = Motion::free) {
  RigidBody body;
  body.name = name;
  body.motion = motion;
  set_shape(body, polygon, model);
  return body;
}

// A push that does work and does not say so.
class Thief final : public Term {
 public:
  [[nodiscard]] std::string describe() const override { return "a thief"; }
  void add_forces(const Evaluation& now) override { now.state.f[0] += 1000; }
};

// A spring to the place where the first body began; it gives no bound of the time step.
class Oscillator final : public Term {
 public:
  Oscillator(double stiffness, double start) : stiffness_(stiffness), start_(start) {}
  [[nodiscard]] std::string describe() const override { return "a spring"; }
  void add_forces(const Evaluation& now) override {
    now.state.f[0] -= stiffness_ * (now.state.x[0] - start_);
  }
  void add_energies(const State& state, double /*dt*/, Energies& e) override {
    e.strain += stiffness_ * (state.x[0] - start_) * (state.x[0] - start_) / 2;
  }

 private:
  double stiffness_, start_;
};

}  // namespace

TEST_CASE("more than a tenth of the energy in play is too much", "[energy]") {
  EnergyGuard guard((Model()));
  CHECK_FALSE(guard.exceeded(present(100, 0)));
  CHECK_FALSE(guard.exceeded(present(100, 9.9)));
  CHECK_FALSE(guard.exceeded(present(1, -9.9)));  // of all that was there
  CHECK(guard.exceeded(present(100, 10.1)));      // a contact that was passed through, say
  CHECK(guard.largest_error() == 10.1);
  CHECK(guard.in_play() == 100);
  CHECK(guard.exceeded(present(100, std::nan(""))));
}

TEST_CASE("work of gravity and from outside is in play as well", "[energy]") {
  EnergyGuard guard((Model()));
  CHECK_FALSE(guard.exceeded({.external_work = 100}));
  CHECK_FALSE(guard.exceeded({.external_work = 100, .total_error = 9.9}));
  CHECK_FALSE(guard.exceeded({.gravity = -200, .total_error = 19.9}));
}

TEST_CASE("the first steps of a load, or of a contact, are no verdict", "[energy]") {
  EnergyGuard guard((Model()));
  double energy = 1e-12;
  for (int look = 0; look < 3; ++look, energy *= 100) {
    CHECK_FALSE(guard.exceeded(present(energy, energy)));
  }
  CHECK_FALSE(guard.exceeded(present(energy, .01 * energy)));
  // A run that blows up makes its own energy.
  int looks = 0;
  do {
    energy *= 100;
    ++looks;
  } while (!guard.exceeded(present(energy, energy)));
  CHECK(looks == 4);
}

TEST_CASE("a force that is not what its energy says is caught", "[energy]") {
  Model model;
  model.materials = {rock()};
  model.bodies.push_back(rigid(model, "driven", samples::block(0, 0, 1, 1)));
  Simulation simulation(model, {.end = 1, .fixed_step = 1e-4}, 1, 1);
  simulation.add(std::make_unique<Thief>());
  CHECK_THROWS_WITH(
      [&] {
        for (int i = 0; i < 1000; ++i) simulation.step();
      }(),
      Catch::Contains("unaccounted for") && Catch::Contains("no bodies touch") &&
          !Catch::Contains("impact"));
  CHECK(simulation.state().step <= 4 * EnergyGuard::kEvery);
}

TEST_CASE("a step a little too long is caught, one a little below the limit is not", "[energy]") {
  Model model;
  model.materials = {rock()};
  model.bodies.push_back(rigid(model, "swinging", samples::block(0, 0, 1, 1)));
  model.bodies[0].velocity = {1, 0};
  const auto run = [&](double share) {
    constexpr double kStep = 1e-3;
    Simulation simulation(model, {.end = 10, .fixed_step = kStep}, 1, 1);
    const double rate = 2 * share / kStep;
    simulation.add(std::make_unique<Oscillator>(model.bodies[0].mass * rate * rate,
                                                model.bodies[0].position.x()));
    for (int i = 0; i < 2000; ++i) simulation.step();
  };
  CHECK_NOTHROW(run(.3));
  CHECK_THROWS_WITH(run(1.05), Catch::Contains("unaccounted for"));
}

TEST_CASE("how often energies are asked for changes no verdict", "[energy]") {
  // A ramped load on a beam: at first nothing but round-off and the first step's error is there.
  DeformableBody body = block({1, .1}, {20, 2}, ElementKind::quad4);
  body.supports.push_back({nodes_at(body.mesh, 0), {true, true}, {}});
  body.dead_loads.push_back({nodes_at(body.mesh, 1), {}, {{{0, 0}, {1e-3, 1}}}});
  body.dead_loads[0].forces.assign(body.dead_loads[0].nodes.size(), Vec2(0, -1e5));
  const Model model = model_of(std::move(body), rock());
  for (const double share : {.1, .5, .95}) {
    const double limit = Simulation(model, {.end = 1}, 1, 1).step_choice().stability;
    Simulation often(model, {.end = 1, .fixed_step = share * limit}, 1, 1);
    Simulation never(model, {.end = 1, .fixed_step = share * limit}, 1, 1);
    for (int i = 0; i < 500; ++i) {
      REQUIRE_NOTHROW(often.step());
      [[maybe_unused]] const Energies e = often.energies();
      REQUIRE_NOTHROW(never.step());
    }
    CHECK(often.extremes().energy_error == never.extremes().energy_error);
    CHECK(often.state().x == never.state().x);
  }
}
