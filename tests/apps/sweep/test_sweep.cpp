// apothem sweep as its users meet it.
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "lib/text/csv.hpp"
#include "tests/program.hpp"

using namespace apothem;
using test::content;
using test::Folder;
using test::lines;
using test::Result;
using test::run;
using Words = std::vector<std::string>;

namespace fs = std::filesystem;

namespace {

// A meshed block that is pulled; its cells are random. A path that ends in seed repeats it.
const char* const kPulledCells =
    R"({ "name": "pull", "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
  "bodies": [ { "name": "block", "material": "rock",
    "mesh": { "voronoi": { "size": [2, 1], "cells": 6, "seed": 1 } },
    "supports": [ { "where": { "x": 0 }, "fix": ["x", "y"] } ],
    "loads": [ { "where": { "x": 2 }, "force": [1e6, 0], "history": [[0, 0], [1e-4, 1]] } ] } ],
  "time": { "end": 1e-4 }, "output": { "frames": 1, "history": { "interval": 1e-5,
    "track": [ { "body": "block", "point": [2, 0.5], "name": "A" } ] } },
  "expect": [ { "quantity": "A.ux", "take": "last", "value": 0, "tolerance": 1 } ] })";

// A stone that falls for long, in small steps: half a second of work, within which a signal reaches
// it.
const std::string kSmallStep = test::kSanitized ? "2e-6" : "4e-7";
const std::string kLongFall =
    std::string(
        R"({ "name": "long", "materials": { "rock": { "density": 2000 } }, "gravity": [0, -10],
  "bodies": [ { "name": "stone", "material": "rock", "polygon": [[0,0],[1,0],[1,1],[0,1]] } ],
  "time": { "end": 1, "step": )") +
    kSmallStep +
    R"( }, "output": { "frames": 1, "history": { "interval": 0.1 } },
  "expect": [ { "quantity": "stone.vy", "take": "last", "value": 0, "tolerance": 100 } ] })";

const Words kPoisson{"--vary", "materials.rock.poisson=0.1..0.3:0.1"};
const Words kSeeds{"--vary", "bodies.block.mesh.voronoi.seed=1..3"};

Words joined(Words words, std::initializer_list<Words> more) {
  for (const Words& part : more) words.insert(words.end(), part.begin(), part.end());
  return words;
}

// A study in a folder of its own.
struct Pull {
  Folder folder;
  std::string scene = folder.write("pull.json", kPulledCells);
  std::string study = folder / "study";
  Words varied = joined(kPoisson, {kSeeds});

  Words command(const std::string& output, const Words& more = {}) const {
    return joined({"sweep", scene}, {varied, {"-o", output, "--jobs", "2"}, more});
  }
  Result sweep(const Words& more = {}) const { return run(command(study, more), folder); }
};

using Rows = std::vector<CsvRow>;

// The cells of one column of a CSV file, by its name.
Words column(const std::string& file, const std::string& name) {
  const Rows rows = read_csv(file);
  const Words& header = rows.at(0).cells;
  const auto at = std::find(header.begin(), header.end(), name);
  REQUIRE(at != header.end());
  Words cells;
  for (size_t i = 1; i < rows.size(); ++i) {
    cells.push_back(rows[i].cells.at(static_cast<size_t>(at - header.begin())));
  }
  return cells;
}

// A table of runs without what the clock decides.
std::vector<Words> without_clocks(const std::string& file) {
  Rows rows = read_csv(file);
  const Words header = rows.at(0).cells;
  const auto at = std::find(header.begin(), header.end(), "wall_time [s]") - header.begin();
  REQUIRE(header.at(at + 1) == "processor_time [s]");
  std::vector<Words> result;
  for (CsvRow& row : rows) {
    row.cells.erase(row.cells.begin() + at, row.cells.begin() + at + 2);
    result.push_back(row.cells);
  }
  return result;
}

std::map<std::string, fs::file_time_type> times_of(const std::string& study) {
  std::map<std::string, fs::file_time_type> times;
  for (const auto& entry : fs::directory_iterator(study + "/runs")) {
    times[entry.path().filename()] = fs::last_write_time(entry.path() / "run.json");
  }
  return times;
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The process with this word on its command line, or 0.
pid_t process_with(const std::string& word) {
  const std::string whole = std::string(1, 0) + word + std::string(1, 0);
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (says(content(entry.path() / "cmdline"), whole)) return std::stoi(name);
  }
  return 0;
}

