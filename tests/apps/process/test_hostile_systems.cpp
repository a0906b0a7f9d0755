// What the program does where the system fails it, as docs/system-failures.md says: what it
// returns, that it says so in one sentence, and that what is left can be read.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "lib/output/history.hpp"
#include "lib/output/run_folder.hpp"
#include "tests/program.hpp"
#include "tests/run/hopper.hpp"

using namespace apothem;
using namespace apothem::test;

namespace hostile {
namespace {

const std::string kMeshed = kSource + "/data/scenes/meshed-incline.json";

// A scene of rigid blocks with a cross, whose skeleton a helper constructs.
std::string pile(const Folder& folder, const std::string& frames = "6") {
  return folder.write(
      "pile.json", exchanged(hopper("remove", kStops), "\"frames\": 6", "\"frames\": " + frames));
}

std::string executable(const Folder& folder, const std::string& name, const std::string& text) {
  const std::string file = folder.write(name, "#!/bin/sh\n" + text);
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  return file;
}

const std::string kCross = "POLYGON ((1 0, 2 0, 2 1, 3 1, 3 2, 2 2, 2 3, 1 3, 1 2, 0 2, 0 1, 1 1))";

}  // namespace

TEST_CASE("memory that ends anywhere is one sentence and exit code 4", "[hostile]") {
  if (kSanitized) return;  // it cannot be bounded there
  const Folder folder;
  const std::string scene = pile(folder);
  REQUIRE(run({"run", scene, "-o", folder / "done", "--quiet"}, folder).code == 0);
  const std::vector<std::vector<std::string>> commands{
      {"run", kMeshed, "-o", folder / "out", "--overwrite", "--quiet", "--until", "0.001",
       "--threads", "2"},
      {"run", scene, "-o", folder / "out", "--overwrite", "--quiet", "--until", "0.01"},
      {"view", folder / "done", "-o", folder / "view.html"},
      {"picture", folder / "done", "-o", folder / "picture.png"}};
  int without = 0;
  const rlim_t step = long_run() ? 512 << 10 : 6 << 20;
  for (rlim_t memory = 48 << 20; memory < 110 << 20; memory += step) {
    for (const std::vector<std::string>& words : commands) {
      const Result r = run(words, folder, {.memory = memory, .most_seconds = 60});
      INFO(words[0] << ' ' << words[1] << " with " << memory << ": " << r.err);
      if (r.code == 127) continue;  // not enough for the libraries of the program
      CHECK((r.code == 0 || r.code == 4));
      if (r.code != 4) continue;
      ++without;
      CHECK(lines(r.err) == 1);
      CHECK(r.err.starts_with("apothem: "));
    }
  }
  CHECK(without > 0);
}

TEST_CASE("few descriptors are one sentence and exit code 4", "[hostile][slow]") {
  const Folder folder;
  const std::string scene = pile(folder);
  int without = 0;
  for (rlim_t descriptors = 4; descriptors < 14; ++descriptors) {
    const Result r =
        run({"run", scene, "-o", folder / "out", "--overwrite", "--quiet", "--until", "0.01"},
            folder, {.descriptors = descriptors, .most_seconds = 60});
    INFO(descriptors << ": " << r.err);
    if (r.code == 127) continue;  // not enough for the libraries of the program
    CHECK((r.code == 0 || r.code == 4 || r.code == 2));
    without += r.code != 0;
    if (r.code != 0) CHECK(lines(r.err) == 1);
  }
  CHECK(without > 0);
}

TEST_CASE("closed screens are no place for results, nor results for the screen",
          "[hostile][slow]") {
  const Folder folder;
  const std::string scene = pile(folder);
  const Result r = run({"run", scene, "-o", folder / "a"}, folder, {.closed_screens = true});
  REQUIRE(r.code == 0);
  REQUIRE(run({"run", scene, "-o", folder / "b", "--quiet"}, folder).code == 0);
  for (const char* name : {"/history.csv", "/energy.csv", "/momentum.csv"}) {
    CHECK((content(folder / "a" + name) == content(folder / "b" + name)));
  }
  CHECK(run({"picture", folder / "b", "--plot", "energy", "-o", folder / "e.png"}, folder,
            {.closed_screens = true})
            .code == 0);
}

TEST_CASE("a folder that vanishes ends the run with exit code 4", "[hostile]") {
  const Folder folder;
  const std::string scene = pile(folder, "2000"), out = folder / "out";
  std::thread remover([&] {
    for (int i = 0; i < 6000 && !std::filesystem::exists(out + "/frames.pvd"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::error_code error;
    for (int i = 0; i < 100 && std::filesystem::exists(out); ++i) {
      std::filesystem::remove_all(out, error);
    }
  });
  const Result r = run({"run", scene, "-o", out, "--quiet"}, folder, {.most_seconds = 100});
  remover.join();
  INFO(r.err);
  CHECK(r.code == 4);
  // It depends on what is written first after that.
  const bool unwritable = r.err.find("cannot be written") != std::string::npos;
  CHECK((unwritable || r.err.find("has been deleted") != std::string::npos));
}

TEST_CASE("helpers that fail are said and leave nothing behind", "[hostile]") {
  const Folder folder;
  const std::string cross = folder.write("cross.wkt", kCross);
  for (const std::string& helper : {executable(folder, "killed", "kill -9 $$\n"),
                                    executable(folder, "fails", "exit 3\n"), folder / "missing"}) {
    const Result r =
        run({"polygon", cross}, folder,
            {.environment = {"APOTHEM_SKELETON_PROGRAM=" + helper}, .most_seconds = 60});
    INFO(helper << ": " << r.code << r.err);
    CHECK((r.code == 0 || r.code == 2 || r.code == 4));
    if (r.code != 0) CHECK(lines(r.err) == 1);
  }
  // A helper that stalls does not keep the program from ending.
  const std::string stalls = executable(folder, "stalls", "exec sleep 100\n");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"polygon", cross}, {"run", pile(folder), "-o", folder / "out"}}) {
    const Result r = run(words, folder,
                         {.interrupt_after = .5,
                          .signal = SIGTERM,
                          .environment = {"APOTHEM_SKELETON_PROGRAM=" + stalls},
                          .most_seconds = 5});
    INFO(words[0] << ": " << r.err);
    CHECK((r.code == 130 || r.code == 0));
  }
}

TEST_CASE("a full standard output is exit code 4", "[hostile]") {
  const Folder folder;
  const std::string cross = folder.write("cross.wkt", kCross);
  const std::string command = kProgram + " polygon " + cross + " > /dev/full 2> " + folder / "err";
  CHECK(WEXITSTATUS(std::system(command.c_str())) == 4);
  CHECK(lines(content(folder / "err")) == 1);
}

}  // namespace hostile
