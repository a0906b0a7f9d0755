// What is refused before it is opened: no input may be without end.
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "lib/system/input_file.hpp"
#include "tests/folder.hpp"
#include "tests/program.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// The commands that read a file which a user names.
std::vector<std::vector<std::string>> readers_of(const std::string& file, const Folder& folder) {
  return {{"check", file},
          {"polygon", file},
          {"polygon", "--batch", file},
          {"contact", file, file},
          {"contact", "--batch", file},
          {"mesh", file},
          {"mesh", file, "--voronoi", "4"},
          {"accuracy", "--cases", file, "-o", folder / "accuracy"}};
}

}  // namespace

TEST_CASE("named pipes, devices, folders and large files are refused unopened", "[input]") {
  const Folder folder;
  const std::string pipe = folder / "pipe", zeros = folder / "zeros.msh", large = folder / "large";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  std::filesystem::create_symlink("/dev/zero", zeros);
  folder.write("large", "");
  std::filesystem::resize_file(large, 3 << 20);  // a hole
  CHECK(refusal_of_input(pipe).find("named pipe") != std::string::npos);
  CHECK(refusal_of_input(zeros).find("device") != std::string::npos);
  CHECK(refusal_of_input(folder.path()).find("directory") != std::string::npos);
  CHECK(refusal_of_input(folder / "none").find("check the name") != std::string::npos);
  CHECK(refusal_of_input(large).empty());
  CHECK(refusal_of_input(large, 3 << 20).empty());
  const std::string refusal = refusal_of_input(large, 2 << 20);
  CHECK(refusal.find("2 MiB") != std::string::npos);
  CHECK(refusal.find("APOTHEM_INPUT_LIMIT") != std::string::npos);
}

TEST_CASE("every kind of input without end is refused at once", "[input][program][slow]") {
  const Folder folder;
  const std::string pipe = folder / "pipe", zeros = folder / "zeros.msh";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  std::filesystem::create_symlink("/dev/zero", zeros);
  std::filesystem::create_directories(folder / "run");
  folder.write("run/frames.pvd", "<VTKFile></VTKFile>");
  for (const char* name : {"checkpoint.json", "energy.csv", "names.csv", "run.json"}) {
    std::filesystem::create_symlink(pipe, folder / "run/" + name);
  }
  const auto scene = [&](const std::string& name, const std::string& rest) {
    return folder.write(name, R"({ "materials": { "rock": { "density": 1 } }, "time": { "end": 1 },
      "contact": { "normal_stiffness": 1 }, )" +
                                  rest + " }");
  };
  const std::string good = scene("good.json", R"("bodies": [ { "name": "a", "material": "rock",
      "polygon": [[0,0],[1,0],[0,1]] } ])");
  for (const std::string& file : {pipe, zeros}) {
    const std::string drawing =
        scene("drawing.json", R"("import": [ { "file": ")" + file + R"(", "material": "rock" } ])");
    const std::string mesh =
        scene("mesh.json", R"("bodies": [ { "name": "a", "material": "rock", "mesh": { "file": ")" +
                               file + R"(" } } ])");
    std::vector<std::vector<std::string>> commands = readers_of(file, folder);
    commands.insert(commands.end(),
                    {{"run", file},
                     {"check", drawing},
                     {"check", mesh},
                     {"sweep", good, "--table", file, "--dry-run", "-o", folder / "sweep"},
                     {"run", good, "-o", folder / "run", "--resume"},
                     {"picture", folder / "run", "--plot", "energy"},
                     {"view", folder / "run"}});
    for (const std::vector<std::string>& words : commands) {
      const Result r = run(words, folder, {.memory = 2UL << 30, .most_seconds = 5});
      INFO(words[0] << ' ' << words[1] << ": " << r.err);
      CHECK(r.code == 2);
      CHECK(lines(r.err) == 1);
    }
  }
}

TEST_CASE("no message quotes a file that is another one than it should be",
          "[input][program][slow]") {
  const Folder folder;
  const std::string text = "secret:$6$longsecret:19000:0:99999:7:::\nother:secret:1:2\n";
  for (const char* name : {"f", "f.json", "f.msh", "f.dxf", "f.wkt", "f.csv", "f.geojson"}) {
    const std::string file = folder.write(name, text);
    for (const std::vector<std::string>& words : readers_of(file, folder)) {
      const Result r = run(words, folder);
      INFO(words[0] << ' ' << words[1] << ": " << r.err << r.out);
      CHECK(r.code == 2);
      CHECK((r.err + r.out).find("secret") == std::string::npos);
    }
  }
}

TEST_CASE("the limit of input files can be raised and lowered", "[input][program]") {
  const Folder folder;
  const std::string file = folder.write("a.wkt", "POLYGON ((0 0, 1 0, 0 1))");
  CHECK(run({"polygon", file}, folder, {.environment = {"APOTHEM_INPUT_LIMIT=1"}}).code == 0);
  const std::string large =
      folder.write("large.wkt", "POLYGON ((0 0, 1 0, 0 1))" + std::string(2 << 20, ' '));
  CHECK(run({"polygon", large}, folder).code == 0);
  const Result r = run({"polygon", large}, folder, {.environment = {"APOTHEM_INPUT_LIMIT=1"}});
  CHECK(r.code == 2);
  CHECK(r.err.find("larger than 1 MiB") != std::string::npos);
}
