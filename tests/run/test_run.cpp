// A run: a scene that is stepped, recorded, stopped and asked about, with files and without.
#include "lib/run/run.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <map>

#include "lib/dynamics/unstable.hpp"
#include "lib/output/history.hpp"
#include "lib/output/run_folder.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;
namespace fs = std::filesystem;

namespace {

constexpr double kMass = 2000, kInertia = 2000. / 6;  // of the flying block

// Names of the files in a folder.
std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

TEST_CASE("a run without a folder is stepped, looked at, and leaves no files", "[run]") {
  const Folder folder;
  Run run(scene_of(folder, flying_block(R"(, "velocity": [1, 2])", R"(, "gravity": [0, -10])")),
          {});
  CHECK(run.status() == Run::Status::running);
  CHECK(run.state().step == 0);
  CHECK(run.state().pose(0) == Eigen::Vector3d(.5, .5, 0));
  for (int i = 1; i <= 100; ++i) {
    REQUIRE(run.step());
    const double t = run.state().time;
    REQUIRE(run.state().step == i);
    REQUIRE(t == Approx(i * 1e-3).epsilon(1e-14));
    REQUIRE(run.state().pose(0)[0] == Approx(.5 + t).epsilon(1e-13));
    REQUIRE(run.state().pose(0)[1] == Approx(.5 + 2 * t - 5 * t * t).epsilon(1e-13));
  }
  CHECK(run.simulation().momenta().x == Approx(kMass).epsilon(1e-13));
  CHECK(files_in(folder.path()) == std::vector<std::string>{"scene.json"});
}

TEST_CASE("a run goes until a time, on from there, and to its end", "[run]") {
  const Folder folder;
  Run run(scene_of(folder, flying_block()), {});
  CHECK(run.run(.1) == Run::Status::done);
  CHECK(run.state().time == Approx(.1).epsilon(1e-12));
  CHECK(run.state().step == 100);
  CHECK(run.run(.05) == Run::Status::done);  // it is there already
  CHECK(run.state().step == 100);
  REQUIRE(run.step());
  CHECK(run.run(.2) == Run::Status::done);
  CHECK(run.state().step == 200);
  CHECK(run.run(7) == Run::Status::done);  // behind the end of the scene
  CHECK(run.state().time == Approx(.5).epsilon(1e-12));
  CHECK(run.status() == Run::Status::done);
  CHECK(run.message().empty());
  CHECK_FALSE(run.step());
  CHECK(run.state().step == 500);
}

TEST_CASE("a run that is stepped by hand goes where one that runs does", "[run]") {
  const Folder folder;
  const NamedScene scene = rubbing_scenes()[1];
  Run stepped(scene_of(folder, scene.text), {}), ran(scene_of(folder, scene.text), {});
  while (stepped.step()) continue;
  CHECK(ran.run() == Run::Status::done);
  CHECK(stepped.state().x == ran.state().x);
  CHECK(stepped.state().v == ran.state().v);
  CHECK(stepped.state().step == ran.state().step);
}

TEST_CASE("a run tells of every step, and goes on after what it was told", "[run]") {
  struct Enough {};
  const Folder folder;
  int steps = 0;
  Run run(scene_of(folder, flying_block()), {.stop_if = [&] { return steps == 20; }});
  run.on_step([&] {
    if (++steps == 10) throw Enough();
  });
  CHECK_THROWS_AS(run.advance(), Enough);
  CHECK(run.state().step == 10);
  run.advance();
  CHECK(run.state().step == 20);
  CHECK(run.status() == Run::Status::interrupted);
  CHECK(run.step());
  run.advance();
  CHECK(run.state().step == 500);
  CHECK(run.finish() == Run::Status::done);
}

TEST_CASE("the vectors of a state stay in place, and its velocities are set with their energy",
          "[run]") {
  const Folder folder;
  Run run(scene_of(folder, rubbing_scenes()[1].text), {});
  const State& state = run.state();
  const std::array places{state.x.data(), state.v.data(), state.f.data()};
  std::vector<double> v = state.v;
  for (int i = 0; i < 200; ++i) {
    REQUIRE(run.step());
    REQUIRE(places == std::array{state.x.data(), state.v.data(), state.f.data()});
    if (i != 100) continue;
    v = state.v;
    for (double& value : v) value += .01;
    const Energies before = run.simulation().energies();
    run.simulation().set_velocities(v);
    const Energies after = run.simulation().energies();
    CHECK(after.kinetic > before.kinetic);
    CHECK(after.total_error == Approx(before.total_error).margin(1e-12 * after.kinetic));
    CHECK(state.v[3] == v[3]);
    CHECK(state.v[0] == 0);  // of the slope, which is fixed
  }
}

TEST_CASE("a run stops when it is asked to, and says so", "[run]") {
  const Folder folder;
  bool enough = false;
  Run run(scene_of(folder, flying_block()), {.stop_if = [&] { return enough; }});
  std::int64_t looks = 0;
  run.on_progress([&](const Run& now) {
    ++looks;
    CHECK(&now == &run);
    enough = now.state().step >= 100;
  });
  CHECK(run.run() == Run::Status::interrupted);
  CHECK(looks > 0);
  CHECK(run.state().step >= 100);
  CHECK(run.state().step < 200);
  CHECK(run.message().find("interrupted at t = 0.1") == 0);
}

TEST_CASE("a static run takes whole load steps, and none if it is stopped within one", "[run]") {
  const Folder folder;
  bool enough = false;
  Run run(scene_of(folder, pressed_blocks(4)), {.stop_if = [&] { return enough; }});
  CHECK(run.run(.6) == Run::Status::done);  // the third one leads beyond
  REQUIRE(run.load_steps().size() == 2);
  CHECK(run.state().time == .5);
  CHECK(run.load_steps()[1].residual <= 1e-6);
  REQUIRE(run.step());
  CHECK(run.state().time == .75);
  const State before = run.state();
  enough = true;
  CHECK_FALSE(run.step());
  CHECK(run.state().time == .75);
  CHECK(run.state().x == before.x);
  CHECK(run.state().f == before.f);
  CHECK(run.run() == Run::Status::interrupted);
}

TEST_CASE("a run with a folder writes its histories, frames and summary", "[run]") {
  const Folder folder;
  const Scene scene = scene_of(folder, flying_block(R"(, "velocity": [1, 2])",
                                                    R"(, "gravity": [0, -10], "expect": [
            { "quantity": "block.x", "value": 1, "tolerance": 1e-12 },
            { "quantity": "block.y", "take": "max", "value": 7, "tolerance": 1e-3 } ])"));
  Run run(scene, {.folder = folder / "out"});
  CHECK(run.run() == Run::Status::done);
  const HistoryTable history = read_history(folder / "out/history.csv");
  REQUIRE(history.columns[0].size() == 51);
  for (size_t i = 0; i <= 50; ++i) {
    const double t = history.columns[0][i];
    CHECK(t == Approx(.01 * static_cast<double>(i)).margin(1e-12));
    CHECK((*history.column("block.x"))[i] == Approx(.5 + t).epsilon(1e-12));
    CHECK((*history.column("block.vy"))[i] == Approx(2 - 10 * t).margin(1e-11));
  }
  CHECK(read_history(folder / "out/energy.csv").columns[0] == history.columns[0]);
  CHECK(read_history(folder / "out/momentum.csv").columns[0] == history.columns[0]);
  for (const char* name : {"frames.pvd", "run.json", "frames/bodies_000005.vtu"}) {
    CHECK(fs::exists(folder / ("out/" + std::string(name))));
  }
  CHECK_FALSE(fs::exists(folder / "out/frames/bodies_000006.vtu"));
  CHECK_FALSE(fs::exists(folder / "out/checkpoint.json"));  // it is at its end
  REQUIRE(run.outcomes().size() == 2);
  CHECK(run.outcomes()[0].met);
  CHECK_FALSE(run.outcomes()[1].met);
  // Results are not replaced, unless that is asked for.
  CHECK_THROWS_WITH(Run(scene, {.folder = folder / "out"}), Catch::Contains("--overwrite"));
  CHECK_NOTHROW(Run(scene, {.folder = folder / "out", .overwrite = true}));
}

TEST_CASE("histories and frames tell how many bodies each one touches", "[run]") {
  const Folder folder;
  const Scene scene = scene_of(folder, R"({ "gravity": [0, -10],
    "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e9 },
    "bodies": [
      { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-9, -1], [9, -1], [9, 1e-7], [-9, 1e-7]] },
      { "name": "lower", "material": "rock", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]] },
      { "name": "upper", "material": "rock", "polygon": [[0, 0.9999999], [1, 0.9999999], [1, 2], [0, 2]] },
      { "name": "away", "material": "rock", "polygon": [[5, 1], [6, 1], [6, 2], [5, 2]] },
      { "name": "soft", "material": "rock",
        "mesh": { "rectangle": { "size": [1, 1], "cells": [2, 2], "origin": [2, 0] }, "element": "Q4" } } ],
    "time": { "end": 1e-4 }, "output": { "frames": 1, "history": { "interval": 1e-5 } } })");
  Run run(scene, {.folder = folder / "out"});
  REQUIRE(run.run() == Run::Status::done);
  const HistoryTable history = read_history(folder / "out/history.csv");
  const Frame frame = read_frame(folder / "out", 0, 0);
  const std::map<std::string, double> expected{
      {"lower", 2}, {"upper", 1}, {"away", 0}, {"soft", 1}};
  for (const auto& [name, count] : expected) {
    INFO(name);
    CHECK(history.column(name + ".coordination")->front() == count);
    const auto body = std::ranges::find(frame.bodies, name, &FrameBody::name);
    REQUIRE(body != frame.bodies.end());
    CHECK(body->values[body_quantity("coordination")][0] == count);
  }
}

