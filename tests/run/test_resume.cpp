// A run that was stopped continues bit for bit: in the middle of friction, between load steps, and
// with a force of the user's own. A checkpoint that does not fit is refused.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <random>

#include "lib/output/files.hpp"
#include "lib/run/hash.hpp"
#include "tests/archive/saved.hpp"
#include "tests/dynamics/term_of.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace {

// All that a simulation remembers.
std::string remembered(Run& run) { return saved(run.simulation())["simulation"].dump(); }

void check_same(Run& run, Run& other) {
  CHECK(run.state().step == other.state().step);
  CHECK(state_hash(run.state()) == state_hash(other.state()));
  CHECK((remembered(run) == remembered(other)));
}

void check_same_files(const Folder& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    INFO(name);
    const std::string whole = content(folder / ("whole/" + name));
    CHECK(!whole.empty());
    CHECK((whole == content(folder / ("parts/" + name))));
  }
}

std::vector<NamedScene> stopped_scenes() {
  std::vector<NamedScene> scenes = rubbing_scenes();
  scenes.push_back(turning_slope());
  return scenes;
}

// Meshes on each other and on a rigid floor, with friction, and a rigid block between two meshes.
std::vector<NamedScene> static_scenes() {
  const std::string between = R"({ "gravity": [0, -10],
    "materials": { "rock": { "density": 2000, "young": 2e8, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e9,
                 "friction": { "coefficient": 0.4, "tangential_stiffness": 5e8 } },
    "bodies": [
      { "name": "lower", "material": "rock",
        "mesh": { "rectangle": { "size": [1, 0.5], "cells": [6, 3] } },
        "supports": [ { "where": { "y": 0 }, "fix": ["x", "y"] } ] },
      { "name": "stone", "material": "rock", "polygon": [[0.2, 0.5], [0.8, 0.5], [0.8, 0.7], [0.2, 0.7]] },
      { "name": "upper", "material": "rock",
        "mesh": { "rectangle": { "size": [0.5, 0.2], "cells": [5, 2], "origin": [0.25, 0.7] } },
        "loads": [ { "where": { "group": "top" }, "force": [3e3, -1e5], "history": [[0, 0], [1, 1]] } ] } ],
    "time": { "end": 1, "mode": "static", "load_steps": 3 },
    "output": { "history": { "track": [ { "body": "stone" } ] } } })";
  return {{"two meshes", pressed_blocks(3), 0, false, {}},
          {"a mesh pulled over a floor",
           pulled_block(R"(, "velocity": [[0, 0, 0], [1, 0, 0], [1.000001, 2e-3, 0]])",
                        R"(, "history": [[0, 0], [1, 1]])",
                        R"({ "end": 1.5, "mode": "static", "load_steps": 3 })"),
           0,
           false,
           {}},
          {"a rigid block between meshes", between, 0, false, {}}};
}

std::string checkpoint_of(const Folder& folder) { return folder / "parts/checkpoint.json"; }

}  // namespace

TEST_CASE("a run that was stopped while bodies rub continues bit for bit", "[resume]") {
  for (const NamedScene& named : stopped_scenes()) {
    INFO(named.name);
    const Folder folder;
    const Scene scene = scene_of(folder, named.text);
    Run whole(scene, {.folder = folder / "whole"});
    REQUIRE(whole.run() == Run::Status::done);
    Run first(scene, {.folder = folder / "parts"});
    REQUIRE(first.run(named.stop) == Run::Status::done);
    REQUIRE(first.state().time < .9 * scene.time.end);
    REQUIRE(std::filesystem::exists(checkpoint_of(folder)));

    // In the middle of friction: springs hold something back, below Coulomb's limit or at it.
    double pull = 0, pressure = 0;
    for (const Spring& spring : springs(first.simulation())) pull += std::abs(spring.force);
    for (const ContactRecord& r : first.simulation().contacts()) pressure += r.normal.norm();
    const double share = pull / (scene.model.contact.friction.coefficient * pressure);
    CAPTURE(pull, share);
    REQUIRE(pull > 1);
    if (named.sticks) CHECK(share < .5);
    if (!named.sticks && scene.model.deformables.empty()) CHECK(share == Approx(1).epsilon(.01));
    if (!named.sticks) CHECK(first.simulation().energies().friction_loss > 0);
    for (const char* need : named.needs) {
      const auto& terms = first.simulation().terms();
      CHECK(std::any_of(terms.begin(), terms.end(), [&](const auto& term) {
        return term->describe().find(need) != std::string::npos;
      }));
    }

    Run second(scene, {.folder = folder / "parts", .threads = 2, .resume = true});
    CHECK(second.state().time == first.state().time);
    CHECK(state_hash(second.state()) == state_hash(first.state()));
    REQUIRE(second.run() == Run::Status::done);
    CHECK(second.simulation().own_steps() == second.state().step - first.state().step);
    check_same(second, whole);
    check_same_files(folder, {"history.csv", "energy.csv", "momentum.csv", "frames.pvd",
                              "frames/bodies_000004.vtu", "frames/contacts_000004.vtu"});
    CHECK_FALSE(std::filesystem::exists(checkpoint_of(folder)));
  }
}

