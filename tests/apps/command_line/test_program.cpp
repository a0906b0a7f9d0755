// The program as its users meet it: arguments, exit codes, messages, files.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "geometry/meshing/voronoi.hpp"
#include "lib/output/history.hpp"
#include "lib/output/run_folder.hpp"
#include "tests/folder.hpp"
#include "tests/program.hpp"
#include "tests/support.hpp"

using namespace apothem;
using test::content;
using test::Folder;
using test::lines;
using test::Result;
using test::run;
using Json = nlohmann::json;

namespace {

const std::string kScene = test::kSource + "/data/scenes/impact-asymmetric.json";

std::string scene(const std::string& time, const std::string& bodies_extra = "") {
  return R"({ "materials": { "rock": { "density": 2000 } }, "gravity": [0, -9.81],
  "contact": { "normal_stiffness": 20e9 },
  "bodies": [ { "name": "flat", "material": "rock", "motion": "fixed", "polygon": [[-2,-1],[2,-1],[2,0],[-2,0]] },
              { "name": "square", "material": "rock", "polygon": [[-0.5,0.1],[0.5,0.1],[0.5,1.1],[-0.5,1.1]] })" +
         bodies_extra + R"( ],
  "time": )" +
         time + " }";
}

}  // namespace

TEST_CASE("help and usage", "[program][slow]") {
  const Folder folder;
  CHECK(run({"--help"}, folder).code == 0);
  CHECK(run({"--version"}, folder).out.starts_with("apothem "));
  for (const char* sub : {"run", "sweep", "check", "contact", "polygon", "mesh", "accuracy",
                          "benchmark", "reproduce"})
    CHECK(run({sub, "--help"}, folder).code == 0);
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{},
        {"fly"},
        {"run"},
        {"run", kScene, "--threads", "0"},
        {"run", kScene, "--until", "-1"},
        {"run", kScene, "--until", "nan"},
        {"run", kScene, "--until", "inf"},
        {"contact", "a"},
        {"contact"},
        {"accuracy", "--cases"},
        {"accuracy", "--cases", "a", "--write-cases", "b"},
        {"accuracy", "--cases", "missing.txt"},
        {"contact", "a", "b", "--method", "guess"},
        {"contact", "a", "b", "--field", "x"},
        {"contact", "a", "b", "--potential", "area", "--reference", "roof"},
        {"contact", "a", "b", "--reference", "x"},
        {"polygon"},
        {"polygon", "missing.json"},
        {"polygon", "a", "--reference", "0"},
        {"polygon", "a", "--reference", "nan"},
        {"polygon", "a", "--picture", "a.jpg"},
        {"polygon", "a", "--batch", "b"},
        {"polygon", "--batch", "b", "--picture", "a.png"},
        {"polygon", "--batch", "missing.txt"}}) {
    const Result r = run(wrong, folder);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(lines(r.err) == 1);
  }
}

TEST_CASE("a run writes what the interface promises", "[program]") {
  const Folder folder;
  const std::string out = folder / "out";
  const Result r = run({"run", kScene, "-o", out, "--until", "0.01", "--quiet"}, folder);
  REQUIRE(r.code == 0);
  CHECK(r.out.empty());
  CHECK(r.err.empty());
  const Json json = Json::parse(content(out + "/run.json"));
  for (const char* key :
       {"scene_hash", "version", "threads", "steps", "dt", "dt_limited_by", "wall_time",
        "processor_time", "pairs_per_step", "largest_penetration", "largest_energy_error"}) {
    INFO(key);
    CHECK(json.contains(key));
  }
  CHECK(json["status"] == "done");
  CHECK(json["steps"] == 5000);
  CHECK(std::filesystem::exists(out + "/frames.pvd"));
  CHECK(std::filesystem::exists(out + "/contacts.pvd"));
  CHECK(read_history(out + "/history.csv").columns[0].back() == .01);
  // Results are not overwritten unless asked.
  const Result again = run({"run", kScene, "-o", out, "--until", "0.01"}, folder);
  CHECK(again.code == 2);
  CHECK(again.err.find("--overwrite") != std::string::npos);
  std::ofstream(out + "/mine.txt") << "keep";
  CHECK(run({"run", kScene, "-o", out, "--until", "0.005", "--overwrite"}, folder).code == 0);
  CHECK(content(out + "/mine.txt") == "keep");
  CHECK(read_history(out + "/history.csv").columns[0].back() == .005);
}

TEST_CASE("bad scenes end with exit code 2 and nothing on disk", "[program]") {
  const Folder folder;
  for (
      const std::string& text :
      {std::string("{"), scene(R"({ "end": 1, "step": 1e-3 })"), scene(R"({ "end": 1 })", ", {}"),
       scene(
           R"({ "end": 1 })",
           R"(, { "name": "deep", "material": "rock", "polygon": [[-0.5,0.11],[0.5,0.1],[0.5,1.1],[-0.5,1.1]] })")}) {
    const std::string file = folder.write("bad.json", text);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"run", file, "-o", folder / "bad"}, {"check", file}}) {
      const Result r = run(arguments, folder);
      INFO(r.err);
      CHECK(r.code == 2);
      CHECK(lines(r.err) == 1);
      CHECK(r.err.find(file) != std::string::npos);
      CHECK_FALSE(std::filesystem::exists(folder / "bad"));
    }
  }
  const Result limit =
      run({"check", folder.write("bad.json", scene(R"({ "end": 1, "step": 1e-3 })"))}, folder);
  CHECK(limit.err.find("stability limit of 0.000316") != std::string::npos);
  CHECK(limit.err.find("/time/step") != std::string::npos);
  CHECK(run({"run", "no-such-file.json"}, folder).code == 2);
}

TEST_CASE("check prints the plan", "[program]") {
  const Folder folder;
  const Result r = run({"check", kScene}, folder);
  CHECK(r.code == 0);
  for (const char* word : {"bodies", "time step", "limited by", "contact", "friction"})
    CHECK(r.out.find(word) != std::string::npos);
}

