#include "lib/output/shape_file.hpp"

#include <fmt/format.h>
#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <string_view>

#include "geometry/polygon/triangulation.hpp"
#include "lib/output/convex_cells.hpp"
#include "lib/output/vtk_grid.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

using Kind = Shape::Kind;

struct NamedShapeFormat {
  std::string_view ending;
  ShapeFormat format;
};
constexpr std::array kEndings{
    NamedShapeFormat{".wkt", ShapeFormat::wkt}, NamedShapeFormat{".geojson", ShapeFormat::geojson},
    NamedShapeFormat{".svg", ShapeFormat::svg}, NamedShapeFormat{".vtu", ShapeFormat::vtu}};

// A list of texts with a comma and a blank between them.
template <class List, class Text>
std::string listed(const List& list, const Text& text) {
  std::string result;
  for (const auto& item : list) result += (result.empty() ? "" : ", ") + text(item);
  return result;
}

// The points of a ring as formats ask for it that repeat the first point at the end.
std::vector<Vec2> closed(std::vector<Vec2> ring) {
  ring.push_back(ring.front());
  return ring;
}

// ------------------------------------------------------------------------------------------ WKT

std::string wkt_points(const std::vector<Vec2>& points) {
  return "(" + listed(points, [](const Vec2& p) { return fmt::format("{} {}", p.x(), p.y()); }) +
         ")";
}

std::string wkt_coordinates(const Shape& shape) {
  if (shape.kind != Kind::polygon) return wkt_points(shape.rings[0]);
  return "(" + listed(shape.rings, [](const auto& ring) { return wkt_points(closed(ring)); }) + ")";
}

const char* wkt_name(Kind kind) {
  return kind == Kind::point ? "POINT" : kind == Kind::line ? "LINESTRING" : "POLYGON";
}

std::string wkt(const std::vector<Shape>& shapes) {
  if (shapes.empty()) return "GEOMETRYCOLLECTION EMPTY\n";
  const auto single = [](const Shape& shape) {
    return fmt::format("{} {}", wkt_name(shape.kind), wkt_coordinates(shape));
  };
  if (shapes.size() == 1) return single(shapes[0]) + "\n";
  const bool alike = std::all_of(shapes.begin(), shapes.end(),
                                 [&](const Shape& s) { return s.kind == shapes[0].kind; });
  return alike ? fmt::format("MULTI{} ({})\n", wkt_name(shapes[0].kind),
                             listed(shapes, wkt_coordinates))
               : fmt::format("GEOMETRYCOLLECTION ({})\n", listed(shapes, single));
}

// -------------------------------------------------------------------------------------- GeoJSON

std::string json_point(const Vec2& p) { return fmt::format("[{}, {}]", p.x(), p.y()); }

std::string json_points(const std::vector<Vec2>& points) {
  return "[" + listed(points, json_point) + "]";
}

std::string json_coordinates(const Shape& shape) {
  if (shape.kind == Kind::point) return json_point(shape.rings[0][0]);
  if (shape.kind == Kind::line) return json_points(shape.rings[0]);
  return "[" + listed(shape.rings, [](const auto& ring) { return json_points(closed(ring)); }) +
         "]";
}

std::string geojson(const std::vector<Shape>& shapes) {
  std::string features;
  for (const Shape& shape : shapes) {
    const char* type = shape.kind == Kind::point  ? "Point"
                       : shape.kind == Kind::line ? "LineString"
                                                  : "Polygon";
    const std::string properties = listed(shape.properties, [](const auto& property) {
      return fmt::format("\"{}\": {}", property.first, property.second);
    });
    features += fmt::format(
        "{}{{\"type\": \"Feature\", \"properties\": {{{}}}, \"geometry\": {{\"type\": \"{}\", "
        "\"coordinates\": {}}}}}",
        features.empty() ? "" : ",\n", properties, type, json_coordinates(shape));
  }
  return fmt::format("{{\"type\": \"FeatureCollection\", \"features\": [\n{}\n]}}\n", features);
}

// ------------------------------------------------------------------------------------------ SVG

std::string svg_path(const Shape& shape) {
  std::string path;
  for (const std::vector<Vec2>& ring : shape.rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      path += fmt::format("{}{} {}",
                          path.empty() ? "M"
                          : i == 0     ? " M"
                                       : " L",
                          ring[i].x(), ring[i].y());
    }
    // A line without length and with round ends is a dot.
    path += shape.kind == Kind::polygon ? " Z" : shape.kind == Kind::point ? " h0" : "";
  }
  return path;
}

