// The unit of length that a drawing states.
#pragma once

#include <string>

#include "geometry/polygon/point.hpp"

namespace apothem {

struct DrawingUnit {
  double metres = 1;    ///< of a unit of the drawing
  std::string source;   ///< what says so, as "millimetres, by $INSUNITS 4"; empty if nothing does
  std::string problem;  ///< why a scene must give the scale, and which; empty if it need not
};

/// Of $INSUNITS in a DXF file. 0, and only that, states no unit.
DrawingUnit unit_of_dxf(int code);

/// Of EPSG:NUMBER (`system`), as SRID=NUMBER in WKT states it. `file` is named in remedies, and
/// `box` has the coordinates.
DrawingUnit unit_of_system(const std::string& system, const std::string& file, const Box& box);

/// Of GeoJSON with this "crs", which is empty if it has none. Such a file is in degrees by its
/// standard (RFC 7946), but programs without maps write plain coordinates into it. It is taken for
/// a map if all coordinates can be degrees and the drawing is far from 0, 0 for its extent.
DrawingUnit unit_of_geojson(const std::string& crs, const std::string& file, const Box& box);

/// Of a file with one polygon: GeoJSON, WKT, or a plain list of vertices, which states no unit.
DrawingUnit unit_of_polygon(const std::string& text, const std::string& file, const Box& box);

/// The name of the "crs" of a text of GeoJSON; empty if it has none, or null.
std::string crs_of_geojson(const std::string& text);

}  // namespace apothem