TEST_CASE("check prints the terms of the step, one to a line, and no others", "[program]") {
  const Folder folder;
  const auto terms = [&](const std::string& file) {
    const Result r = run({"check", file}, folder);
    INFO(r.err);
    CHECK(r.code == 0);
    return r.out.substr(r.out.find("terms of the step:"));
  };
  const std::string rigid = terms(kScene);
  CHECK(lines(rigid) == 2);
  CHECK(rigid.find("\n  + contact of 2 surfaces, distance potential, k_n = 2e+10 Pa") !=
        std::string::npos);
  CHECK(rigid.find("no friction") != std::string::npos);
  CHECK(rigid.find("finite elements") == std::string::npos);

  const std::string rough = terms(test::kSource + "/data/scenes/incline-up-mu-06.json");
  CHECK(lines(rough) == 2);
  CHECK(rough.find("friction, mu = 0.6") != std::string::npos);

  const std::string beam = terms(test::kSource + "/data/scenes/cantilever-q4.json");
  CHECK(lines(beam) == 4);
  CHECK(beam.find("\n  + 1000 finite elements, 1111 nodes: Q4") != std::string::npos);
  CHECK(beam.find("\n  + loads: 1 by forces, 0 by pressures") != std::string::npos);
  CHECK(beam.find("\n  + a look at boundaries that cross themselves") != std::string::npos);

  const std::string blocks = terms(test::kSource + "/data/scenes/pressed-blocks.json");
  CHECK(lines(blocks) == 5);
  CHECK(blocks.find("also with themselves") == std::string::npos);
  CHECK(blocks.find("meshes by the potentials of their boundaries") != std::string::npos);

  const std::string alone = folder.write("alone.json", R"({
    "materials": { "rock": { "density": 2000 } },
    "bodies": [ { "name": "alone", "material": "rock", "polygon": [[0, 0], [1, 0], [0, 1]] } ],
    "time": { "end": 1, "step": 0.01 } })");
  CHECK(terms(alone).starts_with("terms of the step: none\n"));
}

TEST_CASE("a static run writes a row and a frame per load step", "[program]") {
  const Folder folder;
  const std::string scene = test::kSource + "/data/scenes/pressed-blocks.json";
  const Result r = run({"run", scene, "-o", folder / "blocks", "--until", "0.6"}, folder);
  INFO(r.err);
  REQUIRE(r.code == 0);
  const Json json = Json::parse(content(folder / "blocks/run.json"));
  REQUIRE(json["load_steps"].size() == 3);
  for (const Json& step : json["load_steps"]) {
    CHECK(step["residual"] <= 1e-6);
    CHECK(step["imbalance"] <= 1e-6);
    CHECK(step["iterations"] > 1);
  }
  CHECK(read_history(folder / "blocks/history.csv").columns[0].size() == 4);
  CHECK(content(folder / "blocks/surfaces.pvd").find("surfaces_000003.vtu") != std::string::npos);
  CHECK(run({"check", scene}, folder).out.find("5 load steps") != std::string::npos);

  const Result rest = run({"run", scene, "-o", folder / "blocks", "--resume", "--verify"}, folder);
  INFO(rest.err);
  CHECK(rest.code == 0);
  CHECK(rest.err.find("load step 4 of 5") != std::string::npos);
  CHECK(rest.err.find("load step 3 of 5") == std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "blocks/checkpoint.json"));
  const Result ended = run({"run", scene, "-o", folder / "blocks", "--resume", "--verify"}, folder);
  CHECK(ended.code == 0);
  CHECK(ended.out.find("has ended before") != std::string::npos);
}

TEST_CASE("Ctrl-C ends the search for a settled start, and no run has begun", "[program][slow]") {
  const Folder folder;
  const Result r =
      run({"run", test::kSource + "/data/scenes/slope-stands.json", "--set",
           "contact.friction={\"coefficient\": 0.56, \"law\": \"per_edge\"}", "--set",
           "contact.damping={\"model\": \"normal_viscous\", \"ratio\": 0.2}", "-o", folder / "out"},
          folder, {.interrupt_after = kSanitized ? 6. : 2.});  // it takes minutes
  INFO(r.err);
  CHECK(r.code == 130);
  CHECK_THAT(r.err, Catch::Contains("not at rest yet"));
  CHECK_FALSE(std::filesystem::exists(folder / "out/run.json"));
}

TEST_CASE("Ctrl-C during a load step keeps the one before, and --resume goes on from it",
          "[program][slow]") {
  const Folder folder;
  const std::string file = folder.write("bent.json", R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 20e9 },
    "bodies": [
      { "name": "die", "material": "rock", "polygon": [[1.7, 0.1], [2.1, 0.8], [1.5, 0.8]],
        "motion": { "velocity": [[0, 0, -0.05]] } },
      { "name": "beam", "material": "rock",
        "mesh": { "rectangle": { "size": [2, 0.1], "cells": [80, 4] } },
        "supports": [ { "where": { "x": 0 }, "fix": ["x", "y"] } ] } ],
    "time": { "end": 1, "mode": "static", "load_steps": 10 },
    "output": { "history": { "track": [ { "body": "die" }, { "body": "beam", "point": [2, 0.05] } ] } } })");
  REQUIRE(run({"run", file, "-o", folder / "whole"}, folder).code == 0);
  const Result r =
      run({"run", file, "-o", folder / "parts"}, folder,
          {.interrupt_after = 1e-3, .once_exists = folder / "parts/frames/bodies_000001.vtu"});
  INFO(r.err);
  REQUIRE(r.code == 130);
  CHECK(r.err.find("--resume continues") != std::string::npos);
  const Json stopped = Json::parse(content(folder / "parts/run.json"));
  CHECK(stopped["status"] == "interrupted");
  const size_t done = stopped["load_steps"].size();
  CHECK(done >= 1);
  CHECK(done < 10);
  CHECK(stopped["steps"] == done);
  CHECK(stopped["time"] == stopped["load_steps"].back()["time"]);
  CHECK(read_history(folder / "parts/history.csv").columns[0].size() == done + 1);
  CHECK(read_history(folder / "parts/history.csv").columns[0].back() == stopped["time"]);

  REQUIRE(run({"run", file, "-o", folder / "parts", "--resume", "--threads", "3"}, folder).code ==
          0);
  REQUIRE(run({"run", file, "-o", folder / "cut", "--until", "0.35"}, folder).code == 0);
  CHECK(Json::parse(content(folder / "cut/run.json"))["steps"] == 3);
  const std::string checkpoint = content(folder / "cut/checkpoint.json");
  Json damaged = Json::parse(checkpoint);
  damaged["progress"]["load_steps"][0]["worst"] = 99;  // of a few bodies
  folder.write("cut/checkpoint.json", damaged.dump());
  CHECK(run({"run", file, "-o", folder / "cut", "--resume"}, folder).code == 2);
  folder.write("cut/checkpoint.json", checkpoint);
  REQUIRE(run({"run", file, "-o", folder / "cut", "--resume"}, folder).code == 0);
  const Json whole = Json::parse(content(folder / "whole/run.json"));
  for (const std::string other : {"parts/", "cut/"}) {
    for (const char* name : {"history.csv", "energy.csv", "momentum.csv", "frames.pvd",
                             "frames/bodies_000010.vtu", "frames/surfaces_000010.vtu"}) {
      INFO(other << name);
      CHECK((content(folder / (std::string("whole/") + name)) == content(folder / (other + name))));
    }
    const Json json = Json::parse(content(folder / (other + "run.json")));
    for (const char* key : {"final_state_hash", "load_steps", "largest_penetration",
                            "largest_contact_force", "largest_energy_error"}) {
      CHECK(whole[key] == json[key]);
    }
  }
}

