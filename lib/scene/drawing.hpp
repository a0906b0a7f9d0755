// Reads drawings: files of DXF, WKT, GeoJSON and CSV.
#pragma once

#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/scene/drawing_unit.hpp"

namespace apothem {

/// Something that is drawn, in units of the drawing.
struct DrawnShape {
  enum class Kind {
    label,
    line,
    area,
    left_out,     ///< no outline, see `remark`
    unbounded,    ///< a line without ends, which matters only between lines
    unsupported,  ///< it cannot be read, see `remark`
  };
  Kind kind;
  /// One point of a label, the vertices of a line, or the outer ring of an area and its holes. As
  /// in the file: the first vertex may be repeated at the end.
  std::vector<std::vector<Vec2>> rings;
  std::string layer;     ///< empty if it has none
  std::string name;      ///< by the attribute "name" or "id", or the text of a label; may be empty
  std::string place;     ///< where it stands in the file, for messages
  std::string entity;    ///< what the format calls it
  std::string remark;    ///< why it is left out, or what is wrong with it, and a remedy
  bool further = false;  ///< it belongs to the entity of the shape before it
  bool hidden = false;   ///< the drawing does not show it: its layer is off or frozen, or itself
};

struct Drawing {
  std::vector<DrawnShape> shapes;   ///< in the order of the file; curves are given by chords
  std::vector<std::string> layers;  ///< of its table of layers, if it has one
  DrawingUnit unit;
};

/// The name's ending tells the format: .dxf; .wkt or .txt, with geometries of WKT one after the
/// other; .geojson or .json; .csv, with a column WKT, or with a vertex x, y in each row and the id
/// of its outline. Throws SceneError.
Drawing read_drawing(const std::string& file);

}  // namespace apothem
