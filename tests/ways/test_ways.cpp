// One situation said in many ways gives one result. A table of ways times a table of scenes: a new
// way, or a new scene, is one entry. Each way says how much its results may differ: not in one bit
// where the program does the same sums, by round-off where numbers are others.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lib/output/run_folder.hpp"
#include "lib/run/run.hpp"
#include "tests/folder.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace ways {
namespace {

struct Motion {
  double x, y, angle, vx, vy, spin;  // angle: by which it has turned
};

struct Outcome {
  std::map<std::string, Motion> bodies;     // at the end
  std::map<std::string, double> energies;   // likewise, J
  double force = 0, depth = 0, energy = 0;  // largest of the run, N and m; energy in play, J
  double time = 0;                          // of the end, s
};

struct NamedText {
  const char* name;
  std::string text;
};

// All bodies have their polygons and meshes about their own mass centres, so that a way moves them
// by "position" and "angle" alone.
std::vector<NamedText> scenes() {
  const std::string materials =
      R"("materials": { "rock": { "density": 2000, "young": 2e8, "poisson": 0.2 } }, "gravity": [0, -9.81])";
  const std::string floor =
      R"({ "name": "floor", "material": "rock", "motion": "fixed", "position": [0, -0.5],
           "polygon": [[-3, -0.5], [3, -0.5], [3, 0.5], [-3, 0.5]] })";
  const std::string meshed_floor =
      R"({ "name": "floor", "material": "rock", "position": [0, -0.15],
           "mesh": { "rectangle": { "size": [3, 0.3], "cells": [12, 2] } },
           "supports": [ { "where": { "group": "bottom" }, "fix": ["x", "y"] } ] })";
  const std::string block =
      R"({ "name": "block", "material": "rock", "position": [-0.3, 0.2501], "velocity": [0.7, -0.6], "spin": 0.4,
           "polygon": [[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]], "angle": 0.2 })";
  const std::string cross =
      R"({ "name": "cross", "material": "rock", "position": [0.5, 0.37], "velocity": [-0.3, -0.8], "spin": -1, "angle": 0.1,
           "polygon": [[-0.1, -0.1], [-0.1, -0.3], [0.1, -0.3], [0.1, -0.1], [0.3, -0.1], [0.3, 0.1],
                       [0.1, 0.1], [0.1, 0.3], [-0.1, 0.3], [-0.1, 0.1], [-0.3, 0.1], [-0.3, -0.1]] })";
  const std::string cube =
      R"({ "name": "cube", "material": "rock", "position": [-0.3, 0.1999], "velocity": [0.5, 0],
           "polygon": [[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]] })";
  const std::string soft =
      R"({ "name": "soft", "material": "rock", "position": [0.25, 0.1695], "velocity": [0.2, -0.5], "angle": 0.1,
           "mesh": { "rectangle": { "size": [0.4, 0.3], "cells": [4, 3] } } })";
  const std::string wheel =
      R"({ "name": "wheel", "material": "rock", "position": [0.25, 0.2035], "velocity": [0.4, -0.5], "spin": -2,
           "mesh": { "disc": { "radius": 0.2, "cells": 2 } } })";
  const std::string plain = R"("normal_stiffness": 1e8)";
  const std::string rough =
      plain + R"(, "friction": { "coefficient": 0.4, "tangential_stiffness": 5e7 })";
  const std::string damped = rough + R"(, "damping": { "model": "viscous", "ratio": 0.2 })";
  const auto scene = [&](const std::string& contact, const std::string& bodies, double end,
                         double step) {
    return fmt::format(
        R"({{ {}, "contact": {{ {} }}, "bodies": [ {} ], "time": {{ "end": {}, "step": {} }} }})",
        materials, contact, bodies, end, step);
  };
  return {{"rigid bodies collide", scene(plain, floor + ", " + block + ", " + cross, .1, 4e-5)},
          {"rigid bodies rub", scene(rough, floor + ", " + block + ", " + cross, .1, 4e-5)},
          {"rigid bodies damped", scene(damped, floor + ", " + block + ", " + cross, .1, 2e-5)},
          {"a block slides", scene(damped, floor + ", " + cube, .06, 2e-5)},
          {"a mesh falls", scene(plain, floor + ", " + soft, .05, 2e-5)},
          {"a mesh rubs", scene(rough, floor + ", " + soft + ", " + block, .05, 2e-5)},
          {"meshes damped", scene(damped, meshed_floor + ", " + soft + ", " + block, .05, 2e-5)},
          {"a wheel on a mesh", scene(damped, meshed_floor + ", " + wheel, .05, 2e-5)}};
}

