// The habits of a command line: hints, JSON, settings, completion, the manual page.
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/folder.hpp"
#include "tests/program.hpp"

using namespace apothem;
using namespace apothem::test;
using Json = nlohmann::json;

namespace {

const std::string kFall = R"({ "$schema": "../docs/scene.schema.json",
  "gravity": [0, -9.81], "materials": { "rock": { "density": 2000 } },
  "bodies": [ { "name": "block", "material": "rock", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]] } ],
  "time": { "end": 0.01, "step": 1e-3 }, "output": { "frames": 2, "history": { "interval": 1e-3 } } })";

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// What a command of the shell prints.
Result shell(const Folder& folder, const std::string& command) {
  const std::string out = folder / "shell.out", err = folder / "shell.err";
  const int status = std::system(("( " + command + " ) > " + out + " 2> " + err).c_str());
  return {WEXITSTATUS(status), content(out), content(err)};
}

bool present(const char* program) {
  return std::system((std::string("command -v ") + program + " > /dev/null 2>&1").c_str()) == 0;
}

}  // namespace

TEST_CASE("a misspelt command line says what it may have meant and where help is", "[program]") {
  const Folder folder;
  struct Case {
    std::vector<std::string> arguments;
    const char *hint, *help;
  };
  for (const Case& c : std::initializer_list<Case>{
           {{"rum"}, "unknown command \"rum\"; did you mean \"run\"?", "see apothem --help"},
           {{"polygn", "a.wkt"}, "did you mean \"polygon\"?", "see apothem --help"},
           {{"xyzzy"},
            "unknown command \"xyzzy\" (known: run, sweep, picture,",
            "see apothem --help"},
           {{"scene.json"}, "did you mean \"apothem run scene.json\"?", "see apothem --help"},
           {{"--versoin"}, "did you mean \"--version\"?", "see apothem --help"},
           {{"run"}, "SCENE is required", "see apothem run --help"},
           {{"run", "a.json", "--thread", "2"},
            "unknown option \"--thread\"; did you mean \"--threads\"?",
            "see apothem run --help"},
           {{"run", "a.json", "--out", "b"}, "did you mean \"--output\"?", "apothem run --help"},
           {{"run", "a.json", "--treads=2"}, "did you mean \"--threads\"?", "apothem run --help"},
           {{"run", "a.json", "--threads", "no"}, "--threads", "see apothem run --help"},
           {{"run", "a.json", "b.json"}, "\"b.json\" is one argument too many", "apothem run"},
           {{"check"}, "SCENE is required", "see apothem check --help"},
           {{"contact", "a", "b", "--methd", "edge"},
            "did you mean \"--method\"?",
            "see apothem contact --help"}}) {
    const Result r = run(c.arguments, folder);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(lines(r.err) == 1);
    CHECK(r.out.empty());
    CHECK(has(r.err, c.hint));
    CHECK(has(r.err, c.help));
  }
}

TEST_CASE("a number on the command line is decimal", "[program]") {
  const Folder folder;
  const std::string scene = folder.write("fall.json", kFall);
  CHECK(has(run({"run", scene, "--until", "0x1p-8"}, folder).err, "must be a positive number"));
  CHECK(has(run({"polygon", scene, "--reference", "0x1"}, folder).err, "positive length"));
  CHECK(has(run({"run", scene, "--threads", "0x2"}, folder).err, "must be a whole number"));
  CHECK(has(run({"accuracy", "--repeat", "0x2"}, folder).err, "must be a whole number"));
  const std::string region = folder.write("region.json", "[[0,0],[1,0],[1,1],[0,1]]");
  const Result ten = run({"mesh", region, "--voronoi", "010"}, folder);
  CHECK(ten.code == 0);
  CHECK(Json::parse(ten.out)["cells"].size() == 10);
}

