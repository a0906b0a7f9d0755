// Static runs whose loads cannot grow any more, and the limit of rigid bodies.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/run/rigid_limit.hpp"
#include "lib/run/summary.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace rigid_limit {
namespace {

// A block of the given size on a table that tilts by 1 rad in 1 s, or something else.
struct Parts {
  double width = .4, height = 1, friction = .8;
  std::string contact = {};  // more keys
  std::string time = R"("load_steps": "auto")";
  std::string rest = {};  // more keys of the scene
};

std::string text_of(const Parts& p) {
  return fmt::format(R"({{
    "gravity": {{ "value": [0, -9.81], "direction_history": [[0, 0], [1, 1]] }},
    "materials": {{ "rock": {{ "density": 2500 }} }},
    "contact": {{ "normal_stiffness": 1e9, "friction": {{ "coefficient": {} }} {} }},
    "bodies": [
      {{ "name": "table", "material": "rock", "motion": "fixed", "polygon": [[-3, -1], [3, -1], [3, 0], [-3, 0]] }},
      {{ "name": "block", "material": "rock", "polygon": [[0, 0], [{}, 0], [{}, {}], [0, {}]] }} ],
    "time": {{ "mode": "static", "end": 1, {} }} {} }})",
                     p.friction, p.contact, p.width, p.width, p.height, p.height, p.time, p.rest);
}

nlohmann::json summary_of(const Run& run) { return nlohmann::json::parse(summary_text(run)); }

}  // namespace

TEST_CASE("load steps shorten to the limit, and a miss from afar is no limit", "[rigid_limit]") {
  LoadPath path(2);
  double time = 0;
  int steps = 0;
  // A limit at 0.7, and a search that misses 0.4 once, from far away.
  bool missed_once = false, ended = false;
  for (; !ended && steps < 200; ++steps) {
    const double next = path.next(time);
    REQUIRE(next > time);
    const bool unlucky = !missed_once && next >= .4;
    if (unlucky || next > .7) {
      missed_once = true;
      ended = path.missed(time, next);
      if (ended) CHECK(next > .7);
    } else {
      path.found(next);
      time = next;
    }
  }
  CHECK(ended);
  CHECK(time <= .7);
  CHECK(time == Approx(.7).epsilon(1.1 * LoadPath::kResolution));
  CHECK(steps < 50);
  LoadPath free(2);
  time = 0;
  for (steps = 0; time < 2; ++steps) free.found(time = free.next(time));
  CHECK(time == 2);
  CHECK(steps == 10);
}

TEST_CASE("extrapolated values have the error that they state", "[rigid_limit]") {
  const auto values = [](auto law) {
    std::vector<double> v;
    for (int i = 0; i < 4; ++i) v.push_back(law(std::pow(10., i)));
    return v;
  };
  const auto check = [&](auto law, double exact, double largest) {
    const Estimate e = extrapolate(values(law), 0);
    CHECK(std::abs(e.value - exact) <= e.error + 1e-14);
    CHECK(e.error <= largest);
  };
  check([](double k) { return 1 - .2 * std::cbrt(1 / k); }, 1, 1e-12);
  check([](double k) { return 1 - .2 * std::cbrt(1 / k) + .05 * std::pow(k, -2. / 3); }, 1, 1e-12);
  check([](double k) { return .3 - .1 / std::sqrt(k); }, .3, 1e-12);
  check([](double k) { return .3 - .1 / std::sqrt(k) + .02 / k; }, .3, 4e-3);
  check([](double) { return .25; }, .25, 1e-15);
  // Noise of the values is noise of the estimate.
  std::vector<double> noisy = values([](double k) { return 1 - .2 * std::cbrt(1 / k); });
  noisy.back() += 1e-5;
  const Estimate e = extrapolate(noisy, 1e-5);
  CHECK(std::abs(e.value - 1) <= e.error);
  CHECK(e.error > 1e-5);
}

