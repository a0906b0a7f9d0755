// Runs that begin where another one has stopped: places, velocities and the memory of contacts.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/output/files.hpp"
#include "lib/run/hash.hpp"
#include "tests/dynamics/term_of.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace {

Scene scene_with(const Folder& folder, const std::string& text,
                 const std::vector<std::string>& settings) {
  const std::string file = folder.write("scene.json", text);
  std::vector<Setting> parsed;
  for (const std::string& s : settings) parsed.push_back(parse_setting(s, file));
  return read_scene(file, parsed);
}

// The largest difference between two lists, in parts of the largest entry.
double apart(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double difference = 0, size = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(a[i]));
  }
  return difference / size;
}

// A block on a slope, stopped while it rubs, as in rubbing_scenes().
const char* const kRough = R"({ "coefficient": 0.6, "tangential_stiffness": 1e9 })";
const char* const kBlock =
    R"("velocity": [1, 0], "polygon": [[-0.25, 0], [0.25, 0], [0.25, 0.125], [-0.25, 0.125]])";

}  // namespace

TEST_CASE("a run that begins with another's state goes on as that one would", "[run][from]") {
  for (const NamedScene& named : rubbing_scenes()) {
    INFO(named.name);
    if (named.name == std::string("gravity that grows")) continue;  // the history begins anew
    const Folder folder;
    const double step = Run(scene_of(folder, named.text), {}).simulation().step_size();
    const std::string fixed = "time.step=" + Json(step).dump();
    Run first(scene_with(folder, named.text, {fixed}), {.folder = folder / "first"});
    REQUIRE(first.run(named.stop) == Run::Status::done);
    REQUIRE(!springs(first.simulation()).empty());

    Run second(scene_with(folder, named.text, {fixed, "time.end=" + Json(200 * step).dump()}),
               {.folder = folder / "second", .from = folder / "first"});
    CHECK(second.state().time == 0);
    CHECK(second.beginning().time == first.state().time);
    CHECK(apart(first.state().x, second.state().x) == 0);
    CHECK(apart(first.state().v, second.state().v) == 0);
    const auto before = springs(first.simulation()), now = springs(second.simulation());
    REQUIRE(before.size() == now.size());
    double largest = 0;
    for (const Spring& spring : before) largest = std::max(largest, std::abs(spring.force));
    for (size_t i = 0; i < now.size(); ++i) {
      CHECK(now[i].key == before[i].key);
      CHECK(std::abs(now[i].force - before[i].force) <= 1e-9 * largest);
    }
    CHECK(second.simulation().energies().friction_loss == Approx(0).margin(1e-9));
    CHECK(second.simulation().energies().total_error == Approx(0).margin(1e-9));

    REQUIRE(second.run() == Run::Status::done);
    REQUIRE(second.state().step == 200);
    for (int i = 0; i < 200; ++i) first.simulation().step();
    CHECK(apart(first.state().x, second.state().x) < 1e-10);
    CHECK(apart(first.state().v, second.state().v) < 1e-6);
  }
}

TEST_CASE("a body that turns about a pivot takes it along into the next run",
          "[run][from][pivot]") {
  const Folder folder;
  const std::string paddle = R"({ "materials": { "wood": { "density": 700 } },
    "bodies": [ { "name": "paddle", "material": "wood", "polygon": [[0, 0], [1, 0], [1, 0.1], [0, 0.1]],
                  "position": [4, 3], "angle": 0.2,
                  "motion": { "velocity": [[0, 2, -1]], "spin": [[0, 5]], "pivot": [4.5, 3] } } ],
    "time": { "end": 0.5, "step": 1e-3 }, "output": { "frames": 2 } })";
  Run first(scene_of(folder, paddle), {.folder = folder / "first"});
  REQUIRE(first.run(.3) == Run::Status::done);
  Run second(scene_with(folder, paddle, {"time.end=0.2"}),
             {.folder = folder / "second", .from = folder / "first"});
  CHECK(apart(first.state().x, second.state().x) == 0);
  CHECK(apart(first.state().v, second.state().v) < 1e-14);
  REQUIRE(second.run() == Run::Status::done);
  while (first.state().time < .5 - 1e-9) first.simulation().step();
  CHECK(apart(first.state().x, second.state().x) < 1e-14);
  CHECK(apart(first.state().v, second.state().v) < 1e-13);
  CHECK(first.state().x[2] == Approx(.2 + 5 * .5));
}

