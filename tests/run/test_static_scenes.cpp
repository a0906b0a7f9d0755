// Random static scenes and settled starts: packs, arches, wedges, soft blocks and mixtures. Each
// one comes to an equilibrium that is one, or is refused with its reason.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "lib/model/statistics.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace static_scenes {
namespace {

using Points = std::vector<Vec2>;
constexpr double kGravity = 9.81;

class RandomStatics {
 public:
  explicit RandomStatics(SeededRandom& random) : random_(random) {}

  // A scene as text; `settled`: it starts at rest and moves, or else it is static.
  std::string text(bool settled) {
    bodies_.clear(), materials_.clear();
    heavy_ = random_.integer(0, 1) == 0 ? 0 : 6;
    young_ = std::pow(10, random_.uniform(6, 11));
    const int kind = random_.integer(0, 4);
    if (kind == 0) add_pack();
    if (kind == 1) add_arch();
    if (kind == 2) add_wedge();
    if (kind == 3) add_soft_blocks();
    if (kind == 4) add_row_on_slope();
    const double friction = random_.integer(0, 2) == 0 ? 0 : random_.uniform(0, 1.5);
    const double stiffness = std::pow(10, random_.uniform(5, 13));
    const bool grows = !settled && random_.integer(0, 2) > 0;
    const std::string time =
        settled ? R"({ "end": 10, "start": "settled" })"
                : fmt::format(R"({{ "end": 1, "mode": "static", "load_steps": {} }})",
                              random_.integer(1, 4));
    return fmt::format(
        R"({{ "gravity": {}, "materials": {{ {} }},
        "contact": {{ "normal_stiffness": {}, "penetration_warning": 10{} }},
        "bodies": [ {} ], "time": {} }})",
        grows ? R"({ "value": [0, -9.81], "history": [[0, 0], [1, 1]] })" : "[0, -9.81]",
        materials_, stiffness,
        friction > 0 ? fmt::format(R"(, "friction": {{ "coefficient": {} }})", friction) : "",
        bodies_, time);
  }

 private:
  static std::string text_of(const Points& ring) {
    std::string text;
    for (const Vec2& p : ring)
      text += fmt::format("{}[{}, {}]", text.empty() ? "" : ", ", p.x(), p.y());
    return text;
  }
  static Points block(double x0, double y0, double x1, double y1) {
    return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  }
  static Points turned(Points ring, double angle) {
    for (Vec2& p : ring) p = samples::turned(p, angle);
    return ring;
  }

  // A material of its own, so that masses differ by up to six powers of ten.
  std::string material() {
    const std::string name = fmt::format("m{}", count_++);
    materials_ += fmt::format(
        R"({}"{}": {{ "density": {}, "young": {}, "poisson": 0.2, "plane": "strain", "law": "neo_hookean" }})",
        materials_.empty() ? "" : ", ", name, 300 * std::pow(10, random_.uniform(0, heavy_)),
        young_);
    return name;
  }
  void add(const std::string& rest) {
    bodies_ += fmt::format(R"({}{{ "name": "b{}", "material": "{}", {} }})",
                           bodies_.empty() ? "" : ", ", count_, material(), rest);
  }
  void add_fixed(const Points& ring) {
    add(fmt::format(R"("motion": "fixed", "polygon": [{}])", text_of(ring)));
  }
  void add_free(const Points& ring, bool meshed) {
    add(meshed ? fmt::format(R"("mesh": {{ "fill": {{ "polygon": [{}], "size": 0.15 }} }})",
                             text_of(ring))
               : fmt::format(R"("polygon": [{}])", text_of(ring)));
  }
  bool chance(int of) { return random_.integer(1, of) == 1; }

  void add_pack() {
    add_fixed(block(-.2, -.2, 2.2, 0));
    if (!chance(5)) {
      add_fixed(block(-.2, 0, 0, 3));
      add_fixed(block(2, 0, 2.2, 3));
    }
    const int count = random_.integer(2, 12);
    for (int i = 0; i < count; ++i) {
      const Vec2 centre(.3 + .45 * (i % 4) + random_.uniform(-.02, .02), .25 + .45 * (i / 4));
      const int corners = random_.integer(3, 7);
      const double turn = random_.uniform(0, 1), radius = random_.uniform(.1, .2);
      Points ring;
      for (int k = 0; k < corners; ++k) {
        const double angle = 2 * std::numbers::pi * (k + turn + random_.uniform(-.2, .2)) / corners;
        ring.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
      }
      add_free(ring, false);
    }
  }
  void add_arch() {
    add_fixed(block(-2, -.5, 2, 0));
    const int stones = random_.integer(3, 10);
    const double inner = 1 - random_.uniform(.05, .2), outer = 2 - inner;
    for (int i = 0; i < stones; ++i) {
      const double u = std::numbers::pi * i / stones, v = std::numbers::pi * (i + 1) / stones;
      const Vec2 a(std::cos(u), std::sin(u)), b(std::cos(v), std::sin(v));
      add_free({inner * a, outer * a, outer * b, inner * b}, false);
    }
  }
  void add_wedge() {
    constexpr double kHigh = .5;
    const double lean = kHigh * std::tan(random_.uniform(.15, 1));
    add_fixed(block(-3, -.2, 3, 0));
    add_free({{-1, 0}, {-.2, 0}, {-.2 - lean, kHigh}, {-1 - lean, kHigh}}, chance(3));
    add_free({{.2, 0}, {1, 0}, {1 + lean, kHigh}, {.2 + lean, kHigh}}, chance(3));
    if (!chance(3)) add_fixed(block(-1.8 - lean, 0, -1 - lean, 1));
    if (!chance(3)) add_fixed(block(1 + lean, 0, 1.8 + lean, 1));
    const auto half = [&](double y) { return .2 + lean * y / kHigh - 1e-3; };
    add_free({{-half(.15), .15}, {half(.15), .15}, {half(.4), .4}, {-half(.4), .4}}, chance(3));
  }
  void add_soft_blocks() {
    add_fixed(block(-2, -.5, 3, 0));
    double y = 0;
    for (int i = random_.integer(1, 4); i > 0; --i) {
      const double wide = random_.uniform(.4, 1), high = random_.uniform(.2, .6);
      const double x = random_.uniform(-.15, .15) - wide / 2;
      if (chance(3)) {
        add_free(block(x, y, x + wide, y + high), false);
      } else {
        add(fmt::format(
            R"("mesh": {{ "rectangle": {{ "size": [{}, {}], "cells": [{}, {}], "origin": [{}, {}] }} }})",
            wide, high, random_.integer(1, 5), random_.integer(1, 4), x, y));
      }
      y += high + (chance(2) ? 0 : .02);
    }
  }
  void add_row_on_slope() {
    const double angle = random_.uniform(0, .6);
    add_fixed(turned(block(-2, -.4, 2, 0), angle));
    if (chance(2)) add_fixed(turned(block(-1.2, 0, -.8, .3), angle));
    double x = -.7;
    for (int i = random_.integer(1, 4); i > 0; --i) {
      const double wide = random_.uniform(.2, .5), high = random_.uniform(.15, .4);
      add_free(turned(block(x, 0, x + wide, high), angle), chance(3));
      x += wide + (chance(2) ? 0 : .01);
    }
  }

  SeededRandom& random_;
  std::string bodies_, materials_;
  int count_ = 0;
  double heavy_ = 0, young_ = 0;
};

