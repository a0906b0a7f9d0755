// What the program says of wrong uses: one line that names what is wrong and what would be right.
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "lib/dynamics/unstable.hpp"
#include "lib/run/warnings.hpp"
#include "lib/system/input_file.hpp"
#include "tests/folder.hpp"
#include "tests/program.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using test::Folder;
using test::lines;
using test::Result;

namespace {

using Words = std::vector<std::string>;

void check_words(const std::string& text, const Words& words) {
  for (const std::string& word : words) {
    INFO(text);
    CHECK(text.find(word) != std::string::npos);
  }
}

// A block over a floor that ends at x = 2, and a rule to stop.
std::string scene_with_rule(const std::string& rule, double x = 0) {
  return R"({ "gravity": [0, -10], "materials": { "rock": { "density": 2000 } },
    "contact": { "normal_stiffness": 1e7, "damping": { "model": "viscous", "ratio": 0.5 } },
    "bodies": [
      { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-2, -1], [2, -1], [2, 0], [-2, 0]] },
      { "name": "block", "material": "rock", "position": [)" +
         std::to_string(x) +
         R"(, 0.51], "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]] } ],
    "stop": [ { "name": "rest", )" +
         rule + R"( } ], "time": { "end": 2 }, "output": { "frames": 1 } })";
}

}  // namespace

TEST_CASE("wrong uses are named with their remedy", "[program][messages]") {
  const Folder folder;
  folder.write("scene.json", test::flying_block());
  folder.write("broken.json", test::flying_block("", R"(, "name": "two\nlines")"));
  REQUIRE(test::run({"run", folder / "scene.json", "-o", folder / "out", "--quiet"}, folder).code ==
          0);
  std::filesystem::create_directory(folder / "mine");
  folder.write("mine/run.json", "mine");
  const std::string scene = folder / "scene.json";
  struct Use {
    Words arguments, words;
    int code;
  };
  for (const Use& use : std::vector<Use>{
           {{"run", "-"}, {"-: is no file", "/dev/stdin"}, 2},
           {{"check", "-"}, {"-: is no file", "/dev/stdin"}, 2},
           {{"run", scene, "--set", "time.end=0,3"},
            {"must be a number", "set by time.end=0,3", "the number is written 0.3"},
            2},
           {{"run", scene, "--set", "a=0,3"}, {"unknown key \"a\"", "set by a=0,3"}, 2},
           {{"picture", folder / "out", "-o", folder / "no/x.png"},
            {"no/x.png: cannot be written: there is no folder", "make it"},
            4},
           {{"view", folder / "out", "-o", folder / "no/x.html"},
            {"there is no folder", "make it"},
            4},
           {{"run", scene, "-o", folder / "mine", "--overwrite"},
            {"mine/run.json: is in the way", "move it"},
            2},
           {{"check", folder / "broken.json"}, {"/name", "line breaks"}, 2}}) {
    CAPTURE(use.arguments);
    const Result result = test::run(use.arguments, folder);
    CHECK(result.code == use.code);
    CHECK(lines(result.err) == 1);
    check_words(result.err, use.words);
  }
}

TEST_CASE("a file that may not be read is no file of another name", "[program][messages]") {
  if (::geteuid() == 0) {
    // For root every file can be read: the words alone.
    CHECK(cannot_open("scene.json", EACCES).find("give yourself the right to read it") !=
          std::string::npos);
    CHECK(cannot_open("scene.json", ENOENT).find("check the name") != std::string::npos);
    return;
  }
  const Folder folder;
  const std::string file = folder.write("scene.json", test::flying_block());
  REQUIRE(::chmod(file.c_str(), 0) == 0);
  for (const char* command : {"run", "check", "polygon"}) {
    const Result result = test::run({command, file}, folder);
    CHECK(result.code == 2);
    check_words(result.err, {"Permission denied", "give yourself the right to read it"});
  }
}

TEST_CASE("GeoJSON with heights is read as without, by all commands", "[program][messages]") {
  const Folder folder;
  const std::string flat = folder.write(
      "flat.geojson",
      R"({ "type": "Polygon", "coordinates": [[[0, 0], [2, 0], [2, 1], [0, 1], [0, 0]]] })");
  const std::string high = folder.write(
      "high.geojson",
      R"({ "type": "Polygon", "coordinates": [[[0, 0, 7], [2, 0, 7], [2, 1, 8], [0, 1, 8], [0, 0, 7]]] })");
  for (const Words& rest : {Words{"polygon"}, Words{"mesh", "--voronoi", "3"}}) {
    Words with = rest, without = rest;
    with.insert(with.begin() + 1, high);
    without.insert(without.begin() + 1, flat);
    const Result expected = test::run(without, folder);
    CHECK(expected.code == 0);
    CHECK(test::run(with, folder).out == expected.out);
  }
  const std::string list = folder.write("list.json", "[[0, 0, 7], [2, 0, 7], [2, 1, 7]]");
  check_words(test::run({"polygon", list}, folder).err, {"has 3 coordinates", "[x, y]"});
}

