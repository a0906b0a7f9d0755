// Values that are legal but hardly meant.
#include "lib/scene/plausibility.hpp"

#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

const std::string kUsual = R"({ "gravity": [0, -9.81],
  "materials": { "rock": { "density": 2000, "young": 20e9, "poisson": 0.2 } },
  "contact": { "normal_stiffness": 20e9, "friction": { "coefficient": 0.5, "tangential_stiffness": 1e9 } },
  "bodies": [
    { "name": "floor", "material": "rock", "motion": "fixed", "polygon": [[-5, -2], [5, -2], [5, 0], [-5, 0]] },
    { "name": "block", "material": "rock", "angle": 0.5, "velocity": [0, -3],
      "polygon": [[0, 1], [1, 1], [1, 2], [0, 2]] } ],
  "time": { "end": 0.1 } })";

std::vector<std::string> found(const std::string& old, const std::string& changed) {
  const Folder folder;
  std::string text = kUsual;
  if (!old.empty()) text.replace(text.find(old), old.size(), changed);
  return unlikely_values(read_scene(folder.write("scene.json", text)));
}

}  // namespace

TEST_CASE("a usual scene has no unlikely values", "[plausibility]") {
  CHECK(found("", "").empty());
}

TEST_CASE("the shipped scenes have no unlikely values", "[plausibility][slow]") {
  for (const auto& entry : std::filesystem::directory_iterator(kSource + "/data/scenes")) {
    if (entry.path().extension() != ".json") continue;
    INFO(entry.path());
    CHECK(unlikely_values(read_scene(entry.path())).empty());
  }
}

TEST_CASE("an unlikely value is named by its key, with its line", "[plausibility]") {
  const auto [old, changed, key, word] =
      GENERATE(table<const char*, const char*, const char*, const char*>({
          {"\"density\": 2000", "\"density\": 2", ":2: /materials/rock/density", "kg/m^3"},
          {"\"normal_stiffness\": 20e9", "\"normal_stiffness\": 20e5",
           ":3: /contact/normal_stiffness", "Young's modulus"},
          {"\"normal_stiffness\": 20e9", "\"normal_stiffness\": 20e13",
           ":3: /contact/normal_stiffness", "time step"},
          {"\"coefficient\": 0.5", "\"coefficient\": 30", ":3: /contact/friction/coefficient",
           "tangent"},
          {"\"coefficient\": 0.5", "\"coefficient\": 0.8", ":3: /contact/friction",
           "may begin to rock"},
          {"\"angle\": 0.5", "\"angle\": 30", ":6: /bodies/1/angle", "30 degrees are 0.523599 rad"},
          {"[0, -3]", "[0, -3000]", ":6: /bodies/1/velocity", "m/s"},
          {"[0, -9.81]", "[0, -9810]", ":1: /gravity", "9.81"},
          {"[[0, 1], [1, 1], [1, 2], [0, 2]]", "[[0, 1], [200, 1], [200, 201], [0, 201]]",
           ":4: /bodies", "not in mm"},
      }));
  INFO(changed);
  const std::vector<std::string> lines = found(old, changed);
  REQUIRE(lines.size() == 1);
  CHECK_THAT(lines[0], Catch::Contains(key) && Catch::Contains(word));
}

TEST_CASE("Young's modulus in GPa is told twice", "[plausibility]") {
  const std::vector<std::string> lines = found("\"young\": 20e9", "\"young\": 210");
  REQUIRE(lines.size() == 2);  // and it is far from the stiffness of contact
  CHECK_THAT(lines[0], Catch::Contains("/materials/rock/young") && Catch::Contains("210 Pa"));
  CHECK_THAT(lines[1], Catch::Contains("/contact/normal_stiffness"));
}