double mass_of(const Run& run, BodyIndex b) {
  const Model& model = run.scene().model;
  const auto rigid = static_cast<BodyIndex>(model.bodies.size());
  if (b < rigid) return model.bodies[b].mass;
  const DeformableBody& body = model.deformables[b - rigid];
  double mass = 0;
  for (size_t i = 0; i < body.mesh.nodes.size(); ++i)
    mass += run.simulation().node_mass()[static_cast<size_t>(body.first_node) + i];
  return mass;
}

// What the rounding of places leaves out of balance, of the lightest free body: places of a metre
// are rounded by 1e-16 m, and contacts answer with some hundred times k_n, as edges are ten times
// as long as the apothems of thin bodies and each body has several.
double rounded(const Run& run) {
  const Model& model = run.scene().model;
  const auto bodies = static_cast<BodyIndex>(model.bodies.size() + model.deformables.size());
  double lightest = HUGE_VAL;
  for (BodyIndex b = 0; b < bodies; ++b) {
    if (is_free(model, b)) lightest = std::min(lightest, mass_of(run, b));
  }
  const double steps = static_cast<double>(std::max<size_t>(1, run.load_steps().size()));
  return 1e-13 * model.contact.normal_stiffness * steps / (lightest * kGravity);
}

// The largest force and moment out of balance on a free body, of what acts on it, from the records
// of the contacts and the masses alone. Moments are looked at for rigid bodies.
double out_of_balance(const Run& run) {
  const Model& model = run.scene().model;
  const auto rigid = static_cast<BodyIndex>(model.bodies.size());
  const size_t bodies = model.bodies.size() + model.deformables.size();
  std::vector<Vec2> force(bodies, Vec2::Zero());
  std::vector<double> moment(bodies, 0), sizes(bodies, 0);
  for (const ContactRecord& c : run.simulation().contacts()) {
    const Vec2 f = c.normal + c.tangential;
    for (const BodyIndex b : {c.a, c.b}) {
      const Vec2 on = b == c.a ? f : Vec2(-f);
      force[b] += on;
      sizes[b] += on.norm();
      if (b < rigid) moment[b] += cross(c.point - run.state().pose(b).head<2>(), on);
    }
  }
  double worst = 0;
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(bodies); ++b) {
    if (!is_free(model, b)) continue;
    const double mass = mass_of(run, b), reach = b < rigid ? model.bodies[b].reach() : 1;
    const Vec2 sum = force[b] - Vec2(0, mass * kGravity);
    const double off = sum.norm() + std::abs(moment[b]) / reach;
    worst = std::max(worst, off / (sizes[b] + mass * kGravity));
  }
  return worst;
}

