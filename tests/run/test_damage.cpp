// Checkpoints and histories that are damaged while nobody runs, and histories that are deleted
// while the run writes them: a run ends as if nothing had been, or says what is wrong.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <random>

#include "lib/output/files.hpp"
#include "lib/run/hash.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;
namespace fs = std::filesystem;

namespace damage {
namespace {

const std::vector<std::string> kHistories{"history.csv", "energy.csv", "momentum.csv"};

// Stops a run in the middle, behind its second checkpoint or a later one.
void stop_between(const Scene& scene, const std::string& folder) {
  bool enough = false;
  Run run(scene, {.folder = folder, .stop_if = [&] { return enough; }});
  run.on_progress([&](const Run& now) { enough = now.state().time > .6 * scene.time.end; });
  REQUIRE(run.run() == Run::Status::interrupted);
  REQUIRE(fs::exists(folder + "/checkpoint.json"));
  REQUIRE(fs::exists(folder + "/checkpoint.previous.json"));
}

using Random = std::mt19937;

// Damages a text as disks, full disks and people do.
std::string damaged(std::string text, Random& random) {
  const size_t at = random() % text.size();
  switch (random() % 4) {
    case 0:
      text[at] = static_cast<char>(text[at] ^ (1 + random() % 255));
      break;
    case 1:
      text.resize(at);
      break;
    case 2:
      std::fill(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), '\0');
      break;
    default:
      text.replace(at, 400, std::string(std::min<size_t>(400, text.size() - at), '\0'));
  }
  return text;
}

// 1: the run has refused to go on, and says why; 0: it ends as if nothing had been.
int outcome(const Scene& scene, const Folder& folder, const std::string& file) {
  try {
    Run run(scene, {.folder = folder / "hurt", .resume = true});
    if (file == "checkpoint.json") {
      REQUIRE(run.warnings().size() == 1);
      CHECK(run.warnings()[0].find("the checkpoint before the last one") != std::string::npos);
      CHECK(run.warnings()[0].find("checkpoint.json: is damaged") != std::string::npos);
    }
    REQUIRE(run.run() == Run::Status::done);
  } catch (const SceneError& error) {
    CHECK(std::string(error.what()).find(file + ": ") != std::string::npos);
    return 1;
  }
  for (const std::string& name : kHistories) {
    INFO(name);
    CHECK((content(folder / ("hurt/" + name)) == content(folder / ("whole/" + name))));
  }
  CHECK((content(folder / "hurt/final.json") == content(folder / "whole/final.json")));
  return 0;
}

}  // namespace

// 40 cases; 1 000 with APOTHEM_LONG=1.
TEST_CASE("no damage of a checkpoint or a history passes silently", "[damage]") {
  const Folder folder;
  Scene scene = scene_of(folder, rubbing_scenes()[1].text);
  scene.output.checkpoint_interval = 1e-9;
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  stop_between(scene, folder / "stopped");
  Random random(40);
  std::vector<std::string> files = kHistories;
  files.insert(files.end(), {"checkpoint.json", "checkpoint.previous.json"});
  int refused = 0;
  const int cases = long_run() ? 1000 : scaled(40);
  for (int i = 0; i < cases; ++i) {
    const std::string& file = files[random() % files.size()];
    const std::string good = content(folder / ("stopped/" + file));
    const std::string bad = damaged(good, random);
    INFO(i << ": " << file);
    if (bad == good) continue;
    fs::remove_all(folder / "hurt");
    fs::copy(folder / "stopped", folder / "hurt", fs::copy_options::recursive);
    folder.write("hurt/" + file, bad);
    refused += outcome(scene, folder, file);
  }
  CHECK(refused > least(cases / 4));
  if (!kSanitized) CHECK(refused < cases * 3 / 4);
}

TEST_CASE("two damaged checkpoints are an error that names the first", "[damage]") {
  const Folder folder;
  Scene scene = scene_of(folder, rubbing_scenes()[1].text);
  scene.output.checkpoint_interval = 1e-9;
  stop_between(scene, folder / "out");
  folder.write("out/checkpoint.json", "");
  folder.write("out/checkpoint.previous.json", "{}");
  CHECK_THROWS_WITH(Run(scene, {.folder = folder / "out", .resume = true}),
                    Catch::Contains("checkpoint.json: is damaged: it is empty; run it anew"));
  // The first is gone: the one before is as good as it was.
  stop_between(scene, folder / "other");
  fs::remove(folder / "other/checkpoint.json");
  Run run(scene, {.folder = folder / "other", .resume = true});
  CHECK(run.warnings().size() == 1);
  CHECK(run.run() == Run::Status::done);
}

TEST_CASE("a history that is deleted, cut or replaced during a run ends it", "[damage]") {
  for (const std::string& file : kHistories) {
    for (const int way : {0, 1, 2}) {
      INFO(file << ' ' << way);
      const Folder folder;
      Scene scene = scene_of(folder, rubbing_scenes()[1].text);
      Run run(scene, {.folder = folder / "out"});
      run.advance(.005);
      const std::string path = folder / ("out/" + file);
      const std::string text = content(path);
      if (way == 0) fs::remove(path);
      if (way == 1) fs::resize_file(path, text.size() / 2);
      if (way == 2) write_file(path, text);
      CHECK_THROWS_AS(run.run(), SystemFailure);
      CHECK(run.status() == Run::Status::failed);
      CHECK(run.message().find(file + ": has been ") != std::string::npos);
      CHECK(run.message().find("run it anew") != std::string::npos);
    }
  }
}

}  // namespace damage
