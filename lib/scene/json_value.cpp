#include "lib/scene/json_value.hpp"

#include <algorithm>
#include <utility>

#include "lib/text/words.hpp"

namespace apothem {

// What an array or an object holds, at an address that does not change when the value is moved, and
// where it stands.
struct JsonValue::Container {
  std::vector<JsonValue> items;
  Keys keys;  // of an object; several objects may share them
  const Container* in = nullptr;
  int index = 0;
};
struct JsonValue::Array : Container {};
struct JsonValue::Object : Container {};

JsonValue::JsonValue(Type type, int line) : line_(line) {
  if (type == Type::boolean) data_ = false;
  if (type == Type::number) data_ = 0.0;
  if (type == Type::string) data_ = std::make_unique<std::string>();
  if (type == Type::array) data_ = std::make_unique<Array>();
  if (type != Type::object) return;
  data_ = std::make_unique<Object>();
  container()->keys = std::make_shared<std::vector<std::string>>();
}

JsonValue::JsonValue(const JsonValue& other)
    : in_(other.in_), index_(other.index_), line_(other.line_) {
  const auto copied = [](const auto& value) -> decltype(data_) {
    if constexpr (requires { *value; }) {
      return std::make_unique<std::decay_t<decltype(*value)>>(*value);
    } else {
      return value;
    }
  };
  data_ = std::visit(copied, other.data_);
  Container* copy = container();
  if (copy == nullptr) return;
  for (JsonValue& item : copy->items) {
    if (item.in_ == other.container()) item.place(copy, item.index_);
  }
}

JsonValue& JsonValue::operator=(const JsonValue& other) { return *this = JsonValue(other); }
JsonValue::JsonValue(JsonValue&& other) noexcept = default;
JsonValue& JsonValue::operator=(JsonValue&& other) noexcept = default;
JsonValue::~JsonValue() = default;

JsonValue::Container* JsonValue::container() {
  if (const auto* array = std::get_if<std::unique_ptr<Array>>(&data_)) return array->get();
  if (const auto* object = std::get_if<std::unique_ptr<Object>>(&data_)) return object->get();
  return nullptr;
}

const JsonValue::Container* JsonValue::container() const {
  return const_cast<JsonValue*>(this)->container();
}

bool JsonValue::boolean() const {
  const auto* value = std::get_if<bool>(&data_);
  return value != nullptr && *value;
}

double JsonValue::number() const {
  const auto* value = std::get_if<double>(&data_);
  return value != nullptr ? *value : 0;
}

const std::string& JsonValue::string() const {
  static const std::string kNone;
  const auto* value = std::get_if<std::unique_ptr<std::string>>(&data_);
  return value != nullptr ? **value : kNone;
}

const std::vector<JsonValue>& JsonValue::items() const {
  static const std::vector<JsonValue> kNone;
  const Container* holds = container();
  return holds != nullptr ? holds->items : kNone;
}

const std::vector<std::string>& JsonValue::keys() const {
  static const std::vector<std::string> kNone;
  return type() == Type::object ? *container()->keys : kNone;
}

const JsonValue* JsonValue::find(std::string_view key) const {
  const auto found = std::ranges::find(keys(), key);
  return found != keys().end() ? &items()[static_cast<size_t>(found - keys().begin())] : nullptr;
}

JsonValue* JsonValue::find(std::string_view key) {
  return const_cast<JsonValue*>(std::as_const(*this).find(key));
}

std::string JsonValue::pointer() const {
  std::string path;
  const Container* in = in_;
  for (int i = index_; in != nullptr; i = in->index, in = in->in) {
    const std::string part =
        in->keys ? escaped_key((*in->keys)[static_cast<size_t>(i)]) : std::to_string(i);
    path.insert(0, "/" + part);
  }
  return path;
}

void JsonValue::set(bool value) { data_ = value; }
void JsonValue::set(double value) { data_ = value; }
void JsonValue::set(std::string value) { data_ = std::make_unique<std::string>(std::move(value)); }

JsonValue& JsonValue::item(size_t i) { return container()->items[i]; }

JsonValue& JsonValue::add(JsonValue value, std::string key) {
  value.place(container(), static_cast<int>(items().size()));
  return add_from_elsewhere(std::move(value), std::move(key));
}

JsonValue& JsonValue::add_from_elsewhere(JsonValue value, std::string key) {
  Container& own = *container();
  if (own.keys) {
    if (own.keys.use_count() > 1) own.keys = std::make_shared<std::vector<std::string>>(*own.keys);
    own.keys->push_back(std::move(key));
  }
  return own.items.emplace_back(std::move(value));
}

void JsonValue::drop_items() {
  Container& own = *container();
  std::vector<JsonValue>().swap(own.items);
  if (own.keys) own.keys = std::make_shared<std::vector<std::string>>();
}

void JsonValue::stand_at(const JsonValue& other) {
  place(other.in_, other.index_);
  line_ = other.line_;
}

void JsonValue::place(const Container* in, int index) {
  in_ = in;
  index_ = index;
  if (Container* own = container()) {
    own->in = in;
    own->index = index;
  }
}

void JsonValue::leave_line() {
  line_ = 0;
  if (Container* own = container()) {
    for (JsonValue& item : own->items) item.leave_line();
  }
}

void JsonValue::share_keys(Keys& keys) {
  Keys& own = container()->keys;
  if (keys && *keys == *own) {
    own = keys;
  } else {
    keys = own;
  }
}

std::string escaped_key(const std::string& key) {
  return replaced(replaced(key, "~", "~0"), "/", "~1");
}

}  // namespace apothem
