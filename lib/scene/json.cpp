#include "lib/scene/json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "lib/scene/ring_text.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// Feeds the parser character by character and counts what it has taken. The count is the position
// of the token that the parser reports.
struct CountingIterator {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;
  const char* at;
  size_t* taken;
  reference operator*() const { return *at; }
  CountingIterator& operator++() {
    ++at;
    ++*taken;
    return *this;
  }
  bool operator==(const CountingIterator& other) const { return at == other.at; }
  bool operator!=(const CountingIterator& other) const { return at != other.at; }
};

// The deepest nesting that is read. Scenes need far less, and the stack could hold far more.
constexpr size_t kDeepest = 100;

// Builds a JsonValue from the events of nlohmann-json's SAX parser. Its public functions are those
// that the parser calls.
class Builder {
 public:
  Builder(const std::string& text, const std::string& file, const size_t& taken)
      : text_(text), file_(file), taken_(taken) {}

  JsonValue root;

  bool null() { return add(JsonValue::Type::null, 2), true; }
  bool boolean(bool b) { return add(JsonValue::Type::boolean, 2).set(b), true; }
  bool number_integer(std::int64_t n) { return number(static_cast<double>(n)); }
  bool number_unsigned(std::uint64_t n) { return number(static_cast<double>(n)); }
  bool number_float(double d, const std::string&) { return number(d); }
  bool string(std::string& s) { return add(JsonValue::Type::string, 1).set(s), true; }
  bool binary(std::vector<std::uint8_t>&) { return true; }
  bool start_object(size_t) { return open(JsonValue::Type::object); }
  bool end_object() {
    stack_.back()->share_keys(last_keys_);
    return stack_.pop_back(), true;
  }
  bool start_array(size_t) { return open(JsonValue::Type::array); }
  bool end_array() { return stack_.pop_back(), true; }
  bool key(std::string& name) {
    const JsonValue& object = *stack_.back();
    if (const JsonValue* first = object.find(name)) {
      throw SceneError(
          file_, line(1), object.pointer() + "/" + escaped_key(name),
          fmt::format("duplicate key, first given in line {}; keep one", first->line()));
    }
    key_ = name;
    return true;
  }
  bool parse_error(size_t position, const std::string&, const nlohmann::json::exception& error) {
    // The message is "[json.exception...] parse error at line 3, column 5: syntax error ...", of
    // which only the last part is for the user.
    std::string what = error.what();
    if (const size_t colon = what.find(": "); colon != std::string::npos) what.erase(0, colon + 2);
    if (error.id == 406) what = "number out of the range of double precision";
    if (root.type() == JsonValue::Type::null) what = "it must begin with { or [";
    throw SceneError(file_, line_at(position), "", "not valid JSON: " + what);
  }

 private:
  int line_at(size_t position) const {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(position, text_.size()));
    return 1 + static_cast<int>(std::count(text_.begin(), end, '\n'));
  }
  // The line of the token that ends `back` characters before what the parser has taken. The parser
  // knows the end of a number only when it has taken the character behind it.
  [[nodiscard]] int line(size_t back) {
    const size_t position = taken_ > back ? taken_ - back : 0;
    for (; counted_ < position; ++counted_) lines_ += text_[counted_] == '\n';
    return lines_;
  }

  bool number(double d) { return add(JsonValue::Type::number, 2).set(d), true; }
  bool open(JsonValue::Type type) {
    stack_.push_back(&add(type, 1));
    if (stack_.size() > kDeepest) {
      throw SceneError(file_, line(1), "", "not valid JSON: nested too deeply");
    }
    return true;
  }
  JsonValue& add(JsonValue::Type type, size_t back) {
    JsonValue value(type, line(back));
    if (stack_.empty()) return root = std::move(value);
    return stack_.back()->add(std::move(value), std::move(key_));
  }

  const std::string& text_;
  const std::string& file_;
  const size_t& taken_;
  size_t counted_ = 0;
  int lines_ = 1;
  // The open arrays and objects. Each is the last item of the one before, and only last items grow,
  // so the pointers stay valid.
  std::vector<JsonValue*> stack_;
  std::string key_;            // of the value that comes next
  JsonValue::Keys last_keys_;  // of the object that has been closed last
};

const char* type_name(JsonValue::Type type) {
  constexpr std::array kNames{"null",     "true/false", "a number",
                              "a string", "an array",   "an object"};
  return kNames[static_cast<size_t>(type)];
}

}  // namespace

JsonValue parse_json(const std::string& text, const std::string& file) {
  // The parser would stop at a NUL character.
  if (const size_t nul = text.find('\0'); nul != std::string::npos) {
    const auto lines =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(nul), '\n');
    throw SceneError(file, 1 + static_cast<int>(lines), "", "not valid JSON: a NUL character");
  }
  size_t taken = 0;
  Builder builder(text, file, taken);
  const CountingIterator begin{text.data(), &taken};
  const CountingIterator end{text.data() + text.size(), &taken};
  nlohmann::json::sax_parse(begin, end, &builder, nlohmann::json::input_format_t::json,
                            /*strict=*/true, /*ignore_comments=*/true);
  return std::move(builder.root);
}

