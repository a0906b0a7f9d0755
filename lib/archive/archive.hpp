// What a struct consists of, said once: its member function `fields` names its members to an
// archive. The same description serves checkpoints, their reading, and comparisons.
//
//   void fields(Archive& archive) { archive("time", time)("step", step); }
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// What is loaded does not fit what it is loaded into.
class ArchiveMismatch : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Archive {
 public:
  virtual ~Archive() = default;

  /// True if it reads what a struct consists of, false if it writes that.
  [[nodiscard]] virtual bool loads() const = 0;

  /// Writes a member, or reads it: a number, a text, a list of numbers, a struct with `fields` or a
  /// list of such structs.
  template <class T>
  Archive& operator()(const char* name, T& value) {
    if constexpr (std::is_same_v<T, double>) {
      number(name, value);
    } else if constexpr (std::is_integral_v<T>) {
      std::int64_t wide = value;
      integer(name, wide);
      value = static_cast<T>(wide);
    } else if constexpr (std::is_same_v<T, std::string>) {
      text(name, value);
    } else if constexpr (std::is_same_v<T, std::vector<double>>) {
      numbers(name, value);
    } else if constexpr (std::is_same_v<T, std::vector<int>>) {
      std::vector<double> list(value.begin(), value.end());  // of which each is exact
      numbers(name, list);
      value.assign(list.begin(), list.end());
    } else if constexpr (std::is_same_v<T, Vec2>) {
      std::vector<double> pair{value.x(), value.y()};
      sized(name, pair);
      value = Vec2(pair[0], pair[1]);
    } else {
      enter(name);
      fields_of(value);
      leave();
    }
    return *this;
  }

  template <class T>
  Archive& operator()(const char* name, std::vector<T>& list) requires(std::is_class_v<T>) {
    list.resize(enter_list(name, list.size()));
    for (T& value : list) {
      enter_item();
      fields_of(value);
      leave();
    }
    leave();
    return *this;
  }

  /// A list of numbers that has its size already. Throws ArchiveMismatch if another one is loaded.
  Archive& sized(const char* name, std::vector<double>& values) {
    const size_t size = values.size();
    numbers(name, values);
    if (values.size() != size) throw ArchiveMismatch(std::string(name) + " has another size");
    return *this;
  }

 protected:
  virtual void number(const char* name, double& value) = 0;
  virtual void integer(const char* name, std::int64_t& value) = 0;
  virtual void text(const char* name, std::string& value) = 0;
  virtual void numbers(const char* name, std::vector<double>& values) = 0;
  /// A struct, up to leave().
  virtual void enter(const char* name) = 0;
  /// A list of so many structs, up to leave(); returns how many there are.
  virtual size_t enter_list(const char* name, size_t size) = 0;
  virtual void enter_item() = 0;
  virtual void leave() = 0;

 private:
  template <class T>
  void fields_of(T& value) {
    if constexpr (requires { value.fields(*this); }) {
      value.fields(*this);
    } else {
      describe(*this, value);  // of a struct of another room, found by its type
    }
  }
};

}  // namespace apothem