TEST_CASE("bodies keep their springs where others come, go, or stand in another order",
          "[run][from]") {
  for (const char* law : {"resultant", "per_edge"}) {
    INFO(law);
    const Folder folder;
    const std::string rough =
        std::string(kRough).replace(1, 0, " \"law\": \"" + std::string(law) + "\",");
    Run first(
        scene_of(folder, slope(rough, kBlock,
                               R"(, "damping": { "model": "normal_viscous", "ratio": 0.2 })")),
        {.folder = folder / "first"});
    REQUIRE(first.run(.013) == Run::Status::done);
    const BodyForce on = first.simulation().contact_forces()[1];
    REQUIRE(on.friction > 1);

    const std::string other =
        R"({ "gravity": [-0.3, -9.5], "materials": { "rock": { "density": 2500 } },
      "contact": { "normal_stiffness": 2e9, "friction": )" +
        rough + R"(,
                   "damping": { "model": "normal_viscous", "ratio": 0.2 } },
      "bodies": [
        { "name": "guest", "material": "rock", "polygon": [[3, 3], [4, 3], [3, 4]] },
        { "name": "block", "material": "rock", "position": [77, 5],
          "polygon": [[-0.25, 0], [0.25, 0], [0.25, 0.125], [-0.25, 0.125]] },
        { "name": "slope", "material": "rock", "motion": "fixed", "polygon": [[-5, -1], [5, -1], [5, 1e-7], [-5, 1e-7]] } ],
      "time": { "end": 0.02 } })";
    Run second(scene_of(folder, other), {.folder = folder / "second", .from = folder / "first"});
    CHECK(second.beginning().bodies.size() == 2);
    const Vec2 moved = second.scene().model.origin - first.scene().model.origin;
    CHECK((second.state().pose(1) - first.state().pose(1)).head<2>().isApprox(-moved, 1e-12));
    CHECK(second.state().pose_rate(1).isApprox(first.state().pose_rate(1), 1e-15));
    CHECK(second.state().pose(0)[0] + second.scene().model.origin.x() == Approx(10. / 3));
    const BodyForce again = second.simulation().contact_forces()[1];
    CHECK(again.friction == Approx(on.friction).epsilon(1e-6));
    const Eigen::Vector3d force = first.state().force(1), here = second.state().force(1);
    CHECK(here.head<2>().isApprox(force.head<2>(), 1e-6));
    const auto before = springs(first.simulation()), now = springs(second.simulation());
    REQUIRE(now.size() == before.size());
    for (const Spring& spring : now) CHECK(spring.key.a == 1);  // the block comes first now

    // Without what contacts remember, friction would begin anew.
    Json forgetful = Json::parse(content(folder / "first/checkpoint.json"));
    forgetful["simulation"]["term_0"]["contacts"]["friction"]["springs"] = Json::array();
    write_file(folder / "first/checkpoint.json", sealed(forgetful.dump()));
    Run third(scene_of(folder, other), {.folder = folder / "third", .from = folder / "first"});
    CHECK(third.simulation().contact_forces()[1].friction < .01 * on.friction);
  }
}

