// The container of all frames: what it holds, what is left of it when writing fails or is broken
// off, and that programs that show results do not care.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>

#include "lib/output/frame_container.hpp"
#include "lib/output/run_folder.hpp"
#include "tests/folder.hpp"
#include "tests/output/run_results.hpp"
#include "tests/run/hopper.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

const std::vector<std::string> kFiles{"frames.h5", "frames.xdmf", "contacts.xdmf"};

std::vector<std::vector<Vec2>> outlines(const Frame& frame) {
  std::vector<std::vector<Vec2>> all;
  for (int e = 0; e < frame.mesh.element_count(); ++e) {
    std::vector<Vec2>& ring = all.emplace_back();
    for (const int node : frame.mesh.element(e)) {
      ring.push_back(frame.position[static_cast<size_t>(node)]);
    }
    const auto less = [](const Vec2& a, const Vec2& b) {
      return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
    };
    std::ranges::rotate(ring, std::ranges::min_element(ring, less));  // rings may begin anywhere
  }
  return all;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void check_same(const RunFolder& a, const RunFolder& b) {
  REQUIRE(a.times() == b.times());
  REQUIRE(a.has_roses() == b.has_roses());
  for (size_t i = 0; i < a.times().size(); ++i) {
    CAPTURE(i);
    const Frame one = a.frame(i), other = b.frame(i);
    CHECK((one.position == other.position));
    CHECK((one.displacement == other.displacement));
    CHECK((one.velocity == other.velocity));
    CHECK((outlines(one) == outlines(other)));
    CHECK(one.body == other.body);
    CHECK(one.material == other.material);
    REQUIRE(one.bodies.size() == other.bodies.size());
    for (size_t k = 0; k < one.bodies.size(); ++k) {
      CHECK(one.bodies[k].present == other.bodies[k].present);
      for (size_t q = 0; q < one.bodies[k].values.size(); ++q) {
        const Components &x = one.bodies[k].values[q], &y = other.bodies[k].values[q];
        CHECK(std::ranges::equal(x, y, same));
      }
    }
    for (size_t e = 0; e < one.stress.size(); ++e) CHECK(one.stress[e].xy == other.stress[e].xy);
    const std::vector<ForceChain> chains = a.chains(i), others = b.chains(i);
    REQUIRE(chains.size() == others.size());
    for (size_t c = 0; c < chains.size(); ++c) {
      CHECK((chains[c].line == others[c].line));
      CHECK(chains[c].normal == others[c].normal);
    }
    if (!a.has_roses()) continue;
    const std::vector<Rose> roses = a.roses(i), more = b.roses(i);
    REQUIRE(roses.size() == more.size());
    for (size_t r = 0; r < roses.size(); ++r) CHECK(roses[r].frequency == more[r].frequency);
  }
}

std::string in_container(std::string scene) {
  const std::string frames = "\"output\": {";
  return scene.replace(scene.find(frames), frames.size(), frames + R"( "format": "xdmf", )");
}

size_t count_files(const std::string& folder) {
  size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    count += entry.is_regular_file();
  }
  return count;
}

}  // namespace

TEST_CASE("a container holds what files of frames hold", "[output][container]") {
  for (const bool mesh : {false, true}) {
    const Folder folder;
    const Model model = model_of_results(mesh);
    write_results(folder / "files", model, 4);
    write_results(folder / "container", model, 4, FrameFormat::xdmf);
    check_same(RunFolder(folder / "files"), RunFolder(folder / "container"));
  }
}

TEST_CASE("bodies that come and go, and polygons of many corners, are in a container",
          "[run][container]") {
  // Crosses and quadrilaterals are cut differently; frames have other bodies, and no contacts at
  // first.
  const Folder folder;
  std::string text = hopper("remove");
  const std::string end = "\"end\": 3";
  text.replace(text.find(end), end.size(), "\"end\": 0.9");
  const std::string quadrilateral = R"({ "quadrilateral": {} })";
  text.replace(text.find(quadrilateral), quadrilateral.size(),
               R"({ "polygon_random": { "corners": [5, 9] } })");
  for (const bool container : {false, true}) {
    Run run(scene_of(folder, container ? in_container(text) : text),
            {.folder = folder / (container ? "container" : "files")});
    REQUIRE(run.run() == Run::Status::done);
  }
  check_same(RunFolder(folder / "files"), RunFolder(folder / "container"));
  CHECK(content(folder / "files/history.csv") == content(folder / "container/history.csv"));
}