TEST_CASE("run --json prints one object: run.json, the message and the folder", "[program]") {
  const Folder folder;
  const std::string scene = folder.write("fall.json", kFall);
  const Result r = run({"run", scene, "-o", folder / "fall", "--json"}, folder);
  REQUIRE(r.code == 0);
  Json printed = Json::parse(r.out);
  CHECK(printed["status"] == "done");
  CHECK(printed["message"] == "");
  CHECK(printed["folder"] == folder / "fall");
  printed.erase("message");
  printed.erase("folder");
  const Json kept = Json::parse(content(folder / "fall/run.json"));
  for (const auto& [key, value] : kept.items()) {
    if (key != "wall_time" && key != "processor_time" && key != "steps_per_second")
      CHECK(printed[key] == value);
  }
  CHECK(printed.size() == kept.size());

  const Result again = run({"run", scene, "-o", folder / "fall", "--json"}, folder);
  CHECK(again.code == 2);
  CHECK(has(Json::parse(again.out)["error"].get<std::string>(), "already holds results"));
  CHECK(Json::parse(again.out)["file"] == folder / "fall");
  CHECK(lines(again.err) == 1);
}

TEST_CASE("check --json prints the plan", "[program]") {
  const Folder folder;
  const Result r = run({"check", kSource + "/data/scenes/cantilever-q4.json", "--json"}, folder);
  REQUIRE(r.code == 0);
  const Json beam = Json::parse(r.out);
  CHECK(beam["elements"] == 1000);
  CHECK(beam["nodes"] == 1111);
  REQUIRE(beam["bodies"].size() == 1);
  CHECK(beam["bodies"][0]["kind"] == "deformable");
  CHECK(beam["bodies"][0]["element"] == "Q4");
  CHECK(beam["bodies"][0]["elements"] == 1000);
  CHECK(beam["terms"].size() == 3);
  CHECK(beam["time_step"]["step"] > 0);
  CHECK(has(beam["time_step"]["limited_by"].get<std::string>(), "element"));

  const std::string scene = folder.write("fall.json", kFall);
  const Json fall = Json::parse(run({"check", scene, "--json"}, folder).out);
  CHECK(fall["bodies"][0] == Json{{"name", "block"},
                                  {"kind", "rigid"},
                                  {"material", "rock"},
                                  {"motion", "free"},
                                  {"vertices", 4},
                                  {"area", 1.},
                                  {"mass", 2000.},
                                  {"inradius", .5}});
  CHECK(fall["time_step"]["steps"] == 10);
  CHECK(fall["time_step"]["automatic"] == false);
  CHECK(fall["output"]["checkpoint_interval"] == 600);
  CHECK(fall["terms"].empty());
}

TEST_CASE("where JSON is asked for, an error is an object with its place", "[program]") {
  const Folder folder;
  const std::string bad = folder.write("bad.json", "{\n \"materials\": {},\n \"bodies\": 1 }");
  const Result r = run({"check", bad, "--json"}, folder);
  CHECK(r.code == 2);
  CHECK(lines(r.out) == 1);
  const Json error = Json::parse(r.out);
  CHECK(error["file"] == bad);
  CHECK(error["line"] == 2);
  CHECK(error["pointer"] == "/materials");
  CHECK(error["error"].get<std::string>().size() > 10);
  CHECK(has(r.err, bad + ":2: /materials: " + error["error"].get<std::string>()));
  CHECK(Json::parse(run({"run", "--json"}, folder).out)["error"] ==
        "SCENE is required; see apothem run --help");
  const Json ring = Json::parse(
      run({"polygon", folder.write("r.wkt", "POLYGON((0 0,\n1 x,0 1))"), "--json"}, folder).out);
  CHECK(ring["line"] == 2);
  CHECK(ring["vertex"] == 1);
}

