// Makes JSON values that stand for something the scene asks for in another place: their errors name
// that place.
#pragma once

#include <string>
#include <vector>

#include "apothem/geometry/polygon/point.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

class ValueMaker {
 public:
  /// `at`: what asks for the values.
  explicit ValueMaker(const JsonValue& at) : line_(at.line), pointer_(at.pointer) {}

  [[nodiscard]] JsonValue make(JsonValue::Type type) const {
    JsonValue value;
    value.type = type;
    value.line = line_;
    value.pointer = pointer_;
    return value;
  }
  [[nodiscard]] JsonValue number(double x) const {
    JsonValue value = make(JsonValue::Type::number);
    value.number = x;
    return value;
  }
  [[nodiscard]] JsonValue string(std::string text) const {
    JsonValue value = make(JsonValue::Type::string);
    value.string = std::move(text);
    return value;
  }
  [[nodiscard]] JsonValue vec2(const Vec2& v) const {
    JsonValue value = make(JsonValue::Type::array);
    value.items = {number(v.x()), number(v.y())};
    return value;
  }
  [[nodiscard]] JsonValue ring(const std::vector<Vec2>& points) const {
    JsonValue value = make(JsonValue::Type::array);
    value.items.reserve(points.size());
    for (const Vec2& p : points) value.items.push_back(vec2(p));
    return value;
  }
  [[nodiscard]] JsonValue object() const { return make(JsonValue::Type::object); }
  static void add(JsonValue& object, const char* key, JsonValue value) {
    object.keys.emplace_back(key);
    object.items.push_back(std::move(value));
  }

 private:
  int line_;
  std::string pointer_;
};

}  // namespace apothem
