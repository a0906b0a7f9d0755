#include "lib/scene/pair_file.hpp"

#include <fmt/format.h>

#include <sstream>

#include "geometry/polygon/polygon.hpp"
#include "lib/scene/json.hpp"
#include "lib/scene/ring_line.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

// Calls read() and turns its InvalidPolygon into a BadPairLine about that polygon of the pair.
template <class Read>
auto of_polygon(const char* polygon, const Read& read) {
  try {
    return read();
  } catch (const InvalidPolygon& error) {
    throw BadPairLine(error, polygon);
  }
}

ExpectedContact read_expected(const JsonReader& reader, const JsonValue& value) {
  JsonObject object(reader, value);
  const auto number = [&](const char* key, const char* unit) {
    return reader.number(object.required(key, std::string("number in ") + unit), unit);
  };
  ExpectedContact expected{};
  expected.force = reader.vec2(object.required("force", "[fx, fy] in m"), "m");
  expected.moment_a = number("moment_a", "m^2");
  expected.moment_b = number("moment_b", "m^2");
  expected.weight = number("weight", "m");
  expected.energy = number("energy", "m^2");
  expected.overlap_area = number("overlap_area", "m^2");
  expected.own_length = number("own_length", "m");
  expected.tolerance =
      reader.positive(object.required("tolerance", "share of own_length"), "own_length");
  object.finish();
  return expected;
}

PolygonWithHoles read_json_polygon(const JsonReader& reader, const JsonValue& value) {
  if (value.type() == JsonValue::Type::array) return {reader.ring(value), {}};
  JsonObject object(reader, value);
  PolygonWithHoles polygon{reader.ring(object.required("polygon", "[[x,y],...] in m")), {}};
  if (const JsonValue* holes = object.optional("holes")) {
    for (const JsonValue& hole : reader.array(*holes)) polygon.holes.push_back(reader.ring(hole));
  }
  object.finish();
  return polygon;
}

std::vector<PolygonPair> read_json(const std::string& text, const std::string& file) {
  const JsonReader reader(file);
  const JsonValue document = parse_json(text, file);
  JsonObject root(reader, document);
  root.optional("about");
  std::vector<PolygonPair> pairs;
  for (const JsonValue& item : reader.array(root.required("pairs", "array of pairs"))) {
    JsonObject object(reader, item);
    PolygonPair& pair = pairs.emplace_back();
    pair.name = reader.string(object.required("name", "string"));
    if (const JsonValue* kind = object.optional("kind")) pair.kind = reader.string(*kind);
    pair.a = read_json_polygon(reader, object.required("a", "[[x,y],...] in m"));
    pair.b = read_json_polygon(reader, object.required("b", "[[x,y],...] in m"));
    if (const JsonValue* expected = object.optional("expected")) {
      pair.expected = read_expected(reader, *expected);
    }
    object.finish();
  }
  root.finish();
  if (pairs.empty()) reader.fail(document, "has no pair; give {\"name\", \"a\", \"b\"}");
  return pairs;
}

}  // namespace

PolygonPair parse_pair(const std::string& line) {
  std::istringstream words(line);
  PolygonPair pair;
  words >> pair.name;
  pair.a = of_polygon("a", [&] { return read_line_polygon(words); });
  pair.b = of_polygon("b", [&] { return read_line_polygon(words); });
  of_polygon("", [&] { require_end(words); });
  return pair;
}

std::vector<PolygonPair> read_pair_file(const std::string& file) {
  const std::string text = read_text(file, kLargestJson);
  const size_t start = text.find_first_not_of(" \t\r\n");
  if (start != std::string::npos && text[start] == '{') return read_json(text, file);
  std::vector<PolygonPair> pairs;
  std::istringstream lines(text);
  for_each_line(lines, file, kPairForm, [&](const BatchLine& line) {
    try {
      pairs.push_back(parse_pair(line.text));
    } catch (const BadPairLine& error) {
      const std::string hole = error.hole() ? fmt::format(", hole {}", *error.hole()) : "";
      const std::string place =
          error.polygon().empty()
              ? ""
              : fmt::format(", polygon {}{}, vertex {}", error.polygon(), hole, error.vertex());
      throw SceneError(file, line.number, "",
                       fmt::format("{}{}: {}; write {}", line.has_polygon ? line.name : "the pair",
                                   place, error.what(), kPairForm));
    }
  });
  return pairs;
}

}  // namespace apothem