namespace {

// A disc and an angle with their mirror images in a smooth box, under a plate with 4e6 N/m.
const char* const kPress = R"({
  "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2, "plane": "strain" } },
  "contact": { "normal_stiffness": 1e9 },
  "bodies": [
    { "name": "box", "material": "rock", "motion": "fixed",
      "polygon": [[-3,-1],[3,-1],[3,3],[2,3],[2,0],[-2,0],[-2,3],[-3,3]] },
    { "name": "disc-right", "material": "rock", "mesh": { "disc": { "radius": 0.5, "centre": [1.5, 0.5], "cells": 5 } } },
    { "name": "disc-left", "material": "rock",
      "mesh": { "disc": { "radius": 0.5, "centre": [1.5, 0.5], "cells": 5 }, "mirror": { "x": 0 } } },
    { "name": "angle-right", "material": "rock",
      "mesh": { "fill": { "polygon": [[0,0],[1,0],[1,0.4],[0.5,0.6],[0.6,1],[0,1]], "size": 0.15 } } },
    { "name": "angle-left", "material": "rock",
      "mesh": { "fill": { "polygon": [[0,0],[1,0],[1,0.4],[0.5,0.6],[0.6,1],[0,1]], "size": 0.15 }, "mirror": { "x": 0 } } },
    { "name": "plate", "material": "rock",
      "mesh": { "rectangle": { "size": [3.9, 0.3], "cells": [26, 2], "origin": [-1.95, 1] } },
      "supports": [ { "where": { "nearest": [0, 1.3] }, "fix": ["x"] } ],
      "loads": [ { "where": { "group": "top" }, "force": [0, -4e6] } ] } ],
  "time": { "end": 1, "mode": "static", "load_steps": 1 },
  "output": { "history": { "track": [ { "body": "plate", "surface": "contact" } ] } } })";

}  // namespace

TEST_CASE("bodies pressed in a box: balance of each, mirror images", "[program]") {
  const Folder folder;
  const std::string scene = folder.write("press.json", kPress);
  const Result r = run({"run", scene, "-o", folder / "press"}, folder);
  INFO(r.err);
  REQUIRE(r.code == 0);
  CHECK(r.err.find("iterations, residual ") != std::string::npos);
  CHECK(r.out.find("force balance: ") != std::string::npos);
  const Json balance = Json::parse(content(folder / "press/run.json"))["balance"];
  REQUIRE(balance.size() == 5);
  for (const Json& body : balance) {
    CHECK(body["of_load"] < 3e-6);  // twice the load is on the plate, and tolerance is 1e-6
    CHECK(body["of_load"].get<double>() * 4e6 == Approx(body["force"].get<double>()).epsilon(.3));
  }

  const Frame frame = read_frame(folder / "press", 1, 1.5);
  const auto cells_of = [&](int body) {
    std::vector<int> cells;
    for (size_t c = 0; c < frame.body.size(); ++c) {
      if (frame.body[c] == body) cells.push_back(static_cast<int>(c));
    }
    return cells;
  };
  double largest = 0, worst = 0;
  for (const int right : {1, 3}) {
    const std::vector<int> here = cells_of(right), there = cells_of(right + 1);
    REQUIRE(here.size() == there.size());
    const auto place = [&](int cell) {
      Vec2 sum = Vec2::Zero();
      for (const int node : frame.mesh.element(cell)) {
        sum += frame.mesh.nodes[node] + frame.displacement[node];
      }
      return Vec2(sum / static_cast<double>(frame.mesh.element(cell).size()));
    };
    for (const int a : here) {
      const Vec2 image(-place(a).x(), place(a).y());
      const int b = *std::min_element(there.begin(), there.end(), [&](int i, int j) {
        return (place(i) - image).norm() < (place(j) - image).norm();
      });
      CHECK((place(b) - image).norm() < 1e-12);
      const CauchyStress &s = frame.stress[a], &t = frame.stress[b];
      largest = std::max(largest, std::abs(s.yy));
      worst =
          std::max({worst, std::abs(s.xx - t.xx), std::abs(s.yy - t.yy), std::abs(s.xy + t.xy)});
    }
  }
  CHECK(largest > 1e6);
  CHECK(worst < 1e-9 * largest);

  // The pressure of the whole is what the surface has.
  double force = 0, most = 0;
  for (const SurfaceRecord& s : read_surfaces(folder / "press", 1, 1.5)) {
    if (s.body != 5) continue;
    force += s.pressure * (s.to - s.from).norm();
    most = std::max(most, s.pressure);
  }
  CHECK(force == Approx(4e6).epsilon(1e-3));
  const HistoryTable history = read_history(folder / "press/history.csv");
  CHECK(history.column("plate.pressure")->back() == Approx(most).epsilon(1e-12));
  CHECK_THROWS_AS(read_surfaces(folder / "press", 2, 3), std::runtime_error);
}

TEST_CASE("the pressure under a block, and its half-width", "[program]") {
  const Folder folder;
  const std::string scene = folder.write("block.json", R"({
  "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0 } },
  "contact": { "normal_stiffness": 1e10 },
  "bodies": [
    { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-3,-1],[3,-1],[3,0],[-3,0]] },
    { "name": "block", "material": "rock",
      "mesh": { "rectangle": { "size": [2, 1], "cells": [4, 2], "origin": [-1, 0] } },
      "supports": [ { "where": { "nearest": [0, 1] }, "fix": ["x"] } ],
      "loads": [ { "where": { "group": "top" }, "traction": [0, -1e5] } ] } ],
  "time": { "end": 1, "mode": "static", "load_steps": 1 },
  "output": { "history": { "track": [ { "body": "block", "surface": "contact" } ] } },
  "expect": [ { "quantity": "block.pressure", "value": 1e5, "relative": 1e-3 },
              { "quantity": "block.half_width", "value": 1.154700538, "relative": 1e-3 } ] })");
  const Result r = run({"run", scene, "-o", folder / "block", "--verify"}, folder);
  INFO(r.err << r.out);
  CHECK(r.code == 0);
}

TEST_CASE("a static run without an equilibrium says what is loose", "[program]") {
  const Folder folder;
  const std::string loose = folder.write(
      "loose.json", R"({ "materials": { "rock": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
    "bodies": [ { "name": "kite", "material": "rock",
                  "mesh": { "rectangle": { "size": [1, 1], "cells": [2, 2] } },
                  "loads": [ { "at": [0.5, 0.5], "force": [1e4, 0] } ] } ],
    "time": { "end": 1, "mode": "static" } })");
  const Result r = run({"run", loose, "-o", folder / "loose"}, folder);
  INFO(r.err);
  CHECK(r.code == 3);
  CHECK(r.err.find("\"kite\"") != std::string::npos);
  CHECK(r.err.find("support it") != std::string::npos);
  CHECK(content(folder / "loose/frames.pvd").find("bodies_000000.vtu") != std::string::npos);
}

