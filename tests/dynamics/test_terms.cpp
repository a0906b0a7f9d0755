// The terms of a step: a scene has those that it needs, and a term of one's own is one of them.
#include <catch2/catch.hpp>

#include "lib/dynamics/elements.hpp"
#include "lib/dynamics/fold_watch.hpp"
#include "lib/dynamics/loads.hpp"
#include "lib/dynamics/mass_damping.hpp"
#include "tests/archive/saved.hpp"
#include "tests/dynamics/mesh_models.hpp"
#include "tests/dynamics/term_of.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

using Names = std::vector<std::string>;

std::string name_of(const Term& term) {
  if (dynamic_cast<const Elements*>(&term)) return "elements";
  if (dynamic_cast<const Loads*>(&term)) return "loads";
  if (dynamic_cast<const ContactTerm*>(&term)) return "contact";
  if (dynamic_cast<const MassDamping*>(&term)) return "mass damping";
  if (dynamic_cast<const FoldWatch*>(&term)) return "fold watch";
  return "another one";
}

Names terms_of(const Model& model) {
  TimeSettings time;
  time.end = 1;
  time.longest_step = 1e-3;
  const Simulation simulation(model, time, 1, 1);
  Names names;
  for (const auto& term : simulation.terms()) {
    names.push_back(name_of(*term));
    CHECK(!term->describe().empty());
  }
  return names;
}

Model rigid_bodies(int count) {
  Model model;
  model.materials = {rock()};
  model.contact.normal_stiffness = 20e9;
  for (int i = 0; i < count; ++i) {
    RigidBody body;
    body.name = std::to_string(i);
    set_shape(body, samples::block(2 * i, -3, 2 * i + 1, -2), model);
    model.bodies.push_back(body);
  }
  return model;
}

// One mesh and some rigid bodies below it.
Model mesh_and(int count) {
  Model model = rigid_bodies(count);
  DeformableBody body = block({1, .5}, {4, 2}, ElementKind::quad4);
  body.name = "mesh";
  model.deformables.push_back(std::move(body));
  return model;
}

// Springs between the mass centres of rigid bodies and the places where they begin.
class Anchor final : public Term {
 public:
  Anchor(double stiffness, std::vector<std::string>& calls)
      : stiffness_(stiffness), calls_(calls) {}

  [[nodiscard]] std::string describe() const override { return "an anchor"; }
  void add_forces(const Evaluation& now) override {
    calls_.emplace_back("add_forces");
    const size_t rigid = now.state.layout.node(0);
    if (start_.empty()) start_.assign(now.state.x.begin(), now.state.x.begin() + ptrdiff_t(rigid));
    for (size_t c = 0; c < rigid; ++c) now.state.f[c] -= stiffness_ * (now.state.x[c] - start_[c]);
    velocity_ = now.velocity[0];
  }
  void damp(State& /*state*/, double h, Ledger& /*ledger*/) override {
    calls_.emplace_back("damp");
    half_step_ = h;
  }
  void book(const State& /*state*/, double h, Ledger& /*ledger*/) override {
    calls_.emplace_back("book");
    CHECK(h == half_step_);
  }
  void watch(const State& /*state*/) override { calls_.emplace_back("watch"); }
  void add_energies(const State& state, Energies& energies) override {
    for (size_t c = 0; c < start_.size(); ++c) {
      energies.strain += stiffness_ * (state.x[c] - start_[c]) * (state.x[c] - start_[c]) / 2;
    }
  }
  void add_losses(double /*dt*/, Energies& energies) const override {
    energies.damping_loss += loss_;
  }
  void fields(Archive& archive) override { archive("start", start_)("loss", loss_); }
  void refresh(const State& state) override {
    calls_.emplace_back("refresh");
    refreshed_at_ = state.time;
  }

  double loss_ = 0;
  double velocity_ = 0;
  double refreshed_at_ = -1;

 private:
  double stiffness_;
  double half_step_ = 0;
  std::vector<double> start_;
  std::vector<std::string>& calls_;
};

}  // namespace

