// The one error a user sees for bad input: file, line, JSON pointer, what is wrong, what would be
// right.
#pragma once

#include <stdexcept>
#include <string>

namespace apothem {

class SceneError : public std::runtime_error {
 public:
  /// `line` 0 and an empty pointer are left out.
  SceneError(const std::string& file, int line, const std::string& pointer, const std::string& what)
      : std::runtime_error(one_line(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                                    (pointer.empty() ? "" : pointer + ": ") + what)) {}

 private:
  /// Input is quoted in messages; its line breaks must not break them.
  static std::string one_line(std::string text) {
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
    }
    return text;
  }
};

}  // namespace apothem
