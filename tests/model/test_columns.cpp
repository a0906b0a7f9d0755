// The quantities of bodies, and the columns of histories.
#include "lib/model/columns.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <iterator>
#include <map>

#include "lib/mesh/rectangle_mesh.hpp"
#include "tests/support.hpp"

using namespace apothem;

namespace {

constexpr double kOriginX = 1024, kOriginY = -512;

// Two rigid bodies, and two meshes of which the second one is looked at.
Model model_of_four() {
  Model model;
  model.origin = {kOriginX, kOriginY};
  model.materials = {{"rock", 2000}};
  for (const char* name : {"one", "two"}) {
    RigidBody body;
    body.name = name;
    set_shape(body, samples::shifted(test::quad_q(), model.origin), model);
    model.bodies.push_back(body);
  }
  for (const char* name : {"soft", "hard"}) {
    DeformableBody body;
    body.name = name;
    body.mesh = rectangle_mesh({2, 1}, {4, 2}, {3, 0}, ElementShape::quadrilateral);
    body.first_node = model.node_count();
    model.deformables.push_back(std::move(body));
  }
  return model;
}

// Masses of all nodes, none like the other.
std::vector<double> masses(const Model& model) {
  std::vector<double> mass;
  for (int i = 0; i < model.node_count(); ++i) mass.push_back(1 + .1 * i);
  return mass;
}

// Those that a history has.
std::map<std::string, double> quantities(const BodyMotion& motion) {
  std::map<std::string, double> values;
  for (const BodyQuantity& quantity : kBodyQuantities) {
    if (quantity.in_histories()) values[quantity.name] = quantity.value({motion, {6, {}}})[0];
  }
  return values;
}

Vec2 turned(const Vec2& arm, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * arm.x() - s * arm.y(), s * arm.x() + c * arm.y()};
}

}  // namespace

TEST_CASE("every quantity of a rigid body comes from its entries in the state", "[columns]") {
  const Model model = model_of_four();
  State state(Layout{2, model.node_count()});
  state.pose(1) << .5, -.25, .3;
  state.pose_rate(1) << 7, -8, 9;
  state.f[state.layout.rigid(1)] = 11;
  state.f[state.layout.rigid(1) + 1] = -12;
  const std::map<std::string, double> found =
      quantities(motion_of(model, state, 1, {0, 0, 13}, masses(model)));
  const std::map<std::string, double> expected{
      {"x", kOriginX + .5}, {"y", kOriginY - .25}, {"angle", .3}, {"vx", 7},
      {"vy", -8},           {"spin", 9},           {"fx", 11},    {"fy", -12},
      {"friction", 13},     {"coordination", 6}};
  CHECK(found == expected);
}

TEST_CASE("every quantity of a body with a mesh is that of its nodes together", "[columns]") {
  const Model model = model_of_four();
  const std::vector<double> mass = masses(model);
  const DeformableBody& body = model.deformables[1];
  REQUIRE(body.first_node > 0);
  Vec2 centre = Vec2::Zero();
  double whole = 0;
  for (int i = 0; i < static_cast<int>(body.mesh.nodes.size()); ++i) {
    centre += mass[body.first_node + i] * body.mesh.nodes[i];
    whole += mass[body.first_node + i];
  }
  centre /= whole;
  // Turned by an angle about its mass centre, moved and spinning: as a rigid body would.
  const double angle = 2.5, spin = -3;
  const Vec2 way(.75, -1.5), velocity(4, 5);
  State state(Layout{2, model.node_count()});
  for (int i = 0; i < static_cast<int>(body.mesh.nodes.size()); ++i) {
    const Vec2 arm = turned(body.mesh.nodes[i] - centre, angle);
    const NodeIndex node = body.first_node + i;
    state.node(node) = centre + way + arm - body.mesh.nodes[i];
    const Vec2 v = velocity + cross(spin, arm);
    state.v[state.layout.node(node)] = v.x();
    state.v[state.layout.node(node) + 1] = v.y();
  }
  const std::map<std::string, double> found =
      quantities(motion_of(model, state, 3, {21, -22, 23}, mass));
  const std::map<std::string, double> expected{{"x", kOriginX + centre.x() + way.x()},
                                               {"y", kOriginY + centre.y() + way.y()},
                                               {"angle", angle},
                                               {"vx", velocity.x()},
                                               {"vy", velocity.y()},
                                               {"spin", spin},
                                               {"fx", 21},
                                               {"fy", -22},
                                               {"friction", 23},
                                               {"coordination", 6}};
  REQUIRE(found.size() == expected.size());
  for (const auto& [name, value] : expected) {
    INFO(name);
    CHECK(found.at(name) == Approx(value).epsilon(1e-13));
  }
  // The other mesh has not moved.
  const BodyMotion other = motion_of(model, state, 2, {}, mass);
  CHECK(other.angle == 0);
  CHECK(other.velocity == Vec2::Zero());
}