TEST_CASE("polygon says what its numbers mean", "[program][messages]") {
  const Folder folder;
  const std::string long_one = folder.write("long.json", "[[0,0],[2,0],[2,1],[0,1]]");
  const std::string l = folder.write("l.json", "[[0,0],[4,0],[4,1],[1,1],[1,4],[0,4]]");
  const std::string two = folder.write(
      "two.json", "[[0,1],[1,0],[1.9,0.9],[3.1,0.9],[4,0],[5,1],[4,2],[3.1,1.1],[1.9,1.1],[1,2]]");
  const auto table = [&](const std::string& file, const char* reference) {
    return test::run({"polygon", file, "--reference", reference}, folder).out;
  };
  const std::string rectangle = table(long_one, "roof");
  CHECK((rectangle.find("(0.5, 0.5) to (1.5, 0.5) m") != std::string::npos ||
         rectangle.find("(1.5, 0.5) to (0.5, 0.5) m") != std::string::npos));
  CHECK(rectangle.find("attempt") == std::string::npos);
  CHECK(rectangle.find("in double precision") != std::string::npos);
  check_words(table(l, "inscribed_circle"), {"none: the roof does not reach the reference length"});
  // Two isolated centres are no segment.
  const std::string rooms = table(two, "roof");
  const size_t at = rooms.find("incircle centres");
  REQUIRE(at != std::string::npos);
  const std::string centres = rooms.substr(at, rooms.find('\n', at) - at);
  CHECK(centres.find(" to ") == std::string::npos);
  CHECK(centres.find("), (") != std::string::npos);
}

TEST_CASE("check has one plan: steps, output and depths", "[program][messages]") {
  const Folder folder;
  const std::string file = folder.write("scene.json", scene_with_rule(R"("kinetic_per_body": 1)"));
  const std::string plan = test::run({"check", file}, folder).out;
  check_words(plan, {"of steps, of which", "of output", "files and", "by weight, about",
                     "in the first impacts about"});
  size_t depths = 0;
  for (size_t k = plan.find("\npenetration"); k != std::string::npos;
       k = plan.find("\npenetration", k + 1)) {
    ++depths;
  }
  CHECK(depths == 1);
}

TEST_CASE("rules that cannot end a run are named", "[program][messages]") {
  const Folder folder;
  struct Rule {
    std::string text;
    double x;
    Words words;  // none: no warning
  };
  for (const Rule& rule : std::vector<Rule>{
           {R"("kinetic_per_body": 1)", 0, {}},
           {R"("count_above": 1)", 0, {}},
           {R"("count_above": 2)", 0, {"waits for 2 free bodies, and there are 1", "count_above"}},
           {R"("count_below": 0)", 0, {"never fewer than 0 bodies"}},
           {R"("kinetic_per_body": 1, "for": 3)", 0, {"more than the 2 s of the run"}},
           {R"("kinetic_per_body": 1, "after": 3)", 0, {"more than the 2 s of the run"}}}) {
    CAPTURE(rule.text);
    const std::string file = folder.write("scene.json", scene_with_rule(rule.text, rule.x));
    const std::string plan = test::run({"check", file}, folder).out;
    CHECK((plan.find("warning: ") == std::string::npos) == rule.words.empty());
    check_words(plan, rule.words);
  }
}

TEST_CASE("a rule that waits for rest is in vain where bodies fall for ever", "[run][messages]") {
  const Folder folder;
  // The block begins beside the floor, and passes it.
  const Scene scene = test::scene_of(folder, scene_with_rule(R"("kinetic_per_body": 1)", 5));
  Run run(scene, {.folder = folder / "out"});
  CHECK(run.warnings().empty());
  REQUIRE(run.run() == Run::Status::done);
  REQUIRE(run.warnings().size() == 1);
  check_words(run.warnings()[0], {"\"block\" falls and nothing is below", "\"rest\"", "remove"});
  const Scene caught = test::scene_of(folder, scene_with_rule(R"("kinetic_per_body": 1)"));
  Run resting(caught, {.folder = folder / "rest"});
  REQUIRE(resting.run() == Run::Status::done);
  CHECK(resting.stopped_by() == "rest");
  CHECK(resting.warnings().empty());
}

TEST_CASE("what helps is the key that the scene has", "[run][messages]") {
  TimeSettings time;
  const auto said = [&](const char* text) { return with_key_of_step(text, time); };
  CHECK(said("unstable; reduce the time step") == "unstable; reduce time.accuracy");
  CHECK(said("the time step is long; give less") == "the time step is long; give less");
  CHECK(said("reduce the load or the time step, or raise x") ==
        "reduce the load or time.accuracy, or raise x");
  time.safety = .1;
  CHECK(said("reduce the time step") == "reduce time.safety");
  time.fixed_step = 1e-3;
  CHECK(said("reduce the time step") == "reduce time.step");
  // A run says it so: the block passes a quarter of its inradius in a step.
  const Folder folder;
  Run run(test::scene_of(folder, R"({ "materials": { "rock": { "density": 2000 } },
    "contact": { "normal_stiffness": 1e3 },
    "bodies": [
      { "name": "wall", "material": "rock", "motion": "fixed", "polygon": [[3, 0], [4, 0], [4, 1], [3, 1]] },
      { "name": "block", "material": "rock", "velocity": [300, 0], "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]] } ],
    "time": { "end": 1, "step": 1e-2 }, "output": { "frames": 1 } })"),
          {.folder = folder / "out"});
  CHECK_THROWS_AS(run.advance(), Unstable);
  check_words(run.message(), {"would be missed", "reduce time.step"});
}
