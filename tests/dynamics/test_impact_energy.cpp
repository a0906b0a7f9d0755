// What impacts of deformable bodies do to the energy: the shipped scenes with every kind of
// element, by the bodies' own surfaces and by potentials of their elements.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/dynamics/simulation.hpp"
#include "lib/scene/scene.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using Json = nlohmann::json;

namespace {

const std::array kShapes{"Q4", "T3", "voronoi"};
// One of them under the sanitizers.
const std::vector<const char*> kScenes =
    test::kSanitized ? std::vector{"corner-impact"}
                     : std::vector{"oblique-discs", "block-on-foundation", "corner-impact"};

// As many cells as the quadrilaterals were.
Json voronoi(const Json& mesh) {
  if (mesh.contains("rectangle")) {
    Json cells = mesh["rectangle"];
    cells["cells"] = cells["cells"][0].get<int>() * cells["cells"][1].get<int>();
    return {{"voronoi", cells}};
  }
  const Json& disc = mesh["disc"];
  const double radius = disc["radius"];
  const int quarter = disc["cells"];
  const std::vector<double> centre = disc.value("centre", std::vector<double>{0, 0});
  Json ring = Json::array();
  for (int i = 0; i < 4 * quarter; ++i) {
    const double angle = 2 * M_PI * i / (4 * quarter);
    ring.push_back({centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle)});
  }
  return {{"voronoi", {{"polygon", ring}, {"cells", 2 * quarter * quarter}}}};
}

Json shipped(const std::string& name, const std::string& shape) {
  const std::string text = test::content(test::kSource + "/data/scenes/" + name + ".json");
  Json scene = Json::parse(text, nullptr, true, true);
  for (Json& body : scene["bodies"]) {
    if (shape == "T3") body["mesh"]["element"] = "T3";
    if (shape == "voronoi") body["mesh"] = voronoi(body["mesh"]);
  }
  return scene;
}

Scene read(const Json& scene) {
  const test::Folder folder;
  return read_scene(folder.write("scene.json", scene.dump()));
}

// Largest energy error at any step, of the kinetic energy at the start.
double worst_error(const Scene& scene, double safety) {
  TimeSettings time = scene.time;
  time.element_safety = safety;
  Simulation simulation(scene.model, time, 1, 1);
  const double kinetic = simulation.energies().kinetic;
  double worst = 0, pressed = 0;
  while (simulation.state().time < time.end) {
    simulation.step();
    const Energies e = simulation.energies();
    worst = std::max(worst, std::abs(e.total_error) / kinetic);
    pressed = std::max(pressed, e.contact / kinetic);
  }
  CHECK(pressed > .01);
  CHECK(simulation.energies().contact == 0);  // apart again
  return worst;
}

// With APOTHEM_LONG a row of the table in docs/verification.md: the errors at safety .4, .2, .1.
void print_row(const std::string& name, const std::string& shape, const std::string& law,
               const Scene& scene) {
  if (!test::long_run()) return;
  fmt::print("{} {} {}: {:.1e} / {:.1e} / {:.1e}\n", name, shape, law, worst_error(scene, .4),
             worst_error(scene, .2), worst_error(scene, .1));
}

}  // namespace

TEST_CASE("an impact keeps the energy to 1e-4 at the usual step, and with its square",
          "[surface][impact_energy][slow]") {
  for (const char* name : kScenes) {
    for (const char* shape : kShapes) {
      const Scene scene = read(shipped(name, shape));
      CHECK_FALSE(scene.time.element_safety);  // the usual one
      const double usual = worst_error(scene, .2), fine = worst_error(scene, .05);
      CAPTURE(name, shape, usual, fine);
      print_row(name, shape, "body", scene);
      CHECK(usual < 1e-4);
      // Each kink where an edge meets a face adds its own phase: not exactly 16.
      CHECK(usual / fine > 8);
      CHECK(usual / fine < 32);
    }
  }
}

TEST_CASE("potentials of elements lose energy at any step", "[surface][impact_energy][slow]") {
  for (const char* distribution : {"resultant", "integrated"}) {
    for (const char* name : kScenes) {
      for (const char* shape : kShapes) {
        Json json = shipped(name, shape);
        json["contact"]["surface"] = "element";
        json["contact"]["distribution"] = distribution;
        const Scene scene = read(json);
        const double usual = worst_error(scene, .2), fine = worst_error(scene, .05);
        CAPTURE(name, shape, distribution, usual, fine);
        print_row(name, shape, distribution, scene);
        CHECK(fine > 2e-4);
        CHECK(usual / fine < 1.3);
      }
    }
  }
}

// All boundary nodes meet the other body in one step, with one phase theta: a spring of stiffness k
// is first seen after (1 - theta) dt, and -k (v dt)^2 theta (1 - theta)/2 is missing.
// Without the correction of such steps, that is.
TEST_CASE("a flat impact is as accurate as others, with the correction of onsets",
          "[surface][impact_energy][slow]") {
  for (const char* shape : kShapes) {
    Json json = shipped("block-on-foundation", shape);
    json["bodies"][1]["angle"] = 0;
    json["bodies"][1]["position"] = {.03, .5004};
    const Scene scene = read(json);
    const double usual = worst_error(scene, .2), fine = worst_error(scene, .05);
    CAPTURE(shape, usual, fine);
    print_row("flat", shape, "body", scene);
    CHECK(usual < 4e-4);
    CHECK(usual / fine > 8);  // order 2, as inside any contact
  }

  Json json = shipped("block-on-foundation", "Q4");
  json["bodies"][1]["angle"] = 0;
  Scene scene = read(json);
  scene.time.onsets = false;
  scene.time.fixed_step = .2 * Simulation(scene.model, scene.time, 1, 1).step_choice().stability;
  const double stride = 20 * *scene.time.fixed_step;
  for (const double theta : {.3, .5, .7}) {
    json["bodies"][1]["position"] = {.03, .5 + theta * stride};
    scene.model = read(json).model;
    Simulation simulation(scene.model, scene.time, 1, 1);
    simulation.step();
    const Energies e = simulation.energies();
    CHECK(e.contact > 0);
    const double stiffness = 20e9 * (1 / .05 + 1 / .0625);  // both bodies' inradii
    CHECK(e.total_error ==
          Approx(-stiffness * stride * stride * theta * (1 - theta) / 2).epsilon(.04));
    const double worst = worst_error(scene, .2) * 4e5;
    CHECK(worst < 1.1 * stiffness * stride * stride / 8);
  }
}
