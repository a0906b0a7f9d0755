// A run that is killed at any moment loses nothing older than its last checkpoint, and leaves
// frames that can be read.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <random>

#include "apothem/output/run_folder.hpp"
#include "program.hpp"
#include "run/hopper.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace survival {
namespace {

// All frames that frames.pvd lists.
size_t readable_frames(const std::string& folder) {
  if (!std::filesystem::exists(folder + "/frames.pvd")) return 0;
  const std::string list = content(folder + "/frames.pvd");
  size_t count = 0;
  const std::string key = "timestep=\"";
  for (size_t at = list.find(key); at != std::string::npos; at = list.find(key, at + 1)) {
    const double time = std::stod(list.substr(at + key.size()));
    CHECK(read_frame(folder, time, time).body.size() > 2);
    ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("a run that is killed twenty times ends as if it had not been", "[survival]") {
  const Folder folder;
  std::string text = hopper("remove", kStops);
  const std::string frames = "\"frames\": 6";
  text.replace(text.find(frames), frames.size(),
               "\"frames\": 200, \"checkpoint\": { \"wall_clock\": 0.02 }");
  const std::string scene = folder.write("scene.json", text);
  REQUIRE(run({"run", scene, "-o", folder / "whole", "--quiet"}, folder).code == 0);
  const std::string parts = folder / "parts";
  std::mt19937 random(5);
  int kills = 0;
  const auto complete = [&] {
    return std::filesystem::exists(parts + "/final.json") &&
           std::filesystem::exists(parts + "/run.json");
  };
  for (int i = 0; i < static_cast<int>(scaled(20)) && !complete(); ++i) {
    const bool resume = std::filesystem::exists(parts + "/checkpoint.json");
    const double delay = .02 + .3 * (static_cast<double>(random()) / 4.3e9);
    const Result killed =
        run({"run", scene, "-o", parts, "--quiet", resume ? "--resume" : "--overwrite"}, folder,
            {.interrupt_after = delay, .signal = SIGKILL});
    kills += killed.code == -SIGKILL;
    readable_frames(parts);
  }
  CHECK(kills > 0);
  if (!complete()) {
    const bool resume = std::filesystem::exists(parts + "/checkpoint.json");
    REQUIRE(run({"run", scene, "-o", parts, "--quiet", resume ? "--resume" : "--overwrite"}, folder)
                .code == 0);
  }
  const Json whole = Json::parse(content(folder / "whole/run.json"));
  const Json end = Json::parse(content(parts + "/run.json"));
  CHECK(end["final_state_hash"] == whole["final_state_hash"]);
  CHECK(end["stopped_by"] == whole["stopped_by"]);
  CHECK(end["measures"] == whole["measures"]);
  CHECK((content(parts + "/history.csv") == content(folder / "whole/history.csv")));
  CHECK((content(parts + "/energy.csv") == content(folder / "whole/energy.csv")));
  CHECK(readable_frames(parts) == readable_frames(folder / "whole"));
}

}  // namespace survival
