// The error for bad input. It tells the user the file, the line, the JSON pointer, what is wrong
// and what would be right.
#pragma once

#include <stdexcept>
#include <string>

namespace apothem {

class SceneError : public std::runtime_error {
 public:
  /// The message leaves out a `line` of 0 and an empty `pointer`.
  SceneError(const std::string& file, int line, const std::string& pointer, const std::string& what)
      : std::runtime_error(one_line(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                                    (pointer.empty() ? "" : pointer + ": ") + what)) {}

 private:
  /// Messages quote input, whose line breaks must not make them longer than one line.
  static std::string one_line(std::string text) {
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
    }
    return text;
  }
};

}  // namespace apothem
