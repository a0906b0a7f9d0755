// JSON that remembers where every value stood and refuses duplicate keys (nlohmann-json, which
// parses here, does neither), and typed access to it that turns every mistake into one clear
// SceneError.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apothem/geometry/polygon/point.hpp"
#include "apothem/scene/error.hpp"

namespace apothem {

struct JsonValue {
  enum class Type { null, boolean, number, string, array, object };
  Type type = Type::null;
  bool boolean = false;
  double number = 0;
  std::string string;
  std::vector<JsonValue> items;   ///< elements of an array, values of an object
  std::vector<std::string> keys;  ///< of an object, in order, unique
  int line = 0;                   ///< in the file, from 1
  std::string pointer;            ///< RFC 6901, empty for the document

  [[nodiscard]] const JsonValue* find(std::string_view key) const;
};

/// Parses JSON with // and /* */ comments. Throws SceneError.
JsonValue parse_json(const std::string& text, const std::string& file);

/// The whole file. Throws SceneError if it cannot be read.
std::string read_text(const std::string& file);

/// `word` in quotes and, if a candidate looks like it, "did you mean ...?".
std::string suggest(std::string_view word, const std::vector<std::string>& candidates);

/// Reads values of one file. Every getter throws SceneError at the value's place.
class JsonReader {
 public:
  explicit JsonReader(std::string file) : file_(std::move(file)) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[noreturn]] void fail(const JsonValue& at, const std::string& what) const {
    throw SceneError(file_, at.line, at.pointer, what);
  }

  double number(const JsonValue& value, const std::string& unit) const;
  double positive(const JsonValue& value, const std::string& unit) const;
  int count(const JsonValue& value) const;  ///< integer >= 0
  const std::string& string(const JsonValue& value) const;
  const std::vector<JsonValue>& array(const JsonValue& value) const;
  /// Array of exactly `size` numbers; `meaning` as in "[x, y] in m".
  [[nodiscard]] std::vector<double> numbers(const JsonValue& value, size_t size,
                                            const std::string& meaning) const;
  [[nodiscard]] Vec2 vec2(const JsonValue& value, const std::string& unit) const;
  /// [[x, y], ...]
  [[nodiscard]] std::vector<Vec2> ring(const JsonValue& value) const;
  /// Index of the string in `names`.
  int choice(const JsonValue& value, const std::vector<std::string>& names) const;

 private:
  std::string file_;
};

/// An object being read: remembers which keys were asked for; the rest is unknown.
class JsonObject {
 public:
  JsonObject(const JsonReader& reader, const JsonValue& value);
  const JsonValue* optional(const std::string& key);
  const JsonValue& required(const std::string& key, const std::string& meaning);
  /// Throws at the first key that nobody asked for.
  void finish() const;
  [[nodiscard]] const JsonValue& value() const { return value_; }

 private:
  const JsonReader& reader_;
  const JsonValue& value_;
  std::vector<std::string> known_;
};

}  // namespace apothem