std::string name_of(const Json& body) { return body["name"]; }

// What bodies are called in a scene, by their names in another one.
using Names = std::map<std::string, std::string>;

Names names_of(const Json& scene, const std::function<std::string(const Json&)>& called = name_of) {
  Names names;
  for (const Json& body : scene["bodies"]) names[name_of(body)] = called(body);
  return names;
}

Outcome run(const Folder& folder, Json scene, const Names& names, int threads = 1,
            double stop = 0) {
  Json tracks = Json::array();
  for (const auto& [own, name] : names) tracks.push_back({{"body", name}});
  Json& output = scene["output"];
  if (!output.contains("frames")) output["frames"] = 1;
  Json& history = output["history"];
  if (!history.contains("interval")) history["interval"] = scene["time"]["end"];
  history["track"] = tracks;
  const std::filesystem::path out = folder / "out";
  std::filesystem::remove_all(out);
  if (stop > 0) {
    Run until(scene_of(folder, scene.dump()), {.folder = out, .threads = threads});
    REQUIRE(until.run(stop) == Run::Status::done);
  }
  Run one(scene_of(folder, scene.dump()), {.folder = out, .threads = threads, .resume = stop > 0});
  CAPTURE(one.message());
  REQUIRE(one.run() == Run::Status::done);
  Outcome found;
  const HistoryTable table = read_table(out, "history.csv");
  const auto first = [&](const std::string& column) { return table.column(column)->front(); };
  const auto last = [&](const std::string& column) { return table.column(column)->back(); };
  for (const auto& [own, name] : names) {
    found.bodies[own] = {
        last(name + ".x"),  last(name + ".y"),  last(name + ".angle") - first(name + ".angle"),
        last(name + ".vx"), last(name + ".vy"), last(name + ".spin")};
  }
  const HistoryTable energies = read_table(out, "energy.csv");
  for (const char* column :
       {"kinetic", "strain", "contact", "gravity", "friction_loss", "damping_loss"}) {
    found.energies[column] = energies.column(column)->back();
  }
  const Json summary = Json::parse(content(out / "run.json"));
  found.force = summary["largest_contact_force"];
  found.depth = summary["largest_penetration"];
  found.energy = summary["energy_in_play"];
  found.time = energies.column("time")->back();
  return found;
}

struct Way {
  const char* name;
  double tolerance;  // of lengths over 1 m, speeds over 1 m/s, energies over the energy in play
  std::function<void(Json&)> change;  // files that it writes lie in the working folder
  /// What the way makes of the motion of a body.
  std::function<Motion(Motion, double time)> motion = [](Motion m, double) { return m; };
  /// How many times the lengths (and the speeds) are what they were.
  double length = 1;
  int threads = 1;
  double stop = 0;             // where a run is stopped and resumed, as a part of its end
  bool gravity_counts = true;  // energies that depend on where the origin is
  bool kinetic_counts = true;  // or on the frame
  bool energies_count = true;  // not where there are other bodies
  /// What a body of the scene is called.
  std::function<std::string(const Json& body)> called = name_of;
  /// Whether a scene can be said in this way.
  std::function<bool(const Json& scene)> fits = [](const Json&) { return true; };
};

void each_vector(Json& scene, const std::function<Vec2(Vec2)>& turn) {
  const auto change = [&](Json& v) {
    const Vec2 p = turn({v[0].get<double>(), v[1].get<double>()});
    v = Json::array({p.x(), p.y()});
  };
  change(scene["gravity"]);
  for (Json& body : scene["bodies"]) {
    change(body["position"]);
    if (body.contains("velocity")) change(body["velocity"]);
  }
}