// The farthest way of a coordinate of the state in some steps, of the way of a free fall.
double moved(Run& run) {
  const std::vector<double> start = run.state().x;
  for (int i = 0; i < 200 && run.step(); ++i) {
  }
  double farthest = 0;
  for (size_t c = 0; c < start.size(); ++c) {
    farthest = std::max(farthest, std::abs(run.state().x[c] - start[c]));
  }
  const double t = run.state().time;
  return farthest / (kGravity * t * t / 2);
}

// Whether a message names what happens.
bool is_reason(const std::string& message) {
  for (const char* const words :
       {"slides on", "tips over or rolls", "falls, or flies off", "moves away from where",
        "too soft", "has collapsed", "pass through each other", "turned inside out"}) {
    if (message.find(words) != std::string::npos) return true;
  }
  return false;
}

}  // namespace
}  // namespace static_scenes

TEST_CASE("prescribed motion leads a shallow truss through both limits of its load", "[static]") {
  const Folder folder;
  const double span = 5, height = .5, thin = .02, young = 2e11;
  const char* const element = GENERATE("Q4", "polygon");
  CAPTURE(element);
  constexpr int kSteps = 12;
  // One of two bars, whose upper end is driven straight down: the other one is its mirror image.
  const double length = std::hypot(span, height);
  Run run(
      scene_of(folder, fmt::format(R"({{
    "materials": {{ "steel": {{ "density": 7800, "young": {0}, "poisson": 0, "plane": "stress" }} }},
    "bodies": [ {{ "name": "bar", "material": "steel", "mesh": {{ "rectangle": {{ "size": [{1}, {2}], "cells": [100, 2] }}, "element": "{3}" }},
      "position": [{4}, {5}], "angle": {6},
      "supports": [ {{ "where": {{ "nearest": [0, 0] }}, "fix": ["x", "y"] }},
        {{ "where": {{ "nearest": [{7}, {8}] }}, "fix": ["x", "y"], "velocity": [[0, 0, -{9}], [1, 0, -{9}]] }} ] }} ],
    "time": {{ "mode": "static", "end": 1, "load_steps": {10} }} }})",
                                   young, length, thin, element, span / 2, height / 2,
                                   std::atan2(height, span), span, height, 2.4 * height, kSteps)),
      {});
  // R. de Borst et al., Non-linear Finite Element Analysis, 2012, Sec. 2.1.
  const double axial = young * thin / std::pow(length, 3);
  const auto energy = [&](double w) { return axial * std::pow(2 * height * w - w * w, 2) / 8; };
  int falling = 0;
  double before = 0, worst = 0;
  for (int i = 1; i <= kSteps; ++i) {
    run.run(double(i) / kSteps);
    const double strain = run.simulation().energies().strain;
    worst = std::max(worst, std::abs(strain - energy(2.4 * height * i / kSteps)));
    falling += strain < before;
    before = strain;
  }
  CHECK(run.status() == Run::Status::done);
  CHECK(worst < .01 * energy(height));
  // Between the limits the upper end has to be held back.
  CHECK(falling == 5);
}

