// JSON values: where they stand, and what objects share.
#include <catch2/catch.hpp>

#include "lib/scene/json.hpp"
#include "lib/scene/value_maker.hpp"

using namespace apothem;

namespace {

// The pointers of a value and of all that it holds, in their order.
void collect(const JsonValue& value, std::vector<std::string>& pointers) {
  pointers.push_back(value.pointer());
  for (const JsonValue& item : value.items()) collect(item, pointers);
}
std::vector<std::string> pointers_in(const JsonValue& value) {
  std::vector<std::string> pointers;
  collect(value, pointers);
  return pointers;
}

TEST_CASE("a JSON value knows its pointer, also when it is moved or copied", "[json]") {
  const std::string text = R"({"a": [1, {"b/c": [[2], "three"]}], "~": {"d": null, "e": true}})";
  const std::vector<std::string> expected{
      "",    "/a",    "/a/0", "/a/1", "/a/1/b~1c", "/a/1/b~1c/0", "/a/1/b~1c/0/0", "/a/1/b~1c/1",
      "/~0", "/~0/d", "/~0/e"};
  JsonValue first = parse_json(text, "f");
  CHECK(pointers_in(first) == expected);
  const JsonValue copy = first;
  JsonValue moved = std::move(first);
  CHECK(pointers_in(moved) == expected);
  moved = JsonValue();
  CHECK(pointers_in(copy) == expected);

  // A copy of a part still stands where the part stands.
  const JsonValue part = copy.items()[0];
  CHECK(pointers_in(part) == std::vector(expected.begin() + 1, expected.begin() + 8));
}

TEST_CASE("the deepest nesting of JSON has a pointer for each level", "[json]") {
  const int depth = 100;
  const JsonValue document =
      parse_json(std::string(depth, '[') + "\n7" + std::string(depth, ']'), "f");
  const JsonValue* at = &document;
  std::string pointer;
  for (int i = 0; i < depth; ++i) {
    REQUIRE(at->pointer() == pointer);
    at = at->items().data();
    pointer += "/0";
  }
  CHECK(at->number() == 7);
  CHECK(at->line() == 2);
  CHECK(at->pointer() == pointer);
}

TEST_CASE("objects that share their keys are independent of each other", "[json]") {
  JsonValue list = parse_json(R"([{"a": 1, "b": 2}, {"a": 3, "b": 4}, {"b": 5, "a": 6}])", "f");
  CHECK(&list.items()[0].keys() == &list.items()[1].keys());
  CHECK(list.items()[2].keys() == std::vector<std::string>{"b", "a"});
  list.item(1).add(JsonValue(JsonValue::Type::array), "c");
  CHECK(list.items()[0].keys() == std::vector<std::string>{"a", "b"});
  CHECK(list.items()[1].keys() == std::vector<std::string>{"a", "b", "c"});
  CHECK(list.items()[1].find("c")->pointer() == "/1/c");
  CHECK(list.items()[0].find("c") == nullptr);
  list.item(0).drop_items();
  CHECK(list.items()[0].find("a") == nullptr);
  CHECK(list.items()[1].find("a")->number() == 3);
}

TEST_CASE("values that are made for another value stand in its place", "[json]") {
  JsonValue document = parse_json("{\"bodies\": [],\n\"import\": [{\"velocity\": [1, 2]}]}", "f");
  const JsonValue& import = document.find("import")->items()[0];
  const ValueMaker make(import);
  JsonValue body = make.object();
  ValueMaker::add(body, "polygon", make.ring({{0, 0}, {1, 0}}));
  ValueMaker::add(body, "velocity", *import.find("velocity"));
  document.find("bodies")->add_from_elsewhere(std::move(body));
  const JsonValue& added = document.find("bodies")->items()[0];
  CHECK(added.pointer() == "/import/0");
  CHECK(added.line() == 2);
  CHECK(added.find("polygon")->items()[1].items()[0].pointer() == "/import/0");
  CHECK(added.find("velocity")->items()[1].pointer() == "/import/0/velocity/1");
}

}  // namespace