TEST_CASE("a run that becomes unstable says why, and keeps what it has", "[run]") {
  const Folder folder;
  const Scene scene = scene_of(folder, R"({ "gravity": [0, -10],
    "materials": { "rock": { "density": 2000 } }, "contact": { "normal_stiffness": 1e4 },
    "bodies": [
      { "name": "flat", "material": "rock", "motion": "fixed", "polygon": [[-2, -1], [2, -1], [2, 0], [-2, 0]] },
      { "name": "square", "material": "rock", "polygon": [[-0.5, 0.1], [0.5, 0.1], [0.5, 1.1], [-0.5, 1.1]] } ],
    "time": { "end": 2 }, "output": { "frames": 4, "history": { "interval": 0.01 } } })");
  Run run(scene, {.folder = folder / "out"});
  CHECK(run.run() == Run::Status::unstable);
  CHECK(run.message().find("normal_stiffness") != std::string::npos);
  CHECK(read_history(folder / "out/history.csv").columns[0].size() > 10);
  Run stepped(scene, {});
  CHECK_THROWS_AS(
      [&] {
        while (stepped.step()) continue;
      }(),
      Unstable);
}

TEST_CASE("records fall on the first step at or after their times", "[run]") {
  Schedule schedule(.1);
  CHECK(schedule.next() == 1);
  CHECK_FALSE(schedule.due(.05, .03));
  CHECK_FALSE(schedule.due(.09, .03));
  CHECK(schedule.due(.12, .03));
  CHECK_FALSE(schedule.due(.15, .03));
  CHECK(schedule.due(.2 - 1e-12, .03));  // round-off is no step
  CHECK(schedule.due(.57, .03));         // and what a long step has passed is over
  CHECK(schedule.next() == 6);
  CHECK_FALSE(schedule.due(.59, .03));
  CHECK(schedule.due(.6, .03));
}