// The body as a polygon at its place.
Json placed(const Json& body) {
  const double angle = body.value("angle", 0.), c = std::cos(angle), s = std::sin(angle);
  const Json at = body.value("position", Json::array({0., 0.}));
  Json ring = Json::array();
  for (const Json& v : body["polygon"]) {
    const double x = v[0], y = v[1];
    ring.push_back(
        Json::array({at[0].get<double>() + c * x - s * y, at[1].get<double>() + s * x + c * y}));
  }
  ring.push_back(ring.front());
  return ring;
}

// Moves the rigid bodies of a scene into drawings.
void draw(Json& scene, const Folder& folder) {
  Json bodies = Json::array();
  for (Json& body : scene["bodies"]) {
    if (!body.contains("polygon")) {
      bodies.push_back(body);
      continue;
    }
    const std::string name = body["name"];
    const Json feature = {{"type", "Feature"},
                          {"properties", {{"name", name}}},
                          {"geometry", {{"type", "Polygon"}, {"coordinates", {placed(body)}}}}};
    folder.write(name + ".geojson", feature.dump());
    Json import = {{"file", name + ".geojson"}, {"name", "drawn"}};
    for (const char* key : {"material", "motion", "velocity", "spin"}) {
      if (body.contains(key)) import[key] = body[key];
    }
    scene["import"].push_back(import);
  }
  scene["bodies"] = bodies;
}

