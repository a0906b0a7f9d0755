#include "lib/scene/setting.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lib/text/decimal.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

using Json = nlohmann::json;

// Numbers that JSON does not know, like .1 or +2, are numbers as elsewhere on the command line.
Json json_of_word(const std::string& word) {
  const std::optional<double> number = find_decimal(word);
  return number ? Json(*number) : Json(word);
}

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
  for (const JsonValue& item : array.items()) {
    const JsonValue* name = item.find("name");
    if (name && name->type() == JsonValue::Type::string) names.push_back(name->string());
  }
  return names;
}

// Follows a path through a scene.
class Path {
 public:
  Path(const Setting& setting, const std::string& file) : setting_(setting), file_(file) {}

  /// One part further: `from` becomes the value there, `rest` what is left of the path.
  JsonValue& step(JsonValue& from, std::string& rest) {
    if (from.type() == JsonValue::Type::array) return item(from, rest);
    if (from.type() != JsonValue::Type::object) fail(from, "has no keys and no items");
    const std::string key = next_part(rest, from.keys());
    cut(rest, key);
    if (JsonValue* found = from.find(key)) return *found;
    JsonValue& added = from.add(JsonValue(JsonValue::Type::object), key);
    if (first_added_.empty()) first_added_ = added.pointer();
    return added;
  }
  [[nodiscard]] const std::string& first_added() const { return first_added_; }

 private:
  JsonValue& item(JsonValue& array, std::string& rest) {
    const std::vector<std::string> names = names_of_items(array);
    const std::string part = next_part(rest, names);
    cut(rest, part);
    const size_t size = array.items().size();
    for (size_t i = 0; i < size; ++i) {
      const JsonValue* name = array.items()[i].find("name");
      if (name && name->type() == JsonValue::Type::string && name->string() == part) {
        return array.item(i);
      }
    }
    const std::optional<int> index = find_count(part);
    if (!index) {
      fail(array,
           (names.empty() ? "has no item " : "has no item of the name ") + suggest(part, names));
    }
    if (static_cast<size_t>(*index) < size) return array.item(static_cast<size_t>(*index));
    fail(array, fmt::format("has no item {}: it has {}, counted from 0", part, size));
  }

  void cut(std::string& rest, const std::string& part) const {
    if (part.empty()) {
      throw SceneError(file_, fmt::format("\"{}\": the path has an empty part", setting_.text()));
    }
    rest.erase(0, part.size() + 1);
  }

  [[noreturn]] void fail(const JsonValue& at, const std::string& what) const {
    throw SceneError(file_, at.line(), at.pointer(),
                     fmt::format("{}, as \"{}\" asks for", what, setting_.text()));
  }

  const Setting& setting_;
  const std::string& file_;
  std::string first_added_;
};

}  // namespace

std::string Setting::as_given() const {
  const Json json = Json::parse(value, nullptr, /*allow_exceptions=*/false);
  if (!json.is_string()) return text();
  const auto& word = json.get_ref<const std::string&>();
  const std::string pointed = replaced(word, ",", ".");
  const bool comma = pointed != word && find_decimal(pointed).has_value();
  return path + "=" + word + (comma ? "; the number is written " + pointed : "");
}

Setting parse_setting(const std::string& text, const std::string& file) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    throw SceneError(file, fmt::format("\"{}\" is no setting; write PATH=VALUE, like "
                                       "contact.friction.coefficient=0.3",
                                       text));
  }
  Setting setting{text.substr(0, equals), text.substr(equals + 1)};
  const Json json = Json::parse(setting.value, nullptr, /*allow_exceptions=*/false);
  if (!json.is_discarded()) {
    setting.value = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  } else if (std::string("[{\"").find(setting.value[0]) != std::string::npos) {
    throw SceneError(file, fmt::format("\"{}\": the value is not valid JSON", text));
  } else {
    setting.value =
        json_of_word(setting.value).dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  return setting;
}

std::string apply_setting(JsonValue& document, const Setting& setting, const std::string& file) {
  Path path(setting, file);
  std::string rest = setting.path;
  JsonValue* at = &document;
  while (!rest.empty()) at = &path.step(*at, rest);
  JsonValue value = parse_json(setting.value, file);
  value.stand_at(*at);
  value.leave_line();
  *at = std::move(value);
  return path.first_added().empty() ? at->pointer() : path.first_added();
}

}  // namespace apothem
