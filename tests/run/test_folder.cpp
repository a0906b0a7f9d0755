// One run at a time writes to a folder, and touches there only what an earlier run has made.
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <map>

#include "lib/run/folder.hpp"
#include "lib/run/hash.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;
namespace fs = std::filesystem;

namespace folders {
namespace {

Scene block(const Folder& folder) { return scene_of(folder, flying_block()); }

// The names and contents of all files.
std::map<std::string, std::string> everything(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[entry.path().string()] = content(entry.path().string());
  }
  return files;
}

void refused(const Scene& scene, const RunSettings& settings, const char* why) {
  const auto before = everything(settings.folder);
  CHECK_THROWS_WITH(Run(scene, settings), Catch::Contains(why));
  CHECK_THROWS_AS(Run(scene, settings), SceneError);
  CHECK((everything(settings.folder) == before));
}

}  // namespace

TEST_CASE("a folder in which a run writes is refused to another one", "[folder]") {
  const Folder folder;
  const Scene scene = block(folder);
  const std::string out = folder / "out";
  {
    Run run(scene, {.folder = out});
    run.advance(.1);
    for (const bool resume : {false, true}) {
      run.save(folder / "out/state.json");
      if (resume) fs::copy(folder / "out/state.json", folder / "out/checkpoint.json");
      CHECK_THROWS_WITH(Run(scene, {.folder = out, .resume = resume, .overwrite = !resume}),
                        Catch::Contains("is in use"));
    }
    REQUIRE(run.run() == Run::Status::done);
    CHECK_NOTHROW(Run(scene, {.folder = out, .overwrite = true}));
  }
}

TEST_CASE("a lock ends with its process, however that ends", "[folder]") {
  const Folder folder;
  fs::create_directory(folder / "out");
  const pid_t child = fork();
  if (child == 0) {
    FileList list(folder / "out");
    const bool locked = list.lock();
    if (locked) list.begin("x", {"run.json"});
    while (locked) pause();
    _exit(1);
  }
  while (content(folder / "out/run.files").empty()) usleep(1000);
  FileList list(folder / "out");
  CHECK_FALSE(list.lock());
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  CHECK(list.lock());
  CHECK(list.identity() == "x");
  CHECK(list.has("run.json"));
}

TEST_CASE("files of nobody's run stay where they are", "[folder]") {
  const Folder folder;
  const Scene scene = block(folder);
  const std::string out = folder / "out";
  fs::create_directories(out + "/frames");
  folder.write("out/frames/bodies_mine.vtu", "mine");
  folder.write("out/notes.txt", "mine");
  CHECK(Run(scene, {.folder = out}).run() == Run::Status::done);
  CHECK(Run(scene, {.folder = out, .overwrite = true}).run(.2) == Run::Status::done);
  CHECK(content(out + "/frames/bodies_mine.vtu") == "mine");
  CHECK(content(out + "/notes.txt") == "mine");
  CHECK_FALSE(fs::exists(out + "/frames/bodies_000004.vtu"));  // of the first run only
  for (const char* name : {"frames/bodies_000007.vtu", "history.csv.x", "picture.png"}) {
    folder.write(std::string("out/") + name, "mine");
  }
  refused(scene, {.folder = out, .overwrite = true}, "frames/bodies_000007.vtu: is in the way");
  fs::remove(out + "/frames/bodies_000007.vtu");
  refused(scene, {.folder = out, .overwrite = true, .other_files = {"picture.png"}},
          "picture.png: is in the way");
  CHECK(Run(scene, {.folder = out, .overwrite = true}).run() == Run::Status::done);
  CHECK(content(out + "/picture.png") == "mine");
}

TEST_CASE("names of results in a folder without a run are not taken", "[folder]") {
  for (const char* name : {"history.csv", "run.json", "run.files", "frames/chains_000000.vtu"}) {
    INFO(name);
    const Folder folder;
    const Scene scene = block(folder);
    fs::create_directories(folder / "out/frames");
    folder.write(std::string("out/") + name, "mine");
    for (const bool overwrite : {false, true}) {
      refused(scene, {.folder = folder / "out", .overwrite = overwrite}, "is in the way");
    }
  }
}

