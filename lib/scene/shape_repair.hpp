// Repairs what a drawing shows, shape by shape.
#pragma once

#include <string>
#include <vector>

#include "geometry/regions/repair.hpp"
#include "lib/scene/drawing.hpp"

namespace apothem {

/// The shapes of a file, in m as far as a DXF file states its unit: of a drawing, see
/// read_drawing(), or the rings of a file as read_polygon_file() reads it. Throws SceneError.
std::vector<DrawnShape> read_shapes(const std::string& file);

/// Where a shape stands in its drawing: "feature 3 on layer \"stones\"".
std::string place_of(const DrawnShape& shape);

/// The distance between the ends of a line, m.
double gap_of(const DrawnShape& line);

/// A shape of the kinds line and area, and its faults in words.
struct RepairedShape {
  Repaired result;
  std::vector<std::string> faults;  ///< with the place of the shape
};

/// Repairs the rings of a shape. The ends of a line are joined, whatever their distance.
RepairedShape repair_shape(const DrawnShape& shape, double tolerance);

}  // namespace apothem