bool installed(const std::string& program) {
  return std::system(("command -v " + program + " > /dev/null").c_str()) == 0;
}

}  // namespace

TEST_CASE("a sweep runs all combinations and writes its tables", "[sweep]") {
  const Pull pull;
  const Result first = pull.sweep();
  INFO(first.err);
  REQUIRE(first.code == 0);
  CHECK(first.out == "9 runs: 9 done; tables in " + pull.study + "/runs.csv and summary.csv\n");
  const std::string runs = pull.study + "/runs.csv", summary = pull.study + "/summary.csv";
  CHECK(column(runs, "status") == Words(9, "done"));
  CHECK(column(runs, "materials.rock.poisson") ==
        Words{"0.1", "0.1", "0.1", "0.2", "0.2", "0.2", "0.3", "0.3", "0.3"});
  CHECK(column(runs, "bodies.block.mesh.voronoi.seed") ==
        Words{"1", "2", "3", "1", "2", "3", "1", "2", "3"});
  CHECK(column(runs, "time [s]") == Words(9, "0.0001"));
  CHECK(column(summary, "materials.rock.poisson") == Words{"0.1", "0.2", "0.3"});
  CHECK(column(summary, "done") == Words(3, "3"));
  CHECK(column(summary, "A.ux n") == Words(3, "3"));

  // What stands in the tables is what run --set gives.
  const Result alone =
      run({"run", pull.scene, "--set", "materials.rock.poisson=0.2", "--set",
           "bodies.block.mesh.voronoi.seed=3", "-o", pull.folder / "alone", "--json"},
          pull.folder);
  REQUIRE(alone.code == 0);
  const auto json = nlohmann::json::parse(alone.out);
  CHECK(column(runs, "final_state_hash")[5] == json["final_state_hash"].get<std::string>());
  CHECK(column(runs, "scene_hash")[5] == json["scene_hash"].get<std::string>());
  const double ux = json["expectations"][0]["value"];
  CHECK(std::stod(column(runs, "A.ux")[5]) == ux);
  double mean = 0;
  for (size_t i = 3; i < 6; ++i) mean += std::stod(column(runs, "A.ux")[i]) / 3;
  CHECK(std::stod(column(summary, "A.ux mean")[1]) == Approx(mean).epsilon(1e-12));

  if (installed("gnuplot")) {
    CHECK(fs::exists(pull.study + "/summary.png"));
    CHECK(says(content(pull.study + "/summary.svg"), "materials.rock.poisson"));
  } else {
    WARN("there is no gnuplot, so no picture was made");
  }
  for (const auto& entry : fs::directory_iterator(pull.study)) {
    CHECK_FALSE(says(entry.path().filename(), "tables-"));
  }

  // Runs that are done are not repeated; those of a longer plan are added.
  const auto before = times_of(pull.study);
  CHECK(pull.sweep().code == 0);
  CHECK(times_of(pull.study) == before);
  const Words more = joined({"sweep", pull.scene, "-o", pull.study, "--quiet"},
                            {kPoisson, {"--vary", "bodies.block.mesh.voronoi.seed=1..4"}});
  const Result longer = run(more, pull.folder);
  CHECK(longer.code == 0);
  CHECK(longer.out.empty());
  CHECK(longer.err.empty());
  const auto after = times_of(pull.study);
  CHECK(after.size() == 12);
  for (const auto& [key, time] : before) CHECK(after.at(key) == time);
}

TEST_CASE("runs of a scene that has changed are done anew", "[sweep][slow]") {
  Pull pull;
  pull.varied = kPoisson;
  REQUIRE(pull.sweep().code == 0);
  const auto before = times_of(pull.study);
  std::string text = kPulledCells;
  text.replace(text.find("1e6"), 3, "2e6");
  pull.folder.write("pull.json", text);
  const Result list = pull.sweep({"--dry-run"});
  CHECK(lines(list.out) == 3);
  CHECK(list.out.starts_with("changed     poisson=0.1\n"));
  CHECK(times_of(pull.study) == before);
  const Result again = pull.sweep();
  CHECK(again.code == 0);
  CHECK(says(again.err, "3 of 3 runs are done anew"));
  for (const auto& [key, time] : times_of(pull.study)) CHECK(time > before.at(key));
  // So are those of other fixed settings.
  CHECK(says(pull.sweep({"--set", "time.safety=0.2"}).err, "3 of 3 runs are done anew"));
}

