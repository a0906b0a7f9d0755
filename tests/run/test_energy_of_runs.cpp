// What a run writes of its energy, what it says of it, and its verdict are one.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "lib/dynamics/term.hpp"
#include "lib/output/run_folder.hpp"
#include "tests/folder.hpp"
#include "tests/run/random_scenes.hpp"
#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

struct Written {
  Run::Status status;
  nlohmann::json summary;
  double largest_row = 0;  // of |total_error|, J
  double last_row = 0;     // |total_error|, J
  double fall = 0;         // the largest of a loss, J
};

Written run_and_read(const Folder& folder, const std::string& text,
                     std::optional<double> interval = {}) {
  Scene scene = scene_of(folder, text);
  if (interval) scene.output.history_interval = *interval;
  Run run(std::move(scene), {.folder = folder / "out", .overwrite = true});
  Written found;
  found.status = run.run();
  found.summary = nlohmann::json::parse(content(folder / "out/run.json"));
  const HistoryTable table = read_table(folder / "out", "energy.csv");
  for (const double error : *table.column("total_error")) {
    found.last_row = std::abs(error);
    found.largest_row = std::max(found.largest_row, found.last_row);
  }
  for (const char* quantity : {"friction_loss", "damping_loss"}) {
    double most = 0;
    for (const double loss : *table.column(quantity)) {
      most = std::max(most, loss);
      found.fall = std::max(found.fall, most - loss);
    }
  }
  return found;
}

}  // namespace

// 800 scenes with APOTHEM_LONG=1.
TEST_CASE("what random runs write and what they say of their energy agree", "[run][energy]") {
  const Folder folder;
  const int count = long_run() ? 800 : scaled(40);
  int done = 0, with_rows_near_the_largest = 0;
  for (int seed = 0; seed < count; ++seed) {
    const std::string text = RandomScene(static_cast<unsigned>(seed)).text();
    CAPTURE(seed, text);
    const Written written = run_and_read(folder, text);
    const double largest = written.summary["largest_energy_error"];
    const double in_play = written.summary["energy_in_play"];
    REQUIRE(written.largest_row <= largest);
    with_rows_near_the_largest += written.largest_row > .5 * largest;
    if (written.status != Run::Status::done) {
      CHECK(written.status == Run::Status::unstable);
      continue;
    }
    ++done;
    // Nothing that has made energy ends well.
    CHECK(written.last_row <= .1 * in_play);
    CHECK(written.fall <= .1 * in_play);
    // The verdict and the largest force do not depend on what is written.
    const Written other = run_and_read(folder, text, 10.);
    CHECK(other.status == Run::Status::done);
    CHECK(other.summary["final_state_hash"] == written.summary["final_state_hash"]);
    for (const char* extreme : {"largest_contact_force", "largest_penetration", "energy_in_play"}) {
      CHECK(other.summary[extreme] == written.summary[extreme]);
    }
    CHECK(other.summary["largest_energy_error"] <= largest);
  }
  CHECK(done > .9 * count);
  // Of a handful, all may be largest between two rows.
  if (count >= 40) CHECK(with_rows_near_the_largest > 0);
}

