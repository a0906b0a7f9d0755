// How long it takes until a scene of many bodies is ready for its first step: reading, making
// blocks and potentials, finding pairs.

#include <memory>

#include "apps/benchmark/bench.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/output/files.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {
namespace {

// Blocks of 0.1 m on a lattice in a square of that size.
std::string lattice(const std::string& shape, int count, int side) {
  const std::string s = std::to_string(side);
  return R"({ "name": "start", "materials": { "rock": { "density": 2000 } },
  "contact": { "normal_stiffness": 2e7, "friction": { "coefficient": 0.5 } },
  "fill": [ { "name": "block", "material": "rock", "region": [[0, 0], [)" +
         s + ", 0], [" + s + ", " + s + "], [0, " + s + R"(]],
              "shapes": [ )" +
         shape + R"( ], "diameter": 0.1, "count": )" + std::to_string(count) +
         R"(, "arrangement": "lattice" } ],
  "time": { "end": 1 } })";
}

Work start(const std::string& text, int threads) {
  const auto folder = std::make_shared<TemporaryFolder>();
  write_file(folder->path() + "/start.json", text);
  return {.once = [folder, threads] {
    const Scene scene = read_scene(folder->path() + "/start.json");
    const Simulation simulation(scene.model, scene.time, scene.output.frames, threads);
    return static_cast<double>(scene.model.bodies.size());
  }};
}

}  // namespace

std::vector<BenchmarkCase> start_cases() {
  std::vector<BenchmarkCase> cases;
  const auto enter = [&](const std::string& name, const std::string& about,
                         const std::string& shape, int count, int side) {
    cases.push_back(
        {.name = "start/" + name + "/" + std::to_string(count),
         .item = "body",
         .about = about,
         .prepare = [=](int threads) { return start(lattice(shape, count, side), threads); },
         .clock = ClockKind::wall});
  };
  enter("crosses", "until the first step can begin: equal crosses", R"({ "cross": { "arm": 1 } })",
        3000, 12);
  enter("quads", "until the first step can begin: different quadrilaterals",
        R"({ "quadrilateral": {} })", 30000, 40);
  return cases;
}

}  // namespace apothem
