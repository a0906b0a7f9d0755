// Archives as JSON: checkpoints are written and read with these. Private to the room.
#pragma once

#include <charconv>
#include <cmath>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "lib/archive/archive.hpp"

namespace apothem {

/// Writes the text of a JSON object. Numbers are written so that they read back to the same double;
/// infinity becomes null.
class JsonWriter final : public Archive {
 public:
  /// Takes a part of the text.
  using Sink = std::function<void(std::string_view)>;

  /// Collects the text if there is no sink.
  explicit JsonWriter(Sink sink = {}) : sink_(std::move(sink)) {}

  /// Hands over what has been collected so far.
  void flush() {
    sink_(text_);
    text_.clear();
  }
  /// Writes the end of the object. Nothing may be written after that.
  void finish() {
    text_ += '}';
    if (sink_) flush();
  }
  [[nodiscard]] bool loads() const override { return false; }
  /// What has been collected, as JSON.
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(text_ + '}'); }

 protected:
  void number(const char* name, double& value) override { key(name), add(value); }
  void integer(const char* name, std::int64_t& value) override {
    key(name), text_ += std::to_string(value);
  }
  void text(const char* name, std::string& value) override { key(name), add(value); }
  void numbers(const char* name, std::vector<double>& values) override {
    key(name);
    text_ += '[';
    for (const double& v : values) {
      if (&v != values.data()) text_ += ',';
      add(v);
      if (sink_ && text_.size() > kBlock) flush();
    }
    text_ += ']';
  }
  void enter(const char* name) override { key(name), open('{', '}'); }
  size_t enter_list(const char* name, size_t size) override {
    key(name), open('[', ']');
    return size;
  }
  void enter_item() override { separate(), open('{', '}'); }
  void leave() override {
    text_ += levels_.back().end;
    levels_.pop_back();
    if (sink_ && text_.size() > kBlock) flush();
  }

 private:
  static constexpr size_t kBlock = 1 << 20;

  struct Level {
    char end;
    bool empty;
  };
  void open(char start, char end) {
    text_ += start;
    levels_.push_back({end, true});
  }
  void separate() {
    if (!levels_.back().empty) text_ += ',';
    levels_.back().empty = false;
  }
  void key(const char* name) {
    separate();
    add(std::string(name));
    text_ += ':';
  }
  void add(const std::string& value) { text_ += nlohmann::json(value).dump(); }
  void add(double value) {
    if (!std::isfinite(value)) {
      text_ += "null";
      return;
    }
    char digits[32];
    const std::string_view shortest(
        digits, static_cast<size_t>(std::to_chars(digits, std::end(digits), value).ptr - digits));
    text_ += shortest;
    // A whole number stays a floating-point number, because an integer has no -0.
    if (shortest.find_first_of(".e") == std::string_view::npos) text_ += ".0";
  }

  Sink sink_;
  std::string text_ = "{";
  std::vector<Level> levels_{{'}', true}};
};

/// Throws nlohmann::json::exception or ArchiveMismatch if something is missing or of another kind.
class JsonLoader final : public Archive {
 public:
  explicit JsonLoader(const nlohmann::json& root) : stack_{{&root, 0}} {}
  [[nodiscard]] bool loads() const override { return true; }

 protected:
  void number(const char* name, double& value) override { value = to_double(at(name)); }
  void integer(const char* name, std::int64_t& value) override { at(name).get_to(value); }
  void text(const char* name, std::string& value) override { at(name).get_to(value); }
  void numbers(const char* name, std::vector<double>& values) override {
    const nlohmann::json& list = at(name);
    if (!list.is_array()) throw ArchiveMismatch(std::string(name) + " is not a list");
    values.clear();
    for (const nlohmann::json& v : list) values.push_back(to_double(v));
  }
  void enter(const char* name) override { stack_.push_back({&at(name), 0}); }
  size_t enter_list(const char* name, size_t /*size*/) override {
    const nlohmann::json& list = at(name);
    if (!list.is_array()) throw ArchiveMismatch(std::string(name) + " is not a list");
    stack_.push_back({&list, 0});
    return list.size();
  }
  void enter_item() override {
    const nlohmann::json& item = stack_.back().value->at(stack_.back().next++);
    stack_.push_back({&item, 0});
  }
  void leave() override { stack_.pop_back(); }

 private:
  static double to_double(const nlohmann::json& value) {
    return value.is_null() ? HUGE_VAL : value.get<double>();
  }
  [[nodiscard]] const nlohmann::json& at(const char* name) const {
    return stack_.back().value->at(name);
  }
  struct Level {
    const nlohmann::json* value;
    size_t next;  // item of a list
  };
  std::vector<Level> stack_;
};

}  // namespace apothem