std::vector<Way> all_ways(const Folder& folder) {
  std::vector<Way> all;
  const double angle = .7;
  const auto turn = [=](const Vec2& p) {
    return Vec2(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                std::sin(angle) * p.x() + std::cos(angle) * p.y());
  };
  all.push_back({"turned", 1e-8,
                 [=](Json& s) {
                   each_vector(s, turn);
                   for (Json& b : s["bodies"]) b["angle"] = b.value("angle", 0.) + angle;
                 },
                 [=](const Motion& m, double) {
                   const Vec2 x = turn({m.x, m.y}), v = turn({m.vx, m.vy});
                   return Motion{x.x(), x.y(), m.angle, v.x(), v.y(), m.spin};
                 }});
  all.push_back(
      {"mirrored", 1e-8,
       [](Json& s) {
         each_vector(s, [](const Vec2& p) { return Vec2(-p.x(), p.y()); });
         for (Json& b : s["bodies"]) {
           b["angle"] = -b.value("angle", 0.);
           if (b.contains("spin")) b["spin"] = -b["spin"].get<double>();
           if (!b.contains("polygon")) continue;
           Json& ring = b["polygon"];
           std::reverse(ring.begin(), ring.end());
           for (Json& v : ring) v[0] = -v[0].get<double>();
         }
       },
       [](const Motion& m, double) { return Motion{-m.x, m.y, -m.angle, -m.vx, m.vy, -m.spin}; }});
  // Round-off is a thousand times larger there, and friction in flat contact amplifies it.
  Way shifted{"shifted by a kilometre", 1e-5,
              [](Json& s) {
                for (Json& b : s["bodies"]) {
                  b["position"][0] = b["position"][0].get<double>() + 1000;
                  b["position"][1] = b["position"][1].get<double>() - 300;
                }
              },
              [](Motion m, double) {
                m.x += 1000, m.y -= 300;
                return m;
              }};
  shifted.gravity_counts = false;
  all.push_back(shifted);
  Way scaled{"a thousand times as large", 1e-8, [](Json& s) {
               each_vector(s, [](const Vec2& p) { return Vec2(1000 * p); });
               const auto times = [](Json& number, double factor) {
                 number = number.get<double>() * factor;
               };
               times(s["materials"]["rock"]["young"], 1e6);
               times(s["contact"]["normal_stiffness"], 1e6);
               if (s["contact"].contains("friction")) {
                 times(s["contact"]["friction"]["tangential_stiffness"], 1e6);
               }
               for (Json& b : s["bodies"]) {
                 if (b.contains("polygon")) {
                   for (Json& v : b["polygon"]) times(v[0], 1000), times(v[1], 1000);
                   continue;
                 }
                 Json& mesh = b["mesh"];
                 if (mesh.contains("disc")) times(mesh["disc"]["radius"], 1000);
                 if (!mesh.contains("rectangle")) continue;
                 for (Json& side : mesh["rectangle"]["size"]) times(side, 1000);
               }
             }};
  scaled.length = 1000;
  all.push_back(scaled);
  all.push_back({"bodies in another order", 1e-8,
                 [](Json& s) { std::reverse(s["bodies"].begin(), s["bodies"].end()); }});
  all.push_back({"written as pairs", 1e-12, [](Json& s) {
                   s["materials"]["other"] = s["materials"]["rock"];
                   s["bodies"].back()["material"] = "other";
                   Json pair = {{"between", {"rock", "other"}}};
                   for (const char* key : {"normal_stiffness", "friction", "damping"}) {
                     if (s["contact"].contains(key)) pair[key] = s["contact"][key];
                   }
                   s["contact"]["pairs"] = Json::array({pair});
                 }});
  Way moving{"seen from a moving frame", 1e-8,
             [](Json& s) {
               for (Json& b : s["bodies"]) {
                 if (b.contains("motion")) {
                   b["motion"] = {{"velocity", Json::array({Json::array({0, 0.9, 0})})}};
                   continue;
                 }
                 const Json v = b.value("velocity", Json::array({0, 0}));
                 b["velocity"] = Json::array({v[0].get<double>() + .9, v[1]});
                 if (!b.contains("supports")) continue;
                 for (Json& support : b["supports"]) {
                   support["velocity"] = Json::array({Json::array({0, 0.9, 0})});
                 }
               }
             },
             [](Motion m, double t) {
               m.x += .9 * t, m.vx += .9;
               return m;
             }};
  moving.kinetic_counts = false;
  all.push_back(moving);
  all.push_back({"gravity with a history", 0, [](Json& s) {
                   s["gravity"] = {
                       {"value", s["gravity"]},
                       {"history", Json::array({Json::array({0, 1}), Json::array({1, 1})})}};
                 }});
  // Impulses of contacts that begin are found for each vertex.
  all.push_back({"vertices in the middle of edges", 1e-5, [](Json& s) {
                   for (Json& b : s["bodies"]) {
                     if (!b.contains("polygon")) continue;
                     Json ring = Json::array();
                     const Json& old = b["polygon"];
                     for (size_t i = 0; i < old.size(); ++i) {
                       const Json &p = old[i], &q = old[(i + 1) % old.size()];
                       ring.push_back(p);
                       ring.push_back(
                           Json::array({.5 * (p[0].get<double>() + q[0].get<double>()),
                                        .5 * (p[1].get<double>() + q[1].get<double>())}));
                     }
                     b["polygon"] = ring;
                   }
                 }});
  all.push_back({"with frames and rows", 0, [](Json& s) {
                   s["output"] = {{"frames", 7}, {"history", {{"interval", 3e-3}}}};
                 }});
  Way far{"with a far mesh", 1e-12, [](Json& s) {
            s["bodies"].push_back(Json::parse(
                R"({ "name": "far", "material": "rock", "position": [50, 0], "mesh": {
                            "rectangle": { "size": [2, 1], "cells": [2, 1] } },
                            "supports": [ { "where": { "group": "bottom" }, "fix": ["x", "y"] } ] })"));
          }};
  far.energies_count = false;
  all.push_back(far);
  all.push_back({"with contact of bodies with themselves", 0,
                 [](Json& s) { s["contact"]["self_contact"] = "compute"; }});
  Way renamed{"with other names", 0, [](Json& s) {
                s["materials"] = {{"a stone", s["materials"]["rock"]}};
                for (Json& b : s["bodies"]) {
                  b["material"] = "a stone";
                  b["name"] = "z " + name_of(b);
                }
              }};
  renamed.called = [](const Json& body) { return "z " + name_of(body); };
  all.push_back(renamed);
  all.push_back({"polygons in files", 0, [&](Json& s) {
                   for (Json& b : s["bodies"]) {
                     if (!b.contains("polygon")) continue;
                     const std::string file = name_of(b) + ".json";
                     folder.write(file, b["polygon"].dump());
                     b["polygon"] = file;
                   }
                 }});
  Way drawn{"bodies from drawings", 1e-8, [&](Json& s) { draw(s, folder); }};
  drawn.called = [](const Json& body) {
    return (body.contains("polygon") ? "drawn-" : "") + name_of(body);
  };
  all.push_back(drawn);
  Way loaded{"weight as a load", 1e-10, [](Json& s) {
               s["gravity"] = Json::array({0, 0});
               for (Json& b : s["bodies"]) {
                 if (b.contains("motion")) continue;
                 b["loads"] = {{{"body_force", {0, -9.81 * 2000}}}};
               }
             }};
  loaded.gravity_counts = false;
  loaded.fits = [](const Json& s) {  // rigid bodies take no loads
    return std::ranges::all_of(
        s["bodies"], [](const Json& b) { return b.contains("motion") || b.contains("mesh"); });
  };
  all.push_back(loaded);
  Way threads{"by three threads", 0, [](Json&) {}};
  threads.threads = 3;
  all.push_back(threads);
  Way resumed{"stopped and resumed", 0, [](Json&) {}};
  resumed.stop = .37;
  all.push_back(resumed);
  return all;
}

