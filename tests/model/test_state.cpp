// The state: one vector each of places, velocities and forces, for rigid bodies and nodes.
#include "lib/model/state.hpp"

#include <catch2/catch.hpp>

#include "lib/run/json_archive.hpp"

using namespace apothem;

namespace {

// Two rigid bodies and three nodes: every entry has a value of its own.
State numbered() {
  State state(Layout{2, 3});
  state.time = .1 + .2;
  state.step = 7;
  for (size_t c = 0; c < state.layout.size(); ++c) {
    state.x[c] = static_cast<double>(c) + 1. / 3;
    state.v[c] = 100 + static_cast<double>(c);
    state.f[c] = 200 + static_cast<double>(c);
  }
  for (size_t c = 0; c < state.remainder.size(); ++c) {
    state.remainder[c] = 1e-20 * static_cast<double>(c + 1);
  }
  return state;
}

nlohmann::json written(State& state) {
  JsonWriter archive;
  archive("state", state);
  return archive.json();
}

void load(const nlohmann::json& json, State& state) {
  JsonLoader archive(json);
  archive("state", state);
}

}  // namespace

TEST_CASE("whole numbers in a list come back from an archive, also from one that held doubles",
          "[state]") {
  std::vector<int> numbers{3, 0, -7};
  JsonWriter writer;
  writer("numbers", numbers);
  std::vector<int> read;
  const nlohmann::json json = writer.json();
  JsonLoader{json}("numbers", read);
  CHECK(read == numbers);
  const nlohmann::json doubles{{"numbers", {3.0, 0.0, -7.0}}};
  JsonLoader{doubles}("numbers", read);
  CHECK(read == numbers);
}

TEST_CASE("rigid bodies have three entries each, and after them nodes have two", "[state]") {
  const Layout layout{2, 3};
  CHECK(layout.rigid(0) == 0);
  CHECK(layout.rigid(1) == 3);
  CHECK(layout.node(0) == 6);
  CHECK(layout.node(2) == 10);
  CHECK(layout.size() == 12);
  CHECK(Layout{}.size() == 0);
  CHECK(Layout{4, 0}.size() == 12);
  CHECK(Layout{0, 4}.size() == 8);
}

TEST_CASE("a new state is at zero, with a remainder for rigid bodies only", "[state]") {
  const State state(Layout{2, 3});
  CHECK(state.time == 0);
  CHECK(state.step == 0);
  CHECK(state.x == std::vector<double>(12, 0));
  CHECK(state.v == std::vector<double>(12, 0));
  CHECK(state.f == std::vector<double>(12, 0));
  CHECK(state.remainder == std::vector<double>(6, 0));
}

TEST_CASE("the parts of a vector are its rigid bodies and its nodes", "[state]") {
  State state = numbered();
  const auto rigid = state.layout.of_rigid(state.x), nodes = state.layout.of_nodes(state.x);
  REQUIRE(rigid.size() == 6);
  REQUIRE(nodes.size() == 6);
  CHECK(&rigid[0] == &state.x[0]);
  CHECK(&nodes[0] == &state.x[6]);
  nodes[5] = -1;  // a view, and no copy
  CHECK(state.x[11] == -1);
  const State& fixed = state;
  static_assert(std::is_same_v<decltype(fixed.layout.of_nodes(fixed.x)), std::span<const double>>);
  CHECK(Layout{2, 0}.of_nodes(std::as_const(state.remainder)).empty());
}

TEST_CASE("places, velocities and forces are found by body and by node", "[state]") {
  State state = numbered();
  const State& fixed = state;
  CHECK(fixed.pose(1) == Eigen::Vector3d(3 + 1. / 3, 4 + 1. / 3, 5 + 1. / 3));
  CHECK(fixed.pose_rate(1) == Eigen::Vector3d(103, 104, 105));
  CHECK(fixed.force(0) == Eigen::Vector3d(200, 201, 202));
  CHECK(fixed.node(1) == Vec2(8 + 1. / 3, 9 + 1. / 3));
  CHECK(fixed.node_velocity(0) == Vec2(106, 107));

  state.pose(1) << -1, -2, -3;
  state.pose_rate(0)[2] = -4;
  state.node(2) = Vec2(-5, -6);
  CHECK(state.x[3] == -1);
  CHECK(state.x[5] == -3);
  CHECK(state.v[2] == -4);
  CHECK(state.x[10] == -5);
  CHECK(state.x[11] == -6);
}

TEST_CASE("contact sees the places of a state with the velocities that it is given", "[state]") {
  const State state = numbered();
  std::vector<double> velocity(12);
  for (size_t c = 0; c < 12; ++c) velocity[c] = -static_cast<double>(c);
  const Kinematics seen = state.kinematics(velocity);
  CHECK(seen.pose.data() == &state.x[0]);
  CHECK(seen.displacement.data() == &state.x[6]);
  REQUIRE(seen.pose_rate.size() == 6);
  REQUIRE(seen.node_velocity.size() == 6);
  CHECK(seen.pose_rate[5] == -5);
  CHECK(seen.node_velocity[0] == -6);
}

TEST_CASE("an archived state is read back bit for bit", "[state]") {
  State state = numbered();
  state.v[3] = -0.;
  state.f[11] = 5e-324;
  const std::string text = written(state).dump();
  State loaded(state.layout);
  load(nlohmann::json::parse(text), loaded);
  CHECK(loaded.time == state.time);
  CHECK(loaded.step == 7);
  CHECK(loaded.x == state.x);
  CHECK(loaded.v == state.v);
  CHECK(std::signbit(loaded.v[3]));
  CHECK(loaded.f == state.f);
  CHECK(loaded.remainder == state.remainder);
  CHECK(written(loaded).dump() == text);
}

TEST_CASE("an archived state does not go into one of other bodies", "[state]") {
  State state = numbered();
  const nlohmann::json json = written(state);
  for (const Layout& other : {Layout{1, 3}, Layout{2, 2}, Layout{0, 6}, Layout{}}) {
    State target(other);
    CHECK_THROWS_AS(load(json, target), ArchiveMismatch);
  }
  // As many numbers, but of other bodies: the remainder tells.
  State same(Layout{4, 0});
  REQUIRE(same.x.size() == state.x.size());
  CHECK_THROWS_AS(load(json, same), ArchiveMismatch);
  for (const char* name : {"x", "v", "f", "remainder"}) {
    nlohmann::json shorter = json;
    shorter["state"][name].erase(0);
    State target(state.layout);
    INFO(name);
    CHECK_THROWS_AS(load(shorter, target), ArchiveMismatch);
  }
}
