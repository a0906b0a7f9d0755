// apothem picture, and run --picture.
#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/folder.hpp"
#include "tests/pixels.hpp"
#include "tests/program.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

const std::string kFallToDraw =
    R"({ "gravity": [0, -9.81], "materials": { "rock": { "density": 2000 } },
  "bodies": [ { "name": "block", "material": "rock", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]] } ],
  "time": { "end": 0.01, "step": 1e-3 }, "output": { "frames": 2, "history": { "interval": 1e-3 } } })";

}  // namespace

TEST_CASE("run --picture draws the end, and picture draws it again", "[program][slow]") {
  const Folder folder;
  const std::string scene = folder.write("fall.json", kFallToDraw), out = folder / "fall";
  const Result ran = run({"run", scene, "-o", out, "--picture"}, folder);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, Catch::Contains(out + "/picture.png"));
  const std::string drawn = content(out + "/picture.png");
  CHECK(decode(drawn).width > 400);
  CHECK(run({"run", scene, "-o", out, "--overwrite"}, folder).code == 0);
  CHECK_FALSE(std::filesystem::exists(out + "/picture.png"));  // not of this run
  const Result again = run({"picture", out}, folder);
  CHECK(again.code == 0);
  CHECK(again.out == out + "/picture.png\n");
  CHECK(content(out + "/picture.png") == drawn);

  for (const std::vector<std::string>& options : std::initializer_list<std::vector<std::string>>{
           {"--strip", "3"},
           {"--time", "0.004"},
           {"--colour", "material", "--chains"},
           {"--deformation", "100"},
           {"--window", "-1,-1,2,2", "--range", "0,1"}}) {
    std::vector<std::string> words{"picture", out, "-o", folder / "other.svg"};
    words.insert(words.end(), options.begin(), options.end());
    const Result r = run(words, folder);
    INFO(options[0] << ": " << r.err);
    CHECK(r.code == 0);
    CHECK_THAT(content(folder / "other.svg"), Catch::Contains("</svg>"));
  }
  if (std::system("command -v gnuplot > /dev/null 2>&1") != 0) return;
  const Result plot = run({"picture", out, "--plot", "energy"}, folder);
  CHECK(plot.code == 0);
  CHECK(decode(content(out + "/energy.png")).width > 400);
  CHECK(run({"picture", out, "--plot", "history", "--columns", "block.y", "-o", folder / "y.svg"},
            folder)
            .code == 0);
}

TEST_CASE("a picture that cannot be made has one reason and leaves no file", "[program][slow]") {
  const Folder folder;
  const std::string scene = folder.write("fall.json", kFallToDraw), out = folder / "fall";
  REQUIRE(run({"run", scene, "-o", out}, folder).code == 0);
  struct Case {
    std::vector<std::string> arguments;
    int code;
    const char* message;
  };
  for (const Case& c : std::initializer_list<Case>{
           {{folder / "none"}, 2, "there is no such folder"},
           {{folder.path()}, 2, "frames.pvd: there is no such file"},
           {{out, "--colour", "hue"}, 2, "hue"},
           {{out, "--colour", "von_mises"}, 2, "no body is of finite elements"},
           {{out, "--roses"}, 2, "\"regions\""},
           {{out, "--time", "7"}, 2, "there is no frame at 7 s; there are 3 from 0 s to 0.01 s"},
           {{out, "--time", "0", "--strip", "2"}, 2, "--time"},
           {{out, "--strip", "0"}, 2, "--strip"},
           {{out, "--window", "0,0,1"}, 2, "--window"},
           {{out, "--window", "0,0,0,1"}, 2, "two opposite corners"},
           {{out, "--window=-1e308,0,1e308,1"}, 2, "--window"},
           {{out, "--range", "1,0"}, 2, "LOW below HIGH"},
           {{out, "--colour", "material", "--range", "0,1"}, 2, "materials have names"},
           {{out, "--plot", "regions"}, 2, "has no regions"},
           {{out, "--plot", "history", "--columns", "block.z"}, 2, "no column \"block.z\""},
           {{out, "--columns", "x"}, 2, "--plot"},
           {{out, "-o", folder / "a.jpg"}, 2, "must end in .png or .svg"},
           {{out, "-o", folder / "none/a.png"}, 4, "a.png: cannot be written"}}) {
    std::vector<std::string> words{"picture"};
    words.insert(words.end(), c.arguments.begin(), c.arguments.end());
    const Result r = run(words, folder);
    INFO(r.err);
    CHECK(r.code == c.code);
    CHECK(lines(r.err) == 1);
    CHECK_THAT(r.err, Catch::Contains(c.message));
    CHECK(r.out.empty());
  }
  CHECK_FALSE(std::filesystem::exists(out + "/picture.png"));
  // A frame that has been cut off: VTK has messages of its own for that.
  std::filesystem::resize_file(out + "/frames/bodies_000002.vtu", 3000);
  const Result damaged = run({"picture", out}, folder);
  INFO(damaged.err);
  CHECK(damaged.code == 2);
  CHECK(lines(damaged.err) == 1);
}

TEST_CASE("a plot on a full disk is no plot, and the older one stays", "[program]") {
  if (std::system("command -v gnuplot > /dev/null 2>&1") != 0) return;
  const Folder folder;
  const std::string scene = folder.write("fall.json", kFallToDraw), out = folder / "fall";
  REQUIRE(run({"run", scene, "-o", out}, folder).code == 0);
  for (const char* name : {"/energy.png", "/energy.svg"}) {
    const std::vector<std::string> words{"picture", out, "--plot", "energy", "-o", out + name};
    REQUIRE(run(words, folder).code == 0);
    const std::string before = content(out + name);
    CHECK(run(words, folder, {.file_size = 6000}).code == 4);
    CHECK(content(out + name) == before);
  }
}

TEST_CASE("a run whose picture cannot be drawn is complete", "[program]") {
  const Folder folder;
  const std::string scene = folder.write("fall.json", kFallToDraw), out = folder / "fall";
  const Result r = run({"run", scene, "-o", out, "--picture"}, folder, {.file_size = 16000});
  INFO(r.err);
  CHECK(r.code == 4);
  CHECK_THAT(r.err, Catch::Contains("no picture"));
  CHECK_THAT(r.out, Catch::Contains("energy error"));
  CHECK_THAT(content(out + "/run.json"), Catch::Contains("\"done\""));
}

TEST_CASE("a folder whose name is no UTF-8 has pictures", "[program]") {
  const Folder folder;
  const std::string scene = folder.write("fall.json", kFallToDraw), out = folder / "l\xe4";
  const Result r = run({"run", scene, "-o", out, "--picture", "--quiet"}, folder);
  INFO(r.err);
  CHECK(r.code == 0);
  CHECK(std::filesystem::exists(out + "/picture.png"));
}