TEST_CASE("extremes are those of every step, beside a mesh as well", "[run][energy]") {
  const Folder folder;
  for (const char* floor :
       {R"("mesh": { "rectangle": { "size": [1, 0.3], "cells": [8, 3], "origin": [-0.5, -0.3] } },
           "supports": [{ "where": { "group": "bottom" }, "fix": ["x", "y"] }])",
        R"("motion": "fixed", "polygon": [[-0.5, -0.3], [0.5, -0.3], [0.5, 0], [-0.5, 0]])"}) {
    nlohmann::json first;
    for (const char* interval : {"1e-5", "3e-4", "7e-3", "1"}) {
      CAPTURE(floor, interval);
      const Written written = run_and_read(folder, std::string(R"({ "gravity": [0, -9.81],
        "materials": { "m": { "density": 2000, "young": 1e9, "poisson": 0.2 } },
        "contact": { "normal_stiffness": 1e8, "reference": 0.02, "penetration_warning": 10 },
        "bodies": [ { "name": "floor", "material": "m", )") +
                                                       floor + R"( },
          { "name": "a", "material": "m", "velocity": [0.2, -1], "spin": 0.7,
            "polygon": [[-0.3, 0.005], [-0.1, 0.02], [-0.12, 0.2], [-0.3, 0.18]] },
          { "name": "b", "material": "m", "velocity": [-0.3, -1],
            "polygon": [[0.1, 0.003], [0.3, 0.05], [0.2, 0.2]] } ],
        "time": { "end": 0.02, "step": 1e-5 },
        "output": { "frames": 1, "history": { "interval": )" +
                                                       interval + " } } }");
      REQUIRE(written.status == Run::Status::done);
      if (first.is_null()) first = written.summary;
      CHECK(first.contains("largest_contact_force"));
      for (const char* extreme : {"largest_contact_force", "largest_penetration"}) {
        CHECK(written.summary[extreme] == first[extreme]);
      }
    }
  }
}

// Blocks fall on each other at 5 and 10 m/s, where contacts begin and end in every step. Impulses
// of such contacts have made up to a tenth of the energy where dashpots take most of the speed in a
// step.
TEST_CASE("a dense flow of damped blocks makes no energy at long steps", "[run][energy][slow]") {
  const Folder folder;
  const std::vector<double> accuracies = kSanitized ? std::vector{.1} : std::vector{.1, .03, .004};
  std::uint64_t number = 0;
  for (const double ratio : {.5, 1.}) {
    for (const double accuracy : accuracies) {
      for (const double speed : {5., 10.}) {
        if (!is_taken(number++)) continue;
        CAPTURE(ratio, accuracy, speed);
        const Written written =
            run_and_read(folder, fmt::format(R"({{ "gravity": [0, -9.81],
          "materials": {{ "rock": {{ "density": 2000 }} }},
          "contact": {{ "normal_stiffness": 2e7, "damping": {{ "model": "viscous", "ratio": {} }} }},
          "bodies": [
            {{ "name": "left", "material": "rock", "motion": "fixed", "polygon": [[-0.6, -0.2], [-0.4, -0.2], [-0.4, 9], [-0.6, 9]] }},
            {{ "name": "right", "material": "rock", "motion": "fixed", "polygon": [[0.4, -0.2], [0.6, -0.2], [0.6, 9], [0.4, 9]] }},
            {{ "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-0.4, -0.2], [0.4, -0.2], [0.4, 0], [-0.4, 0]] }} ],
          "fill": [ {{ "name": "block", "material": "rock", "count": 60, "velocity": [0, {}],
                       "region": [[-0.39, 0.01], [0.39, 0.01], [0.39, 4], [-0.39, 4]], "shapes": [ {{ "quadrilateral": {{}} }} ],
                       "diameter": {{ "uniform_area": [0.089, 0.109] }} }} ],
          "time": {{ "end": {}, "accuracy": {} }}, "output": {{ "frames": 0, "history": {{ "interval": 0.05 }} }} }})",
                                             ratio, -speed, 5 / speed, accuracy));
        CHECK(written.status == Run::Status::done);
        const double error = written.summary["largest_energy_error"];
        CHECK(error < .01 * written.summary["energy_in_play"].get<double>());
      }
    }
  }
}

namespace {

// A push that does work and does not say so.
class Thief final : public Term {
 public:
  [[nodiscard]] std::string describe() const override { return "a thief"; }
  void add_forces(const Evaluation& now) override { now.state.f[0] += 2e4; }
};

}  // namespace

TEST_CASE("a run that is stepped by hand has the verdict of its end as well", "[run][energy]") {
  const Folder folder;
  const Scene scene = scene_of(folder, flying_block(R"(, "velocity": [1, 0])"));
  const auto steal = [](Run& run) { run.simulation().add(std::make_unique<Thief>()); };
  // Until .1 s there is no look by itself.
  Scene brief = scene;
  brief.time.end = .1;
  Run ran(brief, {});
  steal(ran);
  CHECK(ran.run() == Run::Status::unstable);
  CHECK_THAT(ran.message(), Catch::Contains("unaccounted for"));
  Run stepped(brief, {});
  steal(stepped);
  for (int i = 0; i < 99; ++i) REQUIRE(stepped.step());
  CHECK_THROWS_WITH(stepped.step(), Catch::Contains("unaccounted for"));
  CHECK(stepped.status() == Run::Status::unstable);
  // One that goes on is not judged there.
  Run begun(scene, {});
  steal(begun);
  CHECK(begun.run(.1) == Run::Status::done);
}