TEST_CASE("a constant force gives the parabola, and its work and impulse are on the ledgers",
          "[run]") {
  const Folder folder;
  Run run(scene_of(folder, flying_block(R"(, "velocity": [1, -2], "spin": 0.25)")), {});
  const Eigen::Vector3d force(4000, 6000, 100);
  run.add_force("a thrust and a moment", [&](const State& state, std::span<double> on) {
    const size_t at = state.layout.rigid(0);
    for (size_t k = 0; k < 3; ++k) on[at + k] += force[static_cast<int>(k)];
  });
  REQUIRE(run.simulation().terms().size() == 1);
  CHECK(run.simulation().terms()[0]->describe() == "a thrust and a moment");
  const Eigen::Vector3d start = run.state().pose(0);
  while (run.step()) {
    const double t = run.state().time;
    const Eigen::Vector3d inertia(kMass, kMass, kInertia), rate(1, -2, .25);
    const Eigen::Vector3d gain = force.cwiseQuotient(inertia);
    const Eigen::Vector3d way = t * rate + t * t / 2 * gain;
    const Eigen::Vector3d moved = run.state().pose(0) - start;
    REQUIRE((moved - way).cwiseAbs().maxCoeff() < 1e-13);
    REQUIRE((run.state().pose_rate(0) - rate - t * gain).cwiseAbs().maxCoeff() < 1e-12);
    if (run.state().step % 50 != 0) continue;
    const Energies e = run.simulation().energies();
    REQUIRE(e.external_work == Approx(force.dot(way)).epsilon(1e-12));
    REQUIRE(std::abs(e.total_error) < 1e-12 * e.kinetic);
    const Momenta p = run.simulation().momenta();
    REQUIRE(p.x == Approx(kMass * 1 + t * 4000).epsilon(1e-12));
    REQUIRE(std::abs(p.x_error) < 1e-13 * p.x);
    REQUIRE(std::abs(p.y_error) < 1e-13 * p.x);
    REQUIRE(std::abs(p.angular_error) < 1e-13 * p.x);
  }
  CHECK(run.state().time == Approx(.5));
}