TEST_CASE("a block on a tilting table topples or slides at the angle of theory", "[rigid_limit]") {
  const Folder folder;
  // Toppling at tan = width/height, sliding at tan = mu.
  for (const auto& [width, friction, exact] :
       {std::tuple(.4, .8, std::atan(.4)), std::tuple(.9, .3, std::atan(.3))}) {
    Run run(scene_of(folder,
                     text_of({width, 1, friction, R"(, "rigid": true)", R"("tolerance": 1e-6)"})),
            {folder.path() + "/" + "out" + std::to_string(width)});
    CHECK(run.run() == Run::Status::done);
    CHECK(run.stopped_by() == "collapse");
    const Collapse* const collapse = run.collapse();
    REQUIRE(collapse != nullptr);
    INFO(width << " " << collapse->factor() << " +- " << collapse->error() << ", exact " << exact);
    CHECK(std::abs(collapse->factor() - exact) <= collapse->error() + 1e-4 * exact);
    CHECK(collapse->error() <= 1e-3 * exact);
    CHECK(run.message().find("collapses at load factor") == 0);
    CHECK(run.rigid_limit().passes.size() >= 4);
    const std::vector<MovingBody> moving =
        moving_bodies(run.scene().model, run.state(), collapse->motion);
    REQUIRE(moving.size() == 1);
    const bool topples = exact < std::atan(friction) - .01;
    // It turns about its lower left corner, counter-clockwise, or goes to the left.
    if (topples) {
      CHECK(moving[0].x / moving[0].angle == Approx(-.5).epsilon(.1));
      CHECK(moving[0].angle > 0);
    } else {
      CHECK(moving[0].x < 0);
      CHECK(std::abs(moving[0].angle) < .02 * std::abs(moving[0].x));
    }
    // The mechanism is the last frame.
    const auto json = summary_of(run);
    CHECK(json["collapse"]["factor"].get<double>() == collapse->factor());
    CHECK(json["collapse"]["mechanism"].get<size_t>() == run.load_steps().size() + 1);
    CHECK(json["rigid"]["passes"].size() == run.rigid_limit().passes.size());
    CHECK(run.load_steps().back().time == collapse->lower);
  }
}

TEST_CASE("a block of finite elements on a tilting table does what theory says", "[rigid_limit]") {
  const Folder folder;
  const auto [width, friction, young] =
      GENERATE(std::tuple(.4, .8, 1e11), std::tuple(.9, .3, 1e9), std::tuple(.55, .9, 1e11));
  const double exact = std::atan(std::min(width, friction));
  const bool rigid = GENERATE(true, false);
  CAPTURE(width, friction, young, rigid);
  Run run(scene_of(folder, fmt::format(R"({{
    "gravity": {{ "value": [0, -9.81], "direction_history": [[0, 0], [1.2, 1.2]] }},
    "materials": {{ "rock": {{ "density": 2000, "young": {}, "poisson": 0.2 }} }},
    "contact": {{ "normal_stiffness": 1e10, "rigid": {}, "friction": {{ "coefficient": {} }} }},
    "bodies": [
      {{ "name": "table", "material": "rock", "motion": "fixed", "polygon": [[-3, -1], [3, -1], [3, 0], [-3, 0]] }},
      {{ "name": "block", "material": "rock",
         "mesh": {{ "rectangle": {{ "size": [{}, 1], "cells": [4, 6] }}, "element": "Q4" }} }} ],
    "time": {{ "mode": "static", "end": 1.2, "load_steps": "auto" }} }})",
                                       young, rigid, friction, width)),
          {folder.path() + "/" + "out"});
  CHECK(run.run() == Run::Status::done);
  const Collapse* const collapse = run.collapse();
  REQUIRE(collapse != nullptr);
  CAPTURE(collapse->factor(), collapse->error(), exact);
  // Without the limit it tips over earlier, because the corner that presses yields.
  const double early = rigid ? 3e-4 : .02;
  CHECK(collapse->factor() <= exact * (1 + 1e-4) + collapse->error());
  CHECK(collapse->factor() >= exact * (1 - early) - collapse->error());
  if (rigid) CHECK(collapse->error() <= 1e-3 * exact);
}

TEST_CASE("pressed meshes shorten in the rigid limit as one body does", "[rigid_limit]") {
  const Folder folder;
  const bool on_rigid = GENERATE(false, true);
  CAPTURE(on_rigid);
  const double young = 2e10, poisson = .2, pressure = 2e7;
  const std::string lower =
      on_rigid ? R"("motion": "fixed", "polygon": [[-1, 0], [2, 0], [2, 0.5], [-1, 0.5]])"
               : R"("mesh": { "rectangle": { "size": [1, 0.5], "cells": [7, 4] }, "element": "Q4" },
        "supports": [ { "where": { "y": 0 }, "fix": ["y"] }, { "where": { "nearest": [0.5, 0] }, "fix": ["x"] } ])";
  Run run(scene_of(folder, fmt::format(R"({{
    "materials": {{ "rock": {{ "density": 2000, "young": {}, "poisson": {}, "plane": "strain" }} }},
    "contact": {{ "normal_stiffness": 1e10, "rigid": true }},
    "bodies": [ {{ "name": "lower", "material": "rock", {} }},
      {{ "name": "upper", "material": "rock",
         "mesh": {{ "rectangle": {{ "size": [1, 0.5], "cells": [10, 5], "origin": [0, 0.5] }}, "element": "Q4" }},
         "supports": [ {{ "where": {{ "nearest": [0.5, 1] }}, "fix": ["x"] }} ],
         "loads": [ {{ "where": {{ "group": "top" }}, "traction": [0, -2e7], "history": [[0, 0], [1, 1]] }} ] }} ],
    "time": {{ "mode": "static", "end": 1, "load_steps": "auto" }} }})",
                                       young, poisson, lower)),
          {folder.path() + "/" + "out"});
  CHECK(run.run() == Run::Status::done);
  CHECK(run.collapse() == nullptr);
  const DeformableBody& upper = run.scene().model.deformables.back();
  double top = 0;
  for (NodeIndex i = 0; i < static_cast<NodeIndex>(upper.mesh.nodes.size()); ++i) {
    if (upper.mesh.nodes[i].y() == 1) top = run.state().node(upper.first_node + i).y();
  }
  const double height = on_rigid ? .5 : 1;
  const double shortening = (1 - poisson * poisson) * pressure / young * height;
  CHECK(-top == Approx(shortening).epsilon(2 * RigidLimit::kTolerance));
  CHECK(run.rigid_limit().change <= RigidLimit::kTolerance);
  CHECK(run.rigid_limit().passes.size() >= 3);
}

