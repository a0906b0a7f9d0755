// Polygons in well-known text (OGC 06-103r4), POLYGON ((x y, x y, ...)), as geographical programs
// write it.
#pragma once

#include <string>
#include <string_view>

#include "lib/scene/ring_text.hpp"

namespace apothem {

/// The rings of a POLYGON, or of a MULTIPOLYGON that holds one polygon: the outer one and holes.
/// White space may stand between any two words, and upper and lower case mean the same. A
/// coordinate system in front ("SRID=4326;") is not used. Throws PolygonError, at the vertex where
/// there is one, for anything else: further polygons, empty ones, Z and M coordinates, numbers that
/// are none.
PolygonText parse_wkt(std::string_view text, const std::string& file);

/// Reads the polygon that a text begins with as parse_wkt() does, and takes it off the text.
PolygonText take_wkt(std::string_view& text, const std::string& file);

}  // namespace apothem
