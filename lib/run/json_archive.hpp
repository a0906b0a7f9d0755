// Archives as JSON: checkpoints are written and read with these. Private to the room.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apothem/archive/archive.hpp"

namespace apothem {

/// Numbers are written so that they read back to the same double; infinity becomes null.
class JsonWriter final : public Archive {
 public:
  [[nodiscard]] const nlohmann::json& json() const { return root_; }

 protected:
  void number(const char* name, double& value) override { at(name) = of(value); }
  void integer(const char* name, std::int64_t& value) override { at(name) = value; }
  void text(const char* name, std::string& value) override { at(name) = value; }
  void numbers(const char* name, std::vector<double>& values) override {
    nlohmann::json list = nlohmann::json::array();
    for (const double v : values) list.push_back(of(v));
    at(name) = std::move(list);
  }
  void enter(const char* name) override {
    stack_.push_back(&(at(name) = nlohmann::json::object()));
  }
  size_t enter_list(const char* name, size_t size) override {
    nlohmann::json& list = at(name) = nlohmann::json::array();
    list.get_ref<nlohmann::json::array_t&>().reserve(size);  // its items are pointed to
    stack_.push_back(&list);
    return size;
  }
  void enter_item() override {
    stack_.back()->push_back(nlohmann::json::object());
    stack_.push_back(&stack_.back()->back());
  }
  void leave() override { stack_.pop_back(); }

 private:
  static nlohmann::json of(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
  }
  nlohmann::json& at(const char* name) { return (*stack_.back())[name]; }

  nlohmann::json root_ = nlohmann::json::object();
  std::vector<nlohmann::json*> stack_{&root_};
};

/// Throws nlohmann::json::exception or ArchiveMismatch if something is missing or of another kind.
class JsonLoader final : public Archive {
 public:
  explicit JsonLoader(const nlohmann::json& root) : stack_{{&root, 0}} {}

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
