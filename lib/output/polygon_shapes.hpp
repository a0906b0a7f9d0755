// Parts of a polygon's geometry as shapes for a file. Numbers of edges are those of the rings as
// they were given, one after the other; coordinates are those of its vertices, m.
#pragma once

#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"
#include "geometry/skeleton/singular_area.hpp"
#include "lib/output/shape_file.hpp"

namespace apothem {

/// The inner arcs of the straight skeleton as lines: `left_edge` and `right_edge`, the edges on
/// whose faces the arc lies; `start_height` and `end_height`, the roof at its ends, m.
std::vector<Shape> skeleton_shapes(const Polygon& polygon, const Skeleton& skeleton);

/// The faces of the roof as polygons: `edge`.
std::vector<Shape> face_shapes(const Polygon& polygon, const Skeleton& skeleton);

/// The polygon with its sides moved inwards by a depth (m > 0) along its straight skeleton, as
/// polygons: `depth`, m. There may be several or none.
std::vector<Shape> offset_shapes(const Polygon& polygon, const Skeleton& skeleton, double depth);

/// Polygons, lines and points of a singular area.
std::vector<Shape> singular_shapes(const Polygon& polygon, const SingularArea& singular);

/// The largest inscribed circles as polygons with 180 corners on the circle: `radius`, `centre_x`
/// and `centre_y`, m. If the centres form segments, these are the circles at their ends.
std::vector<Shape> circle_shapes(const Polygon& polygon, const InscribedCircle& circle);

}  // namespace apothem
