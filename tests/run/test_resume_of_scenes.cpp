// Shipped scenes that are stopped at random steps, and go on with another number of threads, write
// the same files byte by byte.
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "lib/dynamics/islands.hpp"
#include "lib/run/run.hpp"
#include "tests/dynamics/term_of.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace {

struct Cut {
  std::string scene;
  int steps;  // of the run; a static one has all its load steps
  int stops;  // at which it is stopped and goes on, each in a run of its own
};

// Every kernel, with friction and with damping: polygons, the elements of meshes, their outlines,
// and outlines with polygons.
const std::vector<Cut> kShort{{"arch-falls", 300, 2},         {"bar-on-bar-damped", 400, 2},
                              {"bounce-flat-30", 3000, 1},    {"corner-impact-elements", 300, 2},
                              {"crosses-collide", 3000, 1},   {"drum", 300, 2},
                              {"cantilever-voronoi", 300, 1}, {"meshed-incline", 1200, 6},
                              {"oblique-discs", 600, 2},      {"oblique-discs-elements", 600, 2},
                              {"pressed-blocks", 0, 1},       {"rotor-in-ring", 3000, 1},
                              {"slope-fails-meshed", 200, 2}, {"stack", 300, 1}};

std::string text_of(const std::string& file) {
  std::string text = content(file);
  if (!file.ends_with("/run.json")) return text;
  Json json = Json::parse(text);
  for (const char* of_the_clock : {"wall_time", "processor_time", "steps_per_second", "threads"}) {
    json.erase(of_the_clock);
  }
  return json.dump();
}

std::map<std::string, std::string> files_of(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string file = entry.path().string();
    if (file.ends_with("/checkpoint.previous.json")) continue;  // of runs that were stopped alone
    if (entry.is_regular_file()) files[file.substr(folder.size())] = text_of(file);
  }
  return files;
}

// The run up to `end`, in one piece and stopped at random times before that. `first_end`: how long
// a run is with whose state it begins, s; 0: none.
void check_resumed(const Scene& scene, double end, int stops, std::mt19937& random,
                   double first_end = 0) {
  const Folder folder;
  const std::string from = first_end > 0 ? folder / "first" : "";
  if (first_end > 0) {
    REQUIRE(Run(scene, {.folder = from}).run(first_end) == Run::Status::done);
  }
  {
    Run whole(scene, {.folder = folder / "whole", .from = from});
    REQUIRE(whole.run(end) == Run::Status::done);
  }
  const std::map<std::string, std::string> expected = files_of(folder / "whole");
  REQUIRE(expected.contains("/energy.csv"));
  for (int i = 0; i < stops; ++i) {
    const double stop = std::uniform_real_distribution(.02, .98)(random) * end;
    CAPTURE(stop, end);
    std::filesystem::remove_all(folder / "parts");
    {
      Run first(scene, {.folder = folder / "parts", .threads = 1 + i % 2, .from = from});
      REQUIRE(first.run(stop) == Run::Status::done);
    }
    {
      Run second(scene, {.folder = folder / "parts", .threads = 2 - i % 2, .resume = true});
      REQUIRE(second.run(end) == Run::Status::done);
    }
    const std::map<std::string, std::string> found = files_of(folder / "parts");
    REQUIRE(found.size() == expected.size());
    for (const auto& [name, text] : expected) {
      INFO(name);
      CHECK((found.at(name) == text));
    }
  }
}

double end_of(const Scene& scene, int steps) {
  if (scene.time.statics) return scene.time.end;
  const Run run(scene, {});
  return std::min(scene.time.end, steps * run.simulation().step_size());
}

// A disc of elements rolls and jumps on a rigid floor, and dashpots raise the limit of friction.
const char* const kMeshOnFloor = R"({ "gravity": [0, -9.81],
  "materials": { "m": { "density": 2500 },
                 "e": { "density": 1500, "young": 2e6, "poisson": 0.3 } },
  "contact": { "surface": "SURFACE", "normal_stiffness": 1e8, "friction": { "coefficient": 0.5 },
               "damping": { "model": "viscous", "ratio": 0.2 } },
  "bodies": [
    { "name": "f", "material": "m", "motion": "fixed", "polygon": [[-3, -1], [3, -1], [3, 0], [-3, 0]] },
    { "name": "soft", "material": "e", "velocity": [1, 0],
      "mesh": { "disc": { "radius": 0.3, "centre": [0, 0.301], "cells": 4 } } } ],
  "time": { "end": 0.15 },
  "output": { "frames": 3, "history": { "interval": 0.002 } } })";