TEST_CASE("loads that can be carried end with their last step", "[rigid_limit]") {
  const Folder folder;
  Run run(scene_of(folder, text_of({2, .5, 1.6, R"(, "rigid": true)", R"("tolerance": 1e-6)"})),
          {folder.path() + "/" + "out"});
  CHECK(run.run() == Run::Status::done);
  CHECK(run.collapse() == nullptr);
  CHECK(run.stopped_by().empty());
  CHECK(run.state().time == 1);
  CHECK(run.rigid_limit().change <= RigidLimit::kTolerance);
  CHECK(run.rigid_limit().passes.size() >= 2);
  const auto json = summary_of(run);
  CHECK(!json.contains("collapse"));
  CHECK(json["rigid"]["change"].get<double>() == run.rigid_limit().change);
}

TEST_CASE("a scene may promise the load factor of its collapse", "[rigid_limit]") {
  const Folder folder;
  const std::string promise =
      R"(, "expect": [{ "quantity": "collapse.factor", "value": 0.3, "tolerance": 0.1 },
    { "quantity": "collapse.factor", "value": 0.5, "tolerance": 0.1 }],
    "measure": [{ "name": "fell", "stopped_by": "collapse" }, { "name": "at", "quantity": "collapse.factor" }])";
  Parts parts;
  parts.rest = promise;
  Run run(scene_of(folder, text_of(parts)), {folder.path() + "/" + "out"});
  CHECK(run.run() == Run::Status::done);
  CHECK(run.seeks_collapse());
  REQUIRE(run.outcomes().size() == 2);
  CHECK(run.outcomes()[0].met);
  CHECK(!run.outcomes()[1].met);
  CHECK(run.measures()[0] == 1);
  CHECK(run.measures()[1] == run.collapse()->factor());
  // With a number of load steps there is no such quantity.
  parts.time = R"("load_steps": 5)";
  CHECK_THROWS_WITH(scene_of(folder, text_of(parts)), Catch::Contains("collapse.factor"));
}

TEST_CASE("a load path that is stopped goes on bit for bit", "[rigid_limit]") {
  const Folder folder;
  Parts parts;
  parts.contact = R"(, "rigid": true)";
  Run whole(scene_of(folder, text_of(parts)), {folder.path() + "/" + "whole"});
  whole.run();
  Run first(scene_of(folder, text_of(parts)), {folder.path() + "/" + "part"});
  first.run(.25);
  CHECK(!first.ended());
  CHECK(first.state().time > 0);
  RunSettings settings{folder.path() + "/" + "part"};
  settings.resume = true;
  Run second(scene_of(folder, text_of(parts)), settings);
  second.run();
  REQUIRE(second.collapse() != nullptr);
  CHECK(second.collapse()->factor() == whole.collapse()->factor());
  CHECK(second.state().x == whole.state().x);
  CHECK(second.load_steps().size() == whole.load_steps().size());
}

// The joints of this arch have no depth but round-off, of which different arithmetics say
// different things.
TEST_CASE("blocks that touch by round-off have records", "[rigid_limit]") {
  const Folder folder;
  std::string bodies;
  constexpr int kCount = 16;
  for (int i = 0; i < kCount; ++i) {
    const auto point = [&](double radius, int at) {
      const double angle = M_PI * at / kCount;
      return fmt::format("[{}, {}]", radius * std::cos(angle), radius * std::sin(angle));
    };
    bodies +=
        fmt::format(R"({}{{ "name": "{}", "material": "rock", "polygon": [{}, {}, {}, {}] }})",
                    i > 0 ? ", " : "", i, point(.945, i), point(1.055, i), point(1.055, i + 1),
                    point(.945, i + 1));
  }
  const Scene scene = scene_of(folder, R"({ "gravity": [0, -9.81],
    "materials": { "rock": { "density": 2500 } },
    "contact": { "normal_stiffness": 1e8, "friction": { "coefficient": 1 } }, "bodies": [)" +
                                           bodies + R"(], "time": { "end": 1 } })");
  const auto simulation = make_simulation(scene, 1);
  for (const ContactRecord& record : simulation->contacts()) {
    CHECK(std::abs(record.penetration) < 1e-12);
  }
}

}  // namespace rigid_limit
