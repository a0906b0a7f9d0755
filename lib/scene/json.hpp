// Reads JSON into values that know their place in the file, and gives typed access to them that
// turns every mistake into a SceneError at that place. nlohmann-json parses the text; it keeps no
// places and accepts duplicate keys, so both are added here.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/scene/json_value.hpp"
#include "lib/text/error.hpp"

namespace apothem {

/// Parses JSON in which // and /* */ comments are allowed. Throws SceneError.
JsonValue parse_json(const std::string& text, const std::string& file);

/// Reads the values of one file. Every getter throws SceneError at the value's place if the value
/// is not what it must be. `unit` is named in the message.
class JsonReader {
 public:
  explicit JsonReader(std::string file) : file_(std::move(file)) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[noreturn]] void fail(const JsonValue& at, const std::string& what) const {
    throw SceneError(file_, at.line(), at.pointer(), what);
  }

  bool boolean(const JsonValue& value) const;
  double number(const JsonValue& value, const std::string& unit) const;
  double positive(const JsonValue& value, const std::string& unit) const;
  double not_negative(const JsonValue& value, const std::string& unit) const;
  /// A whole number, 0 or more.
  int count(const JsonValue& value) const;
  const std::string& string(const JsonValue& value) const;
  const std::vector<JsonValue>& array(const JsonValue& value) const;
  /// An array of exactly `size` numbers. `meaning` is named in the message, like "[x, y] in m".
  [[nodiscard]] std::vector<double> numbers(const JsonValue& value, size_t size,
                                            const std::string& meaning) const;
  [[nodiscard]] Vec2 vec2(const JsonValue& value, const std::string& unit) const;
  /// Points [[x, y], ...] in m of a ring, without a closing vertex.
  [[nodiscard]] std::vector<Vec2> ring(const JsonValue& value) const;
  /// The index of a string in `names`, which must contain it.
  int choice(const JsonValue& value, const std::vector<std::string>& names) const;
  /// The same as an enumeration, whose names stand in its order.
  template <class Enum, class Names = std::vector<std::string>>
  Enum choice(const JsonValue& value, const Names& names) const {
    return static_cast<Enum>(choice(value, std::vector<std::string>(names.begin(), names.end())));
  }

 private:
  std::string file_;
};

/// A JSON object that is being read. It remembers which keys were asked for, so that it can refuse
/// all others as unknown.
class JsonObject {
 public:
  JsonObject(const JsonReader& reader, const JsonValue& value);
  /// The value of a key, or nullptr if it is missing.
  const JsonValue* optional(std::string key);
  /// The value of a key. Throws SceneError with its `meaning` if it is missing.
  const JsonValue& required(const std::string& key, const std::string& meaning);
  /// Puts what a getter of the reader makes of the value of a key into `target`, if it is there.
  template <class T, class Get, class... More>
  void read(std::string key, T& target, Get get, const More&... more) {
    if (const JsonValue* v = optional(std::move(key))) target = (reader_.*get)(*v, more...);
  }
  /// Likewise one of the names of an enumeration.
  template <class Enum, class Names = std::vector<std::string>>
  void choose(std::string key, Enum& target, const Names& names) {
    const JsonValue* v = optional(std::move(key));
    if (v) target = reader_.choice<Enum>(*v, names);
  }
  /// Calls use(item) for each item of the array of a key, if it is there.
  template <class Use>
  void each(std::string key, const Use& use) {
    const JsonValue* v = optional(std::move(key));
    if (!v) return;
    for (const JsonValue& item : reader_.array(*v)) use(item);
  }
  /// Throws SceneError at the first key that nobody asked for. Called after the last key was read.
  void finish() const;
  [[nodiscard]] const JsonValue& value() const { return value_; }

 private:
  const JsonReader& reader_;
  const JsonValue& value_;
  std::vector<std::string> known_;
};

}  // namespace apothem
