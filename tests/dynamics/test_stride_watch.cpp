// Bodies that move far in a step: free where nothing is near, an error where contacts would be
// missed, and never through each other in silence.
#include "lib/dynamics/stride_watch.hpp"

#include <catch2/catch.hpp>

#include "lib/dynamics/unstable.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/dynamics/surface_models.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

RigidBody& add_rigid(Model& model, const char* name, const Polygon& polygon, const Vec2& velocity,
                     Motion motion = Motion::free) {
  RigidBody body;
  body.name = name;
  body.motion = motion;
  body.velocity = velocity;
  set_shape(body, polygon, model);
  model.bodies.push_back(std::move(body));
  return model.bodies.back();
}

Model soft_model() {
  Model model = empty_model();
  model.contact.normal_stiffness = 1e5;
  return model;
}

Mesh plate_mesh(double x0, double y0, double x1, double y1) {
  return rectangle_mesh({x1 - x0, y1 - y0},
                        {static_cast<int>(std::lround((x1 - x0) / .1)),
                         static_cast<int>(std::lround((y1 - y0) / .1))},
                        {x0, y0}, ElementShape::quadrilateral);
}

// What a run of so many steps says; empty if it does not stop.
std::string message(const Model& model, double step, int steps, int threads = 1,
                    std::int64_t* stopped = nullptr) {
  Simulation simulation(model, {.end = 1e9, .fixed_step = step}, 1, threads);
  try {
    for (int i = 0; i < steps; ++i) simulation.step();
  } catch (const Unstable& error) {
    if (stopped) *stopped = simulation.state().step;
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a pebble in free flight may go any way in a step", "[stride]") {
  Model model = soft_model();
  model.gravity = {0, -10};
  add_rigid(model, "floor", samples::block(-2, -1, 0, 0), {0, 0}, Motion::fixed);
  add_rigid(model, "resting", samples::block(-1, -1e-4, -.5, .3), {0, 0});
  add_rigid(model, "pebble", samples::block(.5, 0, .51, .01), {30, 0});
  Simulation simulation(model, {.end = 10, .fixed_step = 1e-3}, 1, 1);
  for (int i = 0; i < 3000; ++i) REQUIRE_NOTHROW(simulation.step());
  const double t = simulation.state().time;
  CHECK(simulation.state().pose(2)[0] == Approx(.505 + 30 * t).epsilon(1e-12));
  CHECK(simulation.state().pose(2)[1] == Approx(.005 - 5 * t * t).epsilon(1e-12));
  CHECK(std::abs(simulation.state().pose(1)[1] - .15) < .01);  // the pile is as it was
}

TEST_CASE("a pebble in a hollow of a body is far from it until it lands", "[stride]") {
  Model model = soft_model();
  add_rigid(
      model, "cup",
      Polygon({{-1, -1}, {9, -1}, {9, 5}, {8.5, 5}, {8.5, -.5}, {-.5, -.5}, {-.5, 5}, {-1, 5}}),
      {0, 0}, Motion::fixed);
  add_rigid(model, "pebble", samples::block(4, 4, 4.01, 4.01), {0, -10});
  std::int64_t stopped = 0;
  const std::string what = message(model, 1e-3, 10000, 1, &stopped);
  CHECK_THAT(what, Catch::Contains("\"pebble\"") && Catch::Contains("\"cup\"") &&
                       Catch::Contains("contacts would be missed"));
  CHECK(stopped == 450);  // on the step that would reach the bottom, 4.5 m below
}

TEST_CASE("bodies that fly together are no danger to each other", "[stride]") {
  Model model = soft_model();
  add_rigid(model, "lower", samples::block(0, 0, .1, .1), {100, 0});
  add_rigid(model, "upper", samples::block(0, .09999, .1, .2), {100, 0});
  Simulation simulation(model, {.end = 10, .fixed_step = 1e-3}, 1, 1);
  for (int i = 0; i < 50; ++i) REQUIRE_NOTHROW(simulation.step());
  CHECK(simulation.state().pose(0)[0] == Approx(5.05).epsilon(1e-9));
  CHECK(simulation.extremes().force.value > 0);
}

TEST_CASE("a bullet does not go through a thin plate", "[stride]") {
  // Where it goes, and how thin the plate is against its stride.
  for (const double speed : {30., 300., 3000.}) {
    for (const bool spinning : {false, true}) {
      Model model = soft_model();
      add_rigid(model, "plate", samples::block(5, -2, 5.04, 2), {0, 0}, Motion::fixed);
      add_rigid(model, "bullet", samples::block(0, 0, .05, .05), {speed, 0}).spin = spinning * 5;
      CAPTURE(speed, spinning);
      CHECK_THAT(message(model, 1e-3, 2000), Catch::Contains("\"bullet\"") &&
                                                 Catch::Contains("\"plate\"") &&
                                                 Catch::Contains("contacts would be missed"));
      // The same plate out of its way.
      model.bodies[0].position.y() += 2.1;
      CHECK(message(model, 1e-3, 500).empty());
    }
  }
}

TEST_CASE("nothing goes through a mesh, and no mesh through anything", "[stride]") {
  enum class Kind { rigid, mesh };
  for (const ContactSurface surface : {ContactSurface::body, ContactSurface::element}) {
    for (const auto& [plate, bullet] :
         {std::pair(Kind::mesh, Kind::rigid), std::pair(Kind::rigid, Kind::mesh),
          std::pair(Kind::mesh, Kind::mesh)}) {
      Model model = empty_model();
      model.contact.normal_stiffness = 1e7;
      model.contact.surface = surface;
      model.contact.distribution = surface == ContactSurface::body ? ForceDistribution::variational
                                                                   : ForceDistribution::resultant;
      const Vec2 speed(3000, 0);
      if (plate == Kind::rigid) add_rigid(model, "plate", samples::block(1, -1, 1.1, 1), {0, 0});
      if (bullet == Kind::rigid) add_rigid(model, "bullet", samples::block(0, 0, .1, .1), speed);
      if (plate == Kind::mesh) {
        add(model, "plate", plate_mesh(1, -1, 1.1, 1), ElementKind::quad4, {0, 0});
      }
      if (bullet == Kind::mesh) {
        add(model, "bullet", plate_mesh(0, 0, .1, .1), ElementKind::quad4, speed);
      }
      CAPTURE(static_cast<int>(surface), static_cast<int>(plate), static_cast<int>(bullet));
      const double limit = Simulation(model, {.end = 1}, 1, 1).step_choice().stability;
      const double step = std::min(.9 * limit, 2e-5);  // 6 cm in a step, through 10 cm
      std::int64_t stopped = 0;
      const std::string what = message(model, step, 200, 1, &stopped);
      CHECK_THAT(what, Catch::Contains("\"bullet\"") && Catch::Contains("\"plate\""));
      // Before its middle is in that of the plate.
      CHECK(static_cast<double>(stopped) * step * speed.x() < 1.05);
    }
  }
}

TEST_CASE("a mesh that is too soft to stop a body stops the run", "[stride]") {
  for (const bool meshed : {false, true}) {
    Model model = empty_model();
    model.contact.normal_stiffness = 1e5;  // small steps, and hardly any force
    if (!meshed) add_rigid(model, "bullet", samples::block(.8, 0, .9, .1), {20, 0});
    add(model, "plate", plate_mesh(1, -.5, 1.2, .5), ElementKind::quad4, {0, 0});
    if (meshed) add(model, "bullet", plate_mesh(.8, 0, .9, .1), ElementKind::quad4, {20, 0});
    const double limit = Simulation(model, {.end = 1}, 1, 1).step_choice().stability;
    CAPTURE(meshed);
    CHECK_THAT(message(model, .5 * limit, static_cast<int>(.05 / limit)),
               Catch::Contains("\"bullet\"") && Catch::Contains("\"plate\"") &&
                   Catch::Contains("pass through each other") &&
                   Catch::Contains("contact.normal_stiffness"));
  }
}

TEST_CASE("many fast bodies are judged like few, with any number of threads", "[stride]") {
  // A shower of pebbles; one of them has something in its way.
  const auto shower = [](int count, int threads) {
    Model model = soft_model();
    add_rigid(model, "post", samples::block(3.99, -1.5, 4.03, -1.01), {0, 0}, Motion::fixed);
    for (int i = 0; i < count; ++i) {
      const double x = 4 - .1 * i;
      add_rigid(model, ("pebble " + std::to_string(i)).c_str(), samples::block(x, 0, x + .02, .02),
                {0, -40});
    }
    std::int64_t stopped = 0;
    const std::string what = message(model, 1e-3, 100, threads, &stopped);
    CHECK(stopped == 26);  // on the step that would reach it
    return what;
  };
  const std::string few = shower(3, 1);
  CHECK_THAT(few, Catch::Contains("\"pebble 0\"") && Catch::Contains("\"post\""));
  CHECK(shower(40, 1) == few);
  CHECK(shower(4000, 3) == few);
}
