#include "apothem/scene/setting.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apothem/scene/decimal.hpp"

namespace apothem {
namespace {

// The part of a path up to its next dot. Keys and names may hold dots themselves: of those that the
// path goes on with, the longest one is meant.
std::string next_part(const std::string& rest, const std::vector<std::string>& names) {
  std::string best;
  for (const std::string& name : names) {
    const bool leads = rest == name || rest.starts_with(name + ".");
    if (leads && name.size() > best.size()) best = name;
  }
  return best.empty() ? rest.substr(0, rest.find('.')) : best;
}

std::vector<std::string> names_of_items(const JsonValue& array) {
  std::vector<std::string> names;
  for (const JsonValue& item : array.items) {
    const JsonValue* name = item.find("name");
    if (name && name->type == JsonValue::Type::string) names.push_back(name->string);
  }
  return names;
}

// Gives a value, and all that it holds, the place of what it replaces. It stands in no line.
void put_at(JsonValue& value, const std::string& pointer) {
  value.line = 0;
  value.pointer = pointer;
  for (size_t i = 0; i < value.items.size(); ++i) {
    const std::string key =
        value.type == JsonValue::Type::object ? escaped_key(value.keys[i]) : std::to_string(i);
    put_at(value.items[i], pointer + "/" + key);
  }
}

// Follows a path through a scene.
class Path {
 public:
  Path(const Setting& setting, const std::string& file) : setting_(setting), file_(file) {}

  /// One part further: `from` becomes the value there, `rest` what is left of the path.
  JsonValue& step(JsonValue& from, std::string& rest) {
    if (from.type == JsonValue::Type::array) return item(from, rest);
    if (from.type != JsonValue::Type::object) fail(from, "has no keys and no items");
    const std::string key = next_part(rest, from.keys);
    cut(rest, key);
    for (size_t i = 0; i < from.keys.size(); ++i) {
      if (from.keys[i] == key) return from.items[i];
    }
    JsonValue added;
    added.type = JsonValue::Type::object;
    put_at(added, from.pointer + "/" + escaped_key(key));
    if (first_added_.empty()) first_added_ = added.pointer;
    from.keys.push_back(key);
    return from.items.emplace_back(std::move(added));
  }
  [[nodiscard]] const std::string& first_added() const { return first_added_; }

 private:
  JsonValue& item(JsonValue& array, std::string& rest) {
    const std::vector<std::string> names = names_of_items(array);
    const std::string part = next_part(rest, names);
    cut(rest, part);
    for (JsonValue& value : array.items) {
      const JsonValue* name = value.find("name");
      if (name && name->type == JsonValue::Type::string && name->string == part) return value;
    }
    size_t index = array.items.size();
    try {
      index = static_cast<size_t>(parse_count(part));
    } catch (const BadNumber&) {
      fail(array,
           (names.empty() ? "has no item " : "has no item of the name ") + suggest(part, names));
    }
    if (index < array.items.size()) return array.items[index];
    fail(array, fmt::format("has no item {}: it has {}, counted from 0", part, array.items.size()));
  }

  void cut(std::string& rest, const std::string& part) const {
    if (part.empty()) {
      throw SceneError(file_, 0, "",
                       fmt::format("\"{}\": the path has an empty part", setting_.text()));
    }
    rest.erase(0, part.size() + 1);
  }

  [[noreturn]] void fail(const JsonValue& at, const std::string& what) const {
    throw SceneError(file_, at.line, at.pointer,
                     fmt::format("{}, as \"{}\" asks for", what, setting_.text()));
  }

  const Setting& setting_;
  const std::string& file_;
  std::string first_added_;
};

}  // namespace

Setting parse_setting(const std::string& text, const std::string& file) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    throw SceneError(file, 0, "",
                     fmt::format("\"{}\" is no setting; write PATH=VALUE, like "
                                 "contact.friction.coefficient=0.3",
                                 text));
  }
  Setting setting{text.substr(0, equals), text.substr(equals + 1)};
  using Json = nlohmann::json;
  const Json json = Json::parse(setting.value, nullptr, /*allow_exceptions=*/false);
  if (!json.is_discarded()) {
    setting.value = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  } else if (std::string("[{\"").find(setting.value[0]) != std::string::npos) {
    throw SceneError(file, 0, "", fmt::format("\"{}\": the value is not valid JSON", text));
  } else {
    setting.value = Json(setting.value).dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  return setting;
}

std::string apply_setting(JsonValue& document, const Setting& setting, const std::string& file) {
  Path path(setting, file);
  std::string rest = setting.path;
  JsonValue* at = &document;
  while (!rest.empty()) at = &path.step(*at, rest);
  const std::string pointer = at->pointer;
  JsonValue value = parse_json(setting.value, file);
  put_at(value, pointer);
  *at = std::move(value);
  return path.first_added().empty() ? pointer : path.first_added();
}

}  // namespace apothem