TEST_CASE("a rigid body alone needs no term", "[terms]") {
  CHECK(terms_of(rigid_bodies(1)).empty());
  Model driven = rigid_bodies(1);
  driven.gravity = {0, -9.81};
  driven.bodies[0].motion = Motion::prescribed;
  CHECK(terms_of(driven).empty());
  // It has nothing to rub against.
  Model rough = rigid_bodies(1);
  rough.contact.friction = {.3, 1e9};
  rough.contact.damping.normal = .1;
  CHECK(terms_of(rough).empty());
}

TEST_CASE("two rigid bodies need contact only, with friction and without", "[terms]") {
  Model model = rigid_bodies(2);
  CHECK(terms_of(model) == Names{"contact"});
  model.contact.friction = {.3, 1e9};
  model.contact.damping.normal = .1;
  CHECK(terms_of(model) == Names{"contact"});
}

TEST_CASE("a mesh alone needs its elements, and a look at whether it folds", "[terms]") {
  CHECK(terms_of(mesh_and(0)) == Names{"elements", "fold watch"});
}

TEST_CASE("who computes contact of a mesh with itself needs no look at whether it folds",
          "[terms]") {
  Model model = mesh_and(1);
  CHECK(terms_of(model) == Names{"elements", "contact", "fold watch"});
  model.contact.self = true;
  CHECK(terms_of(model) == Names{"elements", "contact"});
  model.contact.self = false;
  model.contact.surface = ContactSurface::element;
  model.contact.distribution = ForceDistribution::resultant;
  CHECK(terms_of(model) == Names{"elements", "contact", "fold watch"});
}

TEST_CASE("loads and damping are terms where the scene has them", "[terms]") {
  Model damped = rigid_bodies(1);
  damped.contact.mass_damping = 3;
  CHECK(terms_of(damped) == Names{"mass damping"});

  Model mesh = mesh_and(0);
  mesh.materials[0].stiffness_damping = 1e-6;  // of the elements, which have it from their material
  CHECK(terms_of(mesh) == Names{"elements", "fold watch"});
  mesh.materials[0].mass_damping = 3;
  CHECK(terms_of(mesh) == Names{"elements", "mass damping", "fold watch"});

  Model pressed = mesh_and(0);
  pressed.deformables[0].pressures = {{{{0, 1}}, 1e3, {}}};
  CHECK(terms_of(pressed) == Names{"elements", "loads", "fold watch"});
  Model pulled = mesh_and(0);
  pulled.deformables[0].dead_loads = {{{0}, {{1, 0}}, {}}};
  CHECK(terms_of(pulled) == Names{"elements", "loads", "fold watch"});
  Model held = mesh_and(0);
  held.deformables[0].supports = {{{0}, {true, true}, {}}};
  CHECK(terms_of(held) == Names{"elements", "fold watch"});
}

TEST_CASE("a scene with everything has its terms in the order of their sums", "[terms]") {
  Model model = mesh_and(2);
  model.contact.surface = ContactSurface::element;
  model.contact.distribution = ForceDistribution::resultant;
  model.contact.friction = {.3, 1e9};
  model.contact.mass_damping = 3;
  model.deformables[0].dead_loads = {{{0}, {{1, 0}}, {}}};
  CHECK(terms_of(model) == Names{"elements", "loads", "contact", "mass damping", "fold watch"});
}

TEST_CASE("contact says how it is rough and damped", "[terms]") {
  Model model = rigid_bodies(2);
  const auto text = [&] {
    TimeSettings time;
    time.end = 1;
    const Simulation simulation(model, time, 1, 1);
    return term_of<ContactTerm>(simulation)->describe();
  };
  CHECK(text() == "contact of 2 surfaces, distance potential, k_n = 2e+10 Pa; no friction");
  model.contact.friction = {.3, 1e9};
  model.contact.damping.normal = .1;
  CHECK(text() ==
        "contact of 2 surfaces, distance potential, k_n = 2e+10 Pa; friction, mu = 0.3; "
        "viscous damping, ratios 0.1 and 0");
}

