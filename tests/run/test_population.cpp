// Bodies that come and go: ledgers, stopping rules, measures, and runs that go on bit for bit.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <random>

#include "geometry/polygon/predicates.hpp"
#include "lib/output/history.hpp"
#include "lib/output/run_folder.hpp"
#include "lib/run/hash.hpp"
#include "lib/run/run.hpp"
#include "tests/folder.hpp"
#include "tests/run/hopper.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace population {
namespace {

Scene scene_in(const Folder& folder, const std::string& text) {
  return read_scene(folder.write("scene.json", text));
}

}  // namespace

TEST_CASE("bodies come and leave, and the ledgers stay closed", "[population]") {
  const bool meshed = GENERATE(false, true);
  const Folder folder;
  const std::string mesh = meshed ? R"(, "mesh": { "size": 0.2, "element": "T3" })" : "";
  Run run(scene_in(folder, hopper("remove", "", mesh)), {.folder = ""});
  const double end = meshed ? kSanitized ? .05 : 1.2 : 3;
  const BodyIndex total = 2 + 36;
  REQUIRE(static_cast<BodyIndex>(run.state().absent.size()) == total);
  double moved = 0;
  while (run.state().time < end) {
    run.step();
    const Energies e = run.simulation().energies();
    moved = std::max(moved, e.damping_loss + e.friction_loss + e.kinetic);
    REQUIRE(std::abs(e.total_error) < 2e-3 * std::max(moved, 1.));
    const Momenta p = run.simulation().momenta();
    REQUIRE(std::abs(p.y_error) < 1e-8);
    REQUIRE(std::abs(p.angular_error) < 1e-8);
  }
  if (end < 1) return;
  const Population& population = *run.simulation().population();
  CHECK(population.come() == 24);
  if (!meshed) CHECK(population.left() > 20);
  for (BodyIndex b = 0; b < total; ++b) {
    if (!run.state().is_absent(b) || meshed) continue;
    CHECK(run.state().pose_rate(b).norm() == 0);
    CHECK(run.state().force(b).norm() == 0);
  }
}

TEST_CASE("bodies leave a hopper through its opening only, by exact predicates", "[population]") {
  const Folder folder;
  Run run(scene_in(folder, hopper("remove")), {.folder = ""});
  const std::vector<Vec2> left{{-3, 0}, {-.7, 0}, {-2, 1.3}, {-3, 1.3}},
      right{{.7, 0}, {3, 0}, {3, 1.3}, {2, 1.3}};
  const BodyIndex total = 2 + 36;
  const auto centre = [&](BodyIndex b) { return Vec2(run.state().pose(b).head<2>()); };
  std::vector<Vec2> before(static_cast<size_t>(total), Vec2(0, 6));
  int passed = 0;
  const double end = kSanitized ? .5 : 3;
  while (run.state().time < end) {
    run.step();
    for (BodyIndex b = 2; b < total; ++b) {
      if (run.state().is_absent(b)) continue;
      Vec2& last = before[static_cast<size_t>(b)];
      const Vec2 now = centre(b);
      REQUIRE_FALSE(strictly_inside(left, now));
      REQUIRE_FALSE(strictly_inside(right, now));
      if (last.y() >= 0 && now.y() < 0) {
        ++passed;
        REQUIRE(segments_meet(last, now, {-.7, 0}, {.7, 0}));
      }
      last = now;
    }
  }
  CHECK(passed > least(20));
}

TEST_CASE("a world can stop a run, or let bodies go", "[population]") {
  const Folder folder;
  Run stops(scene_in(folder, hopper("stop")), {.folder = ""});
  CHECK(stops.run() == Run::Status::done);
  CHECK(stops.stopped_by() == "outside");
  CHECK(stops.state().time < 2);
  Run keeps(scene_in(folder, hopper("keep")), {.folder = ""});
  CHECK(keeps.run(1.6) == Run::Status::done);
  CHECK(keeps.stopped_by().empty());
  double lowest = 0;
  for (BodyIndex b = 2; b < 38; ++b) lowest = std::min(lowest, keeps.state().pose(b)[1]);
  CHECK(lowest < -2);
}

