// Private header: what a series of frames shows at one moment, as plain arrays, and the two forms
// in which it is written: the text of a .vtu file (vtu_text.hpp) and the container of all frames
// (frame_container.hpp).
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// Numbers for the points or cells of a grid, `columns` for each: either reals or whole ones. Two
/// columns without names are a vector in the plane.
struct GridArray {
  std::string name;
  size_t columns = 1;
  std::vector<const char*> parts = {};  ///< names of the columns; empty: a number or a vector
  bool is_whole = false;
  std::vector<double> reals = {};
  std::vector<std::int32_t> integers = {};

  static GridArray numbers(const char* name) { return {.name = name}; }
  static GridArray whole_numbers(const char* name) { return {.name = name, .is_whole = true}; }
  static GridArray vectors(const char* name) { return {.name = name, .columns = 2}; }
  /// Symmetric tensors of the plane.
  static GridArray tensors(const char* name) {
    return {.name = name, .columns = 3, .parts = {"xx", "yy", "xy"}};
  }

  void add(const Vec2& vector) { reals.insert(reals.end(), {vector.x(), vector.y()}); }
  [[nodiscard]] bool is_vector() const { return columns == 2 && parts.empty(); }
  void reserve(size_t rows) { is_whole ? integers.reserve(rows) : reals.reserve(rows * columns); }
};

/// Cells of one kind. Polygons are convex.
struct FrameGrid {
  enum class Kind { points, lines, polygons };

  Kind kind = Kind::polygons;
  std::vector<Vec2> points = {};           ///< m
  std::vector<std::int32_t> corners = {};  ///< point numbers of all cells
  std::vector<std::int32_t> ends = {};     ///< where the corners of each cell end in this list
  std::vector<GridArray> of_points = {}, of_cells = {};

  std::int32_t add_point(const Vec2& point) {
    points.push_back(point);
    return static_cast<std::int32_t>(points.size()) - 1;
  }
  void end_cell() { ends.push_back(static_cast<std::int32_t>(corners.size())); }
  void add_cell(std::initializer_list<std::int32_t> of) {
    corners.insert(corners.end(), of);
    end_cell();
  }
};

}  // namespace apothem