TEST_CASE("a file that the scene names belongs to it", "[sweep][slow]") {
  const Folder folder;
  const auto square = [&](const char* size) {
    folder.write("stone.json", std::string("[[0,0],[") + size + ",0],[1,1],[0,1]]");
  };
  square("1");
  std::string text = test::exchanged(kLongFall, kSmallStep, "1e-2");
  const Words sweep{"sweep",  folder.write("scene.json", text),
                    "--vary", "bodies.stone.polygon=stone.json,[[0,0],[1,0],[1,1]]",
                    "-o",     folder / "study"};
  REQUIRE(run(sweep, folder).code == 0);
  CHECK(run(sweep, folder).err.empty());
  square("2");
  const Result again = run(sweep, folder);
  CHECK(again.code == 0);
  CHECK(says(again.err, "1 of 2 runs are done anew"));
  CHECK(run(sweep, folder).err.empty());
  // All runs share a file of the scene itself.
  text.replace(text.find("[[0,0],[1,0],[1,1],[0,1]]"), 25, R"("stone.json")");
  const Words shared{"sweep",  folder.write("named.json", text),
                     "--vary", "gravity.1=-1,-2",
                     "-o",     folder / "shared"};
  REQUIRE(run(shared, folder).code == 0);
  CHECK(run(shared, folder).err.empty());
  square("1");
  CHECK(says(run(shared, folder).err, "2 of 2 runs are done anew"));
}

TEST_CASE("shards give the tables of one go, also at the same time", "[sweep][slow]") {
  const Pull pull;
  REQUIRE(run(pull.command(pull.folder / "whole"), pull.folder).code == 0);
  const Result first = pull.sweep({"--shard", "1/4"});
  CHECK(first.code == 0);
  CHECK(says(first.out, "part 1/4: 3 done"));
  CHECK_FALSE(fs::exists(pull.study + "/runs.csv"));
  // Tables of what there is.
  CHECK(pull.sweep({"--collect"}).code == 1);
  const Words some = column(pull.study + "/runs.csv", "status");
  CHECK(std::count(some.begin(), some.end(), "done") == 3);
  CHECK(std::count(some.begin(), some.end(), "missing") == 6);
  std::string command = "for i in 2 3 4; do " + test::kProgram;
  for (const std::string& word : pull.command(pull.study)) command += " '" + word + "'";
  command += " --quiet --shard $i/4 & done; wait";
  REQUIRE(std::system(command.c_str()) == 0);
  CHECK(without_clocks(pull.study + "/runs.csv") == without_clocks(pull.folder / "whole/runs.csv"));
  CHECK(content(pull.study + "/summary.csv") == content(pull.folder / "whole/summary.csv"));
  CHECK(pull.sweep({"--collect"}).code == 0);
}

TEST_CASE("runs that fail are rows with their message, and are repeated on request", "[sweep]") {
  const Folder folder;
  const std::string scene = folder.write("pull.json", kPulledCells);
  // A negative modulus is refused; forces beyond all bounds make the mesh unstable.
  const auto sweep = [&](const Words& more) {
    return run(joined({"sweep", scene, "--vary", "materials.rock.young=20e9,-1", "--vary",
                       "bodies.block.loads.0.force=[1e6,0],[-1e16,0]", "-o", folder / "study"},
                      {more}),
               folder);
  };
  const Result first = sweep({});
  INFO(first.err);
  CHECK(first.code == 1);
  const std::string runs = folder / "study/runs.csv";
  CHECK(column(runs, "status") == Words{"done", "unstable", "refused", "refused"});
  const Words messages = column(runs, "message");
  CHECK(messages[0].empty());
  CHECK(says(messages[1], "t = "));
  CHECK(says(messages[2], "/materials/rock/young"));
  for (size_t i = 1; i < 4; ++i) CHECK(says(first.err, messages[i]));
  CHECK(says(first.err, "--retry-failed"));
  const Words missing = column(folder / "study/summary.csv", "A.ux missing");
  CHECK(missing == Words{"0", "1", "1", "1"});

  const std::string note = folder / "study/runs";
  const auto note_times = [&] {
    std::map<std::string, fs::file_time_type> times;
    for (const auto& entry : fs::directory_iterator(note)) {
      times[entry.path().filename()] = fs::last_write_time(entry.path() / "sweep.json");
    }
    return times;
  };
  const auto before = note_times();
  CHECK(sweep({}).code == 1);
  CHECK(note_times() == before);
  CHECK(sweep({"--retry-failed"}).code == 1);
  int repeated = 0;
  for (const auto& [key, time] : note_times()) repeated += time > before.at(key);
  CHECK(repeated == 3);
}

