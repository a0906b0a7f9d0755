// The error for bad input. It tells the user the file, the line, the JSON pointer, what is wrong
// and what would be right.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

namespace apothem {

class SceneError : public std::runtime_error {
 public:
  /// The message leaves out a `line` of 0 and an empty `pointer`.
  SceneError(const std::string& file, int line, const std::string& pointer, const std::string& what)
      : std::runtime_error(one_line(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                                    (pointer.empty() ? "" : pointer + ": ") + what)),
        file_(file),
        pointer_(pointer),
        reason_(one_line(what)),
        line_(line) {}
  /// Of the file as a whole.
  SceneError(const std::string& file, const std::string& what) : SceneError(file, 0, "", what) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  /// Counted from 1; 0 if it is not known.
  [[nodiscard]] int line() const { return line_; }
  /// Empty if the error has no place in a JSON document.
  [[nodiscard]] const std::string& pointer() const { return pointer_; }
  /// What is wrong and what would be right, without the place.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  /// Messages quote input, whose line breaks must not make them longer than one line.
  static std::string one_line(std::string text) {
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < 32 || c == 127) c = ' ';
    }
    return text;
  }

  std::string file_, pointer_, reason_;
  int line_;
};

/// The error for rings of vertices that are no polygon. It also knows the vertex, and the hole.
class PolygonError : public SceneError {
 public:
  /// `vertex`: counted from 0 in its ring, or -1 if no vertex is meant. `hole`: the number of that
  /// ring among the holes, or nothing if it is the outer one.
  PolygonError(const std::string& file, int line, const std::string& what, int vertex,
               std::optional<int> hole = {})
      : SceneError(file, line, "", what), vertex_(vertex), hole_(hole) {}
  [[nodiscard]] int vertex() const { return vertex_; }
  [[nodiscard]] std::optional<int> hole() const { return hole_; }

 private:
  int vertex_;
  std::optional<int> hole_;
};

}  // namespace apothem