TEST_CASE("a force of the user's own acts on nodes as on rigid bodies", "[run]") {
  const Folder folder;
  const Scene scene = scene_of(folder, R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
    "bodies": [ { "name": "bar", "material": "rock", "velocity": [3, 0],
                  "mesh": { "rectangle": { "size": [1, 0.1], "cells": [10, 1] } } } ],
    "time": { "end": 1e-3 } })");
  Run run(scene, {});
  // In proportion to the masses: the bar is not strained.
  const std::vector<double> mass = run.simulation().node_mass();
  double whole = 0;
  for (const double m : mass) whole += m;
  CHECK(whole == Approx(200));
  const Vec2 acceleration(-500, 1000);
  run.add_force("an acceleration of all nodes", [&](const State& state, std::span<double> on) {
    for (int i = 0; i < state.layout.nodes; ++i) {
      on[state.layout.node(i)] += mass[i] * acceleration.x();
      on[state.layout.node(i) + 1] += mass[i] * acceleration.y();
    }
  });
  while (run.step()) continue;
  const double t = run.state().time;
  const Vec2 way = t * Vec2(3, 0) + t * t / 2 * acceleration;
  for (int i = 0; i < run.state().layout.nodes; ++i) {
    CHECK((run.state().node(i) - way).norm() < 1e-12 * way.norm());
  }
  const Energies e = run.simulation().energies();
  CHECK(e.external_work == Approx(whole * acceleration.dot(way)).epsilon(1e-11));
  CHECK(std::abs(e.total_error) < 1e-11 * e.kinetic);
  const Momenta p = run.simulation().momenta();
  CHECK(std::abs(p.x_error) < 1e-11 * p.x);
  CHECK(std::abs(p.y_error) < 1e-11 * p.x);
  CHECK(std::abs(p.angular_error) < 1e-11 * p.x);
}