TEST_CASE("a mesh may be given at another place, and its strain comes along", "[run][from]") {
  const Folder folder;
  const auto beam = [](const char* origin, const char* more) {
    return std::string(
               R"({ "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
      "gravity": [0, -9.81],
      "bodies": [ { "name": "beam", "material": "rock",
        "mesh": { "rectangle": { "size": [2, 0.5], "cells": [8, 2], "origin": )") +
           origin + R"( } },
        "supports": [ { "where": { "x": )" +
           std::string(origin).substr(1, std::string(origin).find(',') - 1) +
           R"( }, "fix": ["x", "y"] } ] } ],
      "time": { "end": 0.004 }, "output": { "frames": 2)" +
           more + " } }";
  };
  Run first(scene_of(folder, beam("[0, 0]", "")), {.folder = folder / "first"});
  REQUIRE(first.run() == Run::Status::done);
  REQUIRE(std::filesystem::exists(folder / "first/final.json"));
  Run second(scene_of(folder, beam("[100, 7]", "")),
             {.folder = folder / "second", .from = folder / "first"});
  const Energies old = first.simulation().energies(), now = second.simulation().energies();
  REQUIRE(old.strain > 0);
  CHECK(now.strain == Approx(old.strain).epsilon(1e-8));
  CHECK(now.kinetic == Approx(old.kinetic).epsilon(1e-12));
  CHECK(now.gravity == 0);
  // It is where it was, not where the scene puts it.
  const Vec2 place = second.scene().model.deformables[0].mesh.nodes[0] +
                     second.scene().model.origin + second.state().node(0);
  const Vec2 before = first.scene().model.deformables[0].mesh.nodes[0] +
                      first.scene().model.origin + first.state().node(0);
  CHECK((place - before).norm() < 1e-12);
  REQUIRE(second.run() == Run::Status::done);
  CHECK(std::abs(second.simulation().energies().total_error) < 1e-2 * old.strain);
}

TEST_CASE("a run that began with another's state resumes bit for bit, without the other folder",
          "[run][from]") {
  const Folder folder;
  const Scene scene = scene_of(folder, slope(kRough, kBlock));
  Run(scene, {.folder = folder / "first"}).run();
  REQUIRE(std::filesystem::exists(folder / "first/final.json"));
  REQUIRE_FALSE(std::filesystem::exists(folder / "first/checkpoint.json"));
  Run whole(scene, {.folder = folder / "whole", .from = folder / "first"});
  REQUIRE(whole.run() == Run::Status::done);
  Run(scene, {.folder = folder / "parts", .from = folder / "first"}).run(.011);
  std::filesystem::remove_all(folder / "first");
  Run second(scene, {.folder = folder / "parts", .resume = true});
  CHECK(second.beginning().folder == folder / "first");
  REQUIRE(second.run() == Run::Status::done);
  CHECK(state_hash(second.state()) == state_hash(whole.state()));
  CHECK(content(folder / "parts/energy.csv") == content(folder / "whole/energy.csv"));
  const Json from = Json::parse(content(folder / "parts/run.json"))["from"];
  CHECK(from["folder"] == folder / "first");
  CHECK(from["time"] == Approx(.02));
  CHECK(from["bodies"] == 2);
  CHECK(from["others"].empty());
}

TEST_CASE("bodies of another name or shape begin where their scene puts them", "[run][from]") {
  const Folder folder;
  Run(scene_of(folder, flying_block(", \"velocity\": [3, 1]")), {.folder = folder / "first"}).run();
  const auto bodies = [](const char* shape) {
    return std::string(R"({ "materials": { "rock": { "density": 2000 } },
      "contact": { "normal_stiffness": 1e9 }, "bodies": [
      { "name": "block", "material": "rock", "polygon": )") +
           shape +
           R"( }, { "name": "new", "material": "rock", "polygon": [[9, 9], [10, 9], [9, 10]] } ],
      "time": { "end": 0.1 }, "output": { "frames": 2 } })";
  };
  Run same(scene_of(folder, bodies("[[0, 0], [1, 0], [1, 1], [0, 1]]")),
           {.folder = folder / "same", .from = folder / "first"});
  CHECK(same.state().pose(0)[0] + same.scene().model.origin.x() == Approx(.5 + 3 * .5));
  CHECK(same.state().pose_rate(0)[0] == 3);
  same.run();
  CHECK(Json::parse(content(folder / "same/run.json"))["from"]["others"] == Json{"new"});
  CHECK_THROWS_WITH(Run(scene_of(folder, bodies("[[0, 0], [2, 0], [2, 1], [0, 1]]")),
                        RunSettings{.folder = folder / "other", .from = folder / "first"}),
                    Catch::Contains("no body of the same name and shape"));
  CHECK_FALSE(std::filesystem::exists(folder / "other"));
}

TEST_CASE("a state that is not there is refused, with the time that is", "[run][from]") {
  const Folder folder;
  const Scene scene = scene_of(folder, flying_block());
  Run(scene, {.folder = folder / "first"}).run();
  CHECK_NOTHROW(Run(scene, {.folder = "", .from = folder / "first", .from_time = .5}));
  CHECK_THROWS_WITH(
      Run(scene, RunSettings{.folder = "", .from = folder / "first", .from_time = .3}),
      Catch::Contains("is the state at t = 0.5 s; to begin at t = 0.3 s is not "
                      "supported yet"));
  CHECK_THROWS_WITH(Run(scene, RunSettings{.folder = "", .from = folder / "nowhere"}),
                    Catch::Contains("neither final.json nor checkpoint.json"));
  const std::string good = content(folder / "first/final.json");
  write_file(folder / "first/final.json", good.substr(0, good.size() / 2));
  CHECK_THROWS_WITH(Run(scene, RunSettings{.folder = "", .from = folder / "first"}),
                    Catch::Contains("is damaged"));
  Json damaged = Json::parse(good);
  damaged["simulation"]["state"]["x"] = {1.};
  write_file(folder / "first/final.json", sealed(damaged.dump()));
  CHECK_THROWS_WITH(Run(scene, RunSettings{.folder = "", .from = folder / "first"}),
                    Catch::Contains("is damaged"));
  write_file(folder / "first/final.json", good);
}

TEST_CASE("an equilibrium may begin with another run, whose dashpots do not count", "[from]") {
  const Folder folder;
  const bool meshed = GENERATE(false, true);
  const auto text = [&](const char* contact, const char* time) {
    const std::string lower =
        meshed
            ? R"("mesh": { "rectangle": { "size": [1, 0.5], "cells": [4, 2] }, "element": "Q4" })"
            : R"("polygon": [[0, 0], [1, 0], [1, 0.5], [0, 0.5]])";
    return fmt::format(
        R"({{ "gravity": [1, -9.81], "materials": {{ "rock": {{ "density": 2000, "young": 1e8, "poisson": 0.2 }} }},
    "contact": {{ "friction": {{ "coefficient": 0.15 }}, {} }},
    "bodies": [ {{ "name": "floor", "material": "rock", "motion": "fixed",
                  "polygon": [[-5, -1], [5, -1], [5, 0], [-5, 0]] }},
                {{ "name": "upper", "material": "rock", "polygon": [[0.1, 0.502], [0.8, 0.502], [0.5, 1.1]] }},
                {{ "name": "lower", "material": "rock", {} }} ],
    "time": {} }})",
        contact, lower, time);
  };
  const std::string damping = R"("damping": { "model": "viscous", "ratio": 0.5 }, )";
  const Scene first = scene_of(
      folder, text((damping + R"("normal_stiffness": 1e6)").c_str(), R"({ "end": 0.05 })"));
  Run fall(first, RunSettings{.folder = folder / "first"});
  fall.run();
  CHECK(std::abs(fall.state().pose_rate(1)[1]) > 1e-3);  // not at rest
  const bool damped = GENERATE(false, true), statics = GENERATE(false, true);
  if (damped && statics) return;
  CAPTURE(meshed, damped, statics);
  const std::string contact = (damped ? damping : "") + R"("normal_stiffness": 1e8)";
  const Scene scene = scene_of(
      folder, text(contact.c_str(), statics ? R"({ "mode": "static", "end": 1, "load_steps": 1 })"
                                            : R"({ "end": 1e-4, "start": "settled" })"));
  Run run(scene, RunSettings{.folder = "", .from = folder / "first"});
  if (statics) REQUIRE(run.run() == Run::Status::done);
  const double upper = scene.model.bodies[1].mass, all = upper + 1000;
  CHECK(run.state().force(1)[0] == Approx(-upper).epsilon(1e-5));
  CHECK(run.state().force(1)[1] == Approx(upper * 9.81).epsilon(1e-5));
  CHECK(run.state().force(0)[0] == Approx(all).epsilon(1e-5));
  CHECK(run.state().force(0)[1] == Approx(-all * 9.81).epsilon(1e-5));
  CHECK(run.state().pose_rate(1).norm() == 0);
  CHECK((run.state().pose(1) - fall.state().pose(1)).norm() < .1);
}

TEST_CASE("dashpots of a run that is over do not hold a block on a slope", "[from]") {
  const Folder folder;
  const bool meshed = GENERATE(false, true);
  CAPTURE(meshed);
  const auto text = [&](const char* damping, const char* time) {
    return fmt::format(
        R"({{ "gravity": [1, -9.81], "materials": {{ "rock": {{ "density": 2000, "young": 1e8, "poisson": 0.2 }} }},
    "contact": {{ "normal_stiffness": 1e6, "friction": {{ "coefficient": 0.08 }}{} }},
    "bodies": [ {{ "name": "floor", "material": "rock", "motion": "fixed",
                  "polygon": [[-5, -1], [5, -1], [5, 0], [-5, 0]] }},
                {{ "name": "block", "material": "rock", {} }} ],
    "time": {} }})",
        damping,
        meshed
            ? R"("mesh": { "rectangle": { "size": [1, 0.5], "cells": [4, 2], "origin": [0, 0.002] }, "element": "Q4" })"
            : R"("polygon": [[0, 0.002], [1, 0.002], [1, 0.502], [0, 0.502]])",
        time);
  };
  // It presses on the floor, and dashpots press as much.
  Run fall(scene_of(folder, text(R"(, "damping": { "model": "viscous", "ratio": 0.5 })",
                                 R"({ "end": 0.025 })")),
           {.folder = folder / "first"});
  fall.run();
  CHECK(fall.state().force(0)[1] < -1000);
  Run run(scene_of(folder, text("", R"({ "mode": "static", "end": 1, "load_steps": 1 })")),
          {.folder = "", .from = folder / "first"});
  CHECK(run.run() == Run::Status::unstable);
  CHECK_THAT(run.message(), Catch::Contains("\"block\" slides on \"floor\""));
}