TEST_CASE("what only prescribed motion presses is in equilibrium, whatever it is", "[static]") {
  const Folder folder;
  const bool base = GENERATE(false, true), middle = GENERATE(false, true),
             top = GENERATE(false, true);
  const double friction = GENERATE(0., .5), stiffness = GENERATE(1e7, 1e9);
  CAPTURE(base, middle, top, friction, stiffness);
  // Of finite elements or rigid, one on the other; nothing has weight, and nothing is pressed at
  // first.
  const auto body = [&](const char* name, double y, double width, bool meshed,
                        const std::string& rigid, const std::string& nodes) {
    return fmt::format(
        R"({{ "name": "{}", "material": "rock", {} }})", name,
        meshed
            ? fmt::format(
                  R"("mesh": {{ "rectangle": {{ "size": [{}, 1], "cells": [5, 4], "origin": [{}, {}] }}, "element": "Q4" }} {})",
                  width, -width / 2, y, nodes)
            : fmt::format(R"("polygon": [[{0}, {2}], [{1}, {2}], [{1}, {3}], [{0}, {3}]] {4})",
                          -width / 2, width / 2, y, y + 1, rigid));
  };
  const std::string scene = fmt::format(
      R"({{ "materials": {{ "rock": {{ "density": 2000, "young": 1e9, "poisson": 0.2 }} }},
    "contact": {{ "normal_stiffness": {}, "friction": {{ "coefficient": {} }} }},
    "bodies": [ {}, {}, {} ],
    "time": {{ "mode": "static", "end": 1, "load_steps": 2 }} }})",
      stiffness, friction,
      body("base", -1, 3, base, R"(, "motion": "fixed")",
           R"(, "supports": [{ "where": { "y": -1 }, "fix": ["x", "y"] }])"),
      body("middle", 0, 1, middle, "", ""),
      body(
          "top", 1, 2, top, R"(, "motion": { "velocity": [[0, 0, -0.001], [1, 0, -0.001]] })",
          R"(, "supports": [{ "where": { "y": 2 }, "velocity": [[0, 0, -0.001], [1, 0, -0.001]] }])"));
  Run run(scene_of(folder, scene), {folder.path() + "/out"});
  REQUIRE(run.run() == Run::Status::done);
  double pressed = 0, other = 0;
  for (const ContactRecord& c : run.simulation().contacts()) {
    const Model& model = run.scene().model;
    const bool below = model.name_of(c.a) == "base" || model.name_of(c.b) == "base";
    (below ? pressed : other) += std::abs(c.normal.y() + c.tangential.y());
  }
  CHECK(pressed > 0);
  CHECK(pressed == Approx(other).epsilon(1e-6));
}

TEST_CASE("random static scenes come to equilibria, or are refused with the reason", "[static]") {
  using namespace static_scenes;
  SeededRandom random(45);
  RandomStatics scenes(random);
  const int cases = long_run() ? 200 : scaled(56);
  int found = 0, unexplained = 0;
  for (int i = 0; i < cases; ++i) {
    const bool settled = i % 3 == 2;
    const std::string text = scenes.text(settled);
    CAPTURE(i, text);
    const Folder folder;
    std::string why;
    try {
      Run run(scene_of(folder, text), {});
      if (!settled) run.run();
      INFO(run.message());
      if (!settled && run.status() != Run::Status::done) {
        CHECK(run.status() == Run::Status::unstable);
        why = run.message();
      } else {
        ++found;
        const double allowed = 1e-5 + rounded(run);
        CHECK(out_of_balance(run) < allowed);
        for (const LoadStep& step : run.load_steps()) CHECK(step.residual <= allowed);
        if (settled) CHECK(moved(run) < 1e-2);
      }
    } catch (const SceneError& error) {
      why = error.what();
      CHECK_THAT(why, Catch::Contains("/time/start"));
    }
    if (why.empty() || is_reason(why)) continue;
    UNSCOPED_INFO(why);
    ++unexplained;
    CHECK_THAT(why, Catch::Contains("steps of relaxation"));
  }
  INFO(found << " found, " << unexplained << " do not converge, of " << cases);
  CHECK(found > least(cases / 5));
  CHECK(unexplained <= 1 + cases / 20);
}
