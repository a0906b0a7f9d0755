// SIGINT and SIGTERM end the program wherever it is, with exit code 130.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/program.hpp"
#include "tests/run/hopper.hpp"

using namespace apothem;
using namespace apothem::test;

namespace signals {
namespace {

const std::string kSpike = R"({ "gravity": [-5, -8],
  "materials": { "m": { "density": 2000, "young": 1e9, "poisson": 0.25 }, "r": { "density": 2000 } },
  "contact": { "normal_stiffness": 1e9, "penetration_warning": 10 },
  "bodies": [
    { "name": "spike", "material": "r",
      "polygon": [[-0.3577350269189626, 0.1], [-0.3, 0], [-0.24226497308103742, 0.1],
        [0.24226497308103742, 0.1], [800, 0], [0.3577350269189626, 0.1], [0.3577350269189626, 0.2],
        [-0.3577350269189626, 0.2]] },
    { "name": "floor", "material": "m",
      "mesh": { "rectangle": { "size": [6, 0.4], "cells": [90, 6], "origin": [-4, -0.4] } },
      "supports": [ { "where": { "group": "bottom" }, "fix": ["x", "y"] } ] } ],
  "time": { "end": 1e-5 }, "output": { "frames": 1 } })";

// A scene whose reading takes long: the arrangement of many blocks, or their meshes.
std::string long_fill(const std::string& arrangement, const std::string& mesh) {
  return R"({ "materials": { "r": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e7 }, "time": { "end": 1 },
    "fill": [ { "name": "s", "material": "r", "region": [[0,0],[100,0],[100,100],[0,100]],
      "shapes": [ { "cross": { "arm": 1 } }, { "quadrilateral": {} } ], "diameter": 0.3, "count": 60000,
      "arrangement": ")" +
         arrangement + "\"" + mesh + " } ] }";
}

}  // namespace

TEST_CASE("the faces of a spike that have no end do not hold up the search", "[signals]") {
  const Folder folder;
  const std::string scene = folder.write("spike.json", kSpike);
  CHECK(run({"check", scene}, folder, {.most_seconds = 60}).code == 0);
  CHECK(run({"run", scene, "-o", folder / "out"}, folder, {.most_seconds = 60}).code == 0);
}

TEST_CASE("a signal ends whatever takes long before anything is written", "[signals]") {
  if (kSanitized) return;  // programs begin late there
  const Folder folder;
  const std::string random = folder.write("random.json", long_fill("dense", ""));
  const std::string meshed =
      folder.write("meshed.json", long_fill("random", R"(, "mesh": { "size": 0.01 })"));
  std::string ring = "POLYGON ((";  // a saw
  for (int i = 0; i < 9000; ++i) ring += std::to_string(i) + (i % 2 ? " 0.9, " : " 0, ");
  const std::string saw = folder.write("saw.wkt", ring + "9000 5, 0 5))");
  for (const int signal : {SIGINT, SIGTERM}) {
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"check", random},
          {"run", random, "-o", folder / "out"},
          {"run", meshed, "-o", folder / "out"},
          {"polygon", saw, "--json"},
          {"contact", saw, saw, "--method", "exact", "--json"},
          {"mesh", saw, "--voronoi", "200000"}}) {
      const auto start = std::chrono::steady_clock::now();
      const Result r =
          run(words, folder, {.interrupt_after = .4, .signal = signal, .most_seconds = 30});
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
      INFO(words[0] << ' ' << words[1] << ": " << r.err);
      CHECK(r.code == 130);
      CHECK(r.err.find("interrupted") != std::string::npos);
      if (words.back() == "--json") CHECK(nlohmann::json::parse(r.out).contains("error"));
      CHECK(seconds.count() < 5);
      CHECK_FALSE(std::filesystem::exists(folder / "out"));
    }
  }
}

TEST_CASE("a step that does not end is broken off, and its run goes on later", "[signals]") {
  if (kSanitized) return;  // programs begin late there
  const Folder folder;
  const std::string scene = folder.write(
      "pile.json", exchanged(hopper("remove"), "\"frames\": 6",
                             "\"frames\": 600, \"checkpoint\": { \"wall_clock\": 0.01 }"));
  const std::string out = folder / "out", blocked = out + "/frames/bodies_000060.vtu.partial";
  std::thread blocker([&] {
    for (int i = 0; i < 6000 && !std::filesystem::exists(out + "/checkpoint.json"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    mkfifo(blocked.c_str(), 0600);  // whoever opens it waits for a reader
  });
  const auto start = std::chrono::steady_clock::now();
  const Result r = run({"run", scene, "-o", out, "--quiet"}, folder,
                       {.interrupt_after = 1.5, .signal = SIGTERM, .most_seconds = 60});
  blocker.join();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  INFO(r.err);
  CHECK(r.code == 130);
  CHECK(r.err.find("before what was under way was finished") != std::string::npos);
  CHECK(lines(r.err) == 1);
  CHECK(seconds.count() > 4.5);
  std::filesystem::remove(blocked);
  CHECK(run({"run", scene, "-o", out, "--quiet", "--resume"}, folder).code == 0);
}

// Before that, the system loads libraries, and the signal ends the process itself.
TEST_CASE("a signal to a program that has just begun is heeded", "[signals]") {
  if (kSanitized) return;  // programs begin late there
  const Folder folder;
  const std::string scene = folder.write("spike.json", kSpike);
  // A child has the handler of Catch2 until it is the program.
  const auto handler = std::signal(SIGTERM, SIG_DFL);
  int heeded = 0;
  for (int i = 0; i < 40; ++i) {
    const Result r =
        run({"check", scene}, folder, {.interrupt_after = .004 * i + .001, .signal = SIGTERM});
    INFO(i << ": " << r.code << r.err);
    CHECK((r.code == 130 || r.code == -SIGTERM || r.code == 0));
    heeded += r.code == 130;
  }
  std::signal(SIGTERM, handler);
  CHECK(heeded > 0);
}

}  // namespace signals
