// Files with points, lines and polygons with holes, as results of geometry. Coordinates are written
// with as many digits as bring back the same double.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon/polygon_with_holes.hpp"

namespace apothem {

/// Formats of such files.
enum class ShapeFormat { wkt, geojson, svg, vtu };

/// The format that the extension of a file's name stands for, if it is known.
std::optional<ShapeFormat> shape_format(const std::string& file);
/// The extensions, for messages and help.
inline constexpr const char* kShapeFormats = ".wkt, .geojson, .svg or .vtu";

/// A shape with numbers that belong to it.
struct Shape {
  enum class Kind { point, line, polygon };
  Kind kind;
  Rings rings;  ///< one point; the points of a line; the outer ring of a polygon and its holes; m
  std::vector<std::pair<std::string, double>> properties = {};
};
inline Shape polygon_shape(const PolygonWithHoles& polygon) {
  return {Shape::Kind::polygon, rings_of(polygon)};
}

/// The shapes as the bytes of a file. All shapes have the same properties, or none.
/// - WKT: one geometry, which is empty, single, multiple, or a collection; without the properties.
/// - GeoJSON: a collection of features with their properties.
/// - SVG: one path for each shape, with its properties as attributes data-NAME. Coordinates are
///   those of the shapes; a transformation turns the y axis upwards.
/// - VTU: convex cells, with the properties as cell data, and the number of the shape as `shape`.
std::string shape_text(const std::vector<Shape>& shapes, ShapeFormat format);

}  // namespace apothem