TEST_CASE("a force on what is held or driven goes into what holds it", "[run]") {
  const Folder folder;
  const Scene scene = scene_of(folder, R"({ "materials": { "rock": { "density": 2000 } },
    "contact": { "normal_stiffness": 1e7 },
    "bodies": [
      { "name": "fixed", "material": "rock", "motion": "fixed", "polygon": [[0, 0], [1, 0], [1, 1]] },
      { "name": "driven", "material": "rock", "motion": { "velocity": [[0, 2, 0]] }, "polygon": [[0, 2], [1, 2], [1, 3]] },
      { "name": "held", "material": "rock", "fix": ["y"], "polygon": [[0, 5], [1, 5], [1, 6]] } ],
    "time": { "end": 0.1, "step": 1e-3 } })");
  Run run(scene, {});
  run.add_force("wind", [](const State& state, std::span<double> on) {
    for (int i = 0; i < state.layout.rigid_bodies; ++i) {
      on[state.layout.rigid(i)] += 30;
      on[state.layout.rigid(i) + 1] += 40;
    }
  });
  const State start = run.state();
  while (run.step()) continue;
  const double t = run.state().time;
  CHECK(run.state().pose(0) == start.pose(0));
  CHECK(run.state().pose(1)[0] - start.pose(1)[0] == Approx(2 * t).epsilon(1e-12));
  const double gain = 30 / 1000. * t * t / 2;
  CHECK(run.state().pose(2)[0] - start.pose(2)[0] == Approx(gain).epsilon(1e-9));
  CHECK(run.state().pose(2)[1] == start.pose(2)[1]);
  // What drives the driven body takes the work of the wind on it.
  const Energies e = run.simulation().energies();
  CHECK(e.external_work == Approx(30 * gain).epsilon(1e-9));
  CHECK(e.kinetic == Approx(30 * gain).epsilon(1e-9));
  CHECK(std::abs(e.total_error) < 1e-9 * e.kinetic);
  const Momenta p = run.simulation().momenta();
  CHECK(std::abs(p.x_error) < 1e-11);
  CHECK(std::abs(p.y_error) < 1e-11);
  CHECK(std::abs(p.angular_error) < 1e-11);
}

TEST_CASE("in a static run a force of the user's own is a load like others", "[run]") {
  const auto scene = [](const char* load) {
    return std::string(R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
    "bodies": [ { "name": "bar", "material": "rock",
      "mesh": { "rectangle": { "size": [1, 0.25], "cells": [8, 2] } },
      "supports": [ { "where": { "x": 0 }, "fix": ["x", "y"] } ])") +
           load + R"( } ],
    "time": { "end": 1, "mode": "static", "load_steps": 4 } })";
  };
  const Folder folder;
  Run loaded(scene_of(folder, scene(R"(,
      "loads": [ { "at": [1, 0], "force": [1e6, -2e6], "history": [[0, 0], [1, 1]] } ])")),
             {});
  Run pulled(scene_of(folder, scene("")), {});
  const std::vector<Vec2>& nodes = pulled.scene().model.deformables[0].mesh.nodes;
  const auto corner =
      static_cast<int>(std::find(nodes.begin(), nodes.end(), Vec2(1, 0)) - nodes.begin());
  pulled.add_force("a pull", [&](const State& state, std::span<double> on) {
    on[state.layout.node(corner)] += 1e6 * state.time;
    on[state.layout.node(corner) + 1] -= 2e6 * state.time;
  });
  CHECK(loaded.run() == Run::Status::done);
  CHECK(pulled.run() == Run::Status::done);
  CHECK(pulled.state().node(corner).y() < -1e-4);
  CHECK(pulled.state().x == loaded.state().x);
  REQUIRE(pulled.load_steps().size() == 4);
  CHECK(pulled.load_steps()[3].residual == loaded.load_steps()[3].residual);
  const Energies e = pulled.simulation().energies(), other = loaded.simulation().energies();
  CHECK(e.external_work == Approx(other.external_work).epsilon(1e-12));
  CHECK(e.strain == Approx(e.external_work).epsilon(.01));
}