TEST_CASE("an unstable run keeps its last good frame", "[program]") {
  const Folder folder;
  const std::string soft = folder.write(
      "soft.json", R"({ "materials": { "rock": { "density": 2000 } }, "gravity": [0, -9.81],
    "contact": { "normal_stiffness": 1e4 },
    "bodies": [ { "name": "flat", "material": "rock", "motion": "fixed", "polygon": [[-2,-1],[2,-1],[2,0],[-2,0]] },
                { "name": "square", "material": "rock", "polygon": [[-0.5,0.1],[0.5,0.1],[0.5,1.1],[-0.5,1.1]] } ],
    "time": { "end": 2 }, "output": { "frames": 20, "history": { "interval": 0.01 } } })");
  const Result r = run({"run", soft, "-o", folder / "soft"}, folder);
  CHECK(r.code == 3);
  CHECK(r.err.find("\"square\"") != std::string::npos);
  CHECK(r.err.find("t = ") != std::string::npos);
  CHECK(Json::parse(content(folder / "soft/run.json"))["status"] == "unstable");
  CHECK(content(folder / "soft/frames.pvd").find("bodies_000002.vtu") != std::string::npos);
  CHECK(read_history(folder / "soft/history.csv").columns[0].size() > 10);
}

TEST_CASE("a run may stop at the top of a bounce", "[program]") {
  // Kinetic and contact energy are zero there; an error is still measured against the fall.
  const Folder folder;
  const std::string file = folder.write("long.json", scene(R"({ "end": 10000 })"));
  const Result r = run({"run", file, "-o", folder / "top", "--until", "0.2856"}, folder);
  CHECK(r.code == 0);
  // A meshed ball on a long step: 4 % of the fall is unaccounted for, a third of what still moves.
  const std::string ball = folder.write("ball.json", R"({
    "materials": { "rock": { "density": 2000, "young": 20e6, "poisson": 0.2 } }, "gravity": [0, -9.81],
    "contact": { "normal_stiffness": 20e9 },
    "bodies": [
      { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-2,-1],[2,-1],[2,0],[-2,0]] },
      { "name": "ball", "material": "rock", "mesh": { "disc": { "radius": 0.2, "cells": 3, "centre": [0, 0.5] } } } ],
    "time": { "end": 1000, "safety": 0.8 } })");
  CHECK(run({"run", ball, "-o", folder / "ball", "--until", "0.495"}, folder).code == 0);
}

TEST_CASE("Ctrl-C finishes the step and closes the files", "[program]") {
  const Folder folder;
  const std::string file = folder.write("long.json", scene(R"({ "end": 10000 })"));
  const Result r = run({"run", file, "-o", folder / "long"}, folder,
                       {.interrupt_after = 0.5, .once_exists = folder / "long/history.csv"});
  CHECK(r.code == 130);
  const Json json = Json::parse(content(folder / "long/run.json"));
  CHECK(json["status"] == "interrupted");
  CHECK(json["steps"] > 0);
  CHECK(std::filesystem::exists(folder / "long/checkpoint.json"));
  CHECK(read_history(folder / "long/history.csv").columns[0].back() == json["time"]);
  CHECK(content(folder / "long/frames.pvd").ends_with("</VTKFile>\n"));
}

TEST_CASE("a run that is killed goes on from its last checkpoint, bit for bit", "[program]") {
  const Folder folder;
  const std::string file = folder.write("long.json", scene(R"({ "end": 0.6, "step": 2e-6 })"));
  const std::vector<std::string> often{"--set", "output.checkpoint.wall_clock=0.02"};
  std::vector<std::string> arguments{"run", file, "-o", folder / "parts"};
  arguments.insert(arguments.end(), often.begin(), often.end());
  const Result r = run(arguments, folder,
                       {.interrupt_after = 0.05,
                        .signal = SIGKILL,
                        .once_exists = folder / "parts/checkpoint.json"});
  REQUIRE(r.code == -SIGKILL);
  CHECK_FALSE(std::filesystem::exists(folder / "parts/run.json"));
  REQUIRE(run({"run", file, "-o", folder / "parts", "--resume"}, folder).code == 0);
  arguments[3] = folder / "whole";
  REQUIRE(run(arguments, folder).code == 0);
  for (const char* name : {"history.csv", "energy.csv", "momentum.csv", "frames.pvd"}) {
    INFO(name);
    CHECK((content(folder / (std::string("whole/") + name)) ==
           content(folder / (std::string("parts/") + name))));
  }
  CHECK(Json::parse(content(folder / "whole/run.json"))["final_state_hash"] ==
        Json::parse(content(folder / "parts/run.json"))["final_state_hash"]);
}

TEST_CASE("a run may begin with the last state of another one", "[program][slow]") {
  const Folder folder;
  const std::string file = folder.write("fall.json", scene(R"({ "end": 0.1 })"));
  REQUIRE(run({"run", file, "-o", folder / "one"}, folder).code == 0);
  const Result r = run({"run", file, "-o", folder / "two", "--from", folder / "one@0.1"}, folder);
  INFO(r.err);
  REQUIRE(r.code == 0);
  CHECK(r.out.find("began with 2 bodies of " + folder / "one" + " at t = 0.1 s") !=
        std::string::npos);
  const HistoryTable one = read_history(folder / "one/history.csv");
  const HistoryTable two = read_history(folder / "two/history.csv");
  CHECK(two.column("square.y")->front() == Approx(one.column("square.y")->back()).epsilon(1e-12));
  CHECK(two.column("square.vy")->front() == Approx(one.column("square.vy")->back()).epsilon(1e-12));
  for (const auto& [from, says] :
       {std::pair<const char*, const char*>{"one@0.05", "not supported yet"},
        {"one@soon", "--from: the time behind @"},
        {"none", "holds no state of a run"}}) {
    const Result bad = run({"run", file, "-o", folder / "bad", "--from", folder / from}, folder);
    INFO(bad.err);
    CHECK(bad.code == 2);
    CHECK(lines(bad.err) == 1);
    CHECK(bad.err.find(says) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "bad"));
  }
  // The same command again and again, until the run has ended.
  const std::vector<std::string> again{"run",      file,     "-o",           folder / "three",
                                       "--resume", "--from", folder / "one", "--until"};
  for (const char* until : {"0.05", "1", "1"}) {
    std::vector<std::string> command = again;
    command.emplace_back(until);
    CHECK(run(command, folder).code == 0);
  }
  CHECK((content(folder / "two/history.csv") == content(folder / "three/history.csv")));
  REQUIRE(run({"run", file, "-o", folder / "four", "--until", "0.05"}, folder).code == 0);
  const Result other =
      run({"run", file, "-o", folder / "four", "--resume", "--from", folder / "one"}, folder);
  CHECK(other.code == 2);
  CHECK(other.err.find("has not begun with that in") != std::string::npos);
}

