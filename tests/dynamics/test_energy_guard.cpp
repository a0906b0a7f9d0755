// The energy guard: quiet while energy arrives, and not deceived by it.
#include "lib/dynamics/energy_guard.hpp"

#include <catch2/catch.hpp>

#include "lib/dynamics/simulation.hpp"
#include "tests/dynamics/mesh_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

using Verdict = EnergyGuard::Verdict;

Energies present(double energy, double error) { return {.kinetic = energy, .total_error = error}; }

// A guard that sees the same energies at every step that it asks for.
struct Watched {
  EnergyGuard guard{Model()};
  std::int64_t step = 0;
  int looks = 0;

  // What comes of so many steps, or of those until it comes.
  Verdict after(std::int64_t steps, const Energies& e, std::int64_t touching = 0) {
    for (std::int64_t i = 0; i < steps; ++i) {
      if (!guard.due(++step, e, touching)) continue;
      ++looks;
      const Verdict verdict = guard.judge(step, e);
      if (verdict != Verdict::good) return verdict;
    }
    return Verdict::good;
  }
};

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

// A push whose work is booked as a loss that falls: the ledger is closed, and energy is made.
class Giver final : public Term {
 public:
  [[nodiscard]] std::string describe() const override { return "a giver"; }
  void add_forces(const Evaluation& now) override { now.state.f[0] += kPush; }
  void book(const State& state, double h, Ledger& /*ledger*/) override {
    loss_ -= h * kPush * state.v[0];
  }
  void add_losses(double /*dt*/, Energies& e) const override { e.damping_loss += loss_; }

 private:
  static constexpr double kPush = 1000;
  double loss_ = 0;
};

// A spring to the place where the first body began; it gives no bound of the time step.
class Oscillator final : public Term {
 public:
  Oscillator(double stiffness, double start) : stiffness_(stiffness), start_(start) {}
  [[nodiscard]] std::string describe() const override { return "a spring"; }
  void add_forces(const Evaluation& now) override {
    now.state.f[0] -= stiffness_ * (now.state.x[0] - start_);
  }
  void add_energies(const State& state, Energies& e) override {
    e.strain += stiffness_ * (state.x[0] - start_) * (state.x[0] - start_) / 2;
  }

 private:
  double stiffness_, start_;
};

}  // namespace

TEST_CASE("more than a tenth of the energy in play is too much, if it lasts", "[energy]") {
  constexpr auto kEvery = EnergyGuard::kEvery, kLasting = EnergyGuard::kLasting;
  Watched w;
  w.guard.start(present(100, 0));
  CHECK(w.after(2 * kEvery, present(100, 0)) == Verdict::good);
  CHECK(w.after(kEvery, present(100, 9.9)) == Verdict::good);
  CHECK(w.after(kEvery, present(1, -9.9)) == Verdict::good);  // of all that was there
  CHECK(w.looks == 4);
  // A coarse contact that is passed through: the next steps are looked at, and it is over.
  CHECK(w.after(kEvery + kLasting - 1, present(100, 10.1)) == Verdict::good);
  CHECK(w.looks == 4 + kLasting);
  CHECK(w.after(1, present(100, 9.9)) == Verdict::good);
  CHECK(w.after(kEvery - kLasting, present(100, 0)) == Verdict::good);
  CHECK(w.looks == 6 + kLasting);
  const std::int64_t before = w.step;
  CHECK(w.after(2 * kEvery, present(100, 10.1)) == Verdict::unaccounted);
  CHECK(w.step == before + kEvery + kLasting);
  CHECK(w.guard.largest_error() == 10.1);
  CHECK(w.guard.in_play() == 100);
  CHECK(w.guard.judge(w.step, present(100, std::nan(""))) == Verdict::unaccounted);
}

TEST_CASE("what no contact can be the cause of need not last", "[energy]") {
  Watched w;
  w.guard.start(present(100, 0));
  CHECK(w.after(EnergyGuard::kEvery, present(100, 51)) == Verdict::unaccounted);
  CHECK(w.step == EnergyGuard::kEvery);
}

TEST_CASE("the end of a run is judged at once", "[energy]") {
  EnergyGuard guard((Model()));
  guard.start(present(100, 0));
  CHECK(guard.judge(17, present(100, 9.9), true) == Verdict::good);
  CHECK(guard.judge(17, present(100, 10.1), true) == Verdict::unaccounted);
  // Also of a run that makes all of its energy.
  EnergyGuard empty((Model()));
  CHECK(empty.judge(17, present(100, 20), true) == Verdict::good);
  CHECK(empty.judge(17, present(100, 90), true) == Verdict::unaccounted);
}