// What differs too much; empty if nothing does.
std::string difference(const Way& way, const Outcome& plain, const Outcome& other) {
  std::string found;
  const auto compare = [&](const std::string& what, double a, double b, double scale) {
    if (std::abs(a - b) <= way.tolerance * scale) return;
    found += fmt::format("{} is {} and not {}; ", what, b, a);
  };
  const double length = way.length;
  for (const auto& [name, motion] : plain.bodies) {
    Motion m = motion;
    m.x *= length, m.y *= length, m.vx *= length, m.vy *= length;
    m = way.motion(m, plain.time);
    const Motion& n = other.bodies.at(name);
    compare(name + ".x", m.x, n.x, length), compare(name + ".y", m.y, n.y, length);
    compare(name + ".vx", m.vx, n.vx, length), compare(name + ".vy", m.vy, n.vy, length);
    compare(name + ".angle", m.angle, n.angle, 1), compare(name + ".spin", m.spin, n.spin, 1);
  }
  const double size = std::pow(length, 4);
  for (const auto& [name, energy] : plain.energies) {
    if (!way.energies_count) continue;
    if (!way.gravity_counts && name == "gravity") continue;
    if (!way.kinetic_counts && name == "kinetic") continue;
    compare(name, size * energy, other.energies.at(name), size * plain.energy);
  }
  compare("force", plain.force * length * length * length, other.force,
          10 * plain.force * length * length * length);
  compare("depth", plain.depth * length, other.depth, length);
  return found;
}

// Two whole scenes that are one situation, and the columns that must agree at the end.
struct Twins {
  const char* name;
  std::string one, other;
  std::vector<const char*> columns;
  double tolerance;  // of the values, over the larger one
};

std::string at_rest(const std::string& bodies, const std::string& contact, const std::string& time,
                    const std::string& more = "") {
  return R"({ "materials": { "rock": { "density": 2000, "young": 2e10, "poisson": 0.2 },
                             "stiff": { "density": 2000, "young": 2e13, "poisson": 0.2 } },
    "gravity": [0, -9.81], "contact": { "normal_stiffness": )" +
         contact + R"( }, "bodies": [ )" + bodies + R"( ], "time": { )" + time +
         R"( }, "regions": { "all": { "polygon": [[-9, -0.2], [9, -0.2], [9, 9], [-9, 9]] } },
    "output": { "history": { "track": [ { "body": "block" } ] )" +
         more + " } } }";
}