TEST_CASE("a resumed run of elements with damping continues bit for bit", "[program]") {
  const Folder folder;
  const std::string file = folder.write("beam.json", R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2,
                             "damping": { "model": "rayleigh", "mass": 3, "stiffness": 1e-6 } } },
    "gravity": [0, -9.81],
    "bodies": [ { "name": "beam", "material": "rock", "spin": 1,
      "mesh": { "rectangle": { "size": [2, 0.5], "cells": [16, 4] } },
      "supports": [ { "where": { "x": 0 }, "velocity": [[0, 0, 0], [0.01, 1, 0.5]] } ],
      "loads": [ { "where": { "group": "top" }, "pressure": 1e6, "history": [[0, 0], [0.01, 1]] } ] } ],
    "time": { "end": 0.02 },
    "output": { "frames": 10, "history": { "interval": 1e-4, "track": [
      { "body": "beam" }, { "body": "beam", "point": [1.9, 0.3] } ] } } })");
  REQUIRE(run({"run", file, "-o", folder / "whole"}, folder).code == 0);
  REQUIRE(run({"run", file, "-o", folder / "parts", "--until", "0.0073"}, folder).code == 0);
  REQUIRE(run({"run", file, "-o", folder / "parts", "--resume", "--threads", "3"}, folder).code ==
          0);
  for (const char* name :
       {"history.csv", "energy.csv", "momentum.csv", "frames/bodies_000010.vtu"}) {
    INFO(name);
    CHECK((content(folder / (std::string("whole/") + name)) ==
           content(folder / (std::string("parts/") + name))));
  }
  const HistoryTable energy = read_history(folder / "whole/energy.csv");
  CHECK(std::abs(energy.column("total_error")->back()) < 1e-3 * energy.column("kinetic")->back());
  const HistoryTable momentum = read_history(folder / "whole/momentum.csv");
  CHECK(std::abs(momentum.column("py_error")->back()) <
        1e-9 * std::abs(momentum.column("py")->back()));
}

TEST_CASE("a resumed run of rubbing meshes continues bit for bit", "[program]") {
  const Folder folder;
  const std::string surface = GENERATE("body", "element");
  const std::string file = folder.write(
      "discs.json",
      R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
    "contact": { "surface": ")" +
          surface +
          R"(", "normal_stiffness": 20e9, "friction": { "coefficient": 0.3, "tangential_stiffness": 12e9 } },
    "bodies": [
      { "name": "one", "material": "rock", "velocity": [2, 0], "mesh": { "disc": { "radius": 0.5, "cells": 4 } } },
      { "name": "two", "material": "rock", "velocity": [-2, 0], "mesh": { "disc": { "radius": 0.5, "cells": 4, "centre": [0.943, 0.3] } } } ],
    "time": { "end": 1.5e-3 }, "output": { "frames": 5, "history": { "interval": 1e-5 } } })");
  REQUIRE(run({"run", file, "-o", folder / "whole"}, folder).code == 0);
  REQUIRE(run({"run", file, "-o", folder / "parts", "--until", "8e-4"}, folder).code == 0);
  const Json checkpoint = Json::parse(content(folder / "parts/checkpoint.json"));
  REQUIRE(checkpoint["simulation"]["term_1"]["contacts"]["friction"]["springs"].size() > 0);
  REQUIRE(run({"run", file, "-o", folder / "parts", "--resume", "--threads", "2"}, folder).code ==
          0);
  const HistoryTable history = read_history(folder / "whole/history.csv");
  const std::vector<double>& friction = *history.column("one.friction");
  CHECK(*std::max_element(friction.begin(), friction.end()) > 1e5);
  for (const char* name : {"history.csv", "energy.csv", "momentum.csv", "frames/bodies_000005.vtu",
                           "frames/surfaces_000005.vtu", "frames/contacts_000003.vtu"}) {
    INFO(surface << " " << name);
    CHECK((content(folder / (std::string("whole/") + name)) ==
           content(folder / (std::string("parts/") + name))));
  }
}

TEST_CASE("a body that folds onto itself stops with the place", "[program]") {
  const Folder folder;
  const std::string file = folder.write("tongs.json", R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
    "bodies": [ { "name": "tongs", "material": "rock",
      "mesh": { "fill": { "polygon": [[0,0],[1,0],[1,0.1],[0.1,0.1],[0.1,0.2],[1,0.2],[1,0.3],[0,0.3]], "size": 0.05 } },
      "supports": [ { "where": { "y": 0 }, "fix": ["x", "y"] },
                    { "where": { "box": [[0.9, 0.2], [1, 0.3]] }, "velocity": [[0, 0, -20]] } ] } ],
    "time": { "end": 0.02 }, "output": { "frames": 5, "history": { "interval": 1e-4 } } })");
  const Result r = run({"run", file, "-o", folder / "tongs"}, folder);
  INFO(r.err);
  CHECK(r.code == 3);
  CHECK(r.err.find("\"tongs\" folds onto itself at (") != std::string::npos);
  CHECK(r.err.find("say \"self_contact\": \"compute\"") != std::string::npos);
  CHECK(lines(r.err) == 1);
  CHECK(content(folder / "tongs/frames.pvd").find("bodies_000001.vtu") != std::string::npos);
}

TEST_CASE("bodies that begin outside of the world are counted", "[program][slow]") {
  const Folder folder;
  const auto run_with = [&](const std::string& box) {
    const std::string file = folder.write("world.json", R"({
      "materials": { "rock": { "density": 2000 } },
      "bodies": [ { "name": "a", "material": "rock", "polygon": [[0,0],[1,0],[0,1]] },
                  { "name": "b", "material": "rock", "polygon": [[4,0],[5,0],[4,1]] },
                  { "name": "wall", "material": "rock", "motion": "fixed", "polygon": [[8,0],[9,0],[8,1]] } ],
      "contact": { "normal_stiffness": 1e6 },
      "world": { "box": )" + box + R"(, "outside": "remove" },
      "time": { "end": 0.01, "step": 1e-4 } })");
    const Result r = run({"run", file, "-o", folder / "world", "--overwrite"}, folder);
    CHECK(r.code == 0);
    return r.err;
  };
  CHECK(run_with("[[-1,-1],[6,6]]").find("outside of the world") == std::string::npos);
  CHECK(run_with("[[-1,-1],[3,3]]").find("1 body begins outside of the world") !=
        std::string::npos);
  CHECK(run_with("[[6,6],[7,7]]").find("2 bodies begin outside of the world") != std::string::npos);
}

TEST_CASE("a run that fails where an inner corner has closed names the corner", "[program][slow]") {
  const Folder folder;
  const std::string file = folder.write("slit.json", R"({
    "materials": { "rubber": { "density": 1000, "young": 1e5, "poisson": 0.2, "law": "neo_hookean" }, "steel": { "density": 8000 } },
    "contact": { "normal_stiffness": 1e6, "self_contact": "compute" },
    "bodies": [
      { "name": "block", "material": "rubber",
        "mesh": { "fill": { "polygon": [[0,0],[1,0],[1,0.6],[0.7,0.6],[0.5,0.2],[0.3,0.6],[0,0.6]], "size": 0.1 }, "element": "T3" } },
      { "name": "left", "material": "steel", "motion": { "velocity": [[0, 1, 0]] }, "polygon": [[-0.2,-0.2],[-0.01,-0.2],[-0.01,0.8],[-0.2,0.8]] },
      { "name": "right", "material": "steel", "motion": { "velocity": [[0, -1, 0]] }, "polygon": [[1.01,-0.2],[1.2,-0.2],[1.2,0.8],[1.01,0.8]] } ],
    "time": { "end": 0.5 }, "output": { "frames": 10 } })");
  const Result r = run({"run", file, "-o", folder / "slit"}, folder);
  INFO(r.err);
  CHECK(r.code == 3);
  CHECK(r.err.find("turned inside out") != std::string::npos);
  CHECK(r.err.find("the inner corner at (") != std::string::npos);
  CHECK(r.err.find("give the corner two vertices") != std::string::npos);
}