TEST_CASE("a run of a thousand frames has ten files at most", "[run][container]") {
  const Folder folder;
  std::string text = in_container(flying_block("", R"(, "gravity": [0, -10])"));
  const std::string frames = "\"frames\": 5", step = "1e-3";
  text.replace(text.find(frames), frames.size(), "\"frames\": 1000");
  text.replace(text.find(step), step.size(), "2.5e-4");
  Run run(scene_of(folder, text), {.folder = folder / "out"});
  REQUIRE(run.run() == Run::Status::done);
  CHECK(count_files(folder / "out") <= 10);
  const RunFolder results(folder / "out");
  CHECK(results.times().size() == 1001);
  CHECK(results.frame(1000).body.size() == 1);
  // What stays the same is there once: 4 corners and a few arrays of one number for each frame.
  CHECK(std::filesystem::file_size(folder / "out/frames.h5") < 1001 * 5000);
}

TEST_CASE("a run that goes on writes the same container as one that was not stopped",
          "[resume][container]") {
  const Folder folder;
  const Scene scene = scene_of(folder, in_container(rubbing_scenes()[0].text));
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  Run first(scene, {.folder = folder / "parts"});
  first.run(.4 * scene.time.end);
  // As of a run that was killed later: half of a frame stands behind what counts.
  std::ofstream(folder / "parts/frames.h5", std::ios::app | std::ios::binary) << "half a frame";
  CHECK(RunFolder(folder / "parts").times().size() == 3);
  Run second(scene, {.folder = folder / "parts", .resume = true});
  REQUIRE(second.run() == Run::Status::done);
  for (const std::string& name : kFiles) {
    CAPTURE(name);
    const std::string file = content(folder / ("whole/" + name));
    CHECK(!file.empty());
    CHECK((file == content(folder / ("parts/" + name))));
  }
}

TEST_CASE("a container that is missing or damaged is named", "[resume][container]") {
  for (const std::string& name : kFiles) {
    for (const bool missing : {false, true}) {
      CAPTURE(name, missing);
      const Folder folder;
      const Scene scene = scene_of(folder, in_container(rubbing_scenes()[0].text));
      Run(scene, {.folder = folder / "out"}).run(.4 * scene.time.end);
      missing ? void(std::filesystem::remove(folder / ("out/" + name)))
              : void(folder.write("out/" + name, "something else"));
      CHECK_THROWS_WITH(Run(scene, {.folder = folder / "out", .resume = true}),
                        Catch::Contains(name) && Catch::Contains("--overwrite"));
      if (name == "frames.h5") {
        CHECK_THROWS_AS(RunFolder(folder / "out"), ResultsError);
      }
    }
  }
}

TEST_CASE("every byte of a container may be wrong", "[output][container]") {
  const Folder folder;
  write_results(folder / "out", model_of_results(true), 2, FrameFormat::xdmf);
  const std::string file = folder / "out/frames.h5", sound = content(file);
  SeededRandom random(47);
  int refused = 0;
  for (int i = 0; i < scaled(400); ++i) {
    std::string text = sound;
    for (int k = random.integer(1, 3); k > 0; --k) {
      text[static_cast<size_t>(random.integer(0, static_cast<int>(text.size()) - 1))] =
          static_cast<char>(random.integer(0, 255));
    }
    if (random.integer(0, 9) == 0) text.resize(text.size() / 2);
    folder.write("out/frames.h5", text);
    try {
      const RunFolder results(folder / "out");
      for (size_t f = 0; f < results.times().size(); ++f) {
        static_cast<void>(results.frame(f));
        static_cast<void>(results.chains(f));
      }
    } catch (const ResultsError& error) {
      CHECK(std::string(error.what()).find("frames.h5") != std::string::npos);
      ++refused;
    }
  }
  CHECK(refused >= test::least(15));
}

TEST_CASE("a frame that cannot be written leaves the frames before", "[output][container]") {
  const Folder folder;
  const Model model = model_of_results(false);
  const State state = state_of_results(model);
  FrameWriter writer(folder.path(), model, {}, 1, nullptr, FrameFormat::xdmf);
  const auto write = [&] { writer.write({.state = state, .forces = std::vector<BodyForce>(3)}); };
  write();
  for (const std::string& name : kFiles) {
    CAPTURE(name);
    // Somebody else has added to a file.
    const std::string before = content(folder / name);
    folder.write(name, before + " ");
    CHECK_THROWS_WITH(write(), Catch::Contains(name));
    CHECK(writer.times().size() == 1);
    folder.write(name, before);
    CHECK(RunFolder(folder.path()).times().size() == 1);
  }
  write();
  CHECK(RunFolder(folder.path()).times().size() == 2);
}
