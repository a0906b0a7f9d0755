// Why a run cannot begin or go on.
#pragma once

#include <stdexcept>
#include <string>

namespace apothem {

/// The scene cannot be run as it is; says which key of the scene is to blame, or which rigid body
/// (or -1).
class Unrunnable : public std::runtime_error {
 public:
  Unrunnable(const std::string& what, std::string key, int body)
      : std::runtime_error(what), key_(std::move(key)), body_(body) {}
  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] int body() const { return body_; }

 private:
  std::string key_;
  int body_;
};

/// The run became unstable or left the range where the method is accurate: says when, where, why
/// and what helps.
class Unstable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace apothem
