// Why a run cannot begin or go on.
#pragma once

#include <exception>
#include <stdexcept>
#include <string>

#include "lib/model/state.hpp"

namespace apothem {

/// The scene cannot be run as it is; says which key of the scene is to blame, or which rigid body
/// (or -1).
class Unrunnable : public std::runtime_error {
 public:
  Unrunnable(const std::string& what, std::string key, RigidIndex body)
      : std::runtime_error(what), key_(std::move(key)), body_(body) {}
  [[nodiscard]] const std::string& key() const { return key_; }
  [[nodiscard]] RigidIndex body() const { return body_; }

 private:
  std::string key_;
  RigidIndex body_;
};

/// The run became unstable or left the range where the method is accurate: says when, where, why
/// and what helps.
class Unstable : public std::runtime_error {
 public:
  explicit Unstable(const std::string& what, RigidIndex body = -1)
      : std::runtime_error(what), body_(body) {}
  /// The rigid body to blame, or -1.
  [[nodiscard]] RigidIndex body() const { return body_; }

 private:
  RigidIndex body_;
};

/// The search for rest at the start was asked to stop.
class Stopped : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override {
    return "interrupted before the start: the bodies are not at rest yet";
  }
};

/// As in `at t = 0.5 s (step 20)`.
std::string at_time(const State& state);
/// Throws Unstable: `what` is not at a finite place.
[[noreturn]] void refuse_infinite(const State& state, const std::string& what,
                                  RigidIndex body = -1);

}  // namespace apothem
