// Statistics of many bodies: regions, mean stresses, coordination numbers.
#include <catch2/catch.hpp>
#include <cmath>

#include "geometry/exact/overlap.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/model/statistics.hpp"
#include "tests/shapes.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

namespace statistics {
namespace {

RigidBody body_of(const Polygon& polygon, Model& model) {
  RigidBody body;
  set_shape(body, polygon, model);
  return body;
}

Model empty() {
  Model model;
  model.thickness = .5;
  model.materials = {{"rock", 2000}};
  return model;
}

State start_of(const Model& model) {
  State state({static_cast<int>(model.bodies.size()), 0});
  for (size_t i = 0; i < model.bodies.size(); ++i) {
    const RigidBody& b = model.bodies[i];
    state.pose(static_cast<int>(i)) << b.position, b.angle;
    state.pose_rate(static_cast<int>(i)) << b.velocity, b.spin;
  }
  return state;
}

Region region_of(const std::vector<std::vector<Vec2>>& parts) {
  double area = 0;
  for (const auto& part : parts) area += area_moments(Polygon(part)).area;
  return {"bin", parts, area};
}

}  // namespace

TEST_CASE("a pressed block has the mean stress of its pressures", "[statistics]") {
  Model model = empty();
  model.bodies = {body_of(samples::block(0, 0, 2, 1), model)};
  model.bodies.push_back(body_of(samples::block(-5, -1, 5, 0), model));
  model.bodies.push_back(body_of(samples::block(-5, 1, 5, 2), model));
  model.regions = {region_of({{{0, 0}, {2, 0}, {2, 1}, {0, 1}}})};
  const State state = start_of(model);
  // 300 N from below and above, with friction of 40 N that shears the block.
  std::vector<ContactRecord> contacts(2);
  contacts[0] = {.a = 0, .b = 1, .point = {1, 0}, .normal = {0, 300}, .tangential = {-40, 0}};
  contacts[1] = {.a = 0, .b = 2, .point = {1, 1}, .normal = {0, -300}, .tangential = {40, 0}};
  const std::vector<BodyStatistics> bodies = body_statistics(model, state, contacts, {});
  CHECK(bodies[0].coordination == 2);
  CHECK(bodies[1].coordination == 1);
  const double volume = 2 * .5;
  CHECK(bodies[0].stress.yy == Approx(-300 / volume).epsilon(1e-13));
  CHECK(std::abs(bodies[0].stress.xx) < 1e-12);
  // The mean of the force couples 40 N x 1 m along x, and the balance of moments, halves it.
  CHECK(bodies[0].stress.xy == Approx(20 / volume).epsilon(1e-13));
  const RegionSums sums = region_sums(model, state, {}, contacts, bodies)[0];
  CHECK(sums.count == 1);
  CHECK(sums.stress.yy / sums.volume == Approx(-300).epsilon(1e-13));
  CHECK(sums.fabric.yy / sums.contacts == 1);
  CHECK(sums.force / sums.contacts == 300);
  CHECK(spread(sums) == 0);
}

TEST_CASE("two patches between two bodies are one of the coordination number", "[statistics]") {
  Model model = empty();
  for (int i = 0; i < 3; ++i)
    model.bodies.push_back(body_of(samples::block(2 * i, 0, 2 * i + 1, 1), model));
  std::vector<ContactRecord> contacts(3);
  contacts[0] = {.a = 0, .b = 1}, contacts[1] = {.a = 0, .b = 1}, contacts[2] = {.a = 1, .b = 2};
  const auto bodies = body_statistics(model, start_of(model), contacts, {});
  CHECK(bodies[0].coordination == 1);
  CHECK(bodies[1].coordination == 2);
}

TEST_CASE("bodies that are held do not count, meshed or rigid", "[statistics]") {
  Model model = empty();
  const std::vector<std::array<bool, 3>> fixes{
      {false, false, false}, {true, true, true}, {true, true, false}, {false, true, true}};
  for (const auto& held : fixes) {
    model.bodies.push_back(body_of(samples::block(0, 0, 1, 1), model));
    model.bodies.back().held = held;
  }
  const auto moved = [] {
    MotionHistory motion;
    motion.velocity = {{0, {1, 0}}};
    return motion;
  }();
  const auto hold = [](bool x, bool y, const MotionHistory& motion = {}) {
    Support support;
    support.nodes = {0, 1}, support.held = {x, y}, support.motion = motion;
    return support;
  };
  const std::vector<std::vector<Support>> supports{{},
                                                   {hold(true, true)},
                                                   {hold(false, true), hold(true, false)},
                                                   {hold(false, true)},
                                                   {hold(true, false, moved)}};
  for (const auto& of : supports) {
    DeformableBody body;
    body.mesh = rectangle_mesh({1, 1}, {1, 1}, {0, 0}, ElementShape::quadrilateral);
    body.first_node = model.node_count();
    body.supports = of;
    model.deformables.push_back(body);
  }
  const std::vector<bool> free{true, false, false, true, true, false, false, true, false};
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(free.size()); ++b) {
    INFO(b);
    CHECK(is_free(model, b) == free[static_cast<size_t>(b)]);
  }
  model.regions = {region_of({{{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}})};
  State state({4, model.node_count()});
  for (int i = 0; i < 4; ++i) state.pose(i) << model.bodies[static_cast<size_t>(i)].position, 0;
  const std::vector<double> mass(static_cast<size_t>(model.node_count()), 250);
  // 1 Pa in each mesh of 0.5 m^3.
  const std::vector<CauchyStress> stress(5, {.xx = 1, .yy = 0, .xy = 0, .zz = 0});
  const auto bodies = body_statistics(model, state, {}, stress);
  const RegionSums sums = region_sums(model, state, mass, {}, bodies)[0];
  CHECK(sums.count == 4);
  CHECK(sums.mass == Approx(4 * 1000));
  CHECK(sums.stress.xx == Approx(2 * .5));
  CHECK(sums.solid_area == Approx(9));
  CHECK(crowd_in(model, state, mass, 0).members == std::vector<BodyIndex>{0, 3, 4, 7});
  // In equilibria supports bear what is looked at; a body of groups has the volume of its elements.
  model.deformables[1].element_material = {1};
  model.materials.push_back({"light", 400});
  const RegionSums still = region_sums(model, state, mass, {}, bodies, true)[0];
  CHECK(still.count == 4);
  CHECK(still.stress.xx == Approx(5 * .5));
}

TEST_CASE("the solid fraction of a region is the exact overlap", "[statistics]") {
  // An L as two convex parts, and stars that lie across its border at many angles.
  const std::vector<std::vector<Vec2>> parts{{{0, 0}, {3, 0}, {3, 1}, {0, 1}},
                                             {{0, 1}, {1, 1}, {1, 3}, {0, 3}}};
  const Polygon whole({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}});
  const Region region = region_of(parts);
  CHECK(region.area == Approx(5));
  for (int i = 0; i < 60; ++i) {
    std::vector<Vec2> star;
    for (int k = 0; k < 10; ++k) {
      const double a = .3 * i + k * M_PI / 5, r = k % 2 == 0 ? .8 : .3;
      star.emplace_back(.05 * i + r * std::cos(a), .04 * i + r * std::sin(a));
    }
    double exact = 0;
    for (const OverlapPolygon& part : overlap_polygons(Polygon(star), whole, Vec2(0, 0))) {
      exact += area_moments(Polygon(part.vertices)).area;
    }
    CHECK(region.overlap(star) == Approx(exact).epsilon(1e-12).margin(1e-14));
  }
}