TEST_CASE("a loss that falls is energy out of nothing", "[energy]") {
  constexpr auto kLasting = EnergyGuard::kLasting;
  const auto with = [](double friction, double damping) {
    return Energies{.kinetic = 100, .friction_loss = friction, .damping_loss = damping};
  };
  for (const bool friction : {true, false}) {
    const double most = friction ? 1 : 10;  // of the 100 J in play
    const auto loss = [&](double x) { return friction ? with(x, 0) : with(0, x); };
    Watched w;
    w.guard.start(with(0, 0));
    CAPTURE(friction);
    CHECK(w.after(200, loss(50)) == Verdict::good);
    CHECK(w.after(200, loss(50 - .99 * most)) == Verdict::good);
    CHECK(w.after(200, loss(60)) == Verdict::good);
    CHECK(w.after(200, loss(60 - .99 * most)) == Verdict::good);
    // It is seen in the step in which it falls.
    CHECK(w.after(kLasting, loss(60 - 1.01 * most)) == Verdict::good);
    CHECK(w.after(1, loss(60 - 1.01 * most)) == (friction ? Verdict::friction : Verdict::damping));
    CHECK(w.step == 800 + kLasting + 1);
    CHECK((friction ? w.guard.friction_fall() : w.guard.damping_fall()) == Approx(1.01 * most));
  }
}

TEST_CASE("work of gravity and from outside is in play as well", "[energy]") {
  EnergyGuard guard((Model()));
  CHECK(guard.judge(128, {.external_work = 100}) == Verdict::good);
  CHECK(guard.judge(256, {.external_work = 100, .total_error = 9.9}, true) == Verdict::good);
  CHECK(guard.judge(384, {.gravity = -200, .total_error = 19.9}, true) == Verdict::good);
}

TEST_CASE("the first steps of a load, or of a contact, are no verdict", "[energy]") {
  constexpr auto kEvery = EnergyGuard::kEvery;
  Watched w;
  double energy = 1e-12;
  for (int look = 0; look < 3; ++look, energy *= 100) {
    CHECK(w.after(kEvery, present(energy, energy)) == Verdict::good);
  }
  CHECK(w.after(kEvery, present(energy, .01 * energy)) == Verdict::good);
  CHECK(w.looks == 4);  // it costs no more for that
  // A run that blows up makes its own energy.
  do energy *= 100;
  while (w.after(kEvery, present(energy, energy)) == Verdict::good);
  CHECK(w.step == 5 * kEvery + EnergyGuard::kArrival);
}

TEST_CASE("a passing contact of few bodies is looked at in nearly every step", "[energy]") {
  Watched w;
  w.guard.start(present(100, 0));
  CHECK(w.after(2000, present(100, 0)) == Verdict::good);
  const int before = w.looks;
  CHECK(before == 2000 / EnergyGuard::kEvery);
  CHECK(w.after(20, present(100, 1), 1) == Verdict::good);
  CHECK(w.looks >= before + 18);
  // One that stays is looked at often, but for a small part of the time.
  const int lately = w.looks;
  CHECK(w.after(100'000, present(100, 1), 1) == Verdict::good);
  CHECK(w.looks - lately < 100'000 / 16);
  CHECK(w.looks - lately > 100'000 / EnergyGuard::kEvery);
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

TEST_CASE("a term that makes energy of a loss that falls ends the run", "[energy]") {
  Model model;
  model.materials = {rock()};
  model.bodies.push_back(rigid(model, "driven", samples::block(0, 0, 1, 1)));
  model.bodies[0].velocity = {1, 0};
  Simulation simulation(model, {.end = 1, .fixed_step = 1e-3}, 1, 1);
  simulation.add(std::make_unique<Giver>());
  CHECK_THROWS_WITH(
      [&] {
        for (int i = 0; i < 1000; ++i) simulation.step();
      }(),
      Catch::Contains("damping has given") && Catch::Contains("energy out of nothing") &&
          Catch::Contains("at t = ") && Catch::Contains("contact.damping.ratio"));
  // 100 J of the 1000 J that are there.
  const Energies e = simulation.energies();
  CHECK(std::abs(e.total_error) < 1e-6);
  CHECK(e.damping_loss < -100);
  CHECK(e.damping_loss > -150);
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