TEST_CASE("crosses that share their skeleton go on bit for bit, on any number of threads",
          "[resume]") {
  const Folder folder;
  const Scene scene = scene_of(folder, R"({ "gravity": [0, -10],
    "materials": { "rock": { "density": 2000 } },
    "contact": { "normal_stiffness": 1e7, "friction": { "coefficient": 0.5 } },
    "bodies": [ { "name": "floor", "material": "rock", "motion": "fixed",
                  "polygon": [[-1, -0.5], [2, -0.5], [2, 0], [-1, 0]] } ],
    "fill": [ { "name": "cross", "material": "rock", "region": [[0, 0], [0.6, 0], [0.6, 1.2], [0, 1.2]],
                "shapes": [ { "cross": {} } ], "diameter": { "uniform": [0.08, 0.1] },
                "arrangement": "lattice", "count": 12, "velocity": [0, -3] } ],
    "time": { "end": 0.055, "accuracy": 0.1 }, "output": { "frames": 1 } })");
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  REQUIRE(whole.simulation().contacts().size() > 0);
  for (const int threads : {2, 3}) {
    Run again(scene, {.folder = "", .threads = threads});
    REQUIRE(again.run() == Run::Status::done);
    CHECK(state_hash(again.state()) == state_hash(whole.state()));
  }
  Run first(scene, {.folder = folder / "parts"});
  REQUIRE(first.run(.03) == Run::Status::done);
  Run second(scene, {.folder = folder / "parts", .threads = 2, .resume = true});
  REQUIRE(second.run() == Run::Status::done);
  check_same(second, whole);
}

TEST_CASE("a run that was saved to a file with its scene goes on bit for bit", "[resume]") {
  for (const NamedScene& named : stopped_scenes()) {
    INFO(named.name);
    const Folder folder;
    Run whole(scene_of(folder, named.text), {});
    REQUIRE(whole.run() == Run::Status::done);
    const std::string file = folder / "state.json";
    Run first(scene_of(folder, named.text), {});
    first.advance(named.stop);
    first.save(file);
    REQUIRE(first.step());  // saving does not disturb it
    std::filesystem::remove(folder / "scene.json");
    Run second(read_saved_scene(file), {.folder = "", .saved = file});
    REQUIRE(second.run() == Run::Status::done);
    check_same(second, whole);
    // With results in a folder. The largest force of meshes is looked for where rows are written.
    Run third(read_saved_scene(file), {.folder = folder / "later", .saved = file});
    REQUIRE(third.run() == Run::Status::done);
    CHECK(state_hash(third.state()) == state_hash(whole.state()));
    CHECK(std::filesystem::exists(folder / "later/final.json"));
  }
}

TEST_CASE("what is loaded is what was saved, to the last bit", "[resume]") {
  for (const NamedScene& named : stopped_scenes()) {
    INFO(named.name);
    const Folder folder;
    const Scene scene = scene_of(folder, named.text);
    Run run(scene, {});
    REQUIRE(run.run(named.stop) == Run::Status::done);
    const Json json = saved(run.simulation());
    const std::unique_ptr<Simulation> other = make_simulation(scene, 1, Start::checkpoint);
    restore(*other, Json::parse(json.dump()));
    CHECK((saved(*other) == json));
    // Contacts are found again, with the forces that they had.
    const std::vector<ContactRecord> before = run.simulation().contacts(), now = other->contacts();
    REQUIRE(before.size() == now.size());
    CHECK(!now.empty());
    for (size_t i = 0; i < now.size(); ++i) {
      CHECK(now[i].a == before[i].a);
      CHECK(now[i].b == before[i].b);
      CHECK(now[i].normal == before[i].normal);
      CHECK(now[i].tangential == before[i].tangential);
      CHECK(now[i].penetration == before[i].penetration);
    }
    const std::vector<BodyForce> on = run.simulation().contact_forces(),
                                 again = other->contact_forces();
    REQUIRE(on.size() == again.size());
    for (size_t i = 0; i < on.size(); ++i) {
      CHECK(on[i].fx == again[i].fx);
      CHECK(on[i].fy == again[i].fy);
      CHECK(on[i].friction == again[i].friction);
    }
  }
}

