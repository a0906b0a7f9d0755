// Union, intersection and difference of sets of the plane, and the set that rings surround. All of
// them are decided exactly, by CGAL's arrangement of the rings' edges; the coordinates of crossings
// are rounded once, to the nearest double.
//
// Rounded crossings may lie on the wrong side of a near edge, so that the rounded boundary crosses
// itself where the exact one does not. The operation is then repeated with the rounded rings, until
// rounding changes nothing. Every step moves a vertex by half a unit in the last place at most.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/polygon_with_holes.hpp"

namespace apothem {

enum class BooleanOperation { join, intersection, difference };

/// The operations by name.
struct NamedOperation {
  std::string_view name;
  BooleanOperation operation;
};
inline constexpr std::array kBooleanOperations{
    NamedOperation{"union", BooleanOperation::join},
    NamedOperation{"intersection", BooleanOperation::intersection},
    NamedOperation{"difference", BooleanOperation::difference},
};

/// What rings surround an odd number of times (the even-odd rule), as polygons whose interiors are
/// connected. The rings may cross, touch and repeat themselves and each other; spikes and rings
/// without area vanish. Vertices of the rings stay, also those with an angle of 180 degrees. If one
/// of them is on the boundary of a polygon, its outer ring begins with the first one of these.
/// Throws InvalidPolygon for coordinates that are not finite, or beyond 1e60.
std::vector<PolygonWithHoles> even_odd_polygons(const Rings& rings);

/// The operation on the sets that `a` and `b` surround by the even-odd rule. Common points and
/// edges without area are no part of the result. Throws as even_odd_polygons().
std::vector<PolygonWithHoles> boolean_operation(const Rings& a, const Rings& b,
                                                BooleanOperation operation);
inline std::vector<PolygonWithHoles> boolean_operation(const Polygon& a, const Polygon& b,
                                                       BooleanOperation operation) {
  return boolean_operation(rings_of(a), rings_of(b), operation);
}

}  // namespace apothem