TEST_CASE("the angle of a mesh goes on beyond half a turn", "[columns]") {
  const Model model = model_of_four();
  const std::vector<double> mass = masses(model);
  const DeformableBody& body = model.deformables[1];
  for (const double spin : {7., -11.}) {
    State state(Layout{2, model.node_count()});
    const auto turn = [&](double time) {
      state.time = time;
      for (int i = 0; i < static_cast<int>(body.mesh.nodes.size()); ++i) {
        const NodeIndex node = body.first_node + i;
        const Vec2 place = turned(body.mesh.nodes[i], spin * time);
        state.node(node) = place - body.mesh.nodes[i];
        state.v[state.layout.node(node)] = -spin * place.y();
        state.v[state.layout.node(node) + 1] = spin * place.x();
      }
    };
    turn(0);
    note_turns(model, mass, state);
    for (int i = 1; i <= 10; ++i) {
      turn(.9 * i);  // a whole turn and more between two looks
      CHECK(motion_of(model, state, 3, {}, mass).angle == Approx(spin * .9 * i).epsilon(1e-12));
      note_turns(model, mass, state);
    }
    CHECK(motion_of(model, state, 2, {}, mass).angle == 0);
  }
}

TEST_CASE("stretching a mesh turns nothing, and a lone node moves the mean by its mass",
          "[columns]") {
  const Model model = model_of_four();
  const std::vector<double> mass = masses(model);
  State state(Layout{2, model.node_count()});
  const DeformableBody& body = model.deformables[0];
  const BodyMotion before = motion_of(model, state, 2, {}, mass);
  for (int i = 0; i < static_cast<int>(body.mesh.nodes.size()); ++i) {
    state.node(i) = .1 * (body.mesh.nodes[i] + model.origin - before.place);
  }
  const BodyMotion stretched = motion_of(model, state, 2, {}, mass);
  CHECK(std::abs(stretched.angle) < 1e-14);
  CHECK((stretched.place - before.place).norm() < 1e-12);

  State pulled(Layout{2, model.node_count()});
  double whole = 0;
  for (size_t i = 0; i < body.mesh.nodes.size(); ++i) whole += mass[i];
  pulled.node(4) = Vec2(.5, 0);
  pulled.v[pulled.layout.node(4) + 1] = 6;
  const BodyMotion moved = motion_of(model, pulled, 2, {}, mass);
  CHECK(moved.place.x() - before.place.x() == Approx(.5 * mass[4] / whole).epsilon(1e-9));
  CHECK(moved.velocity.y() == Approx(6 * mass[4] / whole).epsilon(1e-14));
}

TEST_CASE("a rigid body has turned since the start by what its angle has changed", "[columns]") {
  Model model = model_of_four();
  model.bodies[1].angle = .1;
  State state(Layout{2, model.node_count()});
  state.pose(1) << 0, 0, .3;
  CHECK(motion_of(model, state, 1, {}, masses(model)).rotation == .3 - .1);
}

TEST_CASE("each quantity has a name and a unit of its own", "[columns]") {
  std::map<std::string, int> names;
  for (const BodyQuantity& quantity : kBodyQuantities) {
    ++names[quantity.name];
    CHECK(std::string(quantity.unit).size() > 0);
    // Histories and pictures show single numbers.
    if (quantity.in_histories() || quantity.in_pictures()) CHECK(quantity.components() == 1);
    CHECK((quantity.meaning == nullptr) == (quantity.symbol == nullptr));
  }
  CHECK(names.size() == kBodyQuantities.size());
}

TEST_CASE("vectors and tensors of a body have their components in order", "[columns]") {
  ObservedBody body;
  body.motion.contact = {1, 2, 3};
  body.statistics.stress = {4, 5, 6, 7, 8};
  const auto value = [&](size_t quantity) { return kBodyQuantities[quantity].value(body); };
  CHECK(value(body_quantity("contact_force")) == Components{1, 2, 0});
  CHECK(value(body_quantity("mean_stress")) == Components{4, 5, 6});
}

TEST_CASE("a history has rigid bodies, meshes, surfaces and points, in this order", "[columns]") {
  const Model model = model_of_four();
  OutputSettings settings;
  CHECK(history_columns(model, settings).empty());
  settings.track = {1, 0};
  settings.track_deformables = {1};
  settings.track_surfaces = {0};
  settings.points = {{"tip", 0, 0, {0}, {1}}};
  const std::vector<HistoryColumn> columns = history_columns(model, settings);
  std::vector<BodyQuantity> shown;
  std::ranges::copy_if(kBodyQuantities, std::back_inserter(shown), &BodyQuantity::in_histories);
  const size_t n = shown.size();
  REQUIRE(columns.size() == 3 * n + kSurfaceColumns.size() + kPointColumns.size());
  for (size_t i = 0; i < n; ++i) {
    CHECK(columns[i].name == std::string("two.") + shown[i].name);
    CHECK(columns[i].unit == std::string(shown[i].unit));
    CHECK(columns[i].jumps == (columns[i].name == "two.coordination"));
    CHECK(columns[n + i].name == std::string("one.") + shown[i].name);
    CHECK(columns[2 * n + i].name == std::string("hard.") + shown[i].name);
  }
  CHECK(columns[3 * n].name == "soft.pressure");
  CHECK(columns[3 * n + 1].name == "soft.half_width");
  CHECK(columns[3 * n + 2].name == "tip.ux");
  CHECK(columns.back().name == "tip.s2");
  CHECK(columns.back().unit == std::string("Pa"));
}