TEST_CASE("a run that is stopped many times continues bit for bit", "[resume]") {
  const Folder folder;
  const NamedScene named = rubbing_scenes()[7];
  const Scene scene = scene_of(folder, named.text);
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  std::unique_ptr<Run> part = std::make_unique<Run>(scene, RunSettings{.folder = folder / "parts"});
  for (int i = 1; i < 7; ++i) {
    REQUIRE(part->run(i * scene.time.end / 7) == Run::Status::done);
    part = std::make_unique<Run>(scene, RunSettings{.folder = folder / "parts", .resume = true});
  }
  REQUIRE(part->run() == Run::Status::done);
  check_same(*part, whole);
  check_same_files(folder, {"history.csv", "energy.csv", "momentum.csv", "frames.pvd"});
}

TEST_CASE("a settled start is not repeated when a run is resumed", "[resume]") {
  const Folder folder;
  std::string text = rubbing_scenes()[1].text;
  const std::string end = R"("end": 0.02)";
  text.replace(text.find(end), end.size(), R"("end": 0.02, "start": "settled")");
  const Scene scene = scene_of(folder, text);
  REQUIRE(scene.time.settled);
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  Run first(scene, {.folder = folder / "parts"});
  REQUIRE(first.run(.01) == Run::Status::done);
  REQUIRE(!springs(first.simulation()).empty());
  Run second(scene, {.folder = folder / "parts", .resume = true});
  REQUIRE(second.run() == Run::Status::done);
  check_same(second, whole);
  check_same_files(folder, {"history.csv", "energy.csv", "momentum.csv"});
}

TEST_CASE("damping, loads and driven supports continue bit for bit", "[resume]") {
  const Folder folder;
  const Scene scene = scene_of(folder, R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2,
                             "damping": { "model": "rayleigh", "mass": 3, "stiffness": 1e-6 } } },
    "gravity": [0, -9.81],
    "bodies": [ { "name": "beam", "material": "rock", "spin": 1,
      "mesh": { "rectangle": { "size": [2, 0.5], "cells": [8, 2] } },
      "supports": [ { "where": { "x": 0 }, "velocity": [[0, 0, 0], [0.01, 1, 0.5]] } ],
      "loads": [ { "where": { "group": "top" }, "pressure": 1e6, "history": [[0, 0], [0.01, 1]] } ] } ],
    "time": { "end": 0.01 },
    "output": { "frames": 4, "history": { "interval": 1e-4, "track": [ { "body": "beam" } ] } } })");
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  Run first(scene, {.folder = folder / "parts"});
  REQUIRE(first.run(.0043) == Run::Status::done);
  Run second(scene, {.folder = folder / "parts", .threads = 2, .resume = true});
  REQUIRE(second.run() == Run::Status::done);
  CHECK(second.simulation().energies().damping_loss > 0);
  CHECK(second.simulation().energies().external_work != 0);
  check_same(second, whole);
  check_same_files(folder, {"history.csv", "energy.csv", "momentum.csv"});
}

TEST_CASE("the angle of a mesh goes on where a run goes on", "[resume]") {
  const Folder folder;
  const Scene scene = scene_of(folder, R"({
    "materials": { "m": { "density": 1000, "young": 1e8, "poisson": 0.3 } },
    "contact": { "normal_stiffness": 1e6 },
    "bodies": [
      { "name": "rigid", "material": "m", "spin": -12, "polygon": [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]] },
      { "name": "mesh", "material": "m", "spin": -12,
        "mesh": { "rectangle": { "size": [1, 1], "cells": [2, 2], "origin": [4.5, -0.5] } } } ],
    "time": { "end": 1 }, "output": { "frames": 1, "history": { "interval": 0.4 } } })");
  Run part(scene, {.folder = folder / "parts"});
  part.run(.61);
  Run rest(scene, {.folder = folder / "parts", .resume = true});
  rest.run();
  const HistoryTable table = read_history(folder / "parts/history.csv");
  const std::vector<double>& rigid = *table.column("rigid.angle");
  const std::vector<double>& mesh = *table.column("mesh.angle");
  REQUIRE(rigid.size() == 4);
  for (size_t i = 0; i < rigid.size(); ++i) CHECK(std::abs(mesh[i] - rigid[i]) < .02);
  CHECK(rigid.back() == Approx(-12));
}