// Columns with dashpots come to rest while a block flies, which then falls on one of them.
const char* const kRestAndFlight = R"({ "gravity": [0, -9.81],
  "materials": { "m": { "density": 2000 } },
  "contact": { "normal_stiffness": 1e8, "friction": { "coefficient": 0.5 },
               "damping": { "model": "viscous", "ratio": 0.3 } },
  "bodies": [
    { "name": "floor", "material": "m", "motion": "fixed", "polygon": [[-3, -1], [9, -1], [9, 0], [-3, 0]] },
    { "name": "a", "material": "m", "polygon": [[0, 0.001], [1, 0.001], [1, 0.6], [0, 0.6]] },
    { "name": "b", "material": "m", "polygon": [[0.1, 0.601], [0.9, 0.601], [0.9, 1.1], [0.1, 1.1]] },
    { "name": "c", "material": "m",
      "polygon": [[3, 0.001], [3.3, 0.001], [3.3, 0.2], [3.7, 0.2], [3.7, 0.001], [4, 0.001], [4, 0.6], [3, 0.6]] },
    { "name": "d", "material": "m", "polygon": [[3.1, 0.601], [3.9, 0.601], [3.9, 1.1], [3.1, 1.1]] },
    { "name": "flies", "material": "m", "velocity": [0.2, 4], "spin": 1,
      "polygon": [[3.1, 1.3], [3.4, 1.3], [3.5, 1.6], [3.2, 1.7]] } ],
  "time": { "end": 1.2, "scheme": "auto" },
  "output": { "frames": 6, "history": { "interval": 0.01 } } })";

}  // namespace

TEST_CASE("shipped scenes that are stopped write the same files to the last byte",
          "[resume][slow]") {
  std::mt19937 random(40);
  std::vector<Cut> cuts = kShort;
  if (long_run()) {
    cuts.clear();
    for (const auto& entry : std::filesystem::directory_iterator(kSource + "/data/scenes")) {
      cuts.push_back({entry.path().stem().string(), 6000, 6});
    }
  }
  for (const Cut& cut : cuts) {
    INFO(cut.scene);
    const Scene scene = read_scene(kSource + "/data/scenes/" + cut.scene + ".json");
    check_resumed(scene, end_of(scene, scaled(cut.steps)), cut.stops, random);
  }
}

TEST_CASE("a damped mesh on a rigid floor goes on with equal balances of energy", "[resume]") {
  std::mt19937 random(8);
  for (const std::string surface : {"body", "element"}) {
    INFO(surface);
    std::string text = kMeshOnFloor;
    text.replace(text.find("SURFACE"), 7, surface);
    const Scene scene = read_scene_text(text, "scene.json", {});
    check_resumed(scene, scene.time.end / (kSanitized ? 10 : 1), long_run() ? 40 : 5, random);
  }
  std::string text = kMeshOnFloor;
  text.replace(text.find("SURFACE"), 7, "body");
  const Scene scene = read_scene_text(text, "scene.json", {});
  check_resumed(scene, scene.time.end / 2, 2, random, scene.time.end / 2);
}

TEST_CASE("runs with implicit steps that are stopped write the same files to the last byte",
          "[resume]") {
  std::mt19937 random(41);
  struct Case {
    const char* scene;
    TimeScheme scheme;
    double end;  // s
  };
  for (const auto& [name, scheme, end] :
       {Case{"stack", TimeScheme::automatic, .6}, Case{"arch-stands", TimeScheme::automatic, 1},
        Case{"incline-up-mu-06", TimeScheme::automatic, 1},
        Case{"incline-down-mu-04", TimeScheme::implicit, .5},
        Case{"slope-stands-meshed", TimeScheme::automatic, .4}}) {
    INFO(name);
    Scene scene = read_scene(kSource + "/data/scenes/" + name + ".json");
    scene.time.scheme = scheme;
    check_resumed(scene, end / (kSanitized ? 10 : 1), long_run() ? 20 : 3, random);
  }
}

TEST_CASE("a run in which some bodies rest and are woken writes the same files when it is stopped",
          "[resume][islands]") {
  std::mt19937 random(42);
  const Scene scene = read_scene_text(kRestAndFlight, "scene.json", {});
  const Folder folder;
  Run run(scene, {.folder = folder / "run"});
  run.run(scene.time.end);
  CHECK(run.simulation().islands()->stopped() >= 4);
  CHECK(run.simulation().islands()->woken() == 2);
  {
    // Another run begins with the friction of those that rest as well.
    Run first(scene, {.folder = folder / "first"});
    REQUIRE(first.run(.7) == Run::Status::done);
    REQUIRE(first.simulation().islands()->count() == 4);
    const Run second(scene, {.folder = folder / "second", .from = folder / "first"});
    const std::vector<Spring> before = springs(first.simulation());
    const std::vector<Spring> after = springs(second.simulation());
    REQUIRE(after.size() == before.size());
    for (size_t i = 0; i < after.size(); ++i) {
      CHECK(after[i].force == Approx(before[i].force).margin(1e-6));
    }
  }
  check_resumed(scene, scene.time.end, long_run() ? 20 : 4, random);
}