TEST_CASE("a packing comes to rest with contacts a hundred times stiffer", "[from]") {
  const Folder folder;
  const auto text = [](const char* stiffness, const char* time) {
    return fmt::format(
        R"({{ "gravity": [0, -9.81], "materials": {{ "rock": {{ "density": 2000 }} }},
    "contact": {{ "normal_stiffness": {}, "friction": {{ "coefficient": 0.4 }},
                  "damping": {{ "model": "viscous", "ratio": 0.5 }} }},
    "bodies": [ {{ "name": "bin", "material": "rock", "motion": "fixed",
        "polygon": [[-1, 2], [-1, -0.2], [1, -0.2], [1, 2], [0.6, 2], [0.6, 0], [-0.6, 0.1], [-0.6, 2]] }} ],
    "fill": [ {{ "name": "block", "material": "rock", "region": [[-0.6, 0.1], [0.6, 0.1], [0.6, 1.5], [-0.6, 1.5]],
        "shapes": [{{ "quadrilateral": {{}} }}], "count": {}, "seed": 3, "arrangement": "dense", "diameter": 0.2 }} ],
    "time": {} }})",
        stiffness, kSanitized ? 8 : 30, time);
  };
  const Scene first = scene_of(folder, text("1e6", R"({ "end": 1.5, "scheme": "auto" })"));
  Run fall(first, RunSettings{.folder = folder / "first"});
  fall.run();
  const Scene scene = scene_of(folder, text("1e8", R"({ "end": 1e-4, "start": "settled" })"));
  const Run run(scene, RunSettings{.folder = "", .from = folder / "first"});
  double moved = 0;
  for (RigidIndex i = 1; i < run.state().layout.rigid_bodies; ++i) {
    const double mass = scene.model.bodies[i].mass, weight = 9.81 * mass;
    const Eigen::Vector3d force = run.state().force(i);
    CHECK(std::abs(force[0]) < 1e-6 * weight);
    CHECK(force[1] == Approx(weight).epsilon(1e-6));
    CHECK(std::abs(force[2]) < 1e-6 * weight * scene.model.bodies[i].inradius);
    moved = std::max(moved, (run.state().pose(i) - fall.state().pose(i)).norm());
  }
  CHECK(moved > 1e-4);  // pressed a hundred times less deep
  CHECK(moved < .1);
}

