// Scenes for the tests of runs: short, and in the middle of friction when they are stopped.
#pragma once

#include <string>

#include "lib/output/checksum.hpp"
#include "lib/run/run.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

namespace apothem::test {

/// One free block of 1 m x 1 m and 2000 kg, its mass centre at (0.5, 0.5).
inline std::string flying_block(const std::string& body = "", const std::string& rest = "") {
  return R"({ "materials": { "rock": { "density": 2000 } },
    "bodies": [ { "name": "block", "material": "rock",
                  "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]])" +
         body + R"( } ],
    "time": { "end": 0.5, "step": 1e-3 }, "output": { "frames": 5, "history": { "interval": 0.01 } })" +
         rest + " }";
}

/// The text of a JSON object with its checksum, as a state is written.
inline std::string sealed(std::string object) {
  object.resize(object.rfind('}'));
  Checksum checksum;
  checksum.add(object);
  return object + ",\"checksum\":\"" + checksum.text() + "\"}\n";
}

inline Scene scene_of(const Folder& folder, const std::string& text) {
  return read_scene(folder.write("scene.json", text));
}

struct NamedScene {
  const char* name;
  std::string text;
  double stop;                     ///< s
  bool sticks;                     ///< then; or it slides
  std::vector<const char*> needs;  ///< words of terms that it has
};

/// Rigid bodies on a slope along x: gravity is tilted. They begin 0.1 um deep in each other, about
/// as deep as at rest, and stay in contact. `friction`: of the scene's contact.
inline std::string slope(const std::string& friction, const std::string& block,
                         const std::string& more = "") {
  return R"({ "gravity": [-0.3, -9.5], "materials": { "rock": { "density": 2500 } },
    "contact": { "normal_stiffness": 2e9, "friction": )" +
         friction + more + R"( },
    "bodies": [
      { "name": "slope", "material": "rock", "motion": "fixed", "polygon": [[-5, -1], [5, -1], [5, 1e-7], [-5, 1e-7]] },
      { "name": "block", "material": "rock", )" +
         block + R"( } ],
    "time": { "end": 0.02 }, "output": { "frames": 4, "history": { "interval": 1e-3 } } })";
}

/// Scenes that are stopped while friction acts.
inline std::vector<NamedScene> rubbing_scenes() {
  const std::string rough = R"({ "coefficient": 0.6, "tangential_stiffness": 1e9 })";
  const std::string per_edge =
      R"({ "coefficient": 0.6, "tangential_stiffness": 1e9, "law": "per_edge" })";
  const std::string block = R"("polygon": [[-0.25, 0], [0.25, 0], [0.25, 0.125], [-0.25, 0.125]])";
  const std::string feet =
      R"("polygon": [[-0.25, 0], [-0.15, 0], [-0.15, 0.05], [0.15, 0.05], [0.15, 0], [0.25, 0], [0.25, 0.125], [-0.25, 0.125]])";
  const std::string fast = R"(, "velocity": [1, 0])";
  const std::string damped = R"(, "damping": { "model": "normal_viscous", "ratio": 0.2 })";
  const auto discs = [](const char* surface, const char* third) {
    return std::string(R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
    "contact": { "surface": ")") +
           surface + R"(", "normal_stiffness": 20e9,
                 "friction": { "coefficient": 0.3, "tangential_stiffness": 12e9 } },
    "bodies": [
      { "name": "one", "material": "rock", "velocity": [2, 0], "mesh": { "disc": { "radius": 0.5, "cells": 4 } } },
      { "name": "two", "material": "rock", "velocity": [-2, 0], "mesh": { "disc": { "radius": 0.5, "cells": 4, "centre": [0.943, 0.3] } } })" +
           third + R"( ],
    "time": { "end": 1.2e-3 }, "output": { "frames": 4, "history": { "interval": 1e-5 } } })";
  };
  // A wedge that falls onto both discs, and a wall that stands.
  const char* wedge = R"(,
      { "name": "wall", "material": "rock", "motion": "fixed", "polygon": [[-2, -2], [3, -2], [3, -1], [-2, -1]] },
      { "name": "wedge", "material": "rock", "velocity": [1, -3], "polygon": [[0.1, 0.49], [0.6, 1], [-0.4, 1]] })";
  std::string growing = slope(rough, block);
  const std::string constant = R"("gravity": [-0.3, -9.5])";
  growing.replace(growing.find(constant), constant.size(),
                  R"("gravity": { "value": [-0.3, -9.5], "history": [[0, 1], [0.02, 3]] })");
  return {
      {"a block that sticks", slope(rough, block), .013, true, {}},
      {"a block that slides", slope(rough, block + fast), .013, false, {}},
      {"a body on two feet that sticks", slope(rough, feet), .013, true, {}},
      {"a body on two feet that slides", slope(rough, feet + fast), .013, false, {}},
      {"per edge, sticking", slope(per_edge, block), .013, true, {}},
      {"per edge, sliding", slope(per_edge, feet + fast), .013, false, {}},
      {"damped, sticking", slope(rough, block, damped), .013, true, {"viscous"}},
      {"damped, on two feet", slope(rough, feet + fast, damped), .013, false, {"viscous"}},
      {"gravity that grows", growing, .013, true, {"gravity that follows a history"}},
      {"meshes that rub", discs("body", ""), 8e-4, false, {"finite elements", "boundaries"}},
      {"meshes that rub by their elements", discs("element", ""), 8e-4, false, {"finite elements"}},
      {"meshes and rigid bodies", discs("body", wedge), 8e-4, false, {"finite elements"}},
      {"elements and rigid bodies", discs("element", wedge), 8e-4, false, {"finite elements"}},
  };
}