std::vector<Twins> all_twins() {
  const std::string rigid_floor =
      R"({ "name": "floor", "material": "rock", "motion": "fixed",
           "polygon": [[-0.8, -0.3], [0.8, -0.3], [0.8, 0], [-0.8, 0]] })";
  const std::string held_floor =
      R"({ "name": "floor", "material": "rock",
           "mesh": { "rectangle": { "size": [1.6, 0.3], "cells": [16, 3], "origin": [-0.8, -0.3] } },
           "supports": [ { "where": { "box": [[-9, -9], [9, 9]] }, "fix": ["x", "y"] } ] })";
  const std::string tilted =
      R"(, { "name": "block", "material": "rock",
             "polygon": [[-0.053, -0.001], [0.131, 0.077], [0.053, 0.261], [-0.131, 0.183]] })";
  const std::string meshed =
      R"(, { "name": "block", "material": "rock",
             "mesh": { "rectangle": { "size": [0.4, 0.2], "cells": [4, 2], "origin": [-0.21, -1e-6] } } })";
  const std::string rigid =
      R"(, { "name": "block", "material": "rock",
             "polygon": [[-0.21, -1e-6], [0.19, -1e-6], [0.19, 0.2], [-0.21, 0.2]] })";
  const std::string far =
      R"(, { "name": "far", "material": "rock",
             "mesh": { "rectangle": { "size": [1, 1], "cells": [2, 2], "origin": [30, 0] } },
             "supports": [ { "where": { "x": 30 }, "fix": ["x", "y"] } ] })";
  const std::string falling = R"(, { "name": "block", "material": "stiff", "velocity": [0, -1], )";
  const std::string soft = "1e6";
  const std::string accept = R"(1e8, "reference": 0.02, "overlaps": "accept")";
  const std::string friction = R"(, "friction": { "coefficient": 0.5 })";
  const std::string damped = R"(, "damping": { "model": "normal_viscous", "ratio": 0.5 })";
  const std::string track = R"(, "interval": 1)";
  const std::string soon = R"("end": 2e-6, "step": 1e-8)", brief = R"("end": 0.03, "step": 2e-7)";
  const std::string settled = R"("end": 1e-5, "step": 1e-6, "start": "settled")";
  const auto load_steps = [](int count) {
    return R"("mode": "static", "end": 1, "load_steps": )" + std::to_string(count);
  };
  return {
      {"a corner on a rigid floor, or on a mesh that is held",
       at_rest(rigid_floor + tilted, accept, soon, track),
       at_rest(held_floor + tilted, accept, soon, track),
       {"block.vy", "block.spin", "block.fy", "all.sxy", "all.syy", "all.count", "all.mass",
        "all.coordination"},
       1e-7},
      {"the same with friction",
       at_rest(rigid_floor + tilted, accept + friction, soon, track),
       at_rest(held_floor + tilted, accept + friction, soon, track),
       {"block.vy", "block.fy", "all.syy"},
       1e-7},
      {"a rigid block that falls, or a stiff mesh",
       at_rest(rigid_floor + falling +
                   R"("polygon": [[-0.2, 0.001], [0.2, 0.001], [0.2, 0.2], [-0.2, 0.2]] })",
               R"(1e8, "reference": 0.09)", brief, track),
       at_rest(
           rigid_floor + falling +
               R"("mesh": { "rectangle": { "size": [0.4, 0.199], "cells": [2, 1], "origin": [-0.2, 0.001] } } })",
           R"(1e8, "reference": 0.09)", brief, track),
       {"block.vy", "block.y", "all.translation"},
       5e-4},
      {"a rigid block at rest, static or settled",
       at_rest(rigid_floor + rigid, soft, load_steps(1)),
       at_rest(rigid_floor + rigid, soft, settled, track),
       {"block.y", "block.fy"},
       1e-6},
      {"a mesh at rest, static or settled",
       at_rest(rigid_floor + meshed, soft + friction, load_steps(1)),
       at_rest(rigid_floor + meshed, soft + friction, settled, track),
       {"block.y", "block.fy"},
       1e-5},
      {"a rigid block, settled or after damped motion",
       at_rest(rigid_floor + rigid, soft + damped, settled, track),
       at_rest(rigid_floor + rigid, soft + damped, R"("end": 2)", track),
       {"block.y", "block.fy", "all.syy"},
       1e-5},
      {"a rigid block settled alone, or beside a mesh",
       at_rest(rigid_floor + rigid, soft + damped, settled, track),
       at_rest(rigid_floor + rigid + far, soft + damped, settled, track),
       {"block.y", "block.fy", "block.vy"},
       1e-7},
      {"a mesh in one load step or in twenty",
       at_rest(rigid_floor + meshed, soft, load_steps(1)),
       at_rest(rigid_floor + meshed, soft, load_steps(20)),
       {"block.y", "block.fy", "all.syy"},
       1e-5},
  };
}

