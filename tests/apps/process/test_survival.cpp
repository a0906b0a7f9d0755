// A run that is killed at any moment loses nothing older than its last checkpoint, and leaves
// frames that can be read. The same command, with --resume, is given until it has ended, as
// schedulers of clusters do; then all files are those of a run that nobody has killed.
#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "lib/output/run_folder.hpp"
#include "tests/program.hpp"
#include "tests/run/hopper.hpp"
#include "tests/run/scenes.hpp"

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

using Files = std::map<std::string, std::string>;

// Of the state at the end: what counts the work of the pair search begins anew where a run goes on.
std::string without_counts(const std::string& text) {
  Json json = Json::parse(text);
  json.erase("checksum");
  for (auto& [name, member] : json["simulation"].items()) {
    if (!name.starts_with("term_") || !member.contains("counts")) continue;
    member["counts"].erase("searches");
    member["counts"].erase("candidate_pairs");
  }
  return json.dump();
}

// All files of a folder but those that tell the time that the run has taken.
Files files_in(const std::string& folder) {
  Files files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = std::filesystem::relative(entry.path(), folder).string();
    const std::string last = entry.path().filename().string();
    if (!entry.is_regular_file() || last == "run.json" || last == "runs.csv") continue;
    if (last == "messages.txt" || last == "sweep.json") continue;
    files[name] = content(entry.path().string());
    if (last == "final.json") files[name] = without_counts(files[name]);
  }
  return files;
}

void check_same_files(const std::string& whole, const std::string& parts) {
  const Files good = files_in(whole), other = files_in(parts);
  CHECK(good.size() == other.size());
  for (const auto& [name, text] : good) {
    INFO(name);
    REQUIRE(other.count(name) == 1);
    CHECK((other.at(name) == text));
  }
}

struct Victim {
  const char* name;
  std::string text;
  double seconds;  // within which it is killed
};

std::string exchanged_all(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

std::vector<Victim> victims() {
  const std::string often = R"("checkpoint": { "wall_clock": 0.02 }, )";
  const auto with = [&](const std::string& text) {
    return exchanged(text, "\"output\": {", "\"output\": { " + often);
  };
  std::string longer = exchanged(hopper("remove", kStops), "\"frames\": 6", "\"frames\": 60");
  std::string slide = rubbing_scenes()[1].text;
  slide = exchanged(exchanged_all(slide, "\"end\": 0.02", "\"end\": 2"), "1e-3", "1e-2");
  return {{"hopper that removes", with(longer), .3},
          {"sliding block", with(slide), .2},
          {"meshes", with(rubbing_scenes()[9].text), .2},
          {"meshes and rigid bodies", with(rubbing_scenes()[11].text), .2},
          {"static", with(pressed_blocks(40)), .3}};
}

}  // namespace

// A few kills of each kind; 200 with APOTHEM_LONG=1.
TEST_CASE("a run that is killed at random ends with the same files", "[survival][slow]") {
  std::mt19937 random(41);
  for (const Victim& victim : victims()) {
    INFO(victim.name);
    const Folder folder;
    const std::string scene = folder.write("scene.json", victim.text);
    REQUIRE(run({"run", scene, "-o", folder / "whole", "--quiet"}, folder).code == 0);
    const int wanted = long_run() ? 40 : 2;
    int kills = 0;
    for (int tries = 0; kills < wanted && tries < 10 * wanted; ++tries) {
      std::filesystem::remove_all(folder / "parts");
      // Some runs are killed several times.
      for (bool over = false; !over;) {
        const double delay = .01 + victim.seconds * (static_cast<double>(random()) / 4.3e9);
        const bool spared = kills >= wanted || random() % 3 == 0;
        const Result part = run({"run", scene, "-o", folder / "parts", "--quiet", "--resume"},
                                folder, {.interrupt_after = spared ? 0 : delay, .signal = SIGKILL});
        INFO(part.err);
        REQUIRE((part.code == 0 || part.code == -SIGKILL));
        kills += part.code == -SIGKILL;
        over = part.code == 0;
      }
      check_same_files(folder / "whole", folder / "parts");
    }
    CHECK(kills > 0);
  }
}

TEST_CASE("the runs of a sweep that is killed end with it, and the same command goes on",
          "[survival][sweep][slow]") {
  const Folder folder;
  const std::string scene = folder.write("scene.json", victims()[0].text);
  const auto sweep = [&](const char* study) {
    return std::vector<std::string>{"sweep",        scene,    "--vary", "fill.0.seed=1..3", "-o",
                                    folder / study, "--jobs", "2",      "--quiet"};
  };
  REQUIRE(run(sweep("whole"), folder).code == 0);
  std::mt19937 random(42);
  const int wanted = long_run() ? 30 : 1;
  for (int kills = 0; kills < wanted; ++kills) {
    std::filesystem::remove_all(folder / "parts");
    const double delay = .05 + .4 * (static_cast<double>(random()) / 4.3e9);
    const Result killed =
        run(sweep("parts"), folder, {.interrupt_after = delay, .signal = SIGKILL});
    if (killed.code != -SIGKILL) continue;
    // Children finish their step; nobody holds a run any more soon after.
    int code = 130;
    for (int i = 0; i < 200 && code == 130; ++i) {
      code = run(sweep("parts"), folder).code;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    REQUIRE(code == 0);
    check_same_files(folder / "whole", folder / "parts");
  }
}

TEST_CASE("of many that start at the same time in a folder one runs", "[survival][slow]") {
  const Folder folder;
  const std::string scene = folder.write("scene.json", victims()[0].text);
  REQUIRE(run({"run", scene, "-o", folder / "whole", "--quiet"}, folder).code == 0);
  std::vector<pid_t> children;
  for (const char* way : {"--resume", "--overwrite", "--resume", "--overwrite"}) {
    const pid_t child = fork();
    if (child == 0) {
      const int nowhere = ::open("/dev/null", O_WRONLY);
      dup2(nowhere, 2);
      const std::string out = folder / "parts";
      execl(kProgram.c_str(), kProgram.c_str(), "run", scene.c_str(), "-o", out.c_str(), "--quiet",
            way, nullptr);
      _exit(127);
    }
    children.push_back(child);
  }
  int done = 0, refused = 0;
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    done += WIFEXITED(status) && WEXITSTATUS(status) == 0;
    refused += WIFEXITED(status) && WEXITSTATUS(status) == 2;
  }
  CHECK(done >= 1);  // one that comes later finds that the run has ended, or does it again
  CHECK(done + refused == 4);
  check_same_files(folder / "whole", folder / "parts");
}

TEST_CASE("a run that is killed twenty times ends as if it had not been", "[survival][slow]") {
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