TEST_CASE("a static run continues between its load steps, bit for bit", "[resume]") {
  const Folder folder;
  const Scene scene = scene_of(folder, pressed_blocks(5));
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  Run first(scene, {.folder = folder / "parts"});
  REQUIRE(first.run(.4) == Run::Status::done);
  REQUIRE(first.load_steps().size() == 2);
  REQUIRE(first.simulation().energies().contact > 0);
  Run second(scene, {.folder = folder / "parts", .threads = 2, .resume = true});
  REQUIRE(second.load_steps().size() == 2);
  REQUIRE(second.run() == Run::Status::done);
  REQUIRE(second.load_steps().size() == 5);
  for (size_t i = 0; i < 5; ++i) {
    const LoadStep &one = second.load_steps()[i], &other = whole.load_steps()[i];
    CHECK(one.time == other.time);
    CHECK(one.iterations == other.iterations);
    CHECK(one.residual == other.residual);
    CHECK(one.imbalance == other.imbalance);
    CHECK(one.off == other.off);
  }
  check_same(second, whole);
  check_same_files(folder, {"history.csv", "energy.csv", "momentum.csv", "frames.pvd",
                            "frames/surfaces_000005.vtu"});
}

TEST_CASE("a static run that is stopped within its load steps goes on there, bit for bit",
          "[resume]") {
  std::mt19937 random(41);
  for (const NamedScene& named : static_scenes()) {
    INFO(named.name);
    const Folder folder;
    const Scene scene = scene_of(folder, named.text);
    Run whole(scene, {.folder = folder / "whole"});
    REQUIRE(whole.run() == Run::Status::done);
    std::int64_t longest = 0;
    for (const LoadStep& s : whole.load_steps()) longest = std::max(longest, s.iterations);
    REQUIRE(longest > 2);
    int stops = 0;
    Run::Status status = Run::Status::interrupted;
    for (; status == Run::Status::interrupted && stops < 100; ++stops) {
      std::int64_t left =
          1 + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(longest));
      Run part(scene, {.folder = folder / "parts",
                       .threads = 1 + stops % 2,
                       .resume = stops > 0,
                       .stop_if = [&] { return --left < 0; }});
      status = part.run();
      if (status != Run::Status::done) continue;
      check_same(part, whole);
      REQUIRE(part.load_steps().size() == whole.load_steps().size());
      for (size_t i = 0; i < part.load_steps().size(); ++i) {
        CHECK(part.load_steps()[i].iterations == whole.load_steps()[i].iterations);
        CHECK(part.load_steps()[i].off == whole.load_steps()[i].off);
      }
    }
    REQUIRE(status == Run::Status::done);
    CHECK(stops > 1);
    check_same_files(folder, {"history.csv", "energy.csv", "momentum.csv", "frames.pvd"});
  }
}

TEST_CASE("checkpoints within a load step change nothing, and a run goes on from them",
          "[resume]") {
  const Folder folder;
  Scene scene = scene_of(folder, pressed_blocks(2));
  Run plain(scene, {.folder = folder / "plain"});
  REQUIRE(plain.run() == Run::Status::done);
  scene.output.checkpoint_interval = 1e-9;
  int looks = 0;
  bool copied = false;
  Run whole(scene, {.folder = folder / "whole", .stop_if = [&] {
                      if (++looks % 5 == 0 && !copied) {
                        std::filesystem::copy(folder / "whole", folder / "killed",
                                              std::filesystem::copy_options::recursive);
                        copied = true;
                      }
                      return false;
                    }});
  REQUIRE(whole.run() == Run::Status::done);
  check_same(whole, plain);
  REQUIRE(copied);
  scene.output.checkpoint_interval.reset();
  Run second(scene, {.folder = folder / "killed", .resume = true});
  REQUIRE(second.run() == Run::Status::done);
  check_same(second, plain);
  CHECK(content(folder / "plain/history.csv") == content(folder / "killed/history.csv"));
}