TEST_CASE("settings replace values of the scene, and stand in run.json", "[program]") {
  const Folder folder;
  const std::string scene = folder.write("fall.json", kFall);
  const auto fall = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {"run", scene, "-o", folder / name, "--json"});
    const Result r = run(more, folder);
    INFO(r.err);
    REQUIRE(r.code == 0);
    return Json::parse(r.out);
  };
  const Json plain = fall("plain", {});
  const Json varied = fall("varied", {"--set", "bodies.block.velocity=[1,0]", "--set",
                                      "gravity=[0,0]", "--set", "name=other"});
  CHECK(plain["set"] == Json::object());
  CHECK(varied["set"] ==
        Json{{"bodies.block.velocity", {1, 0}}, {"gravity", {0, 0}}, {"name", "other"}});
  CHECK(varied["name"] == "other");
  CHECK(varied["scene_hash"] != plain["scene_hash"]);
  CHECK(varied["scene_hash"] ==
        fall("again", {"--set", "bodies.block.velocity=[1, 0]", "--set", "gravity=[0,0]", "--set",
                       "name=other"})["scene_hash"]);

  // A run that goes on has the settings that it was started with.
  REQUIRE(fall("parts", {"--set", "bodies.0.spin=2", "--until", "0.004"})["time"] == Approx(.004));
  CHECK(run({"run", scene, "-o", folder / "parts", "--resume", "--set", "bodies.0.spin=3"}, folder)
            .code == 2);
  const Json resumed = fall("parts", {"--resume"});
  CHECK(resumed["set"] == Json{{"bodies.0.spin", 2}});
  CHECK(resumed["final_state_hash"] ==
        fall("whole", {"--set", "bodies.0.spin=2"})["final_state_hash"]);

  const Result wrong = run({"check", scene, "--set", "time.setp=1"}, folder);
  CHECK(wrong.code == 2);
  CHECK(has(wrong.err, "/time/setp: unknown key \"setp\"; did you mean \"step\"?"));
  CHECK(has(wrong.err, "set by time.setp=1"));
  CHECK(Json::parse(run({"check", scene, "--set", "time.end=0.02", "--json"}, folder)
                        .out)["time_step"]["steps"] == 20);
}

TEST_CASE("bash completes commands, options, values and files", "[program]") {
  const Folder folder;
  const Result script = run({"completion", "bash"}, folder);
  REQUIRE(script.code == 0);
  const std::string file = folder.write("complete.bash", script.out);
  REQUIRE(shell(folder, "bash -n " + file).code == 0);
  const auto complete = [&](const std::string& words) {
    return shell(folder, "cd " + folder.path() + " && bash -c 'source complete.bash; COMP_WORDS=(" +
                             words +
                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _apothem; "
                             "printf \"%s\\n\" \"${COMPREPLY[@]}\"'")
        .out;
  };
  CHECK(complete("apothem ru") == "run\n");
  CHECK(complete("apothem --ver") == "--version\n");
  CHECK(complete("apothem run --thr") == "--threads\n");
  CHECK(complete("apothem contact a b --potential a") == "area\n");
  CHECK(complete("apothem contact a b --method \"\"") == "edge\noverlap\nexact\nall\n");
  CHECK(complete("apothem completion z") == "zsh\n");
  CHECK(complete("apothem run --threads \"\"") == "\n");
  folder.write("a-scene.json", "");
  CHECK(complete("apothem run a-sc") == "a-scene.json\n");
  CHECK(complete("apothem polygon --batch a-sc") == "a-scene.json\n");
}

TEST_CASE("zsh has a completion with every command and option", "[program]") {
  const Folder folder;
  const Result script = run({"completion", "zsh"}, folder);
  REQUIRE(script.code == 0);
  CHECK(script.out.starts_with("#compdef apothem\n"));
  for (const char* part : {"'run:Run a scene'", "'--threads[", ":(distance area)'", "'*--set["}) {
    INFO(part);
    CHECK(has(script.out, part));
  }
  if (!present("zsh")) {
    WARN("skipped: there is no zsh to read it");
    return;
  }
  const Result read = shell(folder, "zsh -n " + folder.write("_apothem", script.out));
  INFO(read.err);
  CHECK(read.code == 0);
}

TEST_CASE("the manual page has every command and option, and roff reads it without a warning",
          "[program]") {
  const Folder folder;
  const Result page = run({"manual"}, folder);
  REQUIRE(page.code == 0);
  const std::string help = run({"run", "--help"}, folder).out;
  for (const char* part : {".SS run", ".SS completion", "\\fB\\-\\-threads\\fR",
                           "\\fB\\-\\-set\\fR \\fIPATH=VALUE\\fR", ".SH EXIT STATUS"}) {
    INFO(part);
    CHECK(has(page.out, part));
  }
  CHECK(has(help, "Continue from the checkpoint in the output folder"));
  CHECK(has(page.out, "Continue from the checkpoint in the output folder"));
  if (!present("groff")) {
    WARN("skipped: there is no groff to read it");
    return;
  }
  const Result read =
      shell(folder, "groff -ww -man -T utf8 -P -c " + folder.write("apothem.1", page.out));
  CHECK(read.code == 0);
  CHECK(read.err.empty());
  CHECK(has(read.out, "Run a scene."));
}