TEST_CASE("a term of one's own is asked in the order of the step", "[terms]") {
  Model model = rigid_bodies(1);
  model.bodies[0].velocity = {2, 0};
  Simulation simulation(model, {.end = 1, .fixed_step = 1e-3}, 1, 1);
  Names calls;
  auto anchor = std::make_unique<Anchor>(0, calls);
  const Anchor* added = anchor.get();
  simulation.add(std::move(anchor));
  REQUIRE(simulation.terms().size() == 1);
  CHECK(simulation.terms().back().get() == added);
  CHECK(calls == Names{"add_forces"});
  calls.clear();
  simulation.step();
  CHECK(calls == Names{"damp", "book", "add_forces", "book", "damp"});
  CHECK(added->velocity_ == 2);
  for (int i = 1; i < 64; ++i) simulation.step();
  CHECK(std::count(calls.begin(), calls.end(), "watch") == 1);
  CHECK(calls.back() == "watch");
}

TEST_CASE("a term of one's own moves bodies, and the ledger knows its energy", "[terms]") {
  Model model = rigid_bodies(1);
  model.bodies[0].velocity = {2, -1};
  const double stiffness = 1e6, omega = std::sqrt(stiffness / model.bodies[0].mass);
  const double period = 2 * M_PI / omega;
  double errors[2];
  for (const int k : {0, 1}) {
    Simulation simulation(model, {.end = 10, .fixed_step = period / (k == 0 ? 200 : 400)}, 1, 1);
    Names calls;
    simulation.add(std::make_unique<Anchor>(stiffness, calls));
    const double kinetic = simulation.energies().kinetic;
    errors[k] = 0;
    while (simulation.state().time < 3.25 * period) {
      simulation.step();
      const Energies e = simulation.energies();
      errors[k] = std::max(errors[k], std::abs(e.total_error) / kinetic);
    }
    const State& state = simulation.state();
    const Vec2 way = Vec2(state.pose(0).head<2>()) - model.bodies[0].position;
    const double arrived = std::sin(omega * state.time) / omega;
    CHECK((way - arrived * Vec2(2, -1)).norm() < 1e-3 * arrived);
    CHECK(simulation.energies().strain == Approx(kinetic).epsilon(.01));  // at its farthest
  }
  CHECK(errors[0] < 1e-3);
  CHECK(errors[0] / errors[1] == Approx(4).epsilon(.05));
}

TEST_CASE("what a term says it has lost is a loss, and what it does not say is an error",
          "[terms]") {
  const Model model = rigid_bodies(1);
  for (const double loss : {0., 5.}) {
    Simulation simulation(model, {.end = 1, .fixed_step = 1e-3}, 1, 1);
    Names calls;
    auto anchor = std::make_unique<Anchor>(0, calls);
    Anchor* added = anchor.get();
    simulation.add(std::move(anchor));
    added->loss_ = loss;  // from nowhere: nothing has slowed down
    if (loss == 0) {
      CHECK(simulation.energies().total_error == 0);
    } else {
      CHECK(simulation.energies().total_error == Approx(loss));
    }
  }
}

TEST_CASE("what a term of one's own remembers is archived with the others", "[terms]") {
  const Model model = rigid_bodies(2);
  const TimeSettings time{.end = 1, .fixed_step = 1e-4};
  Names calls;
  Simulation first(model, time, 1, 1);
  auto anchor = std::make_unique<Anchor>(1e6, calls);
  anchor->loss_ = 1. / 3;
  first.add(std::move(anchor));
  for (int i = 0; i < 10; ++i) first.step();
  const nlohmann::json json = saved(first);
  CHECK(json["simulation"]["term_1"]["loss"] == 1. / 3);
  CHECK(json["simulation"]["term_1"]["start"].size() == 6);

  Simulation second(model, time, 1, 1);
  auto other = std::make_unique<Anchor>(1e6, calls);
  const Anchor* loaded = other.get();
  second.add(std::move(other));
  restore(second, json);
  CHECK(loaded->loss_ == 1. / 3);
  CHECK(loaded->refreshed_at_ == first.state().time);
  CHECK(saved(second) == json);
}