TEST_CASE("a load too heavy for the material stops with the place", "[program]") {
  const Folder folder;
  const std::string file = folder.write("crushed.json", R"({
    "materials": { "soft": { "density": 1000, "young": 1e6, "poisson": 0.2 } },
    "bodies": [ { "name": "block", "material": "soft",
      "mesh": { "rectangle": { "size": [1, 1], "cells": [4, 4] } },
      "supports": [ { "where": { "y": 0 }, "fix": ["x", "y"] } ],
      "loads": [ { "where": { "group": "top" }, "pressure": 5e6 } ] } ],
    "time": { "end": 1 }, "output": { "history": { "interval": 1e-3 } } })");
  const Result r = run({"run", file, "-o", folder / "crushed"}, folder);
  CHECK(r.code == 3);
  CHECK(r.err.find("\"block\"") != std::string::npos);
  CHECK(r.err.find("St. Venant-Kirchhoff") != std::string::npos);
  CHECK(r.err.find("\"neo_hookean\"") != std::string::npos);
  CHECK(lines(r.err) == 1);
  CHECK(Json::parse(content(folder / "crushed/run.json"))["status"] == "unstable");
}

TEST_CASE("a resumed run continues bit for bit", "[program][slow]") {
  const Folder folder;
  const std::string file = test::kSource + "/data/scenes/two-body-collision.json";
  REQUIRE(run({"run", file, "-o", folder / "whole"}, folder).code == 0);
  // Stopped in the middle of the contact by --until, then by Ctrl-C if there is time for it.
  REQUIRE(run({"run", file, "-o", folder / "parts", "--until", "0.2501"}, folder).code == 0);
  const std::vector<double> times = read_history(folder / "parts/history.csv").columns[0];
  CHECK(times.back() == Approx(.2501));
  CHECK(std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) == times.end());
  const Result second =
      run({"run", file, "-o", folder / "parts", "--resume"}, folder, {.interrupt_after = 0.1});
  if (second.code != 0) {
    REQUIRE((second.code == 130 || second.code == -SIGINT));  // the latter if before its start
    REQUIRE(run({"run", file, "-o", folder / "parts", "--resume"}, folder).code == 0);
  }
  for (const char* name : {"history.csv", "energy.csv", "momentum.csv", "frames.pvd",
                           "frames/bodies_000050.vtu", "frames/contacts_000013.vtu"}) {
    INFO(name);
    CHECK((content(folder / (std::string("whole/") + name)) ==
           content(folder / (std::string("parts/") + name))));
  }
  CHECK(Json::parse(content(folder / "whole/run.json"))["final_state_hash"] ==
        Json::parse(content(folder / "parts/run.json"))["final_state_hash"]);
  // Resuming only to stop at once, inside a contact, changes nothing either.
  const std::string soft = folder.write("soft.json", scene(R"({ "end": 0.3, "step": 2e-5 })"));
  REQUIRE(run({"run", soft, "-o", folder / "soft", "--until", "0.1431"}, folder).code == 0);
  REQUIRE(run({"run", soft, "-o", folder / "soft", "--resume", "--until", "0.08"}, folder).code ==
          0);
  REQUIRE(run({"run", soft, "-o", folder / "soft", "--resume"}, folder).code == 0);
  REQUIRE(run({"run", soft, "-o", folder / "soft2"}, folder).code == 0);
  CHECK((content(folder / "soft/energy.csv") == content(folder / "soft2/energy.csv")));
  // A scene that starts settled, stopped while it slides.
  const std::string incline = test::kSource + "/data/scenes/incline-up-mu-06.json";
  REQUIRE(run({"run", incline, "-o", folder / "slide", "--until", "0.1"}, folder).code == 0);
  REQUIRE(run({"run", incline, "-o", folder / "slide2", "--until", "0.2"}, folder).code == 0);
  REQUIRE(
      run({"run", incline, "-o", folder / "slide", "--resume", "--until", "0.2"}, folder).code ==
      0);
  for (const char* name : {"history.csv", "energy.csv", "momentum.csv"}) {
    INFO(name);
    CHECK((content(folder / (std::string("slide/") + name)) ==
           content(folder / (std::string("slide2/") + name))));
  }
  // Nothing is left to do; and never from another scene's checkpoint.
  const std::string before = content(folder / "parts/run.json");
  CHECK(run({"run", file, "-o", folder / "parts", "--resume"}, folder).code == 0);
  CHECK(content(folder / "parts/run.json") == before);
  REQUIRE(run({"run", file, "-o", folder / "other", "--until", "0.01"}, folder).code == 0);
  CHECK(
      run({"run", kScene, "-o", folder / "other", "--resume"}, folder).err.find("another scene") !=
      std::string::npos);
}

TEST_CASE("a system that fails gives exit code 4 and keeps what was complete", "[program]") {
  const Folder folder;
  CHECK(run({"run", kScene, "-o", "/dev/null/out"}, folder).code == 4);
  const Result no_folder = run({"run", kScene, "-o", "/proc/out"}, folder);
  CHECK(no_folder.code == 4);
  CHECK(no_folder.err.find("choose a folder that can be made") != std::string::npos);
  // Files may not grow beyond 24 kB: the histories hit that after some frames.
  const Result r = run({"run", kScene, "-o", folder / "full"}, folder, {.file_size = 24 << 10});
  INFO(r.err);
  CHECK(r.code == 4);
  CHECK(r.err.find("cannot be written") != std::string::npos);
  const HistoryTable history = read_history(folder / "full/history.csv");
  CHECK(history.columns[0].size() > 10);
  const std::string pvd = content(folder / "full/frames.pvd");
  CHECK(pvd.ends_with("</VTKFile>\n"));
  for (size_t at = 0; (at = pvd.find("file=\"", at)) != std::string::npos;) {
    at += 6;
    const std::string frame = folder / ("full/" + pvd.substr(at, pvd.find('"', at) - at));
    CHECK(content(frame).ends_with("</VTKFile>\n"));
  }
}

