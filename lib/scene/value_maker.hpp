// Makes JSON values that stand for something the scene asks for in another place: their errors name
// that place.
#pragma once

#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

class ValueMaker {
 public:
  /// `at`: what asks for the values.
  explicit ValueMaker(const JsonValue& at) { place_.stand_at(at); }

  [[nodiscard]] JsonValue make(JsonValue::Type type) const {
    JsonValue value(type);
    value.stand_at(place_);
    return value;
  }
  [[nodiscard]] JsonValue number(double x) const {
    JsonValue value = make(JsonValue::Type::number);
    value.set(x);
    return value;
  }
  [[nodiscard]] JsonValue string(std::string text) const {
    JsonValue value = make(JsonValue::Type::string);
    value.set(std::move(text));
    return value;
  }
  [[nodiscard]] JsonValue vec2(const Vec2& v) const {
    JsonValue value = make(JsonValue::Type::array);
    add(value, number(v.x()));
    add(value, number(v.y()));
    return value;
  }
  [[nodiscard]] JsonValue ring(const std::vector<Vec2>& points) const {
    JsonValue value = make(JsonValue::Type::array);
    for (const Vec2& p : points) add(value, vec2(p));
    return value;
  }
  [[nodiscard]] JsonValue rings(const std::vector<std::vector<Vec2>>& rings) const {
    JsonValue value = make(JsonValue::Type::array);
    for (const std::vector<Vec2>& points : rings) add(value, ring(points));
    return value;
  }
  [[nodiscard]] JsonValue object() const { return make(JsonValue::Type::object); }
  static void add(JsonValue& array, JsonValue value) { array.add_from_elsewhere(std::move(value)); }
  static void add(JsonValue& object, const char* key, JsonValue value) {
    object.add_from_elsewhere(std::move(value), key);
  }

 private:
  JsonValue place_;  // nothing but that
};

}  // namespace apothem
