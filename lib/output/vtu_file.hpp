// Private header: reads the files of VTK time series back.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// A data array: so many components for each point, cell or file.
struct FileArray {
  int components = 1;
  std::vector<double> values;  ///< tuple after tuple
  [[nodiscard]] double operator()(size_t tuple, size_t component = 0) const {
    return values[tuple * static_cast<size_t>(components) + component];
  }
  [[nodiscard]] Vec2 vector(size_t tuple) const { return {(*this)(tuple, 0), (*this)(tuple, 1)}; }
};

/// An unstructured grid in the plane, as a file has it.
struct GridFile {
  using Arrays = std::map<std::string, FileArray>;

  std::string name;            ///< of the file
  std::vector<Vec2> points;    ///< m
  std::vector<int> corners;    ///< point numbers of all cells
  std::vector<int> first{0};   ///< cell c has the corners first[c] ... first[c + 1] - 1
  Arrays of_points, of_cells;  ///< by name
  Arrays of_file;

  [[nodiscard]] size_t cells() const { return first.size() - 1; }
  [[nodiscard]] std::vector<int> cell(size_t c) const {
    return {corners.begin() + first[c], corners.begin() + first[c + 1]};
  }
  [[nodiscard]] std::vector<Vec2> line(size_t c) const;  ///< places of the corners of a cell
  /// The array, empty in a file without cells. Throws ResultsError if there is none of that name
  /// with so many components or more for each point or cell.
  [[nodiscard]] const FileArray& point_array(const char* array, int components = 1) const;
  [[nodiscard]] const FileArray& cell_array(const char* array, int components = 1) const;
};

/// Reads a .vtu file. Throws ResultsError if it is not there or cannot be read.
GridFile read_vtu(const std::string& file);

/// Times (s) and files of a .pvd file, in its order; files relative to its folder. Throws
/// ResultsError if it is not there or cannot be read.
std::vector<std::pair<double, std::string>> read_pvd(const std::string& file);

}  // namespace apothem