bool JsonReader::boolean(const JsonValue& value) const {
  if (value.type() != JsonValue::Type::boolean) fail(value, "must be true or false");
  return value.boolean();
}

double JsonReader::number(const JsonValue& value, const std::string& unit) const {
  if (value.type() != JsonValue::Type::number) {
    fail(value, fmt::format("must be a number{}, not {}", unit.empty() ? "" : " in " + unit,
                            type_name(value.type())));
  }
  return value.number();
}

double JsonReader::positive(const JsonValue& value, const std::string& unit) const {
  const double x = number(value, unit);
  const std::string in = unit.empty() ? "" : " (in " + unit + ")";
  if (!(x > 0)) fail(value, fmt::format("must be positive{}, not {}", in, x));
  return x;
}

double JsonReader::not_negative(const JsonValue& value, const std::string& unit) const {
  const double x = number(value, unit);
  if (x < 0) fail(value, "must not be negative");
  return x;
}

int JsonReader::count(const JsonValue& value) const {
  const double x = number(value, "");
  if (!(x >= 0 && x <= 1e9) || x != std::floor(x)) {
    fail(value, fmt::format("must be a whole number from 0 to 1e9, not {}", x));
  }
  return static_cast<int>(x);
}

const std::string& JsonReader::string(const JsonValue& value) const {
  if (value.type() != JsonValue::Type::string) {
    fail(value, fmt::format("must be a string, not {}", type_name(value.type())));
  }
  return value.string();
}

const std::vector<JsonValue>& JsonReader::array(const JsonValue& value) const {
  if (value.type() != JsonValue::Type::array) {
    fail(value, fmt::format("must be an array, not {}", type_name(value.type())));
  }
  return value.items();
}

std::vector<double> JsonReader::numbers(const JsonValue& value, size_t size,
                                        const std::string& meaning) const {
  if (value.type() != JsonValue::Type::array || value.items().size() != size) {
    fail(value, "must be " + meaning);
  }
  std::vector<double> result;
  for (const JsonValue& item : value.items()) result.push_back(number(item, ""));
  return result;
}

Vec2 JsonReader::vec2(const JsonValue& value, const std::string& unit) const {
  const std::vector<JsonValue>& xy = value.items();
  if (value.type() != JsonValue::Type::array || xy.size() != 2) {
    fail(value, "must be [x, y] in " + unit);
  }
  const double x = number(xy[0], "");
  return {x, number(xy[1], "")};
}

std::vector<Vec2> JsonReader::ring(const JsonValue& value) const {
  std::vector<Vec2> ring;
  for (const JsonValue& point : array(value)) {
    if (point.type() == JsonValue::Type::array && point.items().size() > 2 &&
        point.items()[0].type() == JsonValue::Type::number) {
      fail(point,
           fmt::format("has {} coordinates, and bodies are two-dimensional: give [x, y] in m",
                       point.items().size()));
    }
    ring.push_back(vec2(point, "m"));
  }
  leave_out_closing_vertex(ring);
  return ring;
}

int JsonReader::choice(const JsonValue& value, const std::vector<std::string>& names) const {
  const std::string& word = string(value);
  const auto found = std::ranges::find(names, word);
  if (found == names.end()) {
    fail(value, fmt::format("unknown choice {} (known: {})", suggest(word, names),
                            fmt::join(names, ", ")));
  }
  return static_cast<int>(found - names.begin());
}

JsonObject::JsonObject(const JsonReader& reader, const JsonValue& value)
    : reader_(reader), value_(value) {
  if (value.type() != JsonValue::Type::object) {
    reader.fail(value, fmt::format("must be an object {{...}}, not {}", type_name(value.type())));
  }
  known_.reserve(value.keys().size() + 8);  // of an object that may have some keys more
}

const JsonValue* JsonObject::optional(std::string key) {
  const JsonValue* found = value_.find(key);
  known_.push_back(std::move(key));
  return found;
}

const JsonValue& JsonObject::required(const std::string& key, const std::string& meaning) {
  if (const JsonValue* found = optional(key)) return *found;
  // The likeliest reason is that the key is misspelt.
  if (const std::string* close = nearest_word(key, value_.keys());
      close && std::ranges::find(known_, *close) == known_.end()) {
    reader_.fail(*value_.find(*close), "unknown key " + suggest(*close, {key}));
  }
  reader_.fail(value_, fmt::format("missing key \"{}\": {}", key, meaning));
}

void JsonObject::finish() const {
  for (size_t i = 0; i < value_.keys().size(); ++i) {
    const std::string& key = value_.keys()[i];
    if (std::ranges::find(known_, key) != known_.end()) continue;
    reader_.fail(value_.items()[i], fmt::format("unknown key {} (known here: {})",
                                                suggest(key, known_), fmt::join(known_, ", ")));
  }
}

}  // namespace apothem