namespace {

const char* const kPull = R"(, "velocity": [[0, 0, 0], [1, 0, 0], [1.000001, 4e-4, 0]])";
const char* const kFirstPull = R"(, "velocity": [[0, 4e-4, 0]])";
const char* const kRamp = R"(, "history": [[0, 0], [1, 1]])";

std::vector<double> of_nodes(const State& state) {
  const std::span<const double> x = state.layout.of_nodes(state.x);
  return {x.begin(), x.end()};
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

}  // namespace

TEST_CASE("a static run goes on where another one has ended, with its friction", "[run][from]") {
  const Folder folder;
  const auto time = [](double end, int steps) {
    return fmt::format(R"({{ "mode": "static", "end": {}, "load_steps": {}, "tolerance": 1e-9 }})",
                       end, steps);
  };
  Run whole(scene_of(folder, pulled_block(kPull, kRamp, time(2, 16))), {});
  REQUIRE(whole.run() == Run::Status::done);
  Run first(scene_of(folder, pulled_block("", kRamp, time(1, 8))), {.folder = folder / "first"});
  REQUIRE(first.run() == Run::Status::done);
  const double pressed = first.simulation().contact_forces()[1].friction;
  REQUIRE(pressed > 1e5);
  Run second(scene_of(folder, pulled_block(kFirstPull, "", time(1, 8))),
             {.folder = folder / "second", .from = folder / "first"});
  CHECK(second.simulation().contact_forces()[1].friction == Approx(pressed).epsilon(1e-9));
  REQUIRE(second.run() == Run::Status::done);
  const BodyForce one = whole.simulation().contact_forces()[1];
  const BodyForce other = second.simulation().contact_forces()[1];
  CHECK(one.fx < -1e6);
  CHECK(other.fx == Approx(one.fx).epsilon(1e-5));
  CHECK(other.friction == Approx(one.friction).epsilon(1e-5));
  CHECK(apart(of_nodes(whole.state()), of_nodes(second.state())) < 1e-5);
  // The load stands from the start, and its work is that of the second part.
  const Energies e = second.simulation().energies(), all = whole.simulation().energies();
  const double before = first.simulation().energies().external_work;
  CHECK(e.external_work == Approx(all.external_work - before).epsilon(1e-3));
  CHECK(e.friction_loss ==
        Approx(all.friction_loss - first.simulation().energies().friction_loss).epsilon(1e-3));
  // In parts, bit for bit.
  Run(scene_of(folder, pulled_block(kFirstPull, "", time(1, 8))),
      {.folder = folder / "parts", .from = folder / "first"})
      .run(.5);
  Run resumed(scene_of(folder, pulled_block(kFirstPull, "", time(1, 8))),
              {.folder = folder / "parts", .resume = true});
  REQUIRE(resumed.run() == Run::Status::done);
  CHECK(state_hash(resumed.state()) == state_hash(second.state()));
  CHECK(content(folder / "parts/energy.csv") == content(folder / "second/energy.csv"));
}

TEST_CASE("a dynamic run begins in the equilibrium of a static one", "[run][from][slow]") {
  const Folder folder;
  Run first(scene_of(folder, pulled_block(kPull, kRamp,
                                          R"({ "mode": "static", "end": 2, "load_steps": 16,
                                               "tolerance": 1e-10 })")),
            {.folder = folder / "first"});
  REQUIRE(first.run() == Run::Status::done);
  const BodyForce rubs = first.simulation().contact_forces()[1];
  REQUIRE(rubs.fx < -1e6);
  Run second(scene_of(folder, pulled_block("", "", R"({ "end": 2e-3 })")),
             {.folder = folder / "second", .from = folder / "first"});
  CHECK(largest(second.state().v) == 0);
  CHECK(second.simulation().contact_forces()[1].fx == Approx(rubs.fx).epsilon(1e-9));
  const std::vector<double> start = of_nodes(second.state());
  const double strain = second.simulation().energies().strain;
  REQUIRE(second.run() == Run::Status::done);
  CHECK(apart(start, of_nodes(second.state())) < 1e-6);
  CHECK(second.simulation().energies().kinetic < 1e-12 * strain);
  CHECK(second.simulation().contact_forces()[1].fx == Approx(rubs.fx).epsilon(1e-5));
  // Without its springs it would jump.
  Json forgetful = Json::parse(content(folder / "first/final.json"));
  for (auto& [name, term] : forgetful["simulation"].items()) {
    if (term.is_object() && term.contains("contacts")) {
      term["contacts"]["friction"]["springs"] = Json::array();
    }
  }
  write_file(folder / "first/final.json", sealed(forgetful.dump()));
  Run third(scene_of(folder, pulled_block("", "", R"({ "end": 2e-3 })")),
            {.folder = folder / "third", .from = folder / "first"});
  third.run();
  CHECK(apart(start, of_nodes(third.state())) > 1e-2);
}

TEST_CASE("a static run begins with the state of a dynamic one, at rest", "[run][from]") {
  const Folder folder;
  Run first(scene_of(folder, slope(kRough, kBlock)), {.folder = folder / "first"});
  REQUIRE(first.run() == Run::Status::done);
  REQUIRE(largest(first.state().v) > .1);
  std::string text = slope(kRough, kBlock);
  const std::string end = R"("end": 0.02)", moving = R"("velocity": [1, 0], )";
  text.replace(text.find(end), end.size(), R"("end": 1, "mode": "static", "load_steps": 2)");
  text.replace(text.find(moving), moving.size(), "");
  const std::string output = R"(, "output": { "frames": 4, "history": { "interval": 1e-3 } })";
  text.replace(text.find(output), output.size(), "");
  Run second(scene_of(folder, text), {.folder = folder / "second", .from = folder / "first"});
  CHECK(largest(second.state().v) == 0);
  CHECK(second.simulation().energies().kinetic == 0);
  CHECK(second.simulation().contact_forces()[1].friction ==
        Approx(first.simulation().contact_forces()[1].friction).epsilon(1e-6));
  REQUIRE(second.run() == Run::Status::done);
  // Friction goes back from its limit to what the slope asks for.
  const RigidBody& block = second.scene().model.bodies[1];
  CHECK(second.state().force(1)[0] == Approx(.3 * block.mass).epsilon(1e-5));
  CHECK(second.state().force(1)[1] == Approx(9.5 * block.mass).epsilon(1e-5));
}
