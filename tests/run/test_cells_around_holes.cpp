// A body of Voronoi cells around holes, with another body in one of them.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "lib/mesh/boundary.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("a ring of Voronoi cells falls on a floor and hits the block in it", "[run][holes]") {
  const Folder folder;
  Scene scene = scene_of(folder, R"({ "gravity": [0, -9.81],
    "materials": { "m": { "density": 2000, "young": 1e8, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e8, "reference": 0.02, "penetration_warning": 10 },
    "bodies": [
      { "name": "floor", "material": "m", "motion": "fixed",
        "polygon": [[-1, -0.3], [2, -0.3], [2, 0], [-1, 0]] },
      { "name": "ring", "material": "m", "velocity": [0, -1],
        "mesh": { "voronoi": { "polygon": [[0, 0.001], [1, 0.001], [1, 1], [0, 1]],
                               "holes": [ [[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]],
                                          [[0.1, 0.1], [0.15, 0.1], [0.1, 0.2]] ],
                               "cells": 40, "smallest_angle": 0.6 } } },
      { "name": "block", "material": "m", "velocity": [0, -2],
        "polygon": [[0.4, 0.302], [0.6, 0.302], [0.6, 0.5], [0.4, 0.5]] } ],
    "time": { "end": 0.02, "safety": 0.2 }, "output": { "frames": 1 } })");
  REQUIRE(scene.model.deformables.size() == 1);
  CHECK(boundary(scene.model.deformables[0].mesh).loops.size() == 3);
  Run run(std::move(scene), {.folder = folder / "out"});
  REQUIRE(run.run() == Run::Status::done);
  const nlohmann::json summary = nlohmann::json::parse(content(folder / "out/run.json"));
  CHECK(summary["largest_contact_force"] > 1e4);
  CHECK(summary["largest_energy_error"] < 1e-2 * summary["energy_in_play"].get<double>());
}