TEST_CASE("rules stop a run, and measures say what it has come to", "[population]") {
  const Folder folder;
  Run run(scene_in(folder, hopper("remove", kStops)), {.folder = folder / "out"});
  CHECK(run.run() == Run::Status::done);
  CHECK((run.stopped_by() == "emptied" || run.stopped_by() == "stuck"));
  const nlohmann::json json = nlohmann::json::parse(content(folder / "out/run.json"));
  CHECK(json["status"] == "done");
  CHECK(json["stopped_by"] == run.stopped_by());
  CHECK(json["measures"]["t"].get<double>() == run.state().time);
  CHECK(json["measures"]["out"] == (run.stopped_by() == "emptied"));
  const HistoryTable table = read_history(folder / "out/history.csv");
  CHECK(json["measures"]["left"].get<double>() == table.column("above.count")->back());
  CHECK(std::filesystem::exists(folder / "out/final.json"));
  CHECK(!std::filesystem::exists(folder / "out/checkpoint.json"));
  // The state that a rule watches, counted by hand.
  int above = 0;
  for (BodyIndex b = 2; b < 38; ++b) {
    const auto x = run.state().pose(b);
    above += !run.state().is_absent(b) && x[1] >= 0 && std::abs(x[0]) <= 3 && x[1] <= 6;
  }
  CHECK(table.column("above.count")->back() == above);
}

TEST_CASE("a wall clock stops a run so that it can be continued", "[population]") {
  const Folder folder;
  const Scene scene =
      scene_in(folder, hopper("remove", R"("stop": [ { "name": "late", "wall_clock": 1e-6 } ],)"));
  Run run(scene, {.folder = folder / "out"});
  CHECK(run.run() == Run::Status::interrupted);
  CHECK(run.stopped_by() == "late");
  CHECK(std::filesystem::exists(folder / "out/checkpoint.json"));
}

TEST_CASE("a run with bodies that come and go continues bit for bit", "[population]") {
  const Folder folder;
  const Scene scene = scene_in(folder, hopper("remove", kStops));
  Run whole(scene, {.folder = folder / "whole", .threads = 1});
  REQUIRE(whole.run() == Run::Status::done);
  Run threads(scene, {.folder = folder / "threads", .threads = 3});
  REQUIRE(threads.run() == Run::Status::done);
  CHECK(state_hash(threads.state()) == state_hash(whole.state()));
  std::mt19937 random(3);
  const double end = whole.state().time;
  std::vector<double> stops;
  for (int i = 0; i < 12; ++i) stops.push_back(end * (static_cast<double>(random()) / 4.3e9));
  std::sort(stops.begin(), stops.end());
  bool resume = false;
  for (const double stop : stops) {
    Run part(scene, {.folder = folder / "parts", .threads = 1, .resume = resume});
    part.run(stop);
    resume = true;
  }
  Run last(scene, {.folder = folder / "parts", .threads = 2, .resume = true});
  CHECK(last.run() == Run::Status::done);
  CHECK(last.stopped_by() == whole.stopped_by());
  CHECK(state_hash(last.state()) == state_hash(whole.state()));
  CHECK(last.state().absent == whole.state().absent);
  for (const char* name : {"history.csv", "energy.csv", "momentum.csv"}) {
    INFO(name);
    CHECK((content(folder / ("parts/" + std::string(name))) ==
           content(folder / ("whole/" + std::string(name)))));
  }
}

TEST_CASE("another run begins with those bodies that are still there", "[population]") {
  const Folder folder;
  const Scene scene = scene_in(folder, hopper("remove"));
  Run first(scene, {.folder = folder / "first"});
  first.run(1.5);
  const std::int64_t left = first.simulation().population()->left();
  REQUIRE(left > 3);
  Scene next = scene_in(folder, hopper("remove", R"("description": "the same, later",)"));
  Run second(next, {.folder = folder / "second", .from = folder / "first"});
  const auto gone = [](const Run& run) {
    return std::count(run.state().absent.begin(), run.state().absent.end(), 2);
  };
  CHECK(gone(second) == left);
  CHECK(gone(second) == gone(first));
  for (BodyIndex b = 0; b < 38; ++b) {
    if (first.state().is_absent(b)) continue;
    CHECK((second.state().pose(b) - first.state().pose(b)).norm() == 0);
  }
  second.run(.5);
  CHECK(gone(second) >= left);
}

TEST_CASE("frames show the bodies that are there", "[population]") {
  const Folder folder;
  Run run(scene_in(folder, hopper("remove")), {.folder = folder / "out"});
  run.run();
  const auto shown = [&](double time) {
    const Frame frame = read_frame(folder / "out", time, time + 1e-2);
    std::vector<int> bodies = frame.body;
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    return bodies.size();
  };
  CHECK(shown(0) == 2 + 12);
  const auto there = std::count(run.state().absent.begin(), run.state().absent.end(), 0);
  CHECK(shown(3) == static_cast<size_t>(there));
  for (const char* name : {"chains.pvd", "roses.pvd", "frames.pvd"}) {
    CHECK(std::filesystem::exists(folder / ("out/" + std::string(name))));
  }
}

}  // namespace population
