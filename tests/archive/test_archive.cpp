// Archives: what a struct says about its members once is written and read back, bit for bit.
#include "lib/archive/archive.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "apps/cases/samples.hpp"
#include "lib/run/json_archive.hpp"

using namespace apothem;

namespace {

struct Leaf {
  int number = 0;
  double value = 0;
  bool operator==(const Leaf&) const = default;
  void fields(Archive& archive) { archive("number", number)("value", value); }
};

struct Branch {
  std::string name;
  Vec2 place = Vec2::Zero();
  std::vector<Leaf> leaves;
  bool operator==(const Branch&) const = default;
  void fields(Archive& archive) { archive("name", name)("place", place)("leaves", leaves); }
};

// Without `fields`: a function beside it describes it.
struct Foreign {
  double x = 0;
};
void describe(Archive& archive, Foreign& foreign) { archive("x", foreign.x); }

struct Tree {
  double height = 0;
  std::int64_t age = 0;
  int rings = 0;
  bool alive = false;
  std::vector<double> numbers;
  std::vector<double> three = {0, 0, 0};
  Branch trunk;
  std::vector<Branch> branches;
  Foreign foreign;
  std::vector<Foreign> foreigners;
  void fields(Archive& archive) {
    archive("height", height)("age", age)("rings", rings)("alive", alive)("numbers", numbers);
    archive.sized("three", three);
    archive("trunk", trunk)("branches", branches)("foreign", foreign)("foreigners", foreigners);
  }
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Tree grown() {
  Tree tree;
  tree.height = .1 + .2;
  tree.age = std::numeric_limits<std::int64_t>::min();
  tree.rings = std::numeric_limits<int>::max();
  tree.alive = true;
  tree.numbers = {kInfinity, -0., 5e-324, 1.7976931348623157e308, 1. / 3};
  tree.three = {1e-300, -2, 1e22};
  tree.trunk = {"trunk \"\\ \n", {1. / 7, -1e-17}, {{1, .1}, {-2, 1e9}}};
  tree.branches = {{"empty", {0, 0}, {}}, {"one", {3, 4}, {{5, kInfinity}}}, {}};
  tree.foreign.x = M_PI;
  tree.foreigners = {{1. / 11}, {1. / 13}};
  return tree;
}

nlohmann::json written(Tree& tree) {
  JsonWriter archive;
  archive("tree", tree);
  return archive.json();
}

Tree loaded(const nlohmann::json& json) {
  Tree tree;
  JsonLoader archive(json);
  archive("tree", tree);
  return tree;
}

}  // namespace

TEST_CASE("numbers, texts, structs and lists are read back bit for bit", "[archive]") {
  Tree tree = grown();
  const std::string text = written(tree).dump();
  Tree again = loaded(nlohmann::json::parse(text));
  CHECK(again.height == tree.height);
  CHECK(again.age == tree.age);
  CHECK(again.rings == tree.rings);
  CHECK(again.alive);
  CHECK(again.numbers == tree.numbers);
  CHECK(std::signbit(again.numbers[1]));
  CHECK(again.three == tree.three);
  CHECK(again.trunk == tree.trunk);
  CHECK(again.branches == tree.branches);
  CHECK(again.foreign.x == tree.foreign.x);
  REQUIRE(again.foreigners.size() == 2);
  CHECK(again.foreigners[1].x == tree.foreigners[1].x);
  CHECK(written(again).dump() == text);
}

TEST_CASE("any finite double survives the text", "[archive]") {
  samples::Random random(11);
  Tree tree;
  for (int i = 0; i < 2000; ++i) {
    tree.numbers.push_back(std::ldexp(random.uniform(-1, 1), random.integer(-1060, 1023)));
  }
  CHECK(loaded(nlohmann::json::parse(written(tree).dump())).numbers == tree.numbers);
}

TEST_CASE("infinity is null in the text, and infinity again", "[archive]") {
  Tree tree;
  tree.height = kInfinity;
  tree.numbers = {1, kInfinity};
  const nlohmann::json json = written(tree);
  CHECK(json["tree"]["height"].is_null());
  CHECK(json["tree"]["numbers"][1].is_null());
  CHECK(loaded(json).height == kInfinity);
  CHECK(loaded(json).numbers == tree.numbers);
}

TEST_CASE("structs lie within structs, and lists of them are lists", "[archive]") {
  Tree tree = grown();
  const nlohmann::json json = written(tree)["tree"];
  CHECK(json["trunk"]["leaves"][1]["number"] == -2);
  CHECK(json["branches"].size() == 3);
  CHECK(json["branches"][0]["leaves"] == nlohmann::json::array());
  CHECK(json["branches"][1]["place"] == nlohmann::json{3., 4.});
  CHECK(json["foreigners"][0]["x"] == 1. / 11);
}

TEST_CASE("a list that is loaded replaces the one that was there", "[archive]") {
  Tree tree = grown();
  const nlohmann::json json = written(tree);
  Tree other;
  other.branches.assign(9, {"old", {9, 9}, {{9, 9}}});
  other.numbers.assign(9, 9);
  JsonLoader archive(json);
  archive("tree", other);
  CHECK(other.branches == tree.branches);
  CHECK(other.numbers == tree.numbers);
}

TEST_CASE("what is missing, or is something else, is not loaded", "[archive]") {
  Tree tree = grown();
  const nlohmann::json json = written(tree);
  for (const auto& [name, value] : json["tree"].items()) {
    nlohmann::json without = json;
    without["tree"].erase(name);
    INFO(name);
    CHECK_THROWS_AS(loaded(without), nlohmann::json::exception);
    nlohmann::json text = json;
    text["tree"][name] = nlohmann::json{{"x", "y"}};
    CHECK_THROWS(loaded(text));
  }
  CHECK_THROWS_AS(loaded(nlohmann::json::object()), nlohmann::json::exception);
  nlohmann::json damaged = json;
  damaged["tree"]["branches"][1]["leaves"][0].erase("number");
  CHECK_THROWS_AS(loaded(damaged), nlohmann::json::exception);
  damaged = json;
  damaged["tree"]["numbers"][0] = "one";
  CHECK_THROWS_AS(loaded(damaged), nlohmann::json::exception);
  damaged = json;
  damaged["tree"]["branches"] = 3;
  CHECK_THROWS_AS(loaded(damaged), ArchiveMismatch);
  damaged["tree"]["branches"] = json["tree"]["branches"];
  damaged["tree"]["numbers"] = 3;
  CHECK_THROWS_AS(loaded(damaged), ArchiveMismatch);
}

TEST_CASE("a list that has its size takes no other one", "[archive]") {
  Tree tree = grown();
  for (const size_t size : {0, 2, 4}) {
    nlohmann::json json = written(tree);
    json["tree"]["three"] = std::vector<double>(size, 1);
    CHECK_THROWS_WITH(loaded(json), Catch::Contains("three"));
    CHECK_THROWS_AS(loaded(json), ArchiveMismatch);
  }
  nlohmann::json json = written(tree);
  json["tree"]["trunk"]["place"] = {1, 2, 3};
  CHECK_THROWS_AS(loaded(json), ArchiveMismatch);
}
