// What results take, and what is said of numbers that are absurd.
#include "lib/run/cost.hpp"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lib/run/run.hpp"
#include "tests/folder.hpp"
#include "tests/run/hopper.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("the files and bytes of results are as many as estimated, to a factor", "[run][cost]") {
  const Folder folder;
  std::string text = hopper("keep");
  const std::string end = "\"end\": 3", frames = "\"frames\": 6";
  text.replace(text.find(end), end.size(), "\"end\": 0.3");
  text.replace(text.find(frames), frames.size(), "\"frames\": 60");
  const std::string times = "\"times\": 3";  // bodies that come later are in no frame before
  text.replace(text.find(times), times.size(), "\"times\": 1");
  Run run(scene_of(folder, text), {.folder = folder / "out"});
  REQUIRE(run.run() == Run::Status::done);
  const OutputCost cost = output_cost(run.scene(), static_cast<double>(run.state().step));
  double files = 0, bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out/frames")) {
    ++files;
    bytes += static_cast<double>(entry.file_size());
  }
  CHECK(cost.frames == 61);
  CHECK(cost.files == files);
  CHECK(cost.bytes > .4 * bytes);
  CHECK(cost.bytes < 2.5 * bytes);
  CHECK(excessive_costs(run.scene(), 1e4).empty());

  // The same in one container.
  const std::string output = "\"output\": {";
  text.replace(text.find(output), output.size(), output + R"( "format": "xdmf", )");
  Run contained(scene_of(folder, text), {.folder = folder / "contained"});
  REQUIRE(contained.run() == Run::Status::done);
  const OutputCost less = output_cost(contained.scene(), static_cast<double>(run.state().step));
  bytes = 0;
  for (const char* name : {"frames.h5", "frames.xdmf", "contacts.xdmf"}) {
    bytes += static_cast<double>(
        std::filesystem::file_size(folder / ("contained/" + std::string(name))));
  }
  CHECK(less.files == 3);
  CHECK(less.bytes > .4 * bytes);
  CHECK(less.bytes < 2.5 * bytes);
  CHECK(less.seconds < cost.seconds);
}

TEST_CASE("absurd numbers of frames are named, but for those that no step has", "[run][cost]") {
  const Folder folder;
  Scene scene = scene_of(folder, hopper("keep"));
  scene.output.frames = 20'000'000;
  CHECK(excessive_costs(scene, 1e3).empty());
  const std::vector<std::string> costs = excessive_costs(scene, 1e8);
  REQUIRE(costs.size() == 1);
  for (const char* word : {"2e+07 frames", "GB of disk", "to write", "\"frames\""}) {
    CHECK(costs[0].find(word) != std::string::npos);
  }
  scene.time.statics = true;
  CHECK(excessive_costs(scene, 1e9)[0].find("load_steps") != std::string::npos);
}

TEST_CASE("a fill for which there is no memory is refused before it is made", "[run][cost]") {
  const Folder folder;
  const std::string times = "\"times\": 3";
  std::string often = hopper("keep", "", R"(, "mesh": { "size": 0.05 })");
  often.replace(often.find(times), times.size(), "\"times\": 100000000");
  CHECK_THROWS_WITH(scene_of(folder, often), Catch::Contains("/fill/0/repeat") &&
                                                 Catch::Contains("GB of memory") &&
                                                 Catch::Contains("100000000 batches of 12"));
}