TEST_CASE("a static run that is killed goes on from the checkpoint behind a load step",
          "[resume][slow]") {
  const Folder folder;
  Scene scene = scene_of(folder, pressed_blocks(3));
  scene.output.checkpoint_interval = 1e-9;
  Run whole(scene, {.folder = folder / "whole"});
  whole.on_progress([&](const Run& now) {
    if (now.state().step != 2) return;
    std::filesystem::copy(folder / "whole", folder / "killed",
                          std::filesystem::copy_options::recursive);
  });
  REQUIRE(whole.run() == Run::Status::done);
  Run second(scene, {.folder = folder / "killed", .resume = true});
  CHECK(second.state().step == 1);
  REQUIRE(second.run() == Run::Status::done);
  check_same(second, whole);
  CHECK(content(folder / "whole/history.csv") == content(folder / "killed/history.csv"));
}

TEST_CASE("a run that is killed at its very end has its last row once", "[resume][slow]") {
  for (const std::string& text : {pressed_blocks(3), rubbing_scenes()[1].text}) {
    const Folder folder;
    Scene scene = scene_of(folder, text);
    scene.output.checkpoint_interval = 1e-9;
    Run whole(scene, {.folder = folder / "whole"});
    whole.advance();  // the last checkpoint is that of the end, and the run is not closed yet
    std::filesystem::copy(folder / "whole", folder / "killed",
                          std::filesystem::copy_options::recursive);
    whole.finish();
    scene.output.checkpoint_interval.reset();
    Run second(scene, {.folder = folder / "killed", .resume = true});
    REQUIRE(second.run() == Run::Status::done);
    CHECK(content(folder / "whole/history.csv") == content(folder / "killed/history.csv"));
    CHECK(content(folder / "whole/frames.pvd") == content(folder / "killed/frames.pvd"));
  }
}

TEST_CASE("without an interval there is no checkpoint before the run stops", "[resume]") {
  const Folder folder;
  Scene scene = scene_of(folder, rubbing_scenes()[1].text);
  for (const bool off : {false, true}) {
    scene.output.checkpoint_interval = 1e-9;
    if (off) scene.output.checkpoint_interval.reset();
    const std::string out = folder / (off ? "off" : "on");
    Run run(scene, {.folder = out});
    int seen = 0;
    run.on_progress(
        [&](const Run& /*now*/) { seen += std::filesystem::exists(out + "/checkpoint.json"); });
    REQUIRE(run.run() == Run::Status::done);
    CHECK((seen > 0) == !off);
  }
}

TEST_CASE("a run that was asked to stop leaves a checkpoint", "[resume]") {
  const Folder folder;
  const Scene scene = scene_of(folder, rubbing_scenes()[1].text);
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  bool enough = false;
  Run first(scene, {.folder = folder / "parts", .stop_if = [&] { return enough; }});
  first.on_progress([&](const Run& now) { enough = now.state().time > .01; });
  REQUIRE(first.run() == Run::Status::interrupted);
  Run second(scene, {.folder = folder / "parts", .resume = true});
  REQUIRE(second.run() == Run::Status::done);
  check_same(second, whole);
  check_same_files(folder, {"history.csv", "energy.csv", "momentum.csv", "frames.pvd"});
}

TEST_CASE("a force of the user's own goes on acting after a resume", "[resume]") {
  const Folder folder;
  const Scene scene = scene_of(folder, rubbing_scenes()[1].text);
  const auto push = [](const State& state, std::span<double> on) {
    on[state.layout.rigid(1)] += 100 * std::sin(200 * state.time);
  };
  Run whole(scene, {.folder = folder / "whole"});
  whole.add_force("a push", push);
  REQUIRE(whole.run() == Run::Status::done);
  Run first(scene, {.folder = folder / "parts"});
  first.add_force("a push", push);
  REQUIRE(first.run(.013) == Run::Status::done);
  Run second(scene, {.folder = folder / "parts", .resume = true});
  second.add_force("a push", push);
  CHECK(state_hash(second.state()) == state_hash(first.state()));
  REQUIRE(second.run() == Run::Status::done);
  CHECK(second.simulation().energies().external_work != 0);
  check_same(second, whole);
  check_same_files(folder, {"history.csv", "energy.csv", "momentum.csv"});
}

