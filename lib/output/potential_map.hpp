// A contact potential as parts of a polygon in which it is linear, for pictures and for the numbers
// beside them. For the potentials of contacts (Eqs. 2 and 6) the parts come from the structure that
// the contact kernels integrate. The area potential of Eq. 2 is defined for triangles only; what it
// may mean for other polygons is read in three ways.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"
#include "geometry/skeleton/singular_area.hpp"

namespace apothem {

/// The potential that a map shows. A_i is the area of the triangle of a point with edge i of n, A
/// that of the polygon.
enum class MapKind {
  distance,       ///< Eq. 6
  area,           ///< Eq. 2, triangles only
  area_smallest,  ///< min_i n A_i/A
  area_sectors,   ///< n A_i/A in the triangle of edge i with the centroid
  area_halves     ///< Eq. 2 in the two triangles into which a diagonal cuts a quadrilateral
};

/// The kinds by name, in the order of MapKind.
inline constexpr std::array<std::string_view, 5> kMapKinds{"distance", "area", "area_smallest",
                                                           "area_sectors", "area_halves"};

/// A part in which the potential is linear: phi(x) = gradient . (x - base).
struct PotentialPiece {
  int edge;                ///< of the polygon as it was given
  std::vector<Vec2> ring;  ///< counter-clockwise, m
  Vec2 base, gradient;     ///< m, 1/m

  [[nodiscard]] double phi(const Vec2& x) const { return gradient.dot(x - base); }
};

/// A potential over a polygon. All coordinates are those of the polygon's vertices.
struct PotentialMap {
  std::vector<Vec2> outline;
  Rings holes;
  std::vector<PotentialPiece> pieces;     ///< tile the polygon; phi is limited to 1
  double reference = 0;                   ///< reference length r of the distance potential, m
  std::optional<InscribedCircle> circle;  ///< only of the distance potential
  std::optional<SingularArea> singular;   ///< only of the distance potential
};

/// Makes the map of a polygon. `choice` is only of use for the distance potential. Throws
/// InvalidPolygon, also if the polygon is not one that the kind is defined for.
PotentialMap potential_map(const Polygon& polygon, MapKind kind,
                           const PotentialChoice& choice = {});

/// phi at a point of the polygon; in a border between parts that of one of them.
double phi_at(const PotentialMap& map, const Vec2& x);
/// The largest phi, at most 1.
double largest_phi(const PotentialMap& map);
/// The largest difference of phi between two parts in their common border.
double largest_jump(const PotentialMap& map);

}  // namespace apothem