TEST_CASE("a run that crashes takes no other down", "[sweep][slow]") {
  const Folder folder;
  const std::string scene = folder.write("long.json", kLongFall);
  const Words sweep{"sweep",  scene,
                    "--vary", "time.step=1e-3," + kSmallStep,
                    "--vary", "gravity.1=-1,-2",
                    "-o",     folder / "study",
                    "--jobs", "1"};
  // The first long run is killed from outside.
  const std::string victim =
      folder / "study/runs/step=" + (test::kSanitized ? "2e-06" : "4e-07") + ",1=-1";
  std::thread killer([&] {
    for (int i = 0; i < 6000 && !fs::exists(victim + "/frames.pvd"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (const pid_t process = process_with(victim)) kill(process, SIGKILL);
  });
  const Result r = run(sweep, folder);
  killer.join();
  INFO(r.err);
  CHECK(r.code == 1);
  CHECK(column(folder / "study/runs.csv", "status") == Words{"done", "done", "crashed", "done"});
  CHECK(says(column(folder / "study/runs.csv", "message")[2], "ended by signal 9"));
  Words again = sweep;
  again.emplace_back("--retry-failed");
  CHECK(run(again, folder).code == 0);
}

TEST_CASE("Ctrl-C stops the runs with checkpoints, and the same command goes on", "[sweep][slow]") {
  const Folder folder;
  const std::string scene = folder.write("long.json", kLongFall);
  const auto sweep = [&](const std::string& study) {
    return Words{"sweep", scene,          "--vary", "gravity.1=-1,-2,-3",
                 "-o",    folder / study, "--jobs", "2"};
  };
  REQUIRE(run(sweep("whole"), folder).code == 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(folder / "study");
    const Result stopped = run(sweep("study"), folder,
                               {.interrupt_after = 0.02,
                                .signal = signal,
                                .once_exists = folder / "study/runs/1=-2/frames.pvd"});
    INFO(stopped.err);
    CHECK(stopped.code == 130);
    CHECK(says(stopped.err, "the same command continues"));
    CHECK(fs::exists(folder / "study/runs/1=-1/checkpoint.json"));
    CHECK(fs::exists(folder / "study/runs/1=-2/checkpoint.json"));
    CHECK_FALSE(fs::exists(folder / "study/runs/1=-3"));
    CHECK(column(folder / "study/runs.csv", "status") ==
          Words{"interrupted", "interrupted", "missing"});
    CHECK(run(sweep("study"), folder).code == 0);
    CHECK(without_clocks(folder / "study/runs.csv") == without_clocks(folder / "whole/runs.csv"));
    const auto resumed = nlohmann::json::parse(content(folder / "study/runs/1=-1/run.json"));
    CHECK(resumed["wall_time"]["total"].get<double>() > 0);
    CHECK(content(folder / "study/runs/1=-1/history.csv") ==
          content(folder / "whole/runs/1=-1/history.csv"));
  }
}

TEST_CASE("a damaged checkpoint makes a run begin anew", "[sweep]") {
  const Folder folder;
  const std::string scene = folder.write("long.json", kLongFall);
  const Words sweep{"sweep", scene, "--vary", "gravity.1=-1", "-o", folder / "study"};
  CHECK(run(sweep, folder,
            {.interrupt_after = 0.02, .once_exists = folder / "study/runs/1=-1/frames.pvd"})
            .code == 130);
  REQUIRE(fs::exists(folder / "study/runs/1=-1/checkpoint.json"));
  folder.write("study/runs/1=-1/checkpoint.json", "{");
  const Result r = run(sweep, folder);
  INFO(r.err);
  CHECK(r.code == 0);
  CHECK(column(folder / "study/runs.csv", "status") == Words{"done"});
}

TEST_CASE("two sweeps of the same runs do each of them once", "[sweep]") {
  const Folder folder;
  const std::string scene = folder.write("long.json", kLongFall);
  const std::string command = test::kProgram + " sweep " + scene +
                              " --quiet --jobs 1 --vary gravity.1=-1,-2 -o " + (folder / "study");
  REQUIRE(std::system((command + " & " + command + "; wait").c_str()) == 0);
  CHECK(column(folder / "study/runs.csv", "status") == Words(2, "done"));
}

TEST_CASE("all runs may begin with the state of another run, and tables give rows", "[sweep]") {
  const Folder folder;
  const std::string scene =
      folder.write("scene.json", test::exchanged(kLongFall, kSmallStep, "1e-2"));
  REQUIRE(run({"run", scene, "-o", folder / "first", "--quiet"}, folder).code == 0);
  const std::string table =
      folder.write("rows.csv", "gravity,time.end\n\"[0,-1]\",0.5\n\"[0,-2]\",1\n");
  const Words sweep{"sweep",          scene, "--table",        table,        "--from",
                    folder / "first", "-o",  folder / "study", "--survival", "stone.vy"};
  // Stones fall, so that this is no exposure; the table of runs is there all the same.
  const Result r = run(sweep, folder);
  CHECK(r.code == 2);
  CHECK(lines(r.err) == 1);
  CHECK(says(r.err, "--survival: \"stone.vy\" is -1"));
  const Words speeds = column(folder / "study/runs.csv", "stone.vy");
  REQUIRE(speeds.size() == 2);
  CHECK(std::stod(speeds[0]) == Approx(-10.5));
  CHECK(std::stod(speeds[1]) == Approx(-12));
  CHECK(column(folder / "study/runs.csv", "time [s]") == Words{"0.5", "1"});
}

TEST_CASE("each run may begin with the fitting run of another study", "[sweep][slow]") {
  const Folder folder;
  const std::string scene =
      folder.write("scene.json", test::exchanged(kLongFall, kSmallStep, "1e-2"));
  const Words gravities{"--vary", "gravity=[0,-1],[0,-2]"};
  REQUIRE(run(joined({"sweep", scene}, {gravities, {"-o", folder / "first"}}), folder).code == 0);
  const Result r = run(joined({"sweep", scene}, {gravities,
                                                 {"--vary", "time.end=0.5,1", "--from",
                                                  folder / "first", "-o", folder / "second"}}),
                       folder);
  INFO(r.err);
  REQUIRE(r.code == 0);
  const Words speeds = column(folder / "second/runs.csv", "stone.vy");
  REQUIRE(speeds.size() == 4);
  const double expected[]{-1.5, -2, -3, -4};
  for (size_t i = 0; i < 4; ++i) CHECK(std::stod(speeds[i]) == Approx(expected[i]));
  // What all runs of the first study have in common need not be said again.
  const Words heavy{"--set", "materials.rock.density=3000"};
  REQUIRE(
      run(joined({"sweep", scene}, {gravities, heavy, {"-o", folder / "heavy"}}), folder).code ==
      0);
  CHECK(run(joined({"sweep", scene}, {gravities,
                                      {"--vary", "time.end=0.5", "--from", folder / "heavy", "-o",
                                       folder / "light"}}),
            folder)
            .code == 0);
  const Result none = run({"sweep", scene, "--vary", "gravity=[0,-3]", "--from", folder / "first",
                           "-o", folder / "third"},
                          folder);
  CHECK(none.code == 2);
  CHECK(says(none.err, "0 finished runs"));
}

TEST_CASE("mistakes are named with their remedy before anything runs", "[sweep][slow]") {
  const Folder folder;
  const std::string scene = folder.write("pull.json", kPulledCells);
  const std::string vary = "materials.rock.poisson=0.1,0.2";
  const std::vector<std::pair<Words, std::string>> wrong{
      {{}, "give --vary PATH=A,B,C or --table FILE.csv"},
      {{"--vary", "a"}, "--vary: \"a\" varies nothing; write PATH=A,B,C"},
      {{"--vary", "materials.rock.poisson=0.1..0.2"}, "needs a step"},
      {{"--vary", vary, "--vary", vary}, "is varied twice"},
      {{"--vary", vary, "--set", "materials.rock.poisson=0.3"},
       "--set: \"materials.rock.poisson\" is varied"},
      {{"--vary", "materials.rock.poison=0.1,0.2"}, "did you mean \"poisson\""},
      {{"--vary", "bodies.brick.angle=1,2"}, "has no item of the name \"brick\""},
      {{"--vary", "materials.rock.poisson=2,3"}, "set by materials.rock.poisson=2"},
      {{"--table", folder / "none.csv"}, "none.csv"},
      {{"--table", folder.write("bad.csv", "a,b\n1\n")}, "bad.csv:2: has 1 cells"},
      {{"--vary", vary, "--shard", "3"}, "--shard: \"3\" is no part; write I/N"},
      {{"--vary", vary, "--shard", "3/2"}, "--shard: \"3/2\""},
      {{"--vary", vary, "--shard", "0/2"}, "--shard: \"0/2\""},
      {{"--vary", vary, "--jobs", "0"}, "--jobs"},
      {{"--vary", vary, "--survival", ":jam"}, "write MEASURE or MEASURE:EVENT"},
      {{"--vary", vary, "--survival", "a:"}, "write MEASURE or MEASURE:EVENT"},
      {{"--vary", vary, "--from", folder / "none"}, "--from: there is no folder"},
      {{"--vary", vary, "--workflow", "make"}, "--workflow"},
      {{"--vary", vary, "--shards", "2"}, "--workflow"},
      {{"--vary", vary, "--shard", "1/2", "--collect"}, "--collect"},
  };
  for (const auto& [words, remedy] : wrong) {
    const Result r = run(joined({"sweep", scene, "-o", folder / "study"}, {words}), folder);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(lines(r.err) == 1);
    CHECK(says(r.err, remedy));
    CHECK_FALSE(fs::exists(folder / "study"));
  }
  CHECK(run({"sweep", folder / "none.json", "--vary", vary}, folder).code == 2);
  const Result braces = run(
      {"sweep", scene, "--vary", vary, "--workflow", "snakemake", "-o", folder / "{x}"}, folder);
  CHECK(braces.code == 2);
  CHECK(says(braces.err, "choose another folder"));
}

TEST_CASE("what cannot be written is a failure of the system", "[sweep]") {
  const Pull pull;
  pull.folder.write("study", "a file, not a folder");
  const Result r = pull.sweep();
  CHECK(r.code == 4);
  CHECK(lines(r.err) == 1);
}

TEST_CASE("a workflow for Snakemake gives the tables of one go", "[sweep]") {
  const Pull pull;
  const Words words{"--workflow", "snakemake", "--shards", "2", "--set", R"(name="it's")"};
  const Result written = pull.sweep(words);
  INFO(written.err);
  REQUIRE(written.code == 0);
  CHECK(says(written.out, "9 runs in 2 parts: snakemake -s " + pull.study + "/Snakefile"));
  CHECK_FALSE(fs::exists(pull.study + "/runs"));
  if (!installed("snakemake")) {
    WARN("skipped: there is no snakemake to run it");
    return;
  }
  const std::string command = "cd " + pull.folder.path() + " && snakemake -j2 -s " + pull.study +
                              "/Snakefile > " + (pull.folder / "log") + " 2>&1";
  const int code = std::system(command.c_str());
  INFO(content(pull.folder / "log"));
  REQUIRE(code == 0);
  REQUIRE(run(pull.command(pull.folder / "whole", {"--set", R"(name="it's")"}), pull.folder).code ==
          0);
  CHECK(without_clocks(pull.study + "/runs.csv") == without_clocks(pull.folder / "whole/runs.csv"));
  CHECK(content(pull.study + "/summary.csv") == content(pull.folder / "whole/summary.csv"));
}