std::string svg(const std::vector<Shape>& shapes) {
  Box box;
  for (const Shape& shape : shapes) {
    for (const std::vector<Vec2>& ring : shape.rings) box.include(box_of(ring));
  }
  if (shapes.empty()) box = {0, 0, 0, 0};
  const double margin = box.extent() > 0 ? 0.05 * box.extent() : 1;
  box = box.grown(margin);
  const double width = box.x1 - box.x0, height = box.y1 - box.y0;
  constexpr double kLongest = 800;  // pixels
  const double pixels = kLongest / std::max(width, height);
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.6g}\" height=\"{:.6g}\" viewBox=\"{} "
      "{} {} {}\">\n<g transform=\"scale(1,-1)\" stroke=\"black\" stroke-linecap=\"round\" "
      "stroke-linejoin=\"round\">\n",
      pixels * width, pixels * height, box.x0, -box.y1, width, height);
  for (const Shape& shape : shapes) {
    const bool area = shape.kind == Kind::polygon;
    text += fmt::format(
        "<path fill=\"{}\" fill-rule=\"evenodd\" stroke-width=\"{}\" "
        "vector-effect=\"non-scaling-stroke\" d=\"{}\"",
        area ? "#9ecae1" : "none", shape.kind == Kind::point ? 5 : 1, svg_path(shape));
    for (const auto& [name, value] : shape.properties) {
      text += fmt::format(" data-{}=\"{}\"", name, value);
    }
    text += "/>\n";
  }
  return text + "</g>\n</svg>\n";
}

// ------------------------------------------------------------------------------------------ VTU

// Lists of points of a shape, each of which is a cell.
std::vector<std::vector<int>> cells_of(const Shape& shape) {
  std::vector<int> all(shape.rings[0].size());
  std::iota(all.begin(), all.end(), 0);
  if (shape.kind != Kind::polygon) return {all};
  if (shape.rings.size() == 1) return convex_cells(shape.rings[0]);
  std::vector<std::vector<int>> cells;
  for (const Triangle& triangle : triangulate(polygon_of_rings(shape.rings))) {
    cells.emplace_back(triangle.begin(), triangle.end());
  }
  return cells;
}

std::string vtu(const std::vector<Shape>& shapes) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points = double_points();
  grid->SetPoints(points);
  vtkNew<vtkIntArray> number = integers("shape");
  std::vector<vtkNew<vtkDoubleArray>> values;
  if (!shapes.empty()) {
    for (const auto& property : shapes[0].properties) {
      values.push_back(doubles(property.first.c_str(), 1));
    }
  }
  for (size_t i = 0; i < shapes.size(); ++i) {
    const Shape& shape = shapes[i];
    const vtkIdType first = points->GetNumberOfPoints();
    for (const std::vector<Vec2>& ring : shape.rings) {
      for (const Vec2& p : ring) points->InsertNextPoint(p.x(), p.y(), 0);
    }
    const int type = shape.kind == Kind::point  ? VTK_VERTEX
                     : shape.kind == Kind::line ? VTK_POLY_LINE
                                                : VTK_POLYGON;
    for (const std::vector<int>& cell : cells_of(shape)) {
      std::vector<vtkIdType> nodes;
      nodes.reserve(cell.size());
      for (const int corner : cell) nodes.push_back(first + corner);
      grid->InsertNextCell(type, static_cast<vtkIdType>(nodes.size()), nodes.data());
      number->InsertNextValue(static_cast<int>(i));
      for (size_t k = 0; k < values.size(); ++k) {
        values[k]->InsertNextValue(shape.properties[k].second);
      }
    }
  }
  grid->GetCellData()->AddArray(number);
  for (const auto& array : values) grid->GetCellData()->AddArray(array);
  return xml(grid);
}

}  // namespace

std::optional<ShapeFormat> shape_format(const std::string& file) {
  for (const NamedShapeFormat& known : kEndings) {
    if (lower_case(file).ends_with(known.ending)) return known.format;
  }
  return std::nullopt;
}

std::string shape_text(const std::vector<Shape>& shapes, ShapeFormat format) {
  switch (format) {
    case ShapeFormat::wkt:
      return wkt(shapes);
    case ShapeFormat::geojson:
      return geojson(shapes);
    case ShapeFormat::svg:
      return svg(shapes);
    case ShapeFormat::vtu:
      return vtu(shapes);
  }
  return {};
}

}  // namespace apothem