TEST_CASE("until behind the end of the scene ends with the scene", "[program]") {
  const Folder folder;
  const std::string file =
      folder.write("short.json", scene(R"({ "end": 0.01 }, "output": { "frames": 5 })"));
  REQUIRE(run({"run", file, "-o", folder / "short", "--until", "5"}, folder).code == 0);
  CHECK(read_history(folder / "short/history.csv").columns[0].back() == .01);
  CHECK(content(folder / "short/frames.pvd").find("bodies_000006") == std::string::npos);
}

TEST_CASE("the same scene gives the same bits", "[program][slow]") {
  const Folder folder;
  std::vector<Json> results;
  for (const char* threads : {"1", "1", "2"}) {
    REQUIRE(run({"run", test::kSource + "/data/scenes/two-body-collision.json", "-o",
                 folder / "bits", "--overwrite", "--until", "0.3", "--threads", threads},
                folder)
                .code == 0);
    results.push_back(Json::parse(content(folder / "bits/run.json"))["final_state_hash"]);
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}

TEST_CASE("contact of two polygon files", "[program]") {
  const Folder folder;
  const std::string c = folder.write("c.wkt", "POLYGON((0 0.25, 0.5 1, -0.5 1, 0 0.25))");
  const std::string t = folder.write("t.json", R"({"polygon": [[-2,-1],[2,-1],[2,0.5],[-2,0.5]]})");
  const Result r =
      run({"contact", c, t, "--method", "all", "--stiffness", "2e9", "--json"}, folder);
  REQUIRE(r.code == 0);
  const Json json = Json::parse(r.out);
  CHECK(json["normal_stiffness"] == 2e9);
  REQUIRE(json["results"].size() == 3);
  // Apex on flat: depth d = 1/4, tan a = 2/3.
  const double d = .25, tan_a = 2.0 / 3, sin_a = 2 / std::sqrt(13.0);
  const double rc = .75 / (1 + 2 * std::sqrt(.25 + .5625)), rt = .75;
  const double force = 2e9 * d * d * tan_a * (1 / rt + sin_a / rc);
  for (const Json& result : json["results"]) {
    INFO(result["method"]);
    CHECK(result["force"][1].get<double>() == Approx(force).epsilon(1e-13));
    CHECK(result["energy"].get<double>() == Approx(force * d / 3).epsilon(1e-13));
    CHECK(result["overlap_area"].get<double>() == Approx(d * d * tan_a).epsilon(1e-14));
    CHECK(result["loading_point"][0].get<double>() == Approx(0).margin(1e-15));
    for (const char* key : {"moment_a", "moment_b", "own_length_a", "own_length_b", "seconds"})
      CHECK(result.contains(key));
  }
  const Result bad =
      run({"contact", c, folder.write("bad.json", "[[0,0],[1,1],[1,0],[0,1]]")}, folder);
  CHECK(bad.code == 2);
  CHECK(bad.err.find("bad.json") != std::string::npos);
}

TEST_CASE("contact by either field", "[program]") {
  Folder folder;
  const std::string l = folder.write("l.json", "[[0,0],[2,0],[2,1],[1,1],[1,2],[0,2]]");
  const std::string c = folder.write("c.json", "[[0.8,0.8],[3,0.9],[3,3],[0.9,3]]");
  std::vector<double> forces;
  for (const char* field : {"roof", "distance"}) {
    const Result r =
        run({"contact", l, c, "--field", field, "--reference", "0.5", "--method", "all", "--json"},
            folder);
    REQUIRE(r.code == 0);
    const Json results = Json::parse(r.out)["results"];
    forces.push_back(results[0]["force"][0]);
    CHECK(results[2]["force"][0].get<double>() == Approx(forces.back()).epsilon(1e-13));
    CHECK(results[2]["energy"].get<double>() ==
          Approx(results[0]["energy"].get<double>()).epsilon(1e-13));
  }
  CHECK(std::abs(forces[0] - forces[1]) > 1e-3);
  const Result area = run({"contact", l, c, "--potential", "area", "--field", "distance"}, folder);
  CHECK(area.code == 2);
  CHECK(area.err.find("one field only") != std::string::npos);
}

TEST_CASE("contact of many pairs goes on after a refusal", "[program]") {
  const Folder folder;
  const std::string file =
      folder.write("pairs.txt",
                   "good#1 3 0 0 1 0 0 1 3 0.2 0.2 1 1 0 1\n"
                   "bow#2 4 0 0 1 1 1 0 0 1 3 0 0 1 0 0 1\n"
                   "short#3 3 0 0 1 0\n"
                   "nan#4 3 0 0 1 0 0 nan 3 0 0 1 0 0 1\n"
                   "good#5 3 0 0 1 0 0 1 3 5 5 6 5 5 6\n"
                   "ring#6 POLYGON((0 0,3 0,3 3,0 3),(1 1,2 1,2 2,1 2)) "
                   "POLYGON((.5 .5,2.5 .5,2.5 2.5,.5 2.5))\n"
                   "bad#7 3 0 0 1 0 0 1 POLYGON((0 0,3 0,3 3),(5 5,6 5,6 6))\n");
  const Result r = run({"contact", "--batch", file, "--method", "all"}, folder);
  CHECK(r.code == 2);
  std::istringstream text(r.out);
  std::vector<Json> objects;
  for (std::string line; std::getline(text, line);) objects.push_back(Json::parse(line));
  REQUIRE(objects.size() == 7);
  CHECK(objects[0]["results"].size() == 3);
  CHECK(objects[1]["error"].get<std::string>().find("cross") != std::string::npos);
  CHECK(objects[1]["vertex"] == 2);
  CHECK(objects[2].contains("error"));
  CHECK(objects[3]["vertex"] == 2);
  CHECK(objects[4]["results"][0]["force"][0] == 0);
  for (const Json& result : objects[5]["results"]) {
    CHECK(result["overlap_area"].get<double>() == Approx(3));
  }
  CHECK(objects[6]["polygon"] == "b");
  CHECK(objects[6]["hole"] == 0);
  CHECK(objects[6]["line"] == 7);
}

TEST_CASE("the ending of a file of cells decides its format", "[program]") {
  const Folder folder;
  const std::string region =
      folder.write("r.wkt", "POLYGON ((0 0, 3 0, 3 2, 0 2), (1 .5, 2 .5, 1 1))");
  const auto cells = [&](const std::string& file) {
    return run({"mesh", region, "--voronoi", "8", "-o", folder / file}, folder);
  };
  REQUIRE(cells("c.json").code == 0);
  const size_t count = Json::parse(content(folder / "c.json"))["cells"].size();
  REQUIRE(cells("c.geojson").code == 0);
  const Json features = Json::parse(content(folder / "c.geojson"))["features"];
  REQUIRE(features.size() == count);
  CHECK(features[1]["properties"]["cell"] == 1);
  REQUIRE(cells("c.wkt").code == 0);
  CHECK(content(folder / "c.wkt").starts_with("MULTIPOLYGON"));
  REQUIRE(cells("c.svg").code == 0);
  CHECK(content(folder / "c.svg").find("<svg") != std::string::npos);
  REQUIRE(cells("c.VTU").code == 0);
  CHECK(content(folder / "c.VTU").find("VTKFile") != std::string::npos);
  REQUIRE(run({"mesh", test::kSource + "/data/meshes/mixed.msh", "-o", folder / "m.wkt"}, folder)
              .code == 0);
  CHECK(content(folder / "m.wkt").starts_with("MULTIPOLYGON"));
  const Result wrong = cells("c.vtk");
  CHECK(wrong.code == 2);
  CHECK(wrong.err.find("-o: must end in .json, .wkt, .geojson, .svg or .vtu") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "c.vtk"));
  CHECK(run({"mesh", region, "--voronoi", "8", "--vtk", folder / "c.json"}, folder).code == 2);
}