TEST_CASE("a checkpoint that is missing, damaged or of another scene is refused", "[resume]") {
  const Folder folder;
  const Scene scene = scene_of(folder, rubbing_scenes()[1].text);
  const RunSettings resume{.folder = folder / "parts", .resume = true};
  const auto refused = [&](const char* why) {
    INFO(why);
    CHECK_THROWS_WITH(Run(scene, resume), Catch::Contains(why));
    CHECK_THROWS_AS(Run(scene, resume), SceneError);
  };
  Run(scene, {.folder = folder / "parts"}).run(.01);
  const std::string good = content(checkpoint_of(folder));
  const Json json = Json::parse(good);
  const auto write = [&](const Json& damaged) {
    write_file(checkpoint_of(folder), sealed(damaged.dump()));
  };
  const auto without = [&](const std::string& pointer) {
    Json damaged = json;
    const Json::json_pointer at(pointer);
    REQUIRE(damaged.contains(at));
    damaged[at.parent_pointer()].erase(at.back());
    return damaged;
  };
  const auto with = [&](const std::string& pointer, const Json& value) {
    Json damaged = json;
    REQUIRE(damaged.contains(Json::json_pointer(pointer)));
    damaged[Json::json_pointer(pointer)] = value;
    return damaged;
  };

  for (const char* missing :
       {"/scene_hash", "/potentials", "/progress", "/progress/next_row", "/simulation",
        "/simulation/state/x", "/simulation/ledger", "/simulation/step_control/size",
        "/simulation/term_0", "/simulation/term_0/contacts/search",
        "/simulation/term_0/contacts/friction/springs/0/force"}) {
    INFO(missing);
    write(without(missing));
    refused("is not a checkpoint");
  }
  for (const char* list : {"x", "v", "f", "remainder"}) {
    INFO(list);
    write(with(std::string("/simulation/state/") + list, {1, 2, 3}));
    refused("is damaged");
  }
  write(with("/simulation/state/x", "no list"));
  refused("is damaged");
  write(with("/simulation/step_control/size", 0));
  refused("is damaged");
  write(with("/progress/histories", Json::array()));
  refused("without histories");
  write(with("/progress/histories/1/checksum", "fnv1a64:0123456789abcdef"));
  refused("energy.csv: is not as the run has written it");
  write(with("/scene_hash", "fnv1a64:0123456789abcdef"));
  refused("belongs to another scene");
  write(with("/potentials", "fnv1a64:0123456789abcdef"));
  refused("other potentials");
  write_file(checkpoint_of(folder), good.substr(0, good.size() / 2));
  refused("is damaged");
  write_file(checkpoint_of(folder), "");
  refused("it is empty");
  write_file(checkpoint_of(folder), json.dump());
  refused("is damaged");
  std::filesystem::remove(checkpoint_of(folder));
  refused("no checkpoint to resume from");

  write_file(checkpoint_of(folder), good);
  const std::string history = content(folder / "parts/history.csv");
  write_file(folder / "parts/history.csv", history.substr(0, 40));
  refused("shorter than the checkpoint says");
  std::filesystem::remove(folder / "parts/history.csv");
  refused("is missing");
  write_file(folder / "parts/history.csv", history);
  CHECK_NOTHROW(Run(scene, resume));
}

TEST_CASE("a checkpoint of a static run with another number of bodies is refused", "[resume]") {
  const Folder folder;
  const Scene scene = scene_of(folder, pressed_blocks(4));
  Run(scene, {.folder = folder / "parts"}).run(.25);
  const Json json = Json::parse(content(checkpoint_of(folder)));
  for (const auto& [pointer, value] :
       {std::pair<const char*, Json>{"/progress/load_steps/0/worst", 2},
        {"/progress/load_steps/0/worst", -1},
        {"/progress/load_steps/0/off", {1.}},
        {"/simulation/equilibrium/outside", {1.}},
        {"/simulation/equilibrium/body_loads", {1.}}}) {
    INFO(pointer);
    Json damaged = json;
    REQUIRE(damaged.contains(Json::json_pointer(pointer)));
    damaged[Json::json_pointer(pointer)] = value;
    write_file(checkpoint_of(folder), sealed(damaged.dump()));
    CHECK_THROWS_WITH(Run(scene, {.folder = folder / "parts", .resume = true}),
                      Catch::Contains("is damaged"));
  }
}
