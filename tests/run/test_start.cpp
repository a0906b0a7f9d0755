// The start of a run: overlaps, and what can be said before.
#include "lib/run/start.hpp"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/run/scenes.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// A block whose lower side is so far below the surface of a floor; its inradius is 0.5 m.
std::string sunk(double depth, const std::string& contact = "", const std::string& time = "") {
  return fmt::format(R"({{ "gravity": [0, -10], "materials": {{ "rock": {{ "density": 2000 }} }},
    "contact": {{ "normal_stiffness": 2e9{} }},
    "bodies": [
      {{ "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-5, -2], [5, -2], [5, 0], [-5, 0]] }},
      {{ "name": "block", "material": "rock", "polygon": [[0, {}], [1, {}], [1, {}], [0, {}]] }} ],
    "time": {{ "end": 0.1{} }} }})",
                     contact, -depth, -depth, 1 - depth, 1 - depth, time);
}

}  // namespace

TEST_CASE("bodies that overlap by more than a touch are refused", "[start]") {
  const Folder folder;
  const Scene deep = scene_of(folder, sunk(.1));
  CHECK_THROWS_WITH(make_simulation(deep, 1),
                    Catch::Contains("/bodies/1") && Catch::Contains("\"floor\" and \"block\"") &&
                        Catch::Contains("0.1 m") && Catch::Contains("20 %") &&
                        Catch::Contains(" J") && Catch::Contains("\"overlaps\": \"accept\""));
  CHECK_THROWS_AS(Run(deep, {}), SceneError);
}

TEST_CASE("bodies that rest in contact, or nearly touch, are not refused", "[start]") {
  const Folder folder;
  for (const double depth : {-1e-3, 0., 1e-16, 3e-6, 4e-4}) {
    CHECK_NOTHROW(make_simulation(scene_of(folder, sunk(depth)), 1));
  }
}

TEST_CASE("a scene may accept overlaps, or settle first", "[start]") {
  const Folder folder;
  const Scene accepted = scene_of(folder, sunk(.1, R"(, "overlaps": "accept")"));
  const auto simulation = make_simulation(accepted, 1);
  CHECK_THAT(describe_overlaps(*simulation), Catch::Contains("\"floor\" and \"block\" by 0.1 m"));
  CHECK_NOTHROW(make_simulation(
      scene_of(folder, sunk(.1, R"(, "overlaps": "refuse")", R"(, "start": "settled")")), 1));
}

TEST_CASE("no overlap, nothing to say", "[start]") {
  const Folder folder;
  CHECK(describe_overlaps(*make_simulation(scene_of(folder, sunk(-.1)), 1)).empty());
  CHECK(describe_overlaps(*make_simulation(scene_of(folder, sunk(1e-16)), 1)).empty());
}

TEST_CASE("the energy of the overlaps is that of the contact", "[start]") {
  // Flat, to a depth d small against the inradii: k_n (1/r_a + 1/r_b) d^2 / 2 per length.
  const Folder folder;
  const double depth = 4e-4;
  const std::string text = describe_overlaps(*make_simulation(scene_of(folder, sunk(depth)), 1));
  const double energy = std::stod(text.substr(text.find("energy") + 6));
  CHECK(energy == Approx(2e9 * (1 / .5 + 1 / 1.) * depth * depth / 2).epsilon(.01));
}

TEST_CASE("a trial steps for a while, or to the end", "[start]") {
  const Folder folder;
  const Trial whole = try_steps(scene_of(folder, flying_block()), 1, 1000);
  CHECK(whole.steps == 500);
  CHECK(whole.message.empty());
  CHECK(whole.seconds > 0);
  const Trial none = try_steps(scene_of(folder, flying_block()), 1, 1e-9);
  CHECK(none.steps == 1);
}
