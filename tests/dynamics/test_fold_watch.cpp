// Bodies that fold onto themselves are noticed where that contact is not asked for.
#include <catch2/catch.hpp>

#include "lib/dynamics/unstable.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/dynamics/surface_models.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("a long strip that is bent until its ends meet is refused", "[surface]") {
  for (const bool alone : {true, false}) {
    Model model = empty_model();
    model.contact.surface = alone ? ContactSurface::body : ContactSurface::element;
    model.contact.distribution = ForceDistribution::resultant;
    if (!alone) add_floor(model);
    // Most of a circle of 1 m about (0, 3); the free end comes up to the held one.
    Mesh strip = rectangle_mesh({5.9, .1}, {59, 2}, {.2, .95}, ElementShape::quadrilateral);
    for (Vec2& x : strip.nodes) {
      const double angle = x.x(), radius = 2 - x.y();
      x = Vec2(0, 3) + radius * Vec2(std::cos(angle), std::sin(angle));
    }
    reorder_along_curve(strip);
    const auto end = [&](double angle) {
      std::vector<int> nodes;
      for (int i = 0; i < static_cast<int>(strip.nodes.size()); ++i) {
        const Vec2 arm = strip.nodes[i] - Vec2(0, 3);
        const Vec2 direction(std::cos(angle), std::sin(angle));
        if (std::abs(cross(direction, arm)) < 1e-9 && arm.dot(direction) > 0) nodes.push_back(i);
      }
      REQUIRE(nodes.size() == 3);
      return nodes;
    };
    MotionHistory up;
    up.velocity = {{0, {0, 20}}};
    const std::vector<Support> supports{{end(.2), {true, true}, {}}, {end(6.1), {true, true}, up}};
    add(model, "strip", std::move(strip), ElementKind::quad4, {0, 0});
    model.deformables[0].supports = supports;
    TimeSettings time;
    time.end = .05;
    Simulation simulation(model, time, 1, 1);
    std::string what;
    try {
      while (simulation.state().time < time.end) simulation.step();
    } catch (const Unstable& error) {
      what = error.what();
    }
    CAPTURE(what, simulation.state().time);
    CHECK(what.find("\"strip\" folds onto itself at (") == 0);
    CHECK(what.find("say \"self_contact\": \"compute\"") != std::string::npos);
    // The ends are sin(.2) + sin(.183) of the radius apart.
    CHECK(simulation.state().time == Approx(.38 / 20).epsilon(.1));
  }
}