TEST_CASE("an input is never replaced", "[folder]") {
  const Folder folder;
  // As results of an earlier run, so that their names are on its list.
  REQUIRE(Run(block(folder), {.folder = folder / "out"}).run(.2) == Run::Status::done);
  fs::copy(folder / "scene.json", folder / "out/run.json", fs::copy_options::overwrite_existing);
  const Scene own = read_scene(folder / "out/run.json");
  refused(own, {.folder = folder / "out", .overwrite = true}, "is read by this run");
  refused(block(folder), {.folder = folder / "out", .overwrite = true, .from = folder / "out"},
          "is read by this run");
  folder.write("out/names.csv", "[[0, 0], [1, 0], [1, 1]]");
  fs::create_directory(folder / "named");
  std::string text = flying_block();
  const std::string polygon = "[[0, 0], [1, 0], [1, 1], [0, 1]]";
  text.replace(text.find(polygon), polygon.size(), "\"names.csv\"");
  const Scene named = read_scene(folder.write("out/scene.json", text));
  refused(named, {.folder = folder / "out", .overwrite = true}, "names.csv: is read by this run");
}

TEST_CASE("no link leads out of the folder", "[folder]") {
  const Folder folder;
  const Scene scene = block(folder);
  REQUIRE(Run(scene, {.folder = folder / "out"}).run(.2) == Run::Status::done);
  fs::rename(folder / "out/frames", folder / "elsewhere");
  fs::create_directory_symlink(folder / "elsewhere", folder / "out/frames");
  const auto before = everything(folder / "elsewhere");
  refused(scene, {.folder = folder / "out", .overwrite = true}, "frames: is a link");
  refused(scene, {.folder = folder / "out", .resume = true}, "frames: is a link");
  CHECK((everything(folder / "elsewhere") == before));
  fs::remove(folder / "out/frames");
  const std::string mine = folder.write("mine.csv", "mine");
  fs::remove(folder / "out/history.csv");
  fs::create_symlink(mine, folder / "out/history.csv");
  REQUIRE(Run(scene, {.folder = folder / "out", .overwrite = true}).run() == Run::Status::done);
  CHECK(content(mine) == "mine");
  CHECK_FALSE(fs::is_symlink(folder / "out/history.csv"));
}

TEST_CASE("results of an earlier version, without a list, can be replaced", "[folder]") {
  const Folder folder;
  const Scene scene = block(folder);
  REQUIRE(Run(scene, {.folder = folder / "out"}).run() == Run::Status::done);
  fs::remove(folder / "out/run.files");
  CHECK_THROWS_WITH(Run(scene, {.folder = folder / "out"}), Catch::Contains("--overwrite"));
  REQUIRE(Run(scene, {.folder = folder / "out", .overwrite = true}).run(.2) == Run::Status::done);
  CHECK_FALSE(fs::exists(folder / "out/frames/bodies_000005.vtu"));
}

TEST_CASE("what there is in a folder decides what --resume does", "[folder]") {
  const Folder folder;
  const Scene scene = block(folder);
  const std::string out = folder / "out", hash = scene_hash(scene);
  CHECK(look_into(out, hash) == Found::nothing);
  CHECK_FALSE(fs::exists(out));
  { Run(scene, {.folder = out}).advance(.1); }  // ends without a word, as if killed
  CHECK(look_into(out, hash) == Found::broken_off);
  CHECK(look_into(out, "another") == Found::other);
  Run(scene, {.folder = out, .overwrite = true}).run(.1);
  CHECK(look_into(out, hash) == Found::checkpoint);
  fs::remove(out + "/checkpoint.json");
  CHECK(look_into(out, hash) == Found::other);  // somebody has taken it away
  Run(scene, {.folder = out, .overwrite = true}).run();
  CHECK(look_into(out, hash) == Found::ended);
  CHECK(look_into(out, "another") == Found::other);
}

}  // namespace folders