TEST_CASE("regions count free bodies by their mass centres", "[statistics]") {
  Model model = empty();
  for (int i = 0; i < 4; ++i)
    model.bodies.push_back(body_of(samples::block(i, 0, i + .5, .5), model));
  model.bodies[1].motion = Motion::fixed;
  model.bodies[2].velocity = {2, -1};
  model.bodies[2].spin = 3;
  model.regions = {region_of({{{0, 0}, {2.3, 0}, {2.3, 1}, {0, 1}}})};
  State state = start_of(model);
  const auto sums = [&] {
    return region_sums(model, state, {}, {}, body_statistics(model, state, {}, {}))[0];
  };
  // Bodies 0 and 2 are counted; of body 2 a part is outside, and body 1 takes space.
  CHECK(sums().count == 2);
  CHECK(sums().mass == Approx(2 * 2000 * .25 * .5));
  CHECK(sums().momentum.x() == Approx(250 * 2));
  CHECK(sums().translation == Approx(250 * 5 / 2.));
  CHECK(sums().rotation == Approx(model.bodies[2].inertia * 9 / 2));
  CHECK(sums().solid_area == Approx(.25 + .25 + .3 * .5));
  CHECK(crowd_in(model, state, {}, 0).members == std::vector<BodyIndex>{0, 2});
  CHECK(crowd_in(model, state, {}, -1).members == std::vector<BodyIndex>{0, 2, 3});
  state.absent = {0, 0, 2, 1};
  CHECK(sums().count == 1);
  CHECK(sums().solid_area == Approx(.5));
  CHECK(crowd_in(model, state, {}, -1).kinetic == 0);
}

}  // namespace statistics
