// The plan of a study: lists, ranges, tables, products and the names of folders.
#include <catch2/catch.hpp>
#include <set>

#include "lib/sweep/decimal_range.hpp"
#include "lib/sweep/plan.hpp"
#include "lib/text/decimal.hpp"
#include "tests/folder.hpp"

using namespace apothem;
using test::Folder;
using Words = std::vector<std::string>;

namespace {

Words values_of(const std::string& text) { return parse_variation(text, "--vary").values; }

// The message of the error that a call throws.
template <class Call>
std::string refusal_of(const Call& call) {
  try {
    call();
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

Words keys_of(const Plan& plan) {
  Words keys;
  for (const PlannedRun& run : plan.runs) keys.push_back(run.key);
  return keys;
}

}  // namespace

TEST_CASE("lists of values are JSON or words", "[sweep]") {
  CHECK(parse_variation("a.b=1,2", "--vary").path == "a.b");
  CHECK(values_of("a=0.1,0.25,1e3") == Words{"0.1", "0.25", "1000.0"});
  CHECK(values_of("a=roof,true,null") == Words{"\"roof\"", "true", "null"});
  CHECK(values_of("a=[0, -1],[1,2]") == Words{"[0,-1]", "[1,2]"});
  CHECK(values_of(R"(a={"x": [1, 2], "y": "a,b"},"c,\"d")") ==
        Words{R"({"x":[1,2],"y":"a,b"})", R"("c,\"d")"});
  CHECK(values_of("file=../wall.msh,b..c") == Words{"\"../wall.msh\"", "\"b..c\""});
}

TEST_CASE("ranges are whole numbers or have a step", "[sweep]") {
  CHECK(values_of("a=1..4") == Words{"1", "2", "3", "4"});
  CHECK(values_of("a=-2..1") == Words{"-2", "-1", "0", "1"});
  CHECK(values_of("a=7..7") == Words{"7"});
  CHECK(values_of("a=1..2,5,8..9") == Words{"1", "2", "5", "8", "9"});
  CHECK(values_of("a=0.1..0.5:0.1") == Words{"0.1", "0.2", "0.3", "0.4", "0.5"});
  CHECK(values_of("a=0.1..0.55:0.15") == Words{"0.1", "0.25", "0.4", "0.55"});
  CHECK(values_of("a=0..1:0.3") == Words{"0", "0.3", "0.6", "0.9"});
  CHECK(values_of("a=3..1:-1") == Words{"3", "2", "1"});
  CHECK(values_of("a=1e9..3e9:1e9") == Words{"1000000000", "2000000000", "3000000000"});
  CHECK(values_of("a=1e-5..3e-5:1e-5") == Words{"1e-05", "2e-05", "3e-05"});
}

// In doubles, 0.1 + 2 x 0.1 is 0.30000000000000004.
TEST_CASE("ranges do not drift", "[sweep]") {
  const Words values = decimal_range("0", "1000", "0.001", 2'000'000);
  REQUIRE(values.size() == 1'000'001);
  for (size_t i = 0; i < values.size(); i += 997) {
    CHECK(parse_decimal(values[i]) == static_cast<double>(i) / 1000);
    CHECK(values[i].size() <= 7);
  }
}

TEST_CASE("what varies nothing is refused with the remedy", "[sweep]") {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"a", "write PATH=A,B,C"},
      {"=1", "write PATH=A,B,C"},
      {"a=", "write PATH=A,B,C"},
      {"a=1,,2", "a value of the list is empty"},
      {"a=1,1.0", "has the value 1.0 twice"},
      {"a=1..", "\"\" is not a decimal number"},
      {"a=1..x", "\"x\" is not a decimal number"},
      {"a=1..2:0", "must not be 0"},
      {"a=2..1", "does not lead from 2 to 1"},
      {"a=0.1..0.5", "needs a step"},
      {"a=1..2:x", "\"x\" is not a decimal number"},
      {"a=0..1:1e-30", "more than 15 digits"},
      {"a=0..1:1e-9", "at most 1000000"},
      {"a=[1,2", "is not valid JSON"},
  };
  for (const auto& [text, remedy] : wrong) {
    const std::string error = refusal_of([&] { values_of(text); });
    INFO(text << ": " << error);
    CHECK(error.starts_with("--vary: "));
    CHECK(error.find(remedy) != std::string::npos);
  }
}

TEST_CASE("the plan is the product, the last path fastest", "[sweep]") {
  const Plan plan = make_plan({}, {parse_variation("fill.0.diameter=0.5,0.6", "--vary"),
                                   parse_variation("fill.0.seed=1..3", "--vary")});
  CHECK(plan.paths == Words{"fill.0.diameter", "fill.0.seed"});
  CHECK(keys_of(plan) == Words{"diameter=0.5,seed=1", "diameter=0.5,seed=2", "diameter=0.5,seed=3",
                               "diameter=0.6,seed=1", "diameter=0.6,seed=2",
                               "diameter=0.6,seed=3"});
  CHECK(plan.runs[4].values == Words{"0.6", "2"});
  CHECK(is_seed("fill.0.seed"));
  CHECK(is_seed("seed"));
  CHECK_FALSE(is_seed("fill.0.seeds"));
  CHECK_FALSE(is_seed("seed.0"));
}

TEST_CASE("a table gives rows, and each goes with all other values", "[sweep]") {
  const Folder folder;
  const std::string file = folder.write("t.csv",
                                        "\xEF\xBB\xBFgravity , name\r\n\"[0,-9.81]\",\"a\"\"b\"\r\n"
                                        "\r\n \"[0, -1]\" , plain\r\n");
  const VariationTable table = read_variation_table(file);
  CHECK(table.paths == Words{"gravity", "name"});
  REQUIRE(table.rows.size() == 2);
  CHECK(table.rows[0] == Words{"[0,-9.81]", R"("a\"b")"});
  CHECK(table.rows[1] == Words{"[0,-1]", "\"plain\""});
  const Plan plan = make_plan(table, {parse_variation("seed=1,2", "--vary")});
  CHECK(plan.paths == Words{"gravity", "name", "seed"});
  REQUIRE(plan.runs.size() == 4);
  CHECK(plan.runs[1].values == Words{"[0,-9.81]", R"("a\"b")", "2"});
  CHECK(plan.runs[2].values == Words{"[0,-1]", "\"plain\"", "1"});
}

TEST_CASE("labels of a table stand for its other columns", "[sweep]") {
  const Folder folder;
  const std::string file = folder.write(
      "t.csv", "#width,a.polygon,b\n2,\"[[0,0],[1,0],[1,1]]\",5\n3,\"[[0,0],[2,0],[1,1]]\",6\n");
  const Plan plan = make_plan(read_variation_table(file), {parse_variation("seed=1,2", "--vary")});
  CHECK(plan.paths == Words{"width", "seed"});
  REQUIRE(plan.runs.size() == 4);
  CHECK(plan.runs[3].values == Words{"3", "2"});
  CHECK(plan.runs[3].key == "width=3,seed=2");
  REQUIRE(plan.runs[3].settings.size() == 3);
  CHECK(plan.runs[3].settings[0].path == "a.polygon");
  CHECK(plan.runs[3].settings[1].value == "6");
  CHECK(plan.runs[3].settings[2].path == "seed");
  const std::string twice = folder.write("u.csv", "#width,b\n2,5\n2,6\n");
  CHECK_THROWS_WITH(make_plan(read_variation_table(twice), {}),
                    Catch::Matchers::Contains("two rows have the labels"));
}

TEST_CASE("bad tables are refused at their line", "[sweep]") {
  const Folder folder;
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"", "has no rows"},
      {"a,b\n", "has no rows"},
      {"a,\n1,2\n", "t.csv:1: a column has no path"},
      {"a,b\n1\n", "t.csv:2: has 1 cells; the header has 2"},
      {"a,b\n1,2\n\n3,4,5\n", "t.csv:4: has 3 cells"},
      {"a,b\n1,\n", "t.csv:2: there is no value for \"b\""},
      {"a\n\"1\n", "t.csv:2: the quotes of this cell do not end"},
      {"a\n\"1\"2\n", "t.csv:2: text follows the quotes"},
      {"a,b\n1,2\n\"[1\",2\n", "t.csv:3: \"a=[1\": the value is not valid JSON"},
      {"a,b\n1,2\n3,4\n1,2\n", "t.csv:4: the row repeats that of line 2"},
  };
  for (const auto& [text, message] : wrong) {
    const std::string file = folder.write("t.csv", text);
    const std::string error = refusal_of([&] { read_variation_table(file); });
    INFO(text << ": " << error);
    CHECK(error.find(message) != std::string::npos);
  }
  CHECK(refusal_of([&] { read_variation_table(folder / "none.csv"); }).find("none.csv") !=
        std::string::npos);
}

TEST_CASE("plans without runs, with too many or with a path twice are refused", "[sweep]") {
  const Variation thousand = parse_variation("a=1..1000", "--vary");
  Variation other = thousand, third = thousand;
  other.path = "b";
  third.path = "c";
  CHECK(refusal_of([] { make_plan({}, {}); }).find("give --vary") != std::string::npos);
  CHECK(refusal_of([&] {
          make_plan({}, {thousand, other, third});
        }).find("more than 1000000") != std::string::npos);
  CHECK(refusal_of([&] {
          make_plan({}, {thousand, thousand});
        }).find("\"a\" is varied twice") != std::string::npos);
  CHECK(refusal_of([&] {
          make_plan({{"a"}, {{"1"}}}, {thousand});
        }).find("varied twice") != std::string::npos);
}

TEST_CASE("keys are short, legal and different", "[sweep]") {
  CHECK(short_names({"contact.friction.coefficient", "fill.0.seed", "fill.1.seed"}) ==
        Words{"coefficient", "0.seed", "1.seed"});
  CHECK(short_names({"seed", "fill.seed"}) == Words{"seed", "fill.seed"});
  const Plan plan = make_plan(
      {}, {parse_variation(R"(a="x/y","x\\y","x y",[1],"..","é")", "--vary"),
           parse_variation("b=" + std::string(300, 'c') + "," + std::string(301, 'c'), "--vary")});
  std::set<std::string> keys;
  for (const std::string& key : keys_of(plan)) {
    INFO(key);
    CHECK(keys.insert(key).second);
    CHECK(key.size() <= 100);
    CHECK(key.find_first_not_of("0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                "._+-=,") == std::string::npos);
    CHECK(key[0] != '.');
  }
  CHECK(short_names({".x", "x", "y.x", "a.", "."}) == Words{".x", "x", "y.x", "a.", "."});
  CHECK(
      keys_of(make_plan({}, {parse_variation(".x=1", "--vary"), parse_variation("x=1", "--vary")}))
          .front()
          .starts_with("_x=1,x=1-"));
}