TEST_CASE("a mesh of gmsh's, described", "[program]") {
  const Folder folder;
  const std::string file = test::kSource + "/data/meshes/mixed.msh";
  const Result plain = run({"mesh", file}, folder);
  REQUIRE(plain.code == 0);
  CHECK(plain.out.find("2 triangles, 2 quadrilaterals, 8 nodes") != std::string::npos);
  CHECK(plain.out.find("left: 2 nodes, 1 edges") != std::string::npos);
  const Result json =
      run({"mesh", file, "--json", "-o", folder / "m.json", "--vtk", folder / "m.vtu"}, folder);
  REQUIRE(json.code == 0);
  const Json description = Json::parse(json.out);
  CHECK(description["area"] == 3);
  CHECK(description["areas"] == Json{.5, 1});
  CHECK(description["holes"] == 0);
  CHECK(description["angles"][1] == Approx(std::acos(-1.) / 2));
  CHECK(description["groups"][1] ==
        Json{{"name", "left"}, {"nodes", 2}, {"edges", 1}, {"elements", 0}});
  const Json mesh = Json::parse(content(folder / "m.json"));
  CHECK(mesh["points"][7] == Json{3, 1});
  CHECK(mesh["cells"][2] == Json{2, 3, 6});
  CHECK(mesh["groups"][2]["nodes"] == Json{0, 1, 2, 4, 5, 6});
  CHECK(content(folder / "m.vtu").find("VTKFile") != std::string::npos);
}

TEST_CASE("a mesh of a region", "[program]") {
  const Folder folder;
  // An L far from the origin: shifted by an exact 2^20 m.
  const std::string region = folder.write(
      "L.json", "[[1048576,0.1],[1048579,0.1],[1048579,1],[1048577,1],[1048577,3],[1048576,3]]");
  const std::vector<std::string> mesh{"mesh", region, "--voronoi", "30", "--seed", "5"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), mesh.begin(), mesh.end());
    return run(more, folder);
  };
  const Result printed = with({});
  REQUIRE(printed.code == 0);
  CHECK(lines(printed.err) == 8);
  CHECK(printed.err.find("\nangles       ") != std::string::npos);
  CHECK(printed.err.find("; smallest of the region 90 degrees\n") != std::string::npos);
  CHECK(printed.err.find("\nedge/apothem ") != std::string::npos);
  CHECK(printed.err.find(" of 30 cells\n") != std::string::npos);
  const Result written = with({"-o", folder / "m.json", "--vtk", folder / "m.vtu"});
  REQUIRE(written.code == 0);
  CHECK(written.out == printed.err);  // the summary
  CHECK(written.err.empty());
  CHECK((content(folder / "m.json") == printed.out));

  const Json json = Json::parse(printed.out);
  CHECK(json["region"] == Json::parse(content(region)));
  REQUIRE(json["cells"].size() == 30);
  PolygonMesh read;
  for (const Json& p : json["points"]) read.points.emplace_back(p[0], p[1]);
  for (const Json& cell : json["cells"]) read.cells.push_back(cell);
  for (size_t i = 0; i < 6; ++i) CHECK(json["points"][i] == json["region"][i]);
  CHECK_NOTHROW(tiling_boundary(read));
  // The numbers are those of the library, to the last bit.
  std::vector<Vec2> ring;
  for (const Json& p : json["region"]) ring.emplace_back(p[0], p[1]);
  const VoronoiMesh voronoi = voronoi_mesh(Polygon(ring), {.cells = 30, .seed = 5});
  CHECK(read.points == in_world(Polygon(ring), voronoi.mesh).points);
  CHECK(read.cells == voronoi.mesh.cells);

  const std::string drilled = folder.write(
      "drilled.wkt", "POLYGON ((0 0, 9 0, 9 4, 0 4), (1 1, 2 1, 1 3), (6 1, 8 2, 6 2))");
  const Result around =
      run({"mesh", drilled, "--voronoi", "3", "--convex", "--smallest-angle", "0.3"}, folder);
  REQUIRE(around.code == 0);
  CHECK(around.err.find("\nnot convex   0 of ") != std::string::npos);
  CHECK(around.err.find("\ncuts         ") != std::string::npos);
  const Json holed = Json::parse(around.out);
  CHECK(holed["holes"].size() == 2);
  CHECK(holed["points"][4] == holed["holes"][0][0]);
  PolygonMesh cells{{}, holed["cells"]};
  for (const Json& p : holed["points"]) cells.points.emplace_back(p[0], p[1]);
  CHECK(tiling_boundary(cells, 2).size() == 3);

  const std::string bow = folder.write("bow.json", "[[0,0],[1,1],[1,0],[0,1]]");
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"mesh", region},
        {"mesh", "--voronoi", "5"},
        {"mesh", region, "--voronoi", "0"},
        {"mesh", region, "--voronoi", "2.5"},
        {"mesh", region, "--voronoi", "5", "--seed", "-1"},
        {"mesh", region, "--voronoi", "5", "--lloyd", "-1"},
        {"mesh", region, "--voronoi", "5", "--shortest-edge", "0.6"},
        {"mesh", region, "--voronoi", "5", "--shortest-edge", "nan"},
        {"mesh", region, "--voronoi", "5", "--smallest-angle", "1.1"},
        {"mesh", region, "--convex"},
        {"mesh", region, "--voronoi", "5", "-o", folder / "x", "--vtk", folder / "x"},
        {"mesh", bow, "--voronoi", "5", "-o", folder / "x"},
        {"mesh", region, "--voronoi", "5", "--json"},
        {"mesh", test::kSource + "/data/meshes/mixed.msh", "--voronoi", "5"},
        {"mesh", test::kSource + "/data/meshes/mixed.msh", "--seed", "5"},
        {"mesh", folder / "missing.msh", "-o", folder / "x"},
        {"mesh", folder / "missing.json", "--voronoi", "5"}}) {
    const Result r = run(wrong, folder);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(lines(r.err) == 1);
    CHECK((r.out.empty() || Json::parse(r.out).contains("error")));
  }
  CHECK_FALSE(std::filesystem::exists(folder / "x"));
  for (const char* option : {"-o", "--vtk"}) {
    const Result r = with({option, "/proc/none/m.vtu"});
    CHECK(r.code == 4);
    CHECK(r.out.empty());
  }
}