/// A block that sticks to a slope, which begins to turn about its end.
inline NamedScene turning_slope() {
  std::string text = slope(R"({ "coefficient": 0.6, "tangential_stiffness": 1e9 })",
                           R"("polygon": [[-0.25, 0], [0.25, 0], [0.25, 0.125], [-0.25, 0.125]])");
  const std::string still = R"("motion": "fixed")";
  text.replace(text.find(still), still.size(),
               R"("motion": { "spin": [[0, 0], [0.02, 0.01]], "pivot": [-5, 0] })");
  return {"a block on a slope that turns about its end", text, .013, true, {}};
}

/// Two blocks of meshes, pressed on each other in so many load steps.
inline std::string pressed_blocks(int load_steps) {
  return R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2, "plane": "strain" } },
    "contact": { "normal_stiffness": 200e9 },
    "bodies": [
      { "name": "lower", "material": "rock",
        "mesh": { "rectangle": { "size": [1, 0.5], "cells": [4, 2] } },
        "supports": [ { "where": { "y": 0 }, "fix": ["y"] }, { "where": { "nearest": [0.5, 0] }, "fix": ["x"] } ] },
      { "name": "upper", "material": "rock",
        "mesh": { "rectangle": { "size": [1, 0.5], "cells": [5, 2], "origin": [0, 0.5] } },
        "supports": [ { "where": { "nearest": [0.5, 1] }, "fix": ["x"] } ],
        "loads": [ { "where": { "group": "top" }, "traction": [0, -20e6], "history": [[0, 0], [1, 1]] } ] } ],
    "time": { "end": 1, "mode": "static", "load_steps": )" +
         std::to_string(load_steps) + R"( },
    "output": { "history": { "track": [ { "body": "upper" } ] } } })";
}

/// A meshed block on a rigid floor, pressed until time 1 and then pulled at its right side by so
/// many m in a time of 1. `time`: of the scene.
inline std::string pulled_block(const std::string& pull, const std::string& history,
                                const std::string& time) {
  return R"({
    "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2, "plane": "strain" } },
    "contact": { "normal_stiffness": 200e9,
                 "friction": { "coefficient": 0.5, "tangential_stiffness": 20e9 } },
    "bodies": [
      { "name": "floor", "material": "rock", "motion": "fixed",
        "polygon": [[-2, -1], [3, -1], [3, 0], [-2, 0]] },
      { "name": "block", "material": "rock",
        "mesh": { "rectangle": { "size": [1, 0.5], "cells": [8, 4] } },
        "supports": [ { "where": { "x": 1 }, "fix": ["x"])" +
         pull + R"( } ],
        "loads": [ { "where": { "group": "top" }, "force": [0, -1e7])" +
         history + R"( } ] } ],
    "time": )" +
         time + R"(,
    "output": { "history": { "track": [ { "body": "block" } ] } } })";
}

}  // namespace apothem::test