std::map<std::string, double> last_row(const Folder& folder, const std::string& scene) {
  const std::filesystem::path out = folder / "out";
  std::filesystem::remove_all(out);
  Run run(scene_of(folder, scene), {.folder = out});
  CAPTURE(run.message());
  REQUIRE(run.run() == Run::Status::done);
  std::map<std::string, double> row;
  const HistoryTable table = read_table(out, "history.csv");
  for (const std::string& name : table.names) row[name] = table.column(name)->back();
  return row;
}

// A fill with its blocks written out as polygons at their places.
Json written_out(const Folder& folder, const Json& filled) {
  const Scene scene = scene_of(folder, filled.dump());
  Json written = filled;
  written.erase("fill");
  for (const RigidBody& body : scene.model.bodies) {
    if (!body.name.starts_with("stone")) continue;
    Json ring = Json::array();
    for (const Vec2& v : body.potential.vertices) ring.push_back(Json::array({v.x(), v.y()}));
    const Vec2 place = body.position + scene.model.origin;
    written["bodies"].push_back({{"name", body.name},
                                 {"material", "rock"},
                                 {"polygon", ring},
                                 {"position", {place.x(), place.y()}},
                                 {"angle", body.angle},
                                 {"velocity", {body.velocity.x(), body.velocity.y()}}});
  }
  return written;
}

}  // namespace
}  // namespace ways

TEST_CASE("one situation said in many ways gives one result", "[ways][slow]") {
  const Folder folder;
  for (const ways::NamedText& scene : ways::scenes()) {
    const Json plain = Json::parse(scene.text);
    const ways::Outcome expected = ways::run(folder, plain, ways::names_of(plain));
    REQUIRE(expected.force > 0);
    std::uint64_t number = 0;
    for (const ways::Way& way : ways::all_ways(folder)) {
      if (!is_taken(number++) || !way.fits(plain) || (kSanitized && way.tolerance > 0)) continue;
      CAPTURE(scene.name, way.name);
      Json changed = plain;
      way.change(changed);
      const double end = plain["time"]["end"];
      const ways::Names names = ways::names_of(plain, way.called);
      const ways::Outcome found = ways::run(folder, changed, names, way.threads, way.stop * end);
      CHECK(ways::difference(way, expected, found) == "");
    }
  }
}

TEST_CASE("two scenes of one situation agree", "[ways][slow]") {
  const Folder folder;
  std::uint64_t number = 0;
  for (const ways::Twins& twins : ways::all_twins()) {
    if (!is_taken(number++)) continue;
    CAPTURE(twins.name);
    auto one = ways::last_row(folder, twins.one), other = ways::last_row(folder, twins.other);
    for (const char* column : twins.columns) {
      CAPTURE(column, one.at(column), other.at(column));
      const double largest = std::max(std::abs(one[column]), std::abs(other[column]));
      CHECK(std::abs(one[column] - other[column]) <= twins.tolerance * std::max(largest, 1e-3));
    }
  }
}

TEST_CASE("a fill is what its blocks are when they are written out", "[ways]") {
  const Folder folder;
  const Json filled = Json::parse(R"({
    "gravity": [0, -9.81], "materials": { "rock": { "density": 2000 } },
    "contact": { "normal_stiffness": 1e8, "friction": { "coefficient": 0.3 } },
    "bodies": [ { "name": "floor", "material": "rock", "motion": "fixed",
                  "polygon": [[-2, -1], [2, -1], [2, 0], [-2, 0]] } ],
    "fill": [ { "name": "stone", "material": "rock", "count": 12, "region": [[-1, 0], [1, 0], [1, 1], [-1, 1]],
                "shapes": [ { "quadrilateral": {} }, { "polygon_random": { "corners": 6 } } ], "diameter": 0.2,
                "velocity": [0, -1], "seed": 5 } ],
    "time": { "end": 0.05, "step": 2e-5 } })");
  const Json written = ways::written_out(folder, filled);
  const ways::Names names = ways::names_of(written);
  const ways::Outcome one = ways::run(folder, filled, names),
                      other = ways::run(folder, written, names);
  REQUIRE(one.force > 0);
  CHECK(ways::difference({"written out", 1e-9, {}}, one, other) == "");
}
