// Values that replace those of a scene file: one scene serves many runs.
#pragma once

#include <string>

#include "lib/scene/json.hpp"

namespace apothem {

/// A value, and the path of dots to it: keys of objects, and indices of arrays or the names of
/// their items, like contact.friction.coefficient, bodies.block.velocity or bodies.1.angle.
struct Setting {
  std::string path;
  std::string value;  ///< JSON

  [[nodiscard]] std::string text() const { return path + "=" + value; }
  /// As somebody would write it, without the quotes of a word, and how a number is written if it
  /// looks like one with a comma.
  [[nodiscard]] std::string as_given() const;
  bool operator==(const Setting&) const = default;
};

/// Reads "PATH=VALUE". The value is JSON, or a decimal number like .1 or +2; other text that does
/// not begin like an object, an array or a string is a string. Throws SceneError, with `file` as
/// its place.
Setting parse_setting(const std::string& text, const std::string& file);

/// Puts the value of a setting into a scene. Keys that the path names and the scene lacks are
/// added, so that the reader of the scene judges them. Returns the pointer to what was replaced or
/// added. Throws SceneError where the path leads nowhere: an unknown item of an array, or a part of
/// a value that has none.
std::string apply_setting(JsonValue& document, const Setting& setting, const std::string& file);

}  // namespace apothem
